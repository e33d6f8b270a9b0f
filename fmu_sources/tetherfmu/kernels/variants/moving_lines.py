"""Motion of one or many lines within a communication step: with adaptive steps, fixed steps, or both.

If the adaptive solver abandons a step, fixed steps of order 2 repeat it; the next step is adaptive again,
see `step_control.is_given_up`.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import OK, STEP_BUDGET_SPENT

from ..arrays import nodes_end
from ..compilation import kernel, view
from ..equations.boundary import conditions_of_chain, place_ends
from ..equations.lines import (
    conditions_of,
    lines_of,
    motion_of,
    parameters_of,
    put_reeling,
    room_of,
    segments_of,
    state_of,
    store_conditions,
    with_states,
)
from ..equations.properties import chain_of
from ..equations.ropes import has_sheaves
from ..equations.winch import from_length
from ..line import step_control
from ..line.backward_euler import FixedSteps, given_steps
from ..line.strand_room import FIRST_LENGTH, UNCONVERGED
from ..motion import adaptive_steps, breaks, fallback, fixed_steps, states
from ..notes import note
from ..points import room
from ..points.coordinates import has_own_drum
from ..rest import compressed_chain, end_tensions
from ..step import breaking
from ..step.plausibility import note_pressing, note_stiff_and_slack, note_unconverged


@view
def begin_line(system, k, shape, given, before):
    """Store the conditions of line k, with its initial `shape`, in a step with `StepInputs` from the states `before`."""
    x, v = motion_of(system, k)
    old = state_of(with_states(system, before), k)
    conditions = conditions_of_chain(segments_of(system, k), parameters_of(system, k), shape, given, old, x, v)
    store_conditions(conditions, room_of(system, k))


@kernel
def move(system, steps, step):
    """Move all lines (modified) over a communication step [s] with `FixedSteps`; a status, and its noted value."""
    is_adaptive = steps.size == 0.0
    status = adaptive_steps.integrate(system, step) if is_adaptive else fixed_steps.integrate(system, steps, step)
    if status == OK and room.count_of(system) > 0:
        states.end_lengths(system, step)
    for k in range(lines_of(system)):
        n, state, (x, _) = segments_of(system, k), state_of(system, k), motion_of(system, k)
        if not is_adaptive:
            note_unconverged(room.numbers_of(system, k)[UNCONVERGED], steps.size, state)
        elif status == OK:
            note_stiff_and_slack(chain_of(n, parameters_of(system, k), state), x, state)
    return status


@kernel
def go_back(system, step, before):
    """Restore the nodes and drums of all lines (modified) to the states before a communication step [s]."""
    breaks.go_back(system, step, before)
    for k in range(lines_of(system)):
        n, state, first = segments_of(system, k), state_of(system, k), state_of(with_states(system, before), k)
        for i in range(at.STATE_HEADER, nodes_end(n)):
            state[i] = first[i]
        if has_own_drum(system, k):
            state[at.LENGTH], state[at.REELING] = first[at.LENGTH], first[at.REELING]
    if has_sheaves(system):
        breaking.run_off_again(system, step, before)
    for k in range(lines_of(system)):
        reeling = conditions_of(system, k).reeling
        put_reeling(system, k, from_length(room.numbers_of(system, k)[FIRST_LENGTH], reeling))
    room.begin_coordinates(system)


@kernel
def move_coarsely(system, step, before):
    """Repeat a communication step [s] that the adaptive solver has abandoned, from its start, with fixed steps as in `move`.

    Of order 2, or backward Euler for a stiff tether whose waves they do not resolve.
    """
    h = step * adaptive_steps.work_of(system) / at.COARSE_WORK
    go_back(system, step, before)
    method = at.BACKWARD_EULER if fallback.stiff_swing(system, h) > 0.0 else at.SECOND_ORDER
    status = move(system, FixedSteps(h, float(method)), step)
    memory = state_of(system, 0)
    memory[at.SOLVER_STEP], memory[at.SOLVER_ERROR] = 0.0, step_control.UNRESOLVED
    note(memory, limits.UNRESOLVED, h * h, 0.0)
    return status


@kernel
def advance(system, step, before):
    """Advance all lines (modified) over a communication step [s], from their states `before`; a status.

    Without free nodes, ends and lengths follow their prescribed motion, and there are no internal steps.
    """
    room.begin_coordinates(system)
    if not room.does_any_move(system):
        breaks.break_at_ends(system, step)
        return OK
    status = move(system, given_steps(parameters_of(system, 0)), step)
    if status == STEP_BUDGET_SPENT and move_coarsely(system, step, before) == OK:
        return OK
    return status


@kernel
def end_line(system, k, step):
    """Store line k in its state (modified) at the end of a communication step [s]."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    x, v = motion_of(system, k)
    place_ends(conditions_of(system, k), step, x, v)
    end_tensions.forget(state)
    chain = chain_of(n, parameters, state)
    note_pressing(chain, x, v, True, state)
    compressed_chain.leave(chain, x, v)
