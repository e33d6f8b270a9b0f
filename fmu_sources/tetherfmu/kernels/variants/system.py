"""A system of lines: its plan, first shapes, motion within a communication step and outputs, as transactions of all lines.

The lines are started, and their outputs are found, one by one as dynamic tethers between their ends (`dynamic_chain.py`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import system_layout as places
from tetherfmu.runtime.status import INPUT_NOT_FINITE, OK

from ..arrays import copy, outputs_size, parameters_size, state_size
from ..compilation import kernel
from ..equations.boundary import conditions_of_chain, inputs_of_step
from ..equations.lines import (
    System,
    free_points,
    inputs_of,
    lines_of,
    motion_of,
    outputs_of_line,
    parameters_of,
    points_size,
    recent_load_rates,
    remember_loads,
    room_of,
    segments_of,
    state_of,
    store_conditions,
    take_load_rates,
)
from ..equations.properties import chain_of
from ..flat_arrays import part
from ..line.backward_euler import given_steps
from ..motion import adaptive_steps, iteration_limit
from ..points import system_fixed_room
from ..rest import dynamic_chain, resting_forces, resting_line, resting_points
from ..step import transaction
from ..step.outputs import complete
from ..step.plausibility import note_damping_of_steps
from . import moving_lines

# --- the plan


@kernel
def line_work_size(n):
    """Length of what a line of n segments needs of `work`: an even number, see `system_room.line_work_size`."""
    return max(moving_lines.line_work_size(n), resting_line.line_work_size(n))


@kernel
def complete_plan(plan):
    """Write all numbers of a plan (modified) that follow from those that are given, see `system_layout.py`."""
    parameters, state, outputs, work = 0, 0, 0, 0
    for k in range(plan[places.LINES]):
        row = places.PLAN_HEADER + places.LINE_NUMBERS * k
        n = plan[row + places.SEGMENTS]
        plan[row + places.PARAMETERS_AT] = parameters
        plan[row + places.STATE_AT] = state
        plan[row + places.OUTPUTS_AT] = outputs
        plan[row + places.WORK_AT] = work
        parameters += parameters_size(n)
        state += state_size(n)
        outputs += outputs_size(plan[row + places.SHAPE_POINTS])
        work += line_work_size(n)
    plan[places.STATUS_LINE] = places.ALL_LINES
    plan[places.POINTS_WORK] = work
    points, band = plan[places.FREE_POINTS], plan[places.BAND]
    work += points_size(points, band) + resting_forces.search_size(points, band)
    plan[places.OUTPUTS_WORK] = work
    plan[places.PARAMETERS_SIZE] = parameters
    plan[places.INPUTS_SIZE] = at.INPUTS * plan[places.LINES] + 3 * plan[places.FREE_POINTS]
    plan[places.STATE_SIZE] = state
    plan[places.OUTPUTS_SIZE] = outputs
    plan[places.WORK_SIZE] = work + outputs


# --- outputs


@kernel
def iteration_limit_of(system):
    """The most iterations of all lines in the last communication step: each factorizes the matrix of each line once."""
    steps, duration = given_steps(parameters_of(system, 0)), state_of(system, 0)[at.LAST_STEP]
    return iteration_limit.of_steps(adaptive_steps.work_of(system), steps, system_fixed_room.any_drum(system), duration)


@kernel
def take_outputs(system, outputs):
    """Outputs of all lines (modified) in their states: OK, or OUTPUT_NOT_FINITE, and then they are as they were.

    The plan (modified) says which line a status is about.
    """
    found = part(system.work, system.plan[places.OUTPUTS_WORK], system.plan[places.OUTPUTS_SIZE])
    most = iteration_limit_of(system)
    for k in range(lines_of(system)):
        system.plan[places.STATUS_LINE] = k
        n, state, own = segments_of(system, k), state_of(system, k), outputs_of_line(system, k, found)
        points = system.plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.SHAPE_POINTS]
        dynamic_chain.outputs_of(n, parameters_of(system, k), state, points, own, room_of(system, k))
        own[at.SOLVER_ITERATION_LIMIT] = most
        status = complete(n, state, own)
        if status != OK:
            return status
    copy(found, outputs)
    return OK


@kernel
def with_outputs(system, status, before, outputs):
    """Outputs of all lines (modified) if the status is OK, else the states of before (states modified); the status."""
    if status == OK:
        status = take_outputs(system, outputs)
    if status != OK:
        copy(before, system.state)
    return status


# --- the start


@kernel
def start_line(system, k):
    """First state of line k (modified) between its points as the inputs say; a status."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    status = transaction.start(n, parameters, inputs_of(system, k), state)
    if status == OK:
        note_damping_of_steps(chain_of(n, parameters, state), parameters, state)
        status = dynamic_chain.initialize(n, parameters, parameters[at.INITIAL_SHAPE], state, room_of(system, k))
    return transaction.commit_start(n, parameters, status, state)


@kernel
def initialize(system, before, outputs):
    """First states of all lines and their outputs (both modified), as they were on any status but OK.

    Points that are sought get their positions first, see `resting_points.py`.  before (modified) : room for all states.
    The plan (modified) says which line a status is about.
    """
    copy(system.state, before)
    status = check_loads(system)
    if status == OK:
        status = resting_points.find(system, False)
    for k in range(lines_of(system)):
        if status == OK:
            system.plan[places.STATUS_LINE] = k
            status = start_line(system, k)
    return with_outputs(system, status, before, outputs)


# --- a communication step


@kernel
def check_loads(system):
    """OK, or INPUT_NOT_FINITE about ALL_LINES, with the number of the free point whose load is no number or a huge one."""
    first = at.INPUTS * lines_of(system)
    for i in range(3 * free_points(system)):
        if not abs(system.inputs[first + i]) <= at.LARGEST_INPUT:
            system.plan[places.STATUS_LINE] = places.ALL_LINES
            return INPUT_NOT_FINITE | (i // 3) << 8
    return OK


@kernel
def begin_line(system, k, step):
    """Conditions of line k in a communication step [s], and the header of its state (modified); a status."""
    n, parameters, inputs, state = (
        segments_of(system, k),
        parameters_of(system, k),
        inputs_of(system, k),
        state_of(system, k),
    )
    status = transaction.check_step(inputs, step)
    if status != OK:
        return status
    given = inputs_of_step(parameters, inputs, step, state)
    status = transaction.check_reeling(n, parameters, given)
    if status == OK:
        x, v = motion_of(system, k)
        shape = parameters[at.INITIAL_SHAPE]
        if lines_of(system) > 1:  # ends that lines share move alike only if no line turns them on its own in its first step
            shape = float(at.STATIC_EQUILIBRIUM)
        store_conditions(conditions_of_chain(n, parameters, shape, given, state, x, v), room_of(system, k))
        recent = recent_load_rates(system, k)
        transaction.remember(parameters, inputs, given, state)
        remember_loads(system, k, recent)
    return status


@kernel
def begin(system, step):
    """`begin_line` of all lines, until one is refused; returns the status."""
    status = check_loads(system)
    if status != OK:
        return status
    take_load_rates(system, step)
    for k in range(lines_of(system)):
        system.plan[places.STATUS_LINE] = k
        status = begin_line(system, k, step)
        if status != OK:
            return status
    return OK


@kernel
def commit_line(system, k, before):
    """Check the state of line k, and note in it (modified) what is implausible; a status."""
    n, state = segments_of(system, k), state_of(system, k)
    status = transaction.check_state(n, state)
    if status == OK:
        old = System(system.plan, system.parameters, system.inputs, before, system.work)
        transaction.note_step(n, parameters_of(system, k), state_of(old, k), state)
    return status


@kernel
def commit(system, step, before):
    """End the step of all lines, and `commit_line` until one is refused; returns the status."""
    for k in range(lines_of(system)):
        moving_lines.end_line(system, k, step)
    for k in range(lines_of(system)):
        system.plan[places.STATUS_LINE] = k
        status = commit_line(system, k, before)
        if status != OK:
            return status
    return OK


@kernel
def advance_with_outputs(system, step, before, outputs):
    """`advance`, then the outputs of all lines (modified), which are as they were on any status but OK, too."""
    return with_outputs(system, advance(system, step, before), before, outputs)


@kernel
def advance(system, step, before):
    """One communication step of `step` [s]; on any status but OK the states of all lines are as they were.

    before (modified) : room for all states.  The plan (modified) says which line a status is about.
    """
    copy(system.state, before)
    status = begin(system, step)
    if status == OK:
        system.plan[places.STATUS_LINE] = places.ALL_LINES
        status = moving_lines.advance(system, step, before)
    if status == OK:
        status = commit(system, step, before)
    if status != OK:
        copy(before, system.state)
    return status
