"""The entry points: the only functions that shells call, with numbers and pointers to flat arrays as arguments.

Each library has seven: segments, pack, complete, initialize, advance, outputs, fly; with nodes an eighth: energy.
`runtime.kernel_library` defines their signatures for callers, `plan_layout.py` the arrays. They return statuses
(`status.py`), segments and fly a number. The plan stores the line of a status at STATUS_LINE; INPUT_NOT_FINITE about
ALL_LINES carries the number of the free point with the wrong load, and NO_EQUILIBRIUM_OF_POINT the number of its point.
"""

from ctypes import c_double, c_int32, c_int64

from numba import types

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.kernel_library import PROTOTYPES, Array, Kernels, Plan
from tetherfmu.runtime.status import OK
from tetherfmu.runtime.variants import BY_NAME, DYNAMIC

from . import packing
from .arrays import copy, parameters_size, positions_and_velocities
from .compilation import kernel, view
from .equations.lines import System, lines_of, segments_of, state_of
from .equations.ropes import outputs_of_line
from .equations.torn import has_let_go
from .flat_arrays import flat, part
from .linear_algebra.vectors import norm, vector_at
from .step import power_balance

plan_size = kernel(places.plan_size)

_KINDS = {c_int64: types.int64, c_int32: types.int32, c_double: types.float64}
_KINDS |= {Plan: types.CPointer(types.int64), Array: types.CPointer(types.float64)}
SIGNATURES = Kernels(*(_KINDS[each._restype_](*map(_KINDS.get, each._argtypes_)) for each in PROTOTYPES))


@view
def plan_at(plan):
    """The plan as an array."""
    return flat(plan, plan_size(flat(plan, places.PLAN_HEADER)[places.LINES]))


@view
def system_at(plan, parameters, inputs, state, work):
    """`System` of these arrays."""
    p = plan_at(plan)
    given = flat(parameters, p[places.PARAMETERS_SIZE]), flat(inputs, p[places.INPUTS_SIZE])
    return System(p, *given, flat(state, p[places.STATE_SIZE]), flat(work, p[places.WORK_SIZE]))


def entry_points(lines):
    """Entry points of a library, functions to be compiled with `SIGNATURES`.

    lines : module that moves them: `variants.system`, or a single tether made by `variants.tether`.
    """
    declared = BY_NAME.get(lines.name, DYNAMIC)
    has_nodes, has_waves = declared.has_nodes, declared.has_waves

    @kernel
    def advance_with_outputs(system, step, before, outputs):
        """A communication step, then the outputs (modified); on any status except OK states and outputs are unchanged."""
        status = lines.advance(system, step, before)
        if status == OK:
            status = lines.take_outputs(system, outputs)
            if status != OK:
                copy(before, system.state)
                lines.take_outputs(system, outputs)
        return status

    @kernel
    def take_row(system, outputs, kept):
        """Write the motion of all nodes into a row of a flight (modified), behind its outputs."""
        place = outputs
        for k in range(lines_of(system)):
            state, size = state_of(system, k), 3 * (segments_of(system, k) + 1)
            x, v = positions_and_velocities(segments_of(system, k) + has_let_go(state), state)
            copy(part(x, 0, size), part(kept, place, size))
            copy(part(v, 0, size), part(kept, place + size, size))
            place += 2 * size

    def segments(tethers, quantities):
        """Number of segments of tethers in series with these quantities, see `packing`; 0 if it is unknown."""
        return packing.count_segments(tethers, flat(quantities, packing.count_of_quantities(tethers, 0)), has_nodes)

    def pack(tethers, kites, quantities, tolerance, parameters):
        """Parameters (modified) for the number of segments that `segments` returned; a status; unchanged except on OK."""
        given = flat(quantities, packing.count_of_quantities(tethers, kites))
        p = flat(parameters, parameters_size(packing.count_segments(tethers, given, has_nodes)))
        return packing.pack(tethers, kites, given, tolerance, has_nodes, has_waves, p)

    def complete(plan):
        """Write the derived numbers of a plan (modified); returns OK."""
        lines.complete_plan(plan_at(plan))
        return OK

    def initialize(plan, parameters, inputs, state, outputs, work):
        """Initial states and outputs of all lines (both modified); valid on OK only.

        Free points start at the inputs of their lines, like driven ones; the positions of points that the plan marks as
        sought are solved and written there (inputs modified).
        """
        system = system_at(plan, parameters, inputs, state, work)
        status = lines.initialize(system)
        return lines.take_outputs(system, flat(outputs, system.plan[places.OUTPUTS_SIZE])) if status == OK else status

    def advance(plan, parameters, inputs, step, state, before, outputs, work):
        """One communication step of `step` [s]: states and outputs (both modified), unchanged on any status except OK.

        before (modified) : room for all states; after a successful step, the earlier states.
        """
        system = system_at(plan, parameters, inputs, state, work)
        old, found = flat(before, len(system.state)), flat(outputs, system.plan[places.OUTPUTS_SIZE])
        return advance_with_outputs(system, step, old, found)

    def outputs(plan, parameters, inputs, state, outputs, work):
        """Outputs of all lines (modified) for their states; valid on OK only."""
        system = system_at(plan, parameters, inputs, state, work)
        return lines.take_outputs(system, flat(outputs, system.plan[places.OUTPUTS_SIZE]))

    def fly(plan, parameters, inputs, steps, step, every, outputs, state, before, rows, work):
        """Run `steps` communication steps, until one is refused; returns their number. The states are modified.

        inputs : one row of inputs per step.  every : a row is kept after every so many steps; 0 for none.
        outputs : NEVER, AT_ROWS or ALWAYS (after each step) computed, see `TetherModel.fly`.  before : room for all states.
        rows (modified) : zeros; each kept step writes, unless NEVER, the outputs and for each line the largest
        |kite_force| since the row before; then positions and velocities of all nodes, line by line.
        """
        system = system_at(plan, parameters, inputs, state, work)
        p, count, old = system.plan, lines_of(system), flat(before, len(system.state))
        size = p[places.OUTPUTS_SIZE]
        observed = size + count if outputs != at.NEVER else 0
        width = observed
        for k in range(count):
            width += 6 * (segments_of(system, k) + 1)
        flight = flat(inputs, steps * p[places.INPUTS_SIZE])
        kept = flat(rows, width * (steps // every + 1 if every > 0 else 1))
        row = 0
        for j in range(steps):
            keep = every > 0 and (j + 1) % every == 0
            given = part(flight, j * p[places.INPUTS_SIZE], p[places.INPUTS_SIZE])
            now = System(p, system.parameters, given, system.state, system.work)
            if outputs == at.ALWAYS or (keep and outputs == at.AT_ROWS):
                found = part(kept, row, size)
                if advance_with_outputs(now, step, old, found) != OK:
                    return j
                for k in range(count):
                    force = norm(vector_at(outputs_of_line(now, k, found), at.KITE_FORCE))
                    kept[row + size + k] = max(kept[row + size + k], force)
            elif lines.advance(now, step, old) != OK:
                return j
            if keep:
                take_row(now, observed, part(kept, row, width))
                row += width
        return steps

    def energy(plan, parameters, inputs, line, state, energies, work):
        """Energies, powers, tensions and velocities (modified) of a line with wind, reel-out speed and load of `inputs`."""
        system = system_at(plan, parameters, inputs, state, work)
        return lines.energy(system, line, flat(energies, power_balance.size(segments_of(system, line) + 1)))

    return Kernels(segments, pack, complete, initialize, advance, outputs, fly, energy)
