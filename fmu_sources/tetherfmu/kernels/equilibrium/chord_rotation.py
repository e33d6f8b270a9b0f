"""Rotation of a slack chain about its chord, to where its loads leave it, if hardly anything else keeps it from rotating.

A slack chain between ends one above the other hangs in a fold, and a faint wind alone says to which side: the fold is
almost neutrally stable about the chord. Newton's method then asks for rotations far beyond what its linear equations are
good for, and pseudo-transient continuation rotates the chain too slowly. But a rotation of the inner nodes about the chord,
by an angle phi, leaves lengths and tensions as they are. So the angle is found by itself, from the torque of the loads about
the chord, of the direction c,

    M(phi) = sum_i c . (r_i x f_i) = 0,    dM/dphi < 0,

where the chain is stable, and Newton's method continues from there. Between two rotations pseudo-transient continuation
brings all but the angle to rest. Source: docs/models/numerics.md, "Initial shape".
"""

from math import cos, pi, sin, sqrt

from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from ..compilation import kernel
from ..equations import assembly, segment
from ..linear_algebra.vectors import add, add_scaled, cross, dot, get, put, scale, sub
from . import compressed_chain, newton
from .first_guess import guess
from .rigid_body import NO_PULL, loads

MOST_ROTATIONS = 4
DIRECTIONS, HALVINGS = 24, 40  # angles of a whole rotation that are looked at; of the interval between two of them
COSINE, SINE = cos(2.0 * pi / DIRECTIONS), sin(2.0 * pi / DIRECTIONS)  # of this interval


@kernel
def rotate(body, cosine, sine):
    """Rotate the inner nodes of the body [m] (modified) about its chord by an angle with this cosine and sine."""
    x, n = body.x, body.chain.n
    ground = get(x, 0)
    _, c = segment.geometry(sub(get(x, n), ground))
    for i in range(1, n):
        r = sub(get(x, i), ground)
        rotated = add_scaled(scale(cosine, r), sine, cross(c, r))
        put(x, i, add(ground, add_scaled(rotated, (1.0 - cosine) * dot(c, r), c)))


@kernel
def torque(body, w):
    """Torque [N m] of the loads of the inner nodes about the chord (w.load and velocities of inner nodes modified)."""
    x, n = body.x, body.chain.n
    ground = get(x, 0)
    _, c = segment.geometry(sub(get(x, n), ground))
    loads(body, NO_PULL, w.tension, w.mass, w.load)
    total = 0.0
    for i in range(1, n):
        total += dot(c, cross(sub(get(x, i), ground), get(w.load, i)))
    return total


@kernel
def rotate_to_rest(body, w):
    """Rotate the body about its chord to the next angle where its loads no longer rotate it, and would rotate it back."""
    last = torque(body, w)
    for _ in range(DIRECTIONS):
        rotate(body, COSINE, SINE)
        now = torque(body, w)
        if last > 0.0 >= now:
            break
        last = now
    cosine, sine = COSINE, SINE
    rotate(body, cosine, -sine)
    for _ in range(HALVINGS):
        half = sqrt(0.5 * (1.0 + cosine))
        cosine, sine = half, 0.5 * sine / half
        rotate(body, cosine, sine)
        if torque(body, w) <= 0.0:
            rotate(body, cosine, -sine)


@kernel
def relax(body, load_stiffness, w):
    """Newton's method from the positions in w.kept and w.kept_tension: whether it finds a stable equilibrium, iterations."""
    iterations = 0
    for compliant in (False, True):
        newton.restore(body, w)
        found, more = newton.relax(body, compliant, False, load_stiffness, w)
        iterations += more
        if found and not compressed_chain.is_unstable(body.chain, body.x, compressed_chain.PARALLEL):
            return True, iterations
    return False, iterations


@kernel
def find(body, w):
    """Stable equilibrium between the ends of the body where nothing else has found one.

    Positions and velocities of its inner nodes are modified. Returns a status (OK or NO_EQUILIBRIUM) and the number of
    Newton iterations.
    """
    assembly.node_masses(body.chain, w.mass)
    iterations = 0
    load_stiffness = guess(body, False, w)
    for _ in range(MOST_ROTATIONS):
        rotate_to_rest(body, w)
        newton.keep(body, w)
        found, more = relax(body, load_stiffness, w)
        iterations += more
        if found:
            return OK, iterations
        newton.restore(body, w)
        _, more = newton.relax(body, False, True, load_stiffness, w)
        iterations += more
    return NO_EQUILIBRIUM, iterations
