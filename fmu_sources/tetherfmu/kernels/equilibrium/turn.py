"""Equilibrium of a slack chain that hardly anything keeps from turning about its chord: turned to where its loads leave it.

A slack chain between ends one above the other hangs in a fold, and a faint wind alone says to which side. Hardly anything
keeps it from turning about the chord, so that Newton's method asks for turns far beyond what its linear equations are good
for, and a chain that creeps turns too slowly. But a turn of the inner nodes about the chord, by an angle phi, leaves lengths
and tensions as they are. So the angle is found by itself, from the torque of the loads about the chord, of the direction c,

    M(phi) = sum_i c . (r_i x f_i) = 0,    dM/dphi < 0,

where the chain is stable, and Newton's method goes on from there. Between two turns the chain creeps: all but its turn comes
to rest. Source: docs/numerics.md, "Initial shape".
"""

from math import cos, pi, sin, sqrt

from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from ..algebra.vectors import add, along, cross, dot, get, put, scale, sub
from ..arrays import copy
from ..chain import nodes, segment
from ..compilation import kernel
from . import newton, strut

MOST_TURNS = 4
DIRECTIONS, HALVINGS = 24, 40  # angles of a whole turn that are looked at; of the interval between two of them
COSINE, SINE = cos(2.0 * pi / DIRECTIONS), sin(2.0 * pi / DIRECTIONS)  # of this interval


@kernel
def turn_by(body, cosine, sine):
    """Turn the inner nodes of the body [m] (modified) about its chord by an angle with this cosine and sine."""
    x, n = body.x, body.chain.n
    ground = get(x, 0)
    _, c = segment.geometry(sub(get(x, n), ground))
    for i in range(1, n):
        r = sub(get(x, i), ground)
        turned = along(scale(cosine, r), sine, cross(c, r))
        put(x, i, add(ground, along(turned, (1.0 - cosine) * dot(c, r), c)))


@kernel
def torque(body, w):
    """Torque [N m] of the loads of the inner nodes about the chord (w.load and velocities of inner nodes modified)."""
    x, n = body.x, body.chain.n
    ground = get(x, 0)
    _, c = segment.geometry(sub(get(x, n), ground))
    newton.node_loads(body, newton.NO_PULL, w.tension, w.mass, w.load)
    total = 0.0
    for i in range(1, n):
        total += dot(c, cross(sub(get(x, i), ground), get(w.load, i)))
    return total


@kernel
def turn_to_rest(body, w):
    """Turn the body about its chord to the next angle where its loads no longer turn it, and would turn it back."""
    last = torque(body, w)
    for _ in range(DIRECTIONS):
        turn_by(body, COSINE, SINE)
        now = torque(body, w)
        if last > 0.0 >= now:
            break
        last = now
    cosine, sine = COSINE, SINE
    turn_by(body, cosine, -sine)
    for _ in range(HALVINGS):
        half = sqrt(0.5 * (1.0 + cosine))
        cosine, sine = half, 0.5 * sine / half
        turn_by(body, cosine, sine)
        if torque(body, w) <= 0.0:
            turn_by(body, cosine, -sine)


@kernel
def relax(body, firmness, w):
    """Newton's method from the positions in w.kept and w.kept_tension: whether it finds a stable equilibrium, iterations."""
    iterations = 0
    for compliant in (False, True):
        copy(w.kept, body.x)
        copy(w.kept_tension, w.tension)
        found, more = newton.relax(body, compliant, False, firmness, w)
        iterations += more
        if found and not strut.is_strut(body.chain, body.x, strut.PARALLEL):
            return True, iterations
    return False, iterations


@kernel
def find(body, w):
    """Stable equilibrium between the ends of the body where `newton.find` has found none.

    Positions and velocities of its inner nodes are modified. Returns a status (OK or NO_EQUILIBRIUM) and the number of
    Newton iterations.
    """
    nodes.node_masses(body.chain, w.mass)
    iterations = 0
    firmness = newton.guess(body, False, w)
    for _ in range(MOST_TURNS):
        turn_to_rest(body, w)
        copy(body.x, w.kept)
        copy(w.tension, w.kept_tension)
        found, more = relax(body, firmness, w)
        iterations += more
        if found:
            return OK, iterations
        copy(w.kept, body.x)
        copy(w.kept_tension, w.tension)
        _, more = newton.relax(body, False, True, firmness, w)
        iterations += more
    return NO_EQUILIBRIUM, iterations
