"""A tether alone: its plan, start, steps and outputs, as transactions around the kernels of its variant.

They use these kernels of a variant: work_size(n), initialize(n, parameters, inputs, state, work),
advance(n, parameters, given, before, state, work), outputs_of(n, parameters, state, shape_points, outputs, work) and
tension_at_ground(n, parameters, state); with nodes the view velocities_of(n, parameters, state, work).
"""

from types import ModuleType

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import KITE_AND_WINCH_SOUGHT, OK
from tetherfmu.runtime.variants import BY_NAME

from ..arrays import copy, inputs_size, outputs_size, parameters_size, state_size
from ..compilation import kernel
from ..equations import wind_points
from ..equations.lines import number_of_line, segments_of
from ..equations.winch import is_sought
from ..step import breaking, power_balance, transaction
from ..step.outputs import complete
from .winch_start import winch_start


def tether(variant):
    """Module for `entry_points` of a single tether, like `variants.system`; variant : its module here."""
    name = variant.__name__.rpartition(".")[2]
    has_waves = BY_NAME[name].has_waves
    find_length, note_imbalance = winch_start(variant.initialize, variant.tension_at_ground)

    @kernel
    def complete_plan(plan):
        """Write all derived numbers of a plan (modified), see `plan_layout.py`."""
        n, points = plan[places.PLAN_HEADER + places.SEGMENTS], plan[places.PLAN_HEADER + places.WIND_POINTS]
        plan[places.PARAMETERS_SIZE] = parameters_size(n)
        plan[places.INPUTS_SIZE] = inputs_size(points)
        plan[places.STATE_SIZE] = state_size(n, points)
        plan[places.OUTPUTS_SIZE] = outputs_size(plan[places.PLAN_HEADER + places.SHAPE_POINTS])
        plan[places.WORK_SIZE] = variant.work_size(n + 1)  # includes the segment that is added when the line is released

    @kernel
    def take_outputs(system, outputs):
        """Outputs (modified) of the state: OK, or OUTPUT_NOT_FINITE, which invalidates them."""
        if has_waves:
            breaking.fit(system)
        n, parameters, state = segments_of(system, 0), system.parameters, system.state
        wind_points.take_from_state(n, parameters, state)
        variant.outputs_of(n, parameters, state, number_of_line(system, 0, places.SHAPE_POINTS), outputs, system.work)
        status = complete(n, state, outputs)
        if has_waves:
            breaking.unfit(system)
        return status

    @kernel
    def initialize(system):
        """Initial state between two ends (modified); a status; the state is valid on OK only."""
        n, parameters, state = segments_of(system, 0), system.parameters, system.state
        status = transaction.start(n, parameters, system.inputs, state)
        if status == OK and is_sought(parameters):
            if parameters[at.KITE_START] == at.START_AT_REST:
                return KITE_AND_WINCH_SOUGHT
            status = find_length(n, parameters, system.inputs, state, system.work)
        if status == OK:
            status = variant.initialize(n, parameters, system.inputs, state, system.work)
        return transaction.commit_start(n, parameters, system.inputs, status, state)

    @kernel
    def advance(system, step, before):
        """One communication step of `step` [s]; on any status except OK the state is unchanged.

        before (modified) : the earlier state.
        """
        parameters, state = system.parameters, system.state
        copy(state, before)
        parting = breaking.begin(system, step, before) if has_waves else breaking.refuse(system)
        n = segments_of(system, 0)
        status, given = transaction.begin(n, parameters, system.inputs, step, has_waves, state)
        status = parting if parting != OK else status
        if status == OK:
            status = variant.advance(n, parameters, given, before, state, system.work)
            note_imbalance(n, parameters, before, state)
        status = transaction.commit(n, parameters, status, before, state)
        if has_waves:
            breaking.end(system)
        return status

    @kernel
    def energy(system, k, energies):
        """Energies, powers, tensions and velocities (modified) of the tether in its state, with its inputs; a status."""
        if has_waves:
            breaking.fit(system)
        n, parameters, state = segments_of(system, 0), system.parameters, system.state
        wind_points.take_from_state(n, parameters, state)
        v = variant.velocities_of(n, parameters, state, system.work)
        status = power_balance.balance(n, parameters, state, v, system.inputs, has_waves, energies, system.work)
        if has_waves:
            breaking.unfit(system)
        return status

    made = ModuleType(name)  # numba resolves names in a module
    for each in (complete_plan, take_outputs, initialize, advance, energy):
        setattr(made, each.__name__, each)
    made.name = name
    return made
