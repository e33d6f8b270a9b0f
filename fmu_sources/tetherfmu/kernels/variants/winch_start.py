"""Start of a force-controlled winch: the unstretched length at which its drum is in balance.

    T(L) = W + c u + F sign(u)      (`equations/drum.py`), with the initial reel-out speed u

T decreases with L if the tether is taut; in a tether that hangs from its winch it increases, and no winch can
balance it. The search begins at `initial_length`, then at the length d/(1 + W/EA) of a straight line over the distance d.
"""

from collections import namedtuple
from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import NO_BALANCE_AT_START, OK

from ..compilation import kernel
from ..equations import winch
from ..equations.boundary import distance_of_ends
from ..equations.drum import HELD, INWARDS, OUTWARDS, balance, direction_of, drum_of
from ..equations.properties import chain_of, property_of
from ..motion.balanced_length import Stage, search_with
from ..notes import note

FARTHEST = 0.2  # relative change of the length between evaluations

Start = namedtuple("Start", "n parameters inputs")
Start.__doc__ = """A tether that starts: number of segments, parameters and inputs."""


@kernel
def forget_notes(state):
    """Remove the notes about trial lengths from the new state (modified)."""
    state[at.WARNINGS] = 0.0
    for kind in range(at.WARNING_KINDS):
        state[at.WARNED_VALUES + kind] = 0.0


def winch_start(settle, tension):
    """Return the kernels `find` and `note_imbalance` of a variant.

    settle : kernel (n, parameters, inputs, state, work) that solves the shape of a new state (modified); returns a status.
    tension : kernel (n, parameters, state) of the ground tension [N] of such a state.
    """

    @kernel
    def tension_with(start, length, state, work):
        """A status, and the tension [N] at an unstretched length [m], which is written to the state (modified)."""
        state[at.LENGTH] = length
        status = settle(start.n, start.parameters, start.inputs, state, work)
        return status, tension(start.n, start.parameters, state)

    find_balance = search_with(tension_with, FARTHEST)

    @kernel
    def search(n, parameters, inputs, guess, state, work):
        """Whether a balanced length was found, from a guess [m]; stores it in the state (modified)."""
        drum, speed = drum_of(parameters, inputs[at.WINCH_FORCE], 0.0), state[at.REELING]
        direction = HELD if speed == 0.0 else (OUTWARDS if speed > 0.0 else INWARDS)
        stage = Stage(direction, 0.0, inf, guess, speed)
        _, _, status = find_balance(Start(n, parameters, inputs), drum, stage, guess, inf, state, work)
        return status == OK

    @kernel
    def find(n, parameters, inputs, state, work):
        """Set the length of a new state (modified) at which the winch is in balance; OK or NO_BALANCE_AT_START.

        The shape is invalid until the next `settle`.
        """
        given, force = parameters[at.INITIAL_LENGTH], max(0.0, inputs[at.WINCH_FORCE])
        stiffness = property_of(chain_of(n, parameters, state), 0, at.STIFFNESS)
        straight = distance_of_ends(n, state) / (1.0 + force / stiffness)
        is_found = search(n, parameters, inputs, given, state, work)
        if not is_found and straight > 0.0:
            is_found = search(n, parameters, inputs, straight, state, work)
        forget_notes(state)
        if is_found:
            return OK
        state[at.LENGTH] = given
        return NO_BALANCE_AT_START

    @kernel
    def note_imbalance(n, parameters, before, state):
        """Note in the state (modified) the tension [N] at the start of the first step, if it moves a massless drum far.

        before : the initial state.
        """
        if before[at.LAST_STEP] <= 0.0 and winch.follows_force(parameters) and parameters[at.WINCH_MASS] == 0.0:
            force = state[at.LAST_WINCH_FORCE]
            drum, pull = drum_of(parameters, force, 0.0), tension(n, parameters, before)
            excess = abs(balance(drum, HELD, pull, before[at.REELING], 0.0)) - drum.friction
            if direction_of(drum, before[at.LENGTH], before[at.REELING], pull, 0.0) != HELD and excess > 0.0:
                off = excess > limits.MOST_OFF_BALANCE * abs(force)
                note(state, limits.WINCH_OFF_BALANCE, pull * pull if off else 0.0, 0.0)

    return find, note_imbalance
