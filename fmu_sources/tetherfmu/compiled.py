"""What the Python API runs compiled: the entry points just in time, and a loop over communication steps around them."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import njit

from tetherfmu.kernels import entry_points
from tetherfmu.kernels.compilation import compile_entry_point
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.kernel_library import PROTOTYPES, Kernels


@cache
def _compiled(name):
    return compile_entry_point(getattr(entry_points, name))


def kernels(variant):
    """Entry points of a variant ("dynamic", ...) as `kernel_library.Kernels`."""
    return Kernels(*(prototype(_compiled(f"{variant}_{verb}").address) for verb, prototype in PROTOTYPES._asdict().items()))


class Memory(NamedTuple):
    """Arrays of one running tether, as `layout.py` has them; `before` is the copy of its state of before a step."""

    parameters: np.ndarray
    state: np.ndarray
    before: np.ndarray
    outputs: np.ndarray
    work: np.ndarray


class Rows(NamedTuple):
    """What a flight keeps, one row each: outputs, largest |kite_force| [N] since the row before, node positions [m]."""

    outputs: np.ndarray  # (rows, outputs)
    peak: np.ndarray  # (rows,)
    positions: np.ndarray  # (rows, 3 (segments + 1))


@njit
def fly(advance, observe, n, points, memory, inputs, step, every, peaks, rows):
    """All communication steps of a flight, until one is refused; nothing is allocated.

    Parameters
    ----------
    advance, observe : entry points of `kernel_library.Kernels`
    n, points : int
        Number of segments, and of points of the output `shape`.
    memory : Memory
        Modified. A refused step leaves the state of before it.
    inputs : (steps, INPUTS) array
    step : float
        Communication step [s].
    every : int
        A row is kept after every so many steps; 0 for none.
    peaks : bool
        Whether the outputs are computed after each step, not only where a row is kept.
    rows : Rows
        Modified.

    Returns
    -------
    int, int
        Status of the step that was refused (OK if none was), and how many steps were done.
    """
    state, outputs = memory.state, memory.outputs
    largest = 0.0
    for k in range(len(inputs)):
        kept = every > 0 and (k + 1) % every == 0
        memory.before[:] = state
        result = advance(n, memory.parameters.ctypes, inputs[k].ctypes, step, state.ctypes, memory.work.ctypes)
        if result == status.OK and (kept or peaks):
            result = observe(n, memory.parameters.ctypes, state.ctypes, points, outputs.ctypes, memory.work.ctypes)
            force = outputs[at.KITE_FORCE : at.KITE_FORCE + 3]
            largest = max(largest, np.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2))
        if result != status.OK:
            state[:] = memory.before
            return result, k
        if kept:
            row = k // every
            rows.outputs[row] = outputs
            rows.peak[row] = largest
            rows.positions[row] = state[at.STATE_HEADER : at.STATE_HEADER + 3 * (n + 1)]
            largest = 0.0
    return status.OK, len(inputs)
