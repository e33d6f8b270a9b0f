"""Unstretched length at which a drum is in balance with a tether in equilibrium: the root of one increasing function.

    m (u - u*)/h + c u + F sign(u) + W - T(L) = 0,   u = (L - L*)/h      in a stage of `drum_in_equilibrium.py`
               c u + F sign(u) + W - T(L) = 0,   u = u*               at the start, h = inf (`variants/winch_start.py`)

T is the ground tension. A length beyond a stop is replaced by the stop. Secant method: `secant.py`.
"""

from collections import namedtuple
from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK, STEP_BUDGET_SPENT

from ..compilation import kernel
from ..equations.drum import balance, force_at
from ..equations.properties import chain_of, property_of
from . import secant

MOST_EVALUATIONS = 80  # of the tension for one length
MOST_FAILURES = 2  # failed shapes, each after the whole ladder of `rest.solve`, before it gives up
EXACT, ROUNDING = 1e-13, 3e-16  # of the forces; of the length
NARROW = 1e-12  # interval of the length, relative, in which its tension jumps by rounding
LONGEST = 1e7  # [m], upper limit of the search

Stage = namedtuple("Stage", "direction time h length speed")
Stage.__doc__ = """Where a balance is sought: the direction of the drum and a time [s] of the communication step.

h : gamma times the length of the piece, or all of it without mass and damping [s]; inf for a given speed.
length, speed : L* [m], u* [m/s].
"""


@kernel
def residual_of(drum, stage, length, pull):
    """Residual of the equation of a stage with a length [m] and its tension [N], and the inertial force in it [N]."""
    speed = stage.speed if stage.h == inf else (length - stage.length) / stage.h
    inertial = drum.mass * (speed - stage.speed) / stage.h
    return inertial - balance(drum, stage.direction, pull, speed, stage.time), inertial


def search_with(tension_with, farthest):
    """Return the kernel find(tether, drum, stage, guess, most, state, work), which returns a length.

    tension_with : kernel (tether, length, state, work) that returns a status and the tension [N] at an unstretched length
    [m], which is written to the state (modified).  farthest : relative change of the length between evaluations.
    """

    @kernel
    def find(tether, drum, stage, guess, most, state, work):
        """Length [m] of a `Stage`, from an initial guess [m], with its tension [N]; and a status.

        tether : with its n and parameters.  most : iterations since the start at which the search is abandoned.
        Leaves the state (modified) at this length.
        """
        inertia = drum.mass / (stage.h * stage.h) + drum.damping / stage.h
        stiffness = property_of(chain_of(tether.n, tether.parameters, state), 0, at.STIFFNESS)
        forces = abs(force_at(drum, stage.time)) + drum.friction
        search, length = secant.begin(drum.shortest, min(drum.longest, LONGEST), guess, inertia + stiffness / guess)
        pull, failures = 0.0, 0
        for k in range(MOST_EVALUATIONS):
            status, pull = tension_with(tether, length, state, work)
            if state[at.ITERATIONS] > most:
                return length, pull, STEP_BUDGET_SPENT
            if status != OK:
                failures += 1
                if k == 0 or failures > MOST_FAILURES:
                    return length, 0.0, status
                length = 0.5 * (length + search.last)
                continue
            residual, inertial = residual_of(drum, stage, length, pull)
            if abs(residual) <= EXACT * (forces + abs(inertial)) + ROUNDING * (stiffness + inertia * length):
                return length, pull, OK
            if length == (search.highest if residual < 0.0 else search.lowest):  # the root lies beyond it
                return length, pull, NO_LENGTH if length == LONGEST else OK
            search, onward = secant.go_on(search, length, residual, farthest * length)
            if onward == length and secant.has_interval(search):
                return length, pull, OK
            length = onward
        is_found = secant.has_interval(search) and search.high - search.low <= NARROW * search.high
        return search.last, pull, OK if is_found else NO_LENGTH

    return find
