"""Scratch space of the lines of a system in fixed steps, and what of them moves in one.

What a drum does stands in `FixedRoom.numbers`, at the places below. Its length and speed at the start of a fixed step are
those of the state of its line.
"""

from collections import namedtuple

from ..arrays import behind
from ..compilation import kernel, view
from ..equations.lines import CONDITIONS, conditions_of, lines_of, motion_of, room_of, segments_of
from ..equations.winch import length_at, rate_at
from ..flat_arrays import part
from ..line import incremental_potential, second_order
from ..line.drum_in_backward_euler import Trial
from ..line.drum_step import chain_with
from ..linear_algebra import condensed
from .system_drums import drum_at
from .system_room import has_drum

(
    FROM_LENGTH,  # L0 [m] of the step that is attempted
    FROM_SPEED,  # u0 [m/s]
    LOWEST,  # limits of the speed in it [m/s]
    HIGHEST,
    SPEED,  # u of the iteration [m/s]
    CHANGE,  # by how much the last iteration changed it [m/s]
    WAY,  # how u' is sought in the iteration
    SOUGHT,  # its value where that is given [m/s]
    ONWARD,  # u' as found [m/s]
    IS_FOUND,  # 1 if u' was found as it was sought, else 0
    BEFORE,  # the speed in the second stage of the last step [m/s]
    FIRST,  # the speeds in the first two stages [m/s]
    SECOND,
    REACHED,  # the length after a stage [m]
    ONWARD_LENGTH,  # the start of the third stage but for the result of the second one [m]
    ONWARD_SPEED,  # [m/s]
    DRUM_NUMBERS,  # how many there are
) = range(17)

FixedRoom = namedtuple("FixedRoom", "stages columns goal column numbers")
FixedRoom.__doc__ = """Scratch arrays of a line in fixed steps.

stages : `second_order.Workspace`.  columns : of its ends, see `linear_algebra.condensed`.
goal : 1, the largest move of a node with which it has converged [m].
column : of its drum, 3 (n + 1), see `drum_in_backward_euler.py`.  numbers : of its drum, DRUM_NUMBERS.
"""

Step = namedtuple("Step", "time h kind turns")
Step.__doc__ = """A step of all lines: its start [s] in the communication step, h [s], its kind (`backward_euler.start`).

turns : whether the speeds of the drums are found in it; else their lengths change as the conditions of their lines say.
"""


@kernel
def line_work_size(n):
    """Length of what a line of n segments needs of `work`: an even number, as in `system_room.py`."""
    size = CONDITIONS + second_order.workspace_size(n) + condensed.columns_size(n) + 1 + 3 * (n + 1) + DRUM_NUMBERS
    return size + size % 2


@view
def room_in_fixed_steps(system, k):
    """`FixedRoom` of line k."""
    n, room = segments_of(system, k), behind(CONDITIONS, room_of(system, k))
    own, columns = second_order.workspace_size(n), condensed.columns_size(n)
    goal, beside = part(room, own + columns, 1), behind(own + columns + 1, room)
    column, numbers = part(beside, 0, 3 * (n + 1)), part(beside, 3 * (n + 1), DRUM_NUMBERS)
    return FixedRoom(second_order.workspace(n, room), part(room, own, columns), goal, column, numbers)


@view
def scratch_of(system, k):
    """`backward_euler.Workspace` of line k."""
    return room_in_fixed_steps(system, k).stages.chain


@kernel
def is_turning(system, k, step):
    """Whether line k has a drum whose speed is found in the step."""
    return step.turns and has_drum(system, k)


@kernel
def any_drum(system):
    """Whether any winch is controlled by force."""
    count = 0
    for k in range(lines_of(system)):
        count += has_drum(system, k)
    return count > 0


@kernel
def length_and_rate(system, k, step):
    """Unstretched length [m] of line k at the end of a step and its rate [m/s], in the iteration."""
    if is_turning(system, k, step):
        numbers = room_in_fixed_steps(system, k).numbers
        return numbers[FROM_LENGTH] + step.h * numbers[SPEED], numbers[SPEED]
    reeling, end = conditions_of(system, k).reeling, step.time + step.h
    return length_at(reeling, end), rate_at(reeling, end)


@view
def attempt_of(system, k, step):
    """`incremental_potential.Attempt` of line k."""
    conditions = conditions_of(system, k)
    _, v = motion_of(system, k)
    chain = chain_with(conditions, *length_and_rate(system, k, step))
    return incremental_potential.Attempt(conditions, chain, step.h, v)


@view
def trial_of_line(system, k, step):
    """`drum_in_backward_euler.Trial` of line k, which has a drum."""
    numbers = room_in_fixed_steps(system, k).numbers
    start = numbers[FROM_LENGTH], numbers[FROM_SPEED]
    drum = drum_at(conditions_of(system, k))
    return Trial(drum, step.time, step.h, *start, numbers[LOWEST], numbers[HIGHEST])
