"""Many communication steps in one call of compiled code: what `TetherModel.fly` does."""

from time import perf_counter

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import address

from .results import Flown


def fly(instance, inputs, step, every, outputs):
    """Fly an `Instance` (modified) until a step is refused or all are done; returns how many were done, and the `Flown`.

    inputs : contiguous array (steps, INPUTS).  step : communication step [s].  every : a row is kept after every so many
    steps; 0 for none.  outputs : when they are computed, `layout.NEVER`, `AT_ROWS` or `ALWAYS`.
    """
    size = at.outputs_size(instance.points) + 1 if outputs != at.NEVER else 0  # the peak is one more
    nodes = instance.segments + 1
    rows = np.zeros((len(inputs) // every + 1 if every else 1, size + 3 * nodes))  # the last one is for scratch
    arrays = instance.parameters, instance.state, instance.before, instance.work
    parameters, state, before, work = map(address, arrays)
    flight = inputs.ctypes.data, len(inputs), step, every, outputs
    began = perf_counter()
    done = instance.kernels.fly(
        instance.segments, parameters, *flight, state, before, instance.points, rows.ctypes.data, work
    )
    seconds = perf_counter() - began
    rows = rows[:-1]
    positions = rows[:, size:].reshape(len(rows), nodes, 3)
    if outputs == at.NEVER:
        return done, Flown(None, None, positions, seconds)
    return done, Flown(np.ascontiguousarray(rows[:, : size - 1]), rows[:, size - 1].copy(), positions, seconds)
