"""Time of the compiled kernels of an FMU without Python around them: loops over communication steps, compiled too."""

import numpy as np
from numba import njit

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import load
from tetherfmu.study.measuring.clock import interleaved
from tetherfmu.study.scenes.standard import STEP, circle_inputs, circle_scene, tether_at_start

SEGMENTS = (6, 10, 20, 40, 80, 160)
WITHOUT_NODES = ("catenary", "straight")


@njit
def advance_all(advance, n, parameters, inputs, step, state, work, every, rows):
    """All communication steps; every so many, node positions of the state go into a row of `rows` (modified).

    Returns the status of all steps, or-ed.
    """
    status = 0
    for k in range(len(inputs)):
        status |= advance(n, parameters.ctypes, inputs[k].ctypes, step, state.ctypes, work.ctypes)
        if (k + 1) % every == 0 and (k + 1) // every < len(rows):
            row = rows[(k + 1) // every]
            row[:] = state[at.STATE_HEADER + 3 : at.STATE_HEADER + 3 + len(row)]
    return status


@njit
def initialize_all(initialize, n, parameters, inputs, state, work):
    """A new start at every communication point; returns the status of all, or-ed."""
    status = 0
    for k in range(len(inputs)):
        status |= initialize(n, parameters.ctypes, inputs[k].ctypes, state.ctypes, work.ctypes)
    return status


@njit
def observe_all(observe, n, parameters, state, points, outputs, work, count):
    """The outputs, so many times."""
    for _ in range(count):
        observe(n, parameters.ctypes, state.ctypes, points, outputs.ctypes, work.ctypes)


def checked(status):
    """RuntimeError unless the status is OK."""
    if status != 0:
        raise RuntimeError(f"a kernel returned the status {status}")


class Flight:
    """A tether of the scene "circle" whose kernels come from the library of an FMU."""

    def __init__(self, folder, variant, segments, steps):
        model = tether_at_start(circle_scene(segments), variant=variant)
        self.kernels = load(folder, variant)
        self.n, self.parameters, self.work = model.segments, model._parameters, model._work
        self.start, self.state, self.outputs = model.get_state(), model.get_state(), model._outputs
        self.points = model._points
        self.inputs = circle_inputs(steps)
        self.rows = np.zeros((0, 0))

    def advance(self):
        """Fly all steps from the start; returns internal steps, or iterations for a shape."""
        self.state[:] = self.start
        arrays = self.n, self.parameters, self.inputs, STEP, self.state, self.work, len(self.inputs), self.rows
        checked(advance_all(self.kernels.advance, *arrays))
        used = self.state - self.start
        return int(used[at.STEPS] + used[at.REJECTIONS] + used[at.ITERATIONS])

    def initialize(self):
        """Start anew at every communication point; returns the iterations for the last shape."""
        arrays = self.n, self.parameters, self.inputs, self.state, self.work
        checked(initialize_all(self.kernels.initialize, *arrays))
        return int(self.state[at.ITERATIONS]) * len(self.inputs)

    def observe(self):
        """The outputs, as often as there are steps."""
        observe_all(
            self.kernels.observe,
            self.n,
            self.parameters,
            self.start,
            self.points,
            self.outputs,
            self.work,
            len(self.inputs),
        )
        return 0


def kernel_times(folder, segments, steps, repeats):
    """Rows (what, segments, seconds per communication step, internal steps or iterations per communication step).

    folder : with the libraries of all variants.
    """
    jobs = {}
    for n in segments:
        for variant in ("dynamic", "quasi_steady"):
            flight = Flight(folder, variant, n, steps)
            jobs[f"{variant} step" + (" (warm)" if variant == "quasi_steady" else ""), n] = flight.advance
            if variant == "quasi_steady":
                jobs["quasi_steady start (cold)", n] = Flight(folder, variant, n, steps // 5).initialize
            jobs[f"{variant} outputs", n] = flight.observe
    for variant in WITHOUT_NODES:
        flight = Flight(folder, variant, 1, steps)
        jobs[f"{variant} step", 1] = flight.advance
        jobs[f"{variant} outputs", 1] = flight.observe
    times, counts = interleaved(jobs, repeats, min)
    rows = []
    for (what, n), seconds in times.items():
        calls = steps // 5 if "cold" in what else steps
        rows.append((what, n, seconds / calls, counts[what, n] / calls))
    return rows
