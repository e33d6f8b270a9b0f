"""One run: a configuration of a tether in a scene, its results at the output times of the scene, and its cost.

Costs are counted work times measured unit costs, so that they do not depend on the load of the machine:

    cost = calls (a + b n) + work (c + d n),   n segments

calls: communication steps, each with its outputs. work: internal steps of the dynamic tether, Newton iterations of others.
a, b, c, d are fitted to times measured on one machine and stored in costs.csv, by `docs/make/make_costs.py`.
"""

from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple
from warnings import catch_warnings

import numpy as np
import pandas as pd

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.python.results import Flown
from tetherfmu.records.problems import PlausibilityWarning, StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.variants import DYNAMIC_FREE, VARIANTS, class_name

from .start import tether_at_start

TABLE = Path(__file__).with_name("costs.csv")
UNITS = pd.read_csv(TABLE, index_col="variant")  # unit costs [s]: a row of `COLUMNS` for each variant and one for the host
FIXED = "fixed_step"  # row of the dynamic tether with fixed steps of order 2, in iterations
HOST = "host"  # row of FMPy's overhead per communication step: set 6, step, get 6
ADVISED = tuple(variant for variant in VARIANTS if variant in UNITS.index)  # variants with known costs
HOST_COST = float(UNITS.at[HOST, "per call"])  # [s]
COLUMNS = ("per call", "per call and segment", "per work", "per work and segment")
SHAPE_POINTS = DEFAULT_OPTIONS["shape_points"]
UNWARNED = {"action": "ignore", "category": PlausibilityWarning}  # each run of a study would repeat the same warnings


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
    """Result of a flight at the output times of a scene, without the start, and its cost."""

    flown: Flown  # without the positions of the nodes
    work: int  # internal steps, accepted and rejected, or Newton iterations for shapes
    calls: int  # communication steps
    implausible: tuple = ()  # sentences on implausible behaviour
    length: float = 0.0  # unstretched, at the start [m]


def regressors(config, calls, work):
    """Factors of the four unit costs."""
    return np.array([calls, calls * config.segments, work, work * config.segments], float)


def cost(scene, config, calls, work):
    """Kernel time per simulated second [-], of the machine of costs.csv."""
    return float(UNITS.loc[config.variant].to_numpy() @ regressors(config, calls, work)) / (scene.count * scene.every)


def least_cost(scene, config):
    """Lower bound of the cost of a configuration: one internal step or iteration in each communication step."""
    calls = round(scene.count * scene.every / config.step)
    return cost(scene, config, calls, 0 if config.variant == "straight" else calls)


def parameters_of(scene, config):
    """Values of all parameters of a tether in a scene by name; the solver's others have their defaults."""
    chosen = {"segments": config.segments or 1, "relative_tolerance": config.tolerance, "initial_shape": at.QUASI_STEADY}
    chosen |= {"end_velocities": end_velocities(scene), **winch(scene)}
    found = {**asdict(scene.tether), **asdict(scene.environment), **asdict(scene.ground), **chosen}
    if scene.kite_is_free:
        start = scene.flight.at_rest(scene.tether, scene.environment.gravity).tolist()
        found |= {f"initial_kite_position[{i}]": place for i, place in enumerate(start, 1)}
        found |= {"kite_mass": scene.flight.kite_mass, "initial_shape": at.STATIC_EQUILIBRIUM}
    return found


def fmu_of(scene, config):
    """Name of the FMU of a configuration in a scene."""
    return class_name(DYNAMIC_FREE.name if scene.kite_is_free else config.variant)


def end_velocities(scene):
    """Inputs that an importer has: the velocities of the ends, or only positions."""
    return at.GIVEN if scene.flight.has_velocities else at.DERIVED


def winch_control(scene):
    """Winch inputs that an importer has: a speed, or the force or the length of a log."""
    if scene.has_force:
        return at.WINCH_BY_FORCE
    return at.WINCH_BY_LENGTH if scene.flight.has_length else at.WINCH_BY_SPEED


def winch(scene):
    """Parameters of the winch of a scene by name: how it is controlled, and its drum."""
    return asdict(scene.winch) | {"winch_control": winch_control(scene)}


def run(scene, config, exact=False):
    """`Run` of a `Config` through a scene; StepRefused if the tether refuses the start or a step.

    exact : whether with the exact reel-out and wind of each step, see `Scene.inputs`.
    """
    inputs, wind = scene.inputs(config.step, exact), scene.wind_at(config.step, exact)
    options = {"segments": config.segments or 1, "input_continuation": at.HELD if exact else at.LINEAR}
    options["end_velocities"] = at.GIVEN if exact else end_velocities(scene)
    if options["end_velocities"] == at.DERIVED:
        columns = by_name(inputs)
        columns["kite_velocity"][:] = columns["ground_velocity"][:] = 0.0
    options |= winch(scene)
    if exact and scene.flight.has_length:
        options["winch_control"] = at.WINCH_BY_SPEED
    with catch_warnings(**UNWARNED):
        first = inputs[0], None if wind is None else wind[0]
        model = tether_at_start(scene, config.tolerance, config.variant, *first, **options, shape_points=SHAPE_POINTS)
        length = model.outputs().tether_length
        try:
            flown = model.fly(inputs, config.step, every=round(scene.every / config.step), wind_at=wind)
        except StepRefused as refusal:
            raise StepRefused(f"{config.words()}: {refusal}") from None
    work = sum(model.counters.values())
    return Run(flown._replace(positions=None), work, len(inputs), tuple(model.implausible), length)
