"""A massless drum under the stretch_rate law, balanced with the tension of the first segment at every instant.

T = W + c u + F sign(u) is an algebraic equation; `project` removes the residual that a step leaves. Under the
strain_rate law the rope that moves past the nodes gives every drum inertia. See docs/models/numerics.md, "Rope coordinates".
"""

from collections import namedtuple
from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import segment
from ..equations.boundary import chain_with
from ..equations.drum import balance, force_at
from ..equations.properties import property_of, rest_length, section_of, sees_reeling
from ..linear_algebra.vectors import dot, get, sub

MOST_CORRECTIONS = 30
EXACT, ROUGH, ROUNDING = 1e-13, 1e-10, 2.5e-16  # relative errors of T = W: goal, acceptable if it stagnates, rounding of T
MOST_CHANGE = 0.5  # largest correction, relative to the section at the winch

Instant = namedtuple("Instant", "time length speed x v")
Instant.__doc__ = """A chain with a drum at a time [s] of the communication step.

length, speed : of the drum [m, m/s].  x, v : positions [m] and velocities [m/s] of the nodes.
"""


@kernel
def first_tension(chain, x, v):
    """Tension of the first segment [N] with nodes at x [m] and velocities v [m/s]."""
    length, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    return segment.tension_of(chain, 0, segment.BY_LENGTH, length, dot(e, sub(get(v, 1), get(v, 0))))


@kernel
def tension_at_rest(conditions, now):
    """Tension of the first segment [N] at an `Instant`, with the drum at rest."""
    return first_tension(chain_with(conditions, now.length, 0.0), now.x, now.v)


@kernel
def project(conditions, drum, direction, d, now):
    """Length [m] and speed [m/s] at which a massless drum has T = W + c u + F sign(u); and whether they were found.

    From an `Instant`, with fixed nodes. The length changes by d times the change of the speed, as in an implicit step;
    if no damper depends on the speed, only the length changes.
    """
    time, length, speed, x, v = now
    felt = drum.damping > 0.0 or (sees_reeling(conditions.parameters) and property_of(conditions, 0, at.DAMPING) > 0.0)
    size = abs(force_at(drum, time)) + drum.friction
    moved, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    rate = dot(e, sub(get(v, 1), get(v, 0)))
    last = inf
    for _ in range(MOST_CORRECTIONS):
        chain = chain_with(conditions, length, speed)
        rest = rest_length(chain, 0)
        k, c = segment.stiffness(chain, 0, moved - rest, rest)
        tension = segment.tension(chain, 0, moved, rate, rest, k, c)
        wrong = balance(drum, direction, tension, speed, time)
        rounding = ROUNDING * (k * moved + c * abs(rate))
        if abs(wrong) <= EXACT * size + rounding or (abs(wrong) >= 0.5 * last and abs(wrong) <= ROUGH * size + rounding):
            return length, speed, True
        last = abs(wrong)
        slope = -(k * moved + c * (rate - 2.0 * chain.seen_growth * moved)) / chain.section  # dT/dL
        by_speed = -drum.damping - (c * moved / chain.section if sees_reeling(chain.parameters) else 0.0)
        if felt:
            change = -wrong / (by_speed + d * slope)
            change = max(-MOST_CHANGE * chain.section, min(MOST_CHANGE * chain.section, d * change))
            length += change
            speed += change / d
        else:
            change = -wrong / slope
            length += max(-MOST_CHANGE * chain.section, min(MOST_CHANGE * chain.section, change))
        if not (0.0 < section_of(conditions.parameters, length) < inf and abs(speed) < inf):
            return length, speed, False
    return length, speed, False
