"""A system of lines: motion within a communication step, as a transaction of all its lines.

The lines are started, and their outputs are found, one by one as dynamic tethers between their ends (`dynamic.py`).
"""

from tetherfmu.runtime import system_layout as places
from tetherfmu.runtime.status import OK

from ..arrays import copy
from ..compilation import kernel
from ..equations.boundary import conditions_of_chain, inputs_of_step, place_ends
from ..equations.lines import (
    System,
    conditions_of,
    inputs_of,
    lines_of,
    motion_of,
    parameters_of,
    room_of,
    segments_of,
    state_of,
    store_conditions,
)
from ..equations.properties import chain_of
from ..equilibrium import compressed_chain, end_tensions
from ..integrators import system_control, system_step
from ..step import transaction
from ..step.plausibility import note_stiff_and_slack


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
        store_conditions(conditions_of_chain(n, parameters, given, state, x, v), room_of(system, k))
        transaction.remember(parameters, inputs, given, state)
    return status


@kernel
def begin(system, step):
    """`begin_line` of all lines, until one is refused; returns the status."""
    for k in range(lines_of(system)):
        system.plan[places.STATUS_LINE] = k
        status = begin_line(system, k, step)
        if status != OK:
            return status
    return OK


@kernel
def end_line(system, k, step):
    """Put line k (modified) in its state at the end of a communication step [s], as `dynamic.advance` does."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    x, v = motion_of(system, k)
    note_stiff_and_slack(chain_of(n, parameters, state), x, state)
    place_ends(conditions_of(system, k), step, x, v)
    end_tensions.forget(state)
    compressed_chain.leave(chain_of(n, parameters, state), x, v)


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
    """`end_line` and `commit_line` of all lines, until one is refused; returns the status."""
    for k in range(lines_of(system)):
        end_line(system, k, step)
    for k in range(lines_of(system)):
        system.plan[places.STATUS_LINE] = k
        status = commit_line(system, k, before)
        if status != OK:
            return status
    return OK


@kernel
def advance(system, step, before):
    """One communication step of `step` [s]; on any status but OK the states of all lines are as they were.

    before (modified) : room for all states.  The plan (modified) says which line a status is about.
    """
    copy(system.state, before)
    status = begin(system, step)
    if status == OK:
        system.plan[places.STATUS_LINE] = places.ALL_LINES
        status = system_control.integrate(system, step)
    if status == OK:
        status = commit(system, step, before)
    if status != OK:
        copy(before, system.state)
    return status


line_work_size = system_step.line_work_size
