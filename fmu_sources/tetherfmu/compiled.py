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


class Flown(NamedTuple):
    """What a flight of many communication steps gave: one row for each step that was kept."""

    outputs: np.ndarray  # (rows, outputs_size), as `layout.py` has them
    peak: np.ndarray  # (rows,), largest |kite_force| since the row before [N]
    positions: np.ndarray  # (rows, segments + 1, 3), of the nodes [m]
    seconds: float = 0.0  # wall time of all steps [s]

    @property
    def kite_force(self):
        """Force on the kite [N], array (rows, 3)."""
        return self.outputs[:, at.KITE_FORCE : at.KITE_FORCE + 3]

    @property
    def ground_force(self):
        """Force on the ground station [N], array (rows, 3)."""
        return self.outputs[:, at.GROUND_FORCE : at.GROUND_FORCE + 3]

    @property
    def shape(self):
        """Points of the tether [m], array (rows, points, 3)."""
        points = (self.outputs.shape[1] - at.SHAPE) // 3
        return self.outputs[:, at.SHAPE :].reshape(len(self.outputs), points, 3)


class Memory(NamedTuple):
    """Numbers and arrays of a running tether, see `instance.Instance`; `n` is its number of segments."""

    n: int
    points: int
    parameters: np.ndarray
    state: np.ndarray
    before: np.ndarray
    outputs: np.ndarray
    work: np.ndarray


@njit
def fly(advance, observe, memory, inputs, step, every, peaks, rows):
    """All communication steps of a flight, until one is refused; nothing is allocated.

    advance, observe : of `kernel_library.Kernels`.  memory : `Memory`, modified; a refused step leaves the state of before
    it.  inputs, step, every, peaks : see `TetherModel.fly`.  rows : `Flown`, modified.

    Returns the status of the step that was refused (OK if none was), and how many steps were done.
    """
    n, points, parameters, state, before, outputs, work = memory
    largest = 0.0
    for k in range(len(inputs)):
        kept = every > 0 and (k + 1) % every == 0
        before[:] = state
        result = advance(n, parameters.ctypes, inputs[k].ctypes, step, state.ctypes, work.ctypes)
        if result == status.OK and (kept or peaks):
            result = observe(n, parameters.ctypes, state.ctypes, points, outputs.ctypes, work.ctypes)
            force = outputs[at.KITE_FORCE : at.KITE_FORCE + 3]
            largest = max(largest, np.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2))
        if result != status.OK:
            state[:] = before
            return result, k
        if kept:
            row = k // every
            rows.outputs[row] = outputs
            rows.peak[row] = largest
            rows.positions[row] = state[at.STATE_HEADER : at.STATE_HEADER + 3 * (n + 1)].reshape(n + 1, 3)
            largest = 0.0
    return status.OK, len(inputs)
