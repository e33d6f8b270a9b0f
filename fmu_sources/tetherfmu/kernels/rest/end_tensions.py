"""End tensions of a chain in equilibrium that is too stiff to derive its strain from positions.

A position x is a number with the relative error eps = 2^-52, so the tension of a spring between two positions has the error

    eps |x| EA/l0        (4.6 mN at EA = 1e12 N, 500 m and 25 m)

The node loads do not have this error: they yield all tension vectors from the first, and the span of the chain yields the
first (`hanging_chain.py`). If the tether is slack, an error of the span changes them little.
Source: docs/models/numerics.md, "Stiff tethers".
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import segment
from ..equations.properties import property_of, rest_length
from ..linear_algebra.vectors import ZERO_VECTOR, cross, dot, get, norm, put_at, scale, sub
from . import hanging_chain, newton
from .rigid_body import NO_PULL, loads

HELD = 1e-6  # error of a tension over the larger end tension up to which positions suffice
FAINTEST = 1e-9  # eps of `hanging_chain.py` over the larger tension
CLOSED = 1e-15  # gap over the length of the chain at which it spans the chord
OPEN = 1e-12  # gap above which it does not
ALIKE = 1e-4  # angle [rad] between tension vector and segment that indicates another, compressed shape


@kernel
def rounding(chain, s, reach):
    """Tension error [N] of segment s with its nodes up to `reach` [m] from the origin."""
    rest = rest_length(chain, s)
    return newton.ROUNDING * (reach + rest) * property_of(chain, s, at.STIFFNESS) / rest


@kernel
def are_held(body, w):
    """Whether the positions of the body determine the tensions w.tension [N] of its first and last segment."""
    n = body.chain.n
    reach = max(norm(get(body.x, 0)), norm(get(body.x, n)))
    error = max(rounding(body.chain, 0, reach), rounding(body.chain, n - 1, reach))
    return error <= HELD * max(w.tension[0], w.tension[n - 1])


@kernel
def largest_by_positions(body):
    """Largest tension [N] of the springs between the nodes of the body."""
    largest = -inf
    for s in range(body.chain.n):
        length, _ = segment.geometry(sub(get(body.x, s + 1), get(body.x, s)))
        largest = max(largest, segment.spring_tension(body.chain, s, length))
    return largest


@kernel
def is_along_segment(body, s, tension):
    """Whether a tension vector [N] pulls along segment s."""
    _, e = segment.geometry(sub(get(body.x, s + 1), get(body.x, s)))
    return dot(e, tension) > 0.0 and norm(cross(e, tension)) <= ALIKE * norm(tension)


@kernel
def from_loads(body, w):
    """Tension vectors of the first and the last segment and the largest tension [N]; and whether they were found.

    The body is in equilibrium with tensions near w.tension [N]; w.load (modified).
    """
    chain, x = body.chain, body.x
    loads(body, NO_PULL, w.tension, w.mass, w.load)
    chord = sub(get(x, chain.n), get(x, 0))
    faintest = FAINTEST * max(w.tension[0], w.tension[chain.n - 1])
    _, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    guess = scale(max(w.tension[0], faintest), e)
    first, gap = hanging_chain.solve(chain, guess, faintest, chord, w.load, CLOSED)
    last = first
    largest = norm(first)
    for i in range(1, chain.n):
        last = sub(last, get(w.load, i))
        largest = max(largest, norm(last))
    found = gap <= OPEN * chain.length and is_along_segment(body, 0, first) and is_along_segment(body, chain.n - 1, last)
    return first, last, largest, found


@kernel
def forget(state):
    """Mark the end tensions in the state (modified) as determined by positions."""
    put_at(state, at.GROUND_TENSION_VECTOR, ZERO_VECTOR)
    put_at(state, at.KITE_TENSION_VECTOR, ZERO_VECTOR)
    state[at.MISSING_TENSION] = 0.0


@kernel
def store(body, state, w):
    """Store the end tension vectors of the body at rest in the state (modified) if positions do not determine them."""
    forget(state)
    if body.chain.n == 1 or are_held(body, w):
        return
    first, last, largest, found = from_loads(body, w)
    if found:
        put_at(state, at.GROUND_TENSION_VECTOR, first)
        put_at(state, at.KITE_TENSION_VECTOR, last)
        state[at.MISSING_TENSION] = largest - largest_by_positions(body)
