"""The entry points: the only functions that shells call. Numbers and pointers to flat arrays, nothing else.

Each variant has seven: segments, pack, work_size, initialize, advance, outputs, fly; with nodes an eighth: energy.
`runtime.kernel_library` has their signatures for callers, `layout.py` the arrays. They return statuses (`status.py`), `fly`
the number of steps done.

Of a variant they need the kernels work_size(n), initialize(n, parameters, inputs, state, work),
advance(n, parameters, given, before, state, work), outputs_of(n, parameters, state, shape_points, outputs, work); with nodes
the view velocities_of(n, parameters, state, work).
"""

from numba import types

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import Kernels
from tetherfmu.runtime.status import OK
from tetherfmu.runtime.variants import BY_NAME

from . import packing
from .arrays import copy, inputs_size, outputs_size, parameters_size, positions_and_velocities, state_size
from .compilation import kernel, view
from .equations import wind_points
from .flat_arrays import flat, part
from .linear_algebra.vectors import norm, vector_at
from .step import power_balance, transaction
from .step.outputs import complete

_DOUBLES = types.CPointer(types.float64)
_COUNT, _STATUS, _NUMBER = types.int64, types.int32, types.float64
SIGNATURES = Kernels(
    segments=_COUNT(_COUNT, _DOUBLES),
    pack=_STATUS(_COUNT, _COUNT, _DOUBLES, _NUMBER, _DOUBLES),
    work_size=_COUNT(_COUNT),
    initialize=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES),
    advance=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _NUMBER, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES),
    outputs=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES),
    fly=_COUNT(_COUNT, _DOUBLES, _DOUBLES, _COUNT, _NUMBER, _COUNT, _COUNT, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES),
    energy=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
)


def entry_points(variant):
    """Entry points of a variant, functions to be compiled with `SIGNATURES`; variant : module of `kernels.variants`.

    They are defined in here, in one long function, because the compiler has to know the variant as a constant.
    """
    declared = BY_NAME[variant.__name__.rpartition(".")[2]]
    has_nodes, has_waves = declared.has_nodes, declared.has_waves

    @view
    def chain_arrays(n, parameters, state, work):
        """The parameters, the state and the work as arrays."""
        p = flat(parameters, parameters_size(n))
        return p, state_array(n, p, state), flat(work, variant.work_size(n))

    @view
    def state_array(n, p, state):
        """A state as an array."""
        return flat(state, state_size(n, wind_points.count_of(p)))

    @view
    def inputs_array(p, inputs):
        """The inputs as an array."""
        return flat(inputs, inputs_size(wind_points.count_of(p)))

    @kernel
    def take_outputs(n, p, s, shape_points, outputs, w):
        """Outputs (modified) that belong to a state; a status: OK or OUTPUT_NOT_FINITE."""
        wind_points.take_from_state(n, p, s)
        variant.outputs_of(n, p, s, shape_points, outputs, w)
        return complete(n, s, outputs)

    @kernel
    def take_step(n, p, inputs, step, s, before, w):
        """One communication step of `step` [s]; on any status but OK the state is as it was.

        s (modified) : the state.  before (modified) : the state of before.
        """
        copy(s, before)
        status, given = transaction.begin(n, p, inputs, step, has_waves, s)
        if status == OK:
            status = variant.advance(n, p, given, before, s, w)
        return transaction.commit(n, p, status, before, s)

    @kernel
    def take_step_with_outputs(n, p, inputs, step, s, before, shape_points, outputs, w):
        """`take_step`, then the outputs (modified); on any status but OK the outputs are those of before, too."""
        status = take_step(n, p, inputs, step, s, before, w)
        if status == OK:
            status = take_outputs(n, p, s, shape_points, outputs, w)
            if status != OK:
                copy(before, s)
                take_outputs(n, p, s, shape_points, outputs, w)
        return status

    def segments(tethers, quantities):
        """Number of segments of tethers in series with these quantities, see `packing`; 0 if it is unknown."""
        return packing.count_segments(tethers, flat(quantities, packing.count_of_quantities(tethers, 0)), has_nodes)

    def pack(tethers, kites, quantities, tolerance, parameters):
        """Parameters (modified) of as many segments as `segments` says; a status, and nothing is done on any but OK."""
        given = flat(quantities, packing.count_of_quantities(tethers, kites))
        p = flat(parameters, parameters_size(packing.count_segments(tethers, given, has_nodes)))
        return packing.pack(tethers, kites, given, tolerance, has_nodes, has_waves, p)

    def work_size(n):
        """Length of the work array [-] of a tether with n segments."""
        return variant.work_size(n)

    def initialize(n, parameters, inputs, state, shape_points, outputs, work):
        """First state and its outputs (both modified) between two ends; they have no meaning on any status but OK."""
        p, s, w = chain_arrays(n, parameters, state, work)
        i = inputs_array(p, inputs)
        status = transaction.start(n, p, i, s)
        if status == OK:
            status = variant.initialize(n, p, i, s, w)
        status = transaction.commit_start(n, p, status, s)
        if status == OK:
            status = take_outputs(n, p, s, shape_points, flat(outputs, outputs_size(shape_points)), w)
        return status

    def advance(n, parameters, inputs, step, state, before, shape_points, outputs, work):
        """One communication step of `step` [s]: state and outputs (modified), left as they were on any status but OK.

        before (modified) : room for a state; after a step that was done, the state of before it.
        """
        p, s, w = chain_arrays(n, parameters, state, work)
        i, old, o = inputs_array(p, inputs), state_array(n, p, before), flat(outputs, outputs_size(shape_points))
        return take_step_with_outputs(n, p, i, step, s, old, shape_points, o, w)

    def outputs(n, parameters, state, shape_points, outputs, work):
        """Outputs (modified) that belong to a state."""
        p, s, w = chain_arrays(n, parameters, state, work)
        return take_outputs(n, p, s, shape_points, flat(outputs, outputs_size(shape_points)), w)

    def fly(n, parameters, inputs, steps, step, every, outputs, state, before, shape_points, rows, work):
        """Do `steps` communication steps, until one is refused; returns how many were done. The state is modified.

        inputs : one row of inputs per step.  every : a row is kept after every so many steps; 0 for none.
        outputs : NEVER, AT_ROWS or ALWAYS (after each step) computed, see `TetherModel.fly`.  before : room for a state.
        rows (modified) : of each kept step the outputs and the largest |kite_force| since the row before, unless NEVER; the
        node positions.
        """
        p, s, w = chain_arrays(n, parameters, state, work)
        x, _ = positions_and_velocities(n, s)
        old, size_of_row = state_array(n, p, before), inputs_size(wind_points.count_of(p))
        flight = flat(inputs, steps * size_of_row)
        size, nodes = outputs_size(shape_points), 3 * (n + 1)
        observed = size + 1 if outputs != at.NEVER else 0
        width = observed + nodes
        kept = flat(rows, width * (steps // every + 1 if every > 0 else 1))
        largest, row = 0.0, 0
        for k in range(steps):
            keep = every > 0 and (k + 1) % every == 0
            inputs_now = part(flight, k * size_of_row, size_of_row)
            if outputs == at.ALWAYS or (keep and outputs == at.AT_ROWS):
                now = part(kept, row, size)
                if take_step_with_outputs(n, p, inputs_now, step, s, old, shape_points, now, w) != OK:
                    return k
                largest = max(largest, norm(vector_at(now, at.KITE_FORCE)))
            elif take_step(n, p, inputs_now, step, s, old, w) != OK:
                return k
            if keep:
                if outputs != at.NEVER:
                    kept[row + size] = largest
                copy(x, part(kept, row + observed, nodes))
                largest, row = 0.0, row + width
        return steps

    def energy(n, parameters, state, inputs, energies, work):
        """Energies, powers, tensions and velocities (modified) of a state with wind, reel-out speed and load of `inputs`."""
        p, s, w = chain_arrays(n, parameters, state, work)
        wind_points.take_from_state(n, p, s)
        v = variant.velocities_of(n, p, s, w)
        return power_balance.balance(n, p, s, v, flat(inputs, at.INPUTS), flat(energies, power_balance.size(n)), w)

    return Kernels(segments, pack, work_size, initialize, advance, outputs, fly, energy)
