"""Scratch space of the lines of a system in a step, and what of a line moves.

What a drum does in a step stands in `Room.numbers`, at the places below.
"""

from collections import namedtuple

from ..arrays import behind, places_of
from ..compilation import kernel, view
from ..equations import winch
from ..equations.drum import HELD
from ..equations.lines import CONDITIONS, conditions_of, lines_of, parameters_of, room_of, segments_of
from ..flat_arrays import part
from ..line import drum_step, rosenbrock
from ..linear_algebra import condensed

Room = namedtuple("Room", "w columns drum numbers")
Room.__doc__ = """Scratch arrays of a line.

w : `rosenbrock.Workspace`.  columns : of its ends, see `linear_algebra.condensed`.  drum : `drum_step.Workspace`.
numbers : of its drum, DRUM_NUMBERS.
"""

(
    DIRECTION,  # in which the drum turns, see `equations/drum.py`
    TURNED_BACK,  # not 0: a drum without mass has turned round under friction, which holds it
    NEW_LENGTH,  # after the step [m]
    NEW_SPEED,  # [m/s]
    LENGTH_ERROR,  # their error estimates
    SPEED_ERROR,
    STAGE_LENGTH,  # L_i, u_i, p and U_u of a stage, see `drum_step.py`
    STAGE_SPEED,
    SOLUTION,
    INCREMENT,
    PIVOT,
    BORDER,  # the numbers of `drum_step.Border`
    DRUM_NUMBERS,  # how many there are
) = places_of(*[1] * 11, 10)


@kernel
def line_work_size(n):
    """Length of what a line of n segments needs of `work`: an even number, so that pairs lie within a line of the cache."""
    size = CONDITIONS + rosenbrock.workspace_size(n) + condensed.columns_size(n) + drum_step.drum_size(n) + DRUM_NUMBERS
    return size + size % 2


@view
def integrator_of(system, k):
    """`Room` of line k."""
    n, room = segments_of(system, k), behind(CONDITIONS, room_of(system, k))
    own, columns, drum = rosenbrock.workspace_size(n), condensed.columns_size(n), drum_step.drum_size(n)
    w, beside = rosenbrock.workspace(n, part(room, 0, own)), behind(own + columns, room)
    numbers = part(beside, drum, DRUM_NUMBERS)
    return Room(w, part(room, own, columns), drum_step.beside(n, w, part(beside, 0, drum)), numbers)


@kernel
def has_drum(system, k):
    """Whether the winch of line k is controlled by force."""
    return winch.follows_force(parameters_of(system, k))


@kernel
def turns(system, k):
    """Whether line k has a drum that turns in the step."""
    return has_drum(system, k) and integrator_of(system, k).numbers[DIRECTION] != HELD


@kernel
def has_free_nodes(system, k):
    """Whether any node of line k moves freely."""
    conditions = conditions_of(system, k)
    return conditions.first <= conditions.last


@kernel
def moves(system, k):
    """Whether line k takes part in a step: a node moves freely, or the drum of a winch."""
    return has_free_nodes(system, k) or has_drum(system, k)


@kernel
def does_any_move(system):
    """Whether any line takes part in a step."""
    moving = 0
    for k in range(lines_of(system)):
        moving += moves(system, k)
    return moving > 0


@kernel
def is_any_turning(system):
    """Whether any drum turns in the step."""
    turning = 0
    for k in range(lines_of(system)):
        turning += turns(system, k)
    return turning > 0


@kernel
def is_any_reeling(system):
    """Whether the unstretched length of any line changes in the step."""
    reeling = 0
    for k in range(lines_of(system)):
        reeling += winch.is_reeling(conditions_of(system, k).reeling)
    return reeling > 0 or is_any_turning(system)
