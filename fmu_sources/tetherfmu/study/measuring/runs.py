"""One run: a configuration of a tether flown through a scene, and what it gave at the output times of the scene."""

from dataclasses import replace
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numba import njit

from tetherfmu.models import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.parameters import Solver
from tetherfmu.study.scenes.standard import MODELS, QUASI_STEADY_START

SHAPE_POINTS = 21
VARIANTS = ("straight", "catenary", "quasi_steady", "dynamic")  # from coarse to fine


class Config(NamedTuple):
    """A configuration that a user can choose; numbers that a variant does not have are 0."""

    variant: str
    segments: int
    tolerance: float
    step: float  # communication step [s]

    def words(self):
        """For people."""
        segments = f", {self.segments} segments" if self.segments else ""
        tolerance = f", tolerance {self.tolerance:g}" if self.tolerance else ""
        return f"{self.variant}{segments}{tolerance}, communication step {1e3 * self.step:g} ms"


class Run(NamedTuple):
    """Outputs at the output times of a scene, the start left out; arrays with one row for each. SI units."""

    outputs: np.ndarray  # as `layout.py` has them
    peak: np.ndarray  # largest |kite_force| since the output time before [N]
    steps: int  # internal steps, accepted and rejected, or Newton iterations for shapes
    calls: int  # communication steps
    seconds: float  # wall time of all steps and outputs

    @property
    def kite_force(self):
        """Force on the kite [N], array (times, 3)."""
        return self.outputs[:, at.KITE_FORCE : at.KITE_FORCE + 3]

    @property
    def ground_force(self):
        """Force on the ground station [N], array (times, 3)."""
        return self.outputs[:, at.GROUND_FORCE : at.GROUND_FORCE + 3]

    @property
    def shape(self):
        """Points of the tether [m], array (times, points, 3)."""
        return self.outputs[:, at.SHAPE :].reshape(len(self.outputs), -1, 3)


@njit
def fly(advance, observe, n, parameters, inputs, step, state, work, every, outputs, points, rows, peak):
    """All communication steps, each with its outputs; every so many, these go into `rows` (modified).

    `peak` (modified) gets the largest |kite_force| [N] since the row before. Returns the status of
    the step that failed, or 0.
    """
    largest = 0.0
    for k in range(len(inputs)):
        result = advance(n, parameters.ctypes, inputs[k].ctypes, step, state.ctypes, work.ctypes)
        if result == 0:
            result = observe(n, parameters.ctypes, state.ctypes, points, outputs.ctypes, work.ctypes)
        if result != 0:
            return result
        force = outputs[at.KITE_FORCE : at.KITE_FORCE + 3]
        largest = max(largest, np.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2))
        if (k + 1) % every == 0:
            rows[k // every] = outputs
            peak[k // every] = largest
            largest = 0.0
    return 0


def started(scene, config, first):
    """Python face of a configuration, initialized with the first inputs of a scene."""
    tether = replace(scene.tether, segments=config.segments or 1)
    solver = Solver(relative_tolerance=config.tolerance, initial_shape=QUASI_STEADY_START)
    model = MODELS[config.variant](tether, scene.environment, solver, shape_points=SHAPE_POINTS)
    places = (at.KITE_POSITION, at.KITE_VELOCITY, at.GROUND_POSITION, at.GROUND_VELOCITY)
    ends = [first[place : place + 3] for place in places]
    model.initialize(*ends, first[at.REEL_OUT_SPEED], first[at.WIND_VELOCITY : at.WIND_VELOCITY + 3])
    return model


def run(scene, config, exact=False):
    """Fly a scene.

    Parameters
    ----------
    scene : Scene
    config : Config
    exact : bool
        See `Scene.inputs`.

    Returns
    -------
    Run

    Raises
    ------
    StepRefused
        If the tether refuses the start or a step.
    """
    inputs = scene.inputs(config.step, exact)
    model = started(scene, config, inputs[0])
    every = round(scene.every / config.step)
    rows, peak = np.zeros((scene.count, len(model._outputs))), np.zeros(scene.count)
    began = perf_counter()
    result = fly(
        model._kernels.advance,
        model._kernels.observe,
        model.segments,
        model._parameters,
        inputs,
        config.step,
        model._state,
        model._work,
        every,
        model._outputs,
        SHAPE_POINTS,
        rows,
        peak,
    )
    seconds = perf_counter() - began
    if result != status.OK:
        raise StepRefused(f"{config.words()}: a step was refused, status {status.code(result)}")
    return Run(rows, peak, sum(model.counters.values()), len(inputs), seconds)
