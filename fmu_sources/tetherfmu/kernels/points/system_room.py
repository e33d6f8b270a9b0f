"""Scratch space of the lines of a system in a step, and what of a line moves.

What a drum does in a step stands in `Room.numbers`, at the places below. Its length and speed at the start of the step, in
fixed steps of the stage, are those of the state of its line.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import behind, places_of
from ..compilation import kernel, view
from ..equations import winch
from ..equations.boundary import chain_moving
from ..equations.drum import HELD, drum_with
from ..equations.lines import CONDITIONS, conditions_of, lines_of, motion_of, parameters_of, room_of, segments_of, state_of
from ..equations.properties import property_of
from ..equations.rope_at_drum import feels_rope
from ..equations.ropes import has_coordinates, is_rope
from ..flat_arrays import part
from ..line import rosenbrock, second_order
from ..line.incremental_potential import Attempt
from ..line.rodas4p import STAGES
from ..linear_algebra import condensed
from .sheave_room import has_run, is_running, portion_gaining

Room = namedtuple("Room", "numbers columns own column")
Room.__doc__ = """Scratch arrays of a line.

numbers : see below.  columns : of its ends, see `linear_algebra.condensed`.  own : of the method, see `own_size`.
column : of its drum, 3 (n + 1).
"""
Shares = namedtuple("Shares", "by_length by_speed speeds by_velocity row border pulled")
Shares.__doc__ = """Scratch arrays of a drum in a Rosenbrock step, see `system_drums.py`.

by_length, by_speed : F_L [N/m] and F_u [N s/m], flat arrays of 3 (n + 1) numbers.  speeds : U_u of all stages [m/s].
Of a drum that feels the rope that flows, as long: by_velocity : R_v [N s/m].  row : of the matrix [N s/m].  border,
pulled : col at the start of the step and at a stage [kg].
"""

(
    PIVOT,  # P and g of the equation of the drum, see `at_points.py`
    ROW,
    # Rosenbrock steps
    DIRECTION,  # in which the drum turns, see `equations/drum.py`
    TURNED_BACK,  # not 0: a drum without mass has turned round under friction, which holds it
    LENGTH,  # L_i [m] and u_i [m/s] of a stage; in the end of the step
    SPEED,
    REST,  # r_i of a stage [m/s]
    SOLUTION,  # p [m/s] and U_u [m/s] of a stage; in the end the error estimates of L over d and of u
    INCREMENT,
    BY_SPEED,  # f_u [N s/m]
    RATE,  # explicit time derivative of f [N/s]
    BY_POSITION,  # T_x [N/m]
    # with rope that flows, see `rope_drums.py`
    ROW_AT_START,  # what is left of the row at the ends of the line
    ROW_AT_END,
    STAGE_ACCELERATION,  # u' at the stage [m/s2]
    UNBALANCED,  # force [N] and inertia [kg] of a stage without what the first node adds
    YIELDING,
    INERTIA,  # m (1 + T/EA) + I at the start of the step [kg]
    BALANCE,  # right-hand side of a stage [N]
    CROSSED,  # sum of col_0 . col over the masses of the nodes of a stage [kg]
    # fixed steps
    GOAL,  # the largest move of a node with which the line has converged [m]
    UNCONVERGED,  # in how many steps the iteration ended before
    START_LENGTH,  # of the drum at the start of a step of three stages [m]
    START_SPEED,  # [m/s]
    ONWARD_LENGTH,  # the start of the third stage but for the result of the second one [m]
    ONWARD_SPEED,  # [m/s]
    BEFORE,  # speeds in the last stage but one, and in the one before it [m/s]
    LONG_BEFORE,
    LOWEST,  # limits of the speed in a step or a stage [m/s]
    HIGHEST,
    TRIAL,  # u of the iteration [m/s]
    CHANGE,  # by how much the last iteration changed it [m/s]
    WAY,  # how u' is sought in the iteration
    SOUGHT,  # its value where that is given [m/s]
    ONWARD,  # u' as found [m/s]
    IS_FOUND,  # 1 if u' was found as it was sought, else 0
    TENSION,  # T + T_x p [N]
    LARGEST,  # largest tension of a segment after a Rosenbrock step [N]
    _,
    NUMBERS,  # how many there are: an even number
) = places_of(1, 3, *[1] * 9, 3, 3, 3, *[1] * 6, *[1] * 19)


@kernel
def own_size(n):
    """Length of the room of the method: of a Rosenbrock step with its `Shares`, or of a fixed step."""
    return max(rosenbrock.workspace_size(n) + 18 * (n + 1) + STAGES, second_order.workspace_size(n))


@kernel
def line_work_size(n):
    """Length of what a line of n segments needs of `work`: an even number, so that pairs lie within a line of the cache."""
    size = CONDITIONS + condensed.columns_size(n) + NUMBERS + own_size(n) + 3 * (n + 1)
    return size + size % 2


@view
def room_in_step(system, k):
    """`Room` of line k."""
    n, room = segments_of(system, k), behind(CONDITIONS, room_of(system, k))
    columns, own = condensed.columns_size(n), own_size(n)
    numbers, ends, behind_ends = part(room, 0, NUMBERS), part(room, NUMBERS, columns), behind(NUMBERS + columns, room)
    return Room(numbers, ends, part(behind_ends, 0, own), part(behind_ends, own, 3 * (n + 1)))


@view
def numbers_of(system, k):
    """Numbers of line k, at the places above."""
    return room_in_step(system, k).numbers


@view
def integrator_of(system, k):
    """`rosenbrock.Workspace` of line k."""
    return rosenbrock.workspace(segments_of(system, k), room_in_step(system, k).own)


@view
def shares_of(system, k):
    """`Shares` of line k."""
    flat = 3 * (segments_of(system, k) + 1)
    room = behind(rosenbrock.workspace_size(segments_of(system, k)), room_in_step(system, k).own)
    of_rope = behind(2 * flat + STAGES, room)
    rows = part(of_rope, 0, flat), part(of_rope, flat, flat), part(of_rope, 2 * flat, flat), part(of_rope, 3 * flat, flat)
    return Shares(part(room, 0, flat), part(room, flat, flat), part(room, 2 * flat, STAGES), *rows)


@view
def stages_of(system, k):
    """`second_order.Workspace` of line k."""
    return second_order.workspace(segments_of(system, k), room_in_step(system, k).own)


@view
def scratch_of(system, k):
    """`backward_euler.Workspace` of line k."""
    return stages_of(system, k).chain


@view
def drum_at(system, k):
    """`Drum` of line k; one that feels the rope that flows is as heavy as what rope turns with it at least."""
    conditions = conditions_of(system, k)
    rope = 0.0
    if feels_rope(conditions.parameters):
        rope = 0.5 * property_of(conditions, 0, at.LINE_DENSITY) * property_of(conditions, 0, at.SHARE)
        rope *= state_of(system, k)[at.LENGTH]
    return drum_with(conditions.parameters, rope, conditions.force, conditions.force_rate)


@kernel
def length_of(system, k):
    """Length [m] and speed [m/s] of the drum of line k in its state."""
    state = state_of(system, k)
    return state[at.LENGTH], state[at.REELING]


@kernel
def put_length(system, k, length, speed):
    """Let the drum of line k (modified) have a length [m] and a speed [m/s] in its state."""
    state = state_of(system, k)
    state[at.LENGTH], state[at.REELING] = length, speed


# --- what moves


@kernel
def has_drum(system, k):
    """Whether the winch of line k is controlled by force, and no coordinate (`coordinates.py`)."""
    return winch.follows_force(parameters_of(system, k)) and not has_coordinates(system)


@kernel
def turns(system, k):
    """Whether line k has a drum that turns in a Rosenbrock step."""
    return has_drum(system, k) and numbers_of(system, k)[DIRECTION] != HELD


@kernel
def turns_with_rope(system, k):
    """Whether that drum feels the rope that flows."""
    return turns(system, k) and feels_rope(parameters_of(system, k))


@kernel
def has_free_nodes(system, k):
    """Whether any node of line k moves freely."""
    conditions = conditions_of(system, k)
    return conditions.first <= conditions.last


@kernel
def moves(system, k):
    """Whether line k takes part in a step: a node moves freely, or the drum of a winch, or rope may run in or out."""
    return has_free_nodes(system, k) or has_drum(system, k) or is_rope(system, k)


@kernel
def reels(system, k):
    """Whether the unstretched length of line k changes in a Rosenbrock step."""
    return winch.is_reeling(conditions_of(system, k).reeling) or turns(system, k) or is_running(system, k)


def any_line(holds):
    """The kernel that says whether something holds for any line; holds : the kernel that says it of one."""

    @kernel
    def of_system(system):
        count = 0
        for k in range(lines_of(system)):
            count += holds(system, k)
        return count > 0

    return of_system


does_any_move, any_drum = any_line(moves), any_line(has_drum)
is_any_turning, is_any_reeling = any_line(turns), any_line(reels)
is_any_turning_with_rope = any_line(turns_with_rope)


@kernel
def is_any_sought(system):
    """Whether speeds of drums or of ropes over sheaves are found in fixed steps."""
    return any_drum(system) or has_coordinates(system)


# --- fixed steps

Step = namedtuple("Step", "time h kind turns")
Step.__doc__ = """A fixed step: its start [s] in the communication step, h [s], its kind (`backward_euler.start`).

turns : whether the speeds of drums and of ropes over sheaves are found in it; else lengths change as the conditions of their
lines say, and ropes run as fast as in the last iteration.
"""


@kernel
def is_turning(system, k, step):
    """Whether line k has a drum whose speed is found in the step."""
    return step.turns and has_drum(system, k)


@kernel
def length_in_motion(system, k, step):
    """Unstretched length [m] of line k at the end of a step, its rate [m/s] and its second one [m/s2], in the iteration."""
    if is_turning(system, k, step):
        (length, before), speed = length_of(system, k), numbers_of(system, k)[TRIAL]
        return length + step.h * speed, speed, (speed - before) / step.h
    reeling, end = conditions_of(system, k).reeling, step.time + step.h
    return winch.length_at(reeling, end), winch.rate_at(reeling, end), winch.gain_at(reeling, end)


@view
def attempt_of(system, k, step):
    """`incremental_potential.Attempt` of line k."""
    conditions = conditions_of(system, k)
    _, v = motion_of(system, k)
    if has_run(system, k):
        return Attempt(conditions, portion_gaining(system, k, 1.0), step.h, v)
    return Attempt(conditions, chain_moving(conditions, *length_in_motion(system, k, step)), step.h, v)
