"""Fixed steps of a chain with the drum of a winch: the stages of `second_order.py`, with its length and speed beside them.

    L1 = L0 + g h u1,   u1 = u0 + g h f(x1, v1, L1, u1)/m,   and so on, as x and v of a node

A stage is a step of backward Euler over g h. Without mass f = 0 in each stage, and what putting driven ends on
their curves leaves of it is taken away by `moving_drum.project`. A step is taken anew by backward Euler where one without a
drum is, and where the drum comes to rest or to a stop, or leaves them, within the step: it then rests, or turns, at its end.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK

from ..compilation import kernel
from ..equations import segment
from ..equations.drum import INWARDS, OUTWARDS, is_at_stop
from ..equations.properties import property_of
from ..linear_algebra.vectors import dot, get, sub
from .drum_step import chain_with, first_tension
from .moving_drum import project

Motion = namedtuple("Motion", "length speed before")
Motion.__doc__ = "Length [m] and speed [m/s] of the drum; before : its speed in the second stage of the last step [m/s]."


@kernel
def turns_smoothly(drum, speed, first, second, third):
    """Whether a drum turns, or is held, throughout a step, with its speeds [m/s] at the start and in the stages."""
    if first == 0.0 and second == 0.0 and third == 0.0:
        return drum.mass == 0.0 or speed == 0.0
    if first == 0.0 or second == 0.0 or third == 0.0:
        return False
    if drum.friction == 0.0:
        return True
    return first * second > 0.0 and second * third > 0.0 and (drum.mass == 0.0 or speed * first > 0.0)


@kernel
def power_of_growth(conditions, motion, x, v):
    """Power [W] at most with which the energy of chain and drum grows because not all segments pull as the first one does.

    What the drum pays out lengthens all of them, and only the first one pulls at it; motion : `Motion`.
    """
    chain, power = chain_with(conditions, motion.length, motion.speed), 0.0
    first = first_tension(chain, x, v)
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rate = dot(e, sub(get(v, s + 1), get(v, s)))
        tension = segment.tension_of(chain, s, segment.BY_LENGTH, length, rate)
        power += abs(property_of(chain, s, at.SHARE) * first - tension * length / chain.length)
    return power * abs(motion.speed)


@kernel
def balanced(conditions, drum, time, d, end, x, v):
    """`Motion` after a step with T = W + c u + F sign(u) at a time [s], of a drum without mass that turns; a status.

    d : as for `moving_drum.project`.
    """
    length, speed, before = end
    is_held = speed == 0.0 and (
        drum.friction > 0.0 or is_at_stop(drum, length, OUTWARDS) or is_at_stop(drum, length, INWARDS)
    )
    if drum.mass > 0.0 or is_held:
        return end, OK
    direction = INWARDS if speed < 0.0 else OUTWARDS
    length, speed, found = project(conditions, drum, direction, time, d, length, speed, x, v)
    return Motion(length, speed, before), OK if found else NO_LENGTH
