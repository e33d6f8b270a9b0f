"""A system of lines: its plan, initial shapes, motion within a communication step and outputs, as transactions of all lines.

Initialization and outputs treat each line as a dynamic tether between its ends (`dynamic_chain.py`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.status import (
    INPUT_NOT_FINITE,
    KITE_AND_WINCH_SOUGHT,
    OK,
    SHEAVES_THAT_BREAK,
    SHEAVES_WITH_STRETCH_RATE,
)

from ..arrays import copy, inputs_size, outputs_size, parameters_size, state_size
from ..compilation import kernel
from ..equations import wind_points
from ..equations.free_points import free_points, load_on, take_loads
from ..equations.lines import (
    conditions_of,
    inputs_of,
    lines_of,
    motion_of,
    number_of_line,
    parameters_of,
    put_reeling,
    room_of,
    segments_of,
    state_of,
    with_states,
)
from ..equations.parts import EMPTY, LEAST_SEGMENTS
from ..equations.properties import property_in, section_of, sees_reeling
from ..equations.rope import tension_at_winch
from ..equations.ropes import (
    comes_from,
    first_of,
    goes_on,
    has_coordinates,
    has_sheaves,
    is_portion,
    is_rope,
    is_turned,
    outputs_of_line,
)
from ..equations.winch import follows_length, from_length, is_sought
from ..line.backward_euler import given_steps
from ..linear_algebra.vectors import add, get, put_at, scale, sub, vector_at
from ..motion import adaptive_steps, fixed_steps, states
from ..points import room
from ..points.coordinates import REST_NUMBERS, carries_drum, has_own_drum, is_alone, is_shared_out
from ..rest import dynamic_chain, resting_forces, resting_line, resting_points, resting_ropes
from ..step import breaking, power_balance, transaction
from ..step.outputs import complete
from . import moving_lines, rope_shares
from .winch_start import winch_start

name = SYSTEM

# --- plan


@kernel
def line_work_size(n):
    """Length of a line of n segments in `work`: an even number, see `room.line_work_size`."""
    return max(room.line_work_size(n), resting_line.line_work_size(n))


@kernel
def complete_plan(plan):
    """Write all derived numbers of a plan (modified), see `plan_layout.py`."""
    parameters, inputs, state, outputs, work, sheaves, drums = 0, 0, 0, 0, 0, 0, 0
    for k in range(plan[places.LINES]):
        sheaves += plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.THROUGH]
        drums += plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.DRUM]
    for k in range(plan[places.LINES]):
        row = places.PLAN_HEADER + places.LINE_NUMBERS * k
        n, winds = plan[row + places.SEGMENTS], plan[row + places.WIND_POINTS]
        plan[row + places.PARAMETERS_AT] = parameters
        plan[row + places.INPUTS_AT] = inputs
        plan[row + places.STATE_AT] = state
        plan[row + places.OUTPUTS_AT] = outputs
        plan[row + places.WORK_AT] = work
        parameters += parameters_size(n)
        inputs += inputs_size(winds)
        state += state_size(n, winds)
        before = plan[row - places.LINE_NUMBERS + places.THROUGH] if k > 0 else 0
        outputs += outputs_size(plan[row + places.SHAPE_POINTS], plan[row + places.THROUGH] + before > 0)
        work += line_work_size(n + 1)  # includes the segment that is added when the line is released
        plan[row + places.PORTION_WORK] = work
        work += REST_NUMBERS
    plan[places.STATUS_LINE] = places.ALL_LINES
    plan[places.SHEAVES], plan[places.COORDINATES], plan[places.SHEAVES_WORK] = sheaves, sheaves + drums, work
    most = sheaves + plan[places.LINES]
    work += room.globals_size(plan[places.FREE_POINTS], plan[places.BAND], most)
    plan[places.POINTS_WORK] = work
    work += resting_forces.search_size(plan[places.FREE_POINTS], plan[places.BAND], sheaves + drums)
    plan[places.OUTPUTS_WORK] = work
    plan[places.PARAMETERS_SIZE] = parameters
    plan[places.INPUTS_SIZE] = inputs + 3 * plan[places.FREE_POINTS]
    plan[places.STATE_SIZE] = state
    plan[places.OUTPUTS_SIZE] = outputs
    plan[places.WORK_SIZE] = work + outputs


# --- outputs


@kernel
def is_any_sought(system):
    """Whether fixed steps solve for speeds of drums or of ropes over sheaves."""
    return has_coordinates(system) or any_own_drum(system)


@kernel
def take_outputs(system, outputs):
    """Outputs of all lines (modified) in their states: OK, or OUTPUT_NOT_FINITE, which invalidates them.

    The plan (modified) stores the line of a status.
    """
    steps, duration = given_steps(parameters_of(system, 0)), state_of(system, 0)[at.LAST_STEP]  # with common iterations
    most = fixed_steps.most_iterations(adaptive_steps.work_of(system), steps, is_any_sought(system), duration)
    breaking.fit(system)
    status = OK
    for k in range(lines_of(system)):
        if status != OK:
            continue
        system.plan[places.STATUS_LINE] = k
        n, state, own = segments_of(system, k), state_of(system, k), outputs_of_line(system, k, outputs)
        points = number_of_line(system, k, places.SHAPE_POINTS)
        wind_points.take_from_state(n, parameters_of(system, k), state)
        dynamic_chain.outputs_of(n, parameters_of(system, k), state, points, own, room_of(system, k))
        own[at.SOLVER_ITERATION_LIMIT] = most
        if is_portion(system, k):
            write_portion(system, k, own)
        status = complete(n, state, own)
    if status == OK and has_sheaves(system):
        sum_portions(system, outputs)
    breaking.unfit(system)
    return status


@kernel
def write_portion(system, k, own):
    """Write the additional outputs of a portion of a line over sheaves (modified), and the force on the sheave at its start.

    Rope that turns around a sheave keeps its momentum; a drum would supply it.
    """
    n, state, (x, _) = segments_of(system, k), state_of(system, k), motion_of(system, k)
    if comes_from(system, k):
        speed, share = state_of(system, k - 1)[at.SHEAVE_SPEED], property_in(parameters_of(system, k), n, 0, at.SHARE)
        rest = (share if share > 0.0 else 1.0) * section_of(parameters_of(system, k), state[at.LENGTH])
        density = property_in(parameters_of(system, k), n, 0, at.LINE_DENSITY)
        push = scale(
            -density * speed * speed / rest,
            sub(get(x, 1), get(x, 0)),
        )
        put_at(own, at.GROUND_FORCE, add(vector_at(own, at.GROUND_FORCE), push))
    first = at.SHAPE + 3 * number_of_line(system, k, places.SHAPE_POINTS)
    if state[at.LENGTH] == EMPTY:
        own[at.TETHER_LENGTH] = 0.0
    own[first + at.PORTION_LENGTH] = own[at.TETHER_LENGTH]
    own[first + at.PORTION_TENSION_FROM], own[first + at.PORTION_TENSION_TO] = state[at.TENSION_FROM], state[at.TENSION_TO]
    own[first + at.SHEAVE_PAYOUT], own[first + at.SHEAVE_RATE] = state[at.PAYOUT], state[at.SHEAVE_SPEED]


@kernel
def sum_portions(system, outputs):
    """Replace the outputs of the first portion of a line over sheaves (modified) by sums over the line, where defined."""
    first = 0
    for k in range(lines_of(system)):
        if is_portion(system, k) and not comes_from(system, k):
            first = k
            outputs_of_line(system, k, outputs)[at.WINCH_SPEED] += state_of(system, k)[at.SHEAVE_SPEED]
        elif is_portion(system, k):
            whole, own = outputs_of_line(system, first, outputs), outputs_of_line(system, k, outputs)
            for place in (at.TETHER_LENGTH, at.SLACK_SEGMENTS, at.GROUNDED_LENGTH):
                whole[place] += own[place]
            if whole[at.BROKEN] == 0.0 or (own[at.BROKEN] != 0.0 and own[at.BREAK_TIME] < whole[at.BREAK_TIME]):
                whole[at.BREAK_TIME] = own[at.BREAK_TIME]
            for place in (at.MAX_TENSION, at.PEAK_TENSION, at.BROKEN):
                whole[place] = max(whole[place], own[place])


@kernel
def energy(system, k, energies):
    """Energies, powers, tensions and velocities (modified) of line k in its state, with its inputs; a status."""
    breaking.fit(system)
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    _, v = motion_of(system, k)
    wind_points.take_from_state(n, parameters, state)
    status = power_balance.balance(n, parameters, state, v, inputs_of(system, k), True, energies, room_of(system, k))
    breaking.unfit(system)
    return status


# --- start


@kernel
def settle(n, parameters, inputs, state, work):
    """Put a line in a new state (modified) into its `initial_shape`; returns a status."""
    return dynamic_chain.initialize(n, parameters, parameters[at.INITIAL_SHAPE], state, work)


any_own_drum = room.any_line(has_own_drum)
find_length, note_imbalance = winch_start(settle, tension_at_winch)


@kernel
def start_line(system, k):
    """Initial state of line k (modified) between its points according to the inputs; a status."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    inputs, work = inputs_of(system, k), room_of(system, k)
    status = resting_line.start_state(system, k)
    if status == OK and is_sought(parameters) and not is_shared_out(system, k):
        status = find_length(n, parameters, inputs, state, work)
    if status == OK:
        status = settle(n, parameters, inputs, state, work)
    if status == OK and is_portion(system, k):
        resting_ropes.take_tensions_at_rest(system, k)
    if status == OK and carries_drum(system, k):
        state[at.DRUM_SPEED] = inputs[at.REEL_OUT_SPEED]
    return transaction.commit_start(n, parameters, inputs, status, state)


@kernel
def check_sought(system):
    """OK, or KITE_AND_WINCH_SOUGHT about a line whose length and end point are both sought."""
    for k in range(lines_of(system)):
        first = first_of(system, k)
        is_own = not has_coordinates(system) or is_alone(system, first)
        if resting_line.is_any_sought(system, k) and is_own and is_sought(parameters_of(system, first)):
            system.plan[places.STATUS_LINE] = first
            return KITE_AND_WINCH_SOUGHT
    return OK


@kernel
def check_ropes(system):
    """OK, or the reason why a line cannot have coordinates: its law, breaking."""
    for k in range(lines_of(system)):
        parameters = parameters_of(system, k)
        system.plan[places.STATUS_LINE] = k
        if is_rope(system, k) and not sees_reeling(parameters):
            return SHEAVES_WITH_STRETCH_RATE
        if is_portion(system, k) and parameters[at.CAN_BREAK] != 0.0 and segments_of(system, k) < LEAST_SEGMENTS:
            return SHEAVES_THAT_BREAK
    return OK


@kernel
def initialize(system):
    """Initial states of all lines (modified); a status; the states are valid on OK only.

    Sought points get their positions first, see `resting_points.py`.  The plan (modified) stores the line of a status.
    """
    for k in range(lines_of(system)):
        state_of(system, k)[at.LET_GO] = 0.0
    status = check_loads(system)
    if status == OK:
        status = check_sought(system)
    if status == OK and has_coordinates(system):
        status = check_ropes(system)
    if status == OK and has_coordinates(system):
        status = rope_shares.find_shares(system)
    elif status == OK:
        status = resting_points.find(system, False)
    for k in range(lines_of(system)):
        if status == OK:
            system.plan[places.STATUS_LINE] = k
            status = start_line(system, k)
    return status


# --- a communication step


@kernel
def check_loads(system):
    """OK, or INPUT_NOT_FINITE about ALL_LINES, with the number of the free point whose load is huge or not a number."""
    for point in range(free_points(system)):
        for component in load_on(system, point):
            if not abs(component) <= at.LARGEST_INPUT:
                system.plan[places.STATUS_LINE] = places.ALL_LINES
                return INPUT_NOT_FINITE | point << 8
    return OK


@kernel
def begin_line(system, k, step, before):
    """Conditions of line k in a communication step [s], and the header of its state (modified); a status."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    elsewhere = begin_rope(system, k) if is_portion(system, k) and not comes_from(system, k) else 0.0
    status, given = transaction.begin(n, parameters, inputs_of(system, k), step, True, state)
    if status == OK:
        shape = parameters[at.INITIAL_SHAPE]
        if lines_of(system) > 1:  # shared ends move alike only if no line turns them on its own in its first step
            shape = float(at.STATIC_EQUILIBRIUM)
        moving_lines.begin_line(system, k, shape, given, before)
        take_loads(system, k, step, before)
        if elsewhere != 0.0:
            reeling = conditions_of(system, k).reeling
            put_reeling(system, k, from_length(reeling[0] - elsewhere, reeling))
            state[at.LENGTH] -= elsewhere
    return status


@kernel
def begin_rope(system, k):
    """Set the speed of the winch in the state of the first portion of a rope, k (modified), for its extrapolation.

    If the winch follows a length, also set the rope length. Returns the length of the other portions [m].
    """
    state, elsewhere, j = state_of(system, k), 0.0, k
    if state[at.SHEAVE_SPEED] != 0.0:
        state[at.REELING] += state[at.SHEAVE_SPEED]
    if follows_length(parameters_of(system, k)):
        while goes_on(system, j):
            j += 1
            elsewhere += state_of(system, j)[at.LENGTH]
        state[at.LENGTH] += elsewhere
    return elsewhere


@kernel
def begin(system, step, before):
    """`begin_line` for all lines, until one is refused; returns the status."""
    status = check_loads(system)
    for k in range(lines_of(system)):
        if status == OK:
            system.plan[places.STATUS_LINE] = k
            status = begin_line(system, k, step, before)
    return status


@kernel
def commit(system, step, before):
    """End the step of all lines, until one state is refused; returns the status."""
    status = OK
    for k in range(lines_of(system)):
        moving_lines.end_line(system, k, step)
    if room.count_of(system) > 0:
        states.end_coordinates(system, step)
    for k in range(lines_of(system)):
        if status == OK:
            system.plan[places.STATUS_LINE] = k
            n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
            old = state_of(with_states(system, before), k)
            if not is_turned(system, k):
                note_imbalance(n, parameters, old, state)
            status = transaction.commit(n, parameters, OK, old, state)
    return status


@kernel
def advance(system, step, before):
    """One communication step of `step` [s]; on any status except OK the states of all lines are unchanged.

    before (modified) : room for all states.  The plan (modified) stores the line of a status.
    """
    copy(system.state, before)
    status = breaking.begin(system, step, before)
    if status == OK:
        status = begin(system, step, before)
    if status == OK:
        system.plan[places.STATUS_LINE] = places.ALL_LINES
        status = moving_lines.advance(system, step, before)
    if status == OK:
        status = commit(system, step, before)
    if status != OK:
        copy(before, system.state)
    breaking.end(system)
    return status
