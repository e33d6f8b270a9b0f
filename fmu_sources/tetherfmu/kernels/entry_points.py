"""The entry points: the only functions that shells call. Numbers and pointers to flat arrays, nothing else.

Each variant has four: initialize, advance, observe, fly; with nodes a fifth: account. `runtime.kernel_library` has their
signatures for callers, `layout.py` the arrays. They return statuses (`status.py`), `fly` the number of steps done.
"""

from numba import carray, types

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import Kernels
from tetherfmu.runtime.status import OK

from .algebra.vectors import norm, vector_at
from .arrays import copy, outputs_size, parameters_size, positions_and_velocities, state_size, work_size
from .chain import power_balance
from .compilation import part, view

_DOUBLES = types.CPointer(types.float64)
_COUNT, _STATUS, _NUMBER = types.int64, types.int32, types.float64
SIGNATURES = Kernels(
    initialize=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
    advance=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _NUMBER, _DOUBLES, _DOUBLES),
    observe=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES),
    fly=_COUNT(_COUNT, _DOUBLES, _DOUBLES, _COUNT, _NUMBER, _COUNT, _COUNT, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES),
    account=_STATUS(_COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
)


@view
def _chain_arrays(n, parameters, state, work):
    """The parameters, the state and the work as arrays."""
    return carray(parameters, parameters_size(n)), carray(state, state_size(n)), carray(work, work_size(n))


def entry_points(variant):
    """Entry points of a variant, functions to be compiled with `SIGNATURES`.

    variant : module of `kernels.variants`, with the kernels initialize, advance and observe.
    """

    def initialize(n, parameters, inputs, state, work):
        """First state (modified) between two ends; see the kernel of the variant."""
        p, s, w = _chain_arrays(n, parameters, state, work)
        return variant.initialize(n, p, carray(inputs, at.INPUTS), s, w)

    def advance(n, parameters, inputs, step, state, work):
        """One communication step of `step` [s] (state modified); see the kernel of the variant."""
        p, s, w = _chain_arrays(n, parameters, state, work)
        return variant.advance(n, p, carray(inputs, at.INPUTS), step, s, w)

    def observe(n, parameters, state, shape_points, outputs, work):
        """Outputs (modified) that belong to a state; see the kernel of the variant."""
        p, s, w = _chain_arrays(n, parameters, state, work)
        return variant.observe(n, p, s, shape_points, carray(outputs, outputs_size(shape_points)), w)

    def fly(n, parameters, inputs, steps, step, every, outputs, state, before, shape_points, rows, work):
        """Do `steps` communication steps, until one is refused; returns how many were done. The state is modified.

        inputs : one row of inputs per step.  every : a row is kept after every so many steps; 0 for none.
        outputs : NEVER, AT_ROWS or ALWAYS (after each step) computed, see `TetherModel.fly`.  before : room for a state.
        rows (modified) : of each kept step the outputs and the largest |kite_force| since the row before, unless NEVER; the
        node positions.
        """
        p, s, w = _chain_arrays(n, parameters, state, work)
        x, _ = positions_and_velocities(n, s)
        old = carray(before, state_size(n))
        flight = carray(inputs, steps * at.INPUTS)
        size, nodes = outputs_size(shape_points), 3 * (n + 1)
        observed = size + 1 if outputs != at.NEVER else 0
        width = observed + nodes
        kept = carray(rows, width * (steps // every + 1 if every > 0 else 1))
        largest, row = 0.0, 0
        for k in range(steps):
            keep = every > 0 and (k + 1) % every == 0
            observes = outputs == at.ALWAYS or (keep and outputs == at.AT_ROWS)
            if observes:
                copy(s, old)
            if variant.advance(n, p, part(flight, k * at.INPUTS, at.INPUTS), step, s, w) != OK:
                return k
            if observes:
                now = part(kept, row, size)
                if variant.observe(n, p, s, shape_points, now, w) != OK:
                    copy(old, s)
                    return k
                largest = max(largest, norm(vector_at(now, at.KITE_FORCE)))
            if keep:
                if outputs != at.NEVER:
                    kept[row + size] = largest
                copy(x, part(kept, row + observed, nodes))
                largest, row = 0.0, row + width
        return steps

    def account(n, parameters, state, inputs, energies, work):
        """Energies, powers and tensions (modified) of a state with the wind, the reel-out speed and the load of `inputs`."""
        p, s, w = _chain_arrays(n, parameters, state, work)
        return power_balance.account(n, p, s, carray(inputs, at.INPUTS), carray(energies, power_balance.ENERGIES + n), w)

    return Kernels(initialize, advance, observe, fly, account)
