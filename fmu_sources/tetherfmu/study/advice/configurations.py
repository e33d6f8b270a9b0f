"""The trade of speed for accuracy in a scene: every configuration against a converged reference."""

from concurrent.futures import as_completed
from itertools import product, starmap
from math import inf
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from tetherfmu.files.scene_files import OUTPUTS
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime.variants import BY_NAME
from tetherfmu.study.measuring.errors import Reference, converged, errors, worst
from tetherfmu.study.measuring.executors import progress_bar
from tetherfmu.study.measuring.runs import ADVISED, HOST_COST, Config, cost, run
from tetherfmu.study.measuring.store import key

SEGMENTS = (2, 3, 4, 6, 8, 11, 16, 22, 32, 45)
TOLERANCES = (1e-2, 1e-3, 1e-4)
STEPS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005)  # communication steps [s]
SHORT_STEP = 0.002  # [s]
LEVELS = (0.1, 0.03, 0.01, 0.003)  # error levels, each with its cheapest configuration
REFERENCE_ERROR = 3e-4  # goal for the reference: a tenth of the smallest level
CLEARLY = 1.5  # error over allowed error beyond which nothing coarser is tried
LONG_RUN = 0.05  # [s], not repeated


class Measured(NamedTuple):
    """A configuration in a scene: errors, and cost per simulated second."""

    config: Config
    errors: dict  # by output; empty if refused
    calls: int  # communication steps
    work: int  # internal steps or Newton iterations
    seconds: float  # measured kernel time per simulated second
    cost: float  # the same from counted work, see `runs`
    refused: str = ""

    def error(self, names=None):
        """Largest error of some outputs, or of all; infinite if it was refused."""
        return worst(self.errors, names) if self.errors else inf

    @property
    def host_cost(self):
        """Estimated time per simulated second with FMPy around it [-]."""
        return self.cost + HOST_COST / self.config.step


class Advice(NamedTuple):
    """Recommendation and its certainty."""

    point: Any  # its configuration, and errors against the finer model: `Measured`, with fixed steps `fixed.Point`
    least: float  # the error is at least this, and at most `expected` [-]: measured against the finer model, less and
    expected: float  # plus the finer model's own
    met: bool  # whether `expected` is allowed
    points: list  # of all tested configurations
    finer: Reference
    stopped: bool = False  # whether the budget ended the search
    budget: float = inf  # of all flights [s]


def advice_on(point, points, finer, wanted, names=None, **search):
    """`Advice` for one of the points; names : outputs that count, None: all.  search : `stopped` and `budget`."""
    error, own = point.error(names), finer.own_error(names)
    return Advice(point, max(0.0, error - own), error + own, error + own <= wanted.allowed_error, points, finer, **search)


def steps(scene):
    """Communication steps [s] to choose from."""
    return (scene.wanted.communication_step,) if scene.wanted.communication_step else STEPS


def ladder(scene):
    """All configurations of the study; for a free end, only dynamic tethers.

    At short steps the tolerance has no effect: the solver needs one step each.
    """
    configs = []
    for variant in (BY_NAME[name] for name in ADVISED):
        if variant.has_waves or not scene.kite_is_free:
            segments, tolerances = SEGMENTS if variant.has_nodes else (0,), TOLERANCES if variant.has_waves else (0.0,)
            configs += starmap(Config, product((variant.name,), segments, tolerances, steps(scene)))
    return [each for each in configs if each.step > SHORT_STEP or each.tolerance <= TOLERANCES[-1]]


def measure(scene, config, reference, repeats=1, exact=False):
    """`Measured` of a configuration against a reference, a `Flown`.

    repeats : of a short run; the time is the least.  exact : see `Scene.inputs`.
    """
    try:
        first = run(scene, config, exact)
        again = repeats - 1 if first.flown.seconds < LONG_RUN else 0
        seconds = min([first.flown.seconds, *(run(scene, config, exact).flown.seconds for _ in range(again))])
    except StepRefused as refusal:
        return Measured(config, {}, 0, 0, 0.0, 0.0, str(refusal))
    found, spent = errors(scene, first.flown, reference), cost(scene, config, first.calls, first.work)
    return Measured(config, found, first.calls, first.work, seconds / (scene.count * scene.every), spent)


def study(scene, store, executor, configs=None, repeats=3):
    """All points of a scene: its `Reference`, and a table with a row for each configuration.

    Columns: the fields of `Measured` and `Config`, `host_cost`, an error for each output, and as `error` the largest error
    among the outputs that the scene requires.

    store : `Store` for finished points (read and written).  executor : as of concurrent.futures.
    configs : sequence of `Config`, by default `ladder(scene)`.  repeats : timed runs of each.
    """
    configs, names = configs or ladder(scene), scene.wanted.outputs
    reference = store.kept(key(scene.digest, *names), lambda: converged(scene, REFERENCE_ERROR, names))
    keys = {config: key(scene.digest, *config) for config in configs}
    missing = [config for config in configs if keys[config] not in store.points]
    futures = [executor.submit(measure, scene, config, reference.run.flown, repeats) for config in missing]
    for point in (future.result() for future in progress_bar(as_completed(futures), len(futures), scene.name)):
        store.add(keys[point.config], point._asdict())
    points = [Measured(**{**store.points[keys[config]], "config": config}) for config in configs]
    errors_of_all = pd.DataFrame([point.errors for point in points], columns=OUTPUTS)
    table = pd.concat([pd.DataFrame(points), pd.DataFrame(configs), errors_of_all], axis=1)
    return reference, table.assign(error=[p.error(names) for p in points], host_cost=[p.host_cost for p in points])


def cheapest(table, level):
    """The cheapest row with an error of at most `level`, or None."""
    good = table[table.error <= level]
    return None if good.empty else good.loc[good.cost.idxmin()]


def front(table):
    """Rows that no other beats in both cost and error, from cheap to exact."""
    table = table.sort_values(["cost", "error"])
    return table[table.error < table.error.cummin().shift(fill_value=np.inf)]
