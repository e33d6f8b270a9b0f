"""The trade of speed for accuracy in a scene: every configuration against a converged reference.

`python -m tetherfmu.study tradeoff SCENE`. Points are kept as they finish; a run that was stopped goes on where it was.
"""

import hashlib
from itertools import product
from typing import NamedTuple

from tetherfmu.models import StepRefused
from tetherfmu.study.measuring.converged import converged
from tetherfmu.study.measuring.costs import cost, host_cost
from tetherfmu.study.measuring.errors import errors, worst
from tetherfmu.study.measuring.executors import finished
from tetherfmu.study.measuring.runs import Config, run
from tetherfmu.study.measuring.store import package_digest

SEGMENTS = (2, 3, 4, 6, 8, 11, 16, 22, 32, 45)
TOLERANCES = (1e-2, 1e-3, 1e-4)
STEPS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005)  # communication steps [s]
SHORT_STEP = 0.002  # [s]
LEVELS = (0.1, 0.03, 0.01, 0.003)  # errors for which the cheapest configuration is told
REFERENCE_ERROR = 3e-4  # asked of the reference: a tenth of the smallest level
FORMAT = 1  # of a stored point
LONG_RUN = 0.05  # [s], not repeated


class Point(NamedTuple):
    """A configuration in a scene: errors, and cost per simulated second."""

    config: Config
    errors: dict  # by output; empty if refused
    calls: int  # communication steps
    work: int  # internal steps or Newton iterations
    seconds: float  # measured kernel time per simulated second
    cost: float  # the same from counted work, see `costs`
    refused: str = ""

    def error(self, names):
        """Largest error of some outputs; infinite if it was refused."""
        return worst(self.errors, names) if self.errors else float("inf")

    @property
    def host_cost(self):
        """Estimated time per simulated second with FMPy around it [-]."""
        return self.cost + host_cost(self.config.step)


def steps(scene):
    """Communication steps [s] to choose from."""
    return (scene.wanted.communication_step,) if scene.wanted.communication_step else STEPS


def ladder(scene):
    """All configurations of the study; at short steps the tolerance does not matter: the solver takes one step in each."""
    lines = [Config(variant, 0, 0.0, h) for variant, h in product(("straight", "catenary"), steps(scene))]
    steady = [Config("quasi_steady", n, 0.0, h) for n, h in product(SEGMENTS, steps(scene))]
    dynamic = [
        Config("dynamic", n, tolerance, h)
        for n, tolerance, h in product(SEGMENTS, TOLERANCES, steps(scene))
        if h > SHORT_STEP or tolerance == TOLERANCES[-1]
    ]
    return lines + steady + dynamic


def measure(scene, config, reference, repeats=1):
    """`Point` of a configuration against a reference run; the time is the least of some repeats, long runs have one."""
    try:
        runs = [run(scene, config)]
        while len(runs) < repeats and runs[0].seconds < LONG_RUN:
            runs.append(run(scene, config))
    except StepRefused as refusal:
        return Point(config, {}, 0, 0, 0.0, 0.0, str(refusal))
    first, flown = runs[0], scene.count * scene.every
    seconds = min(each.seconds for each in runs) / flown
    found = errors(scene, first, reference)
    return Point(config, found, first.calls, first.steps, seconds, cost(scene, config, first.calls, first.steps))


def key(scene, config):
    """Name of a point in the store."""
    return hashlib.sha256(repr((FORMAT, package_digest(), scene.digest, tuple(config))).encode()).hexdigest()[:24]


def study(scene, store, executor, progress, configs=None, repeats=3):
    """All points of a scene.

    Parameters
    ----------
    scene : Scene
    store : Store
        Finished points are taken from it and added to it.
    executor : concurrent.futures.Executor
    progress : callable
        Wraps an iterable of so many points, `progress(iterable, total)`; a progress bar.
    configs : sequence of Config
        Default: `ladder(scene)`.
    repeats : int
        Timed runs of each.

    Returns
    -------
    Reference, list of Point
    """
    configs = ladder(scene) if configs is None else configs
    names = scene.wanted.outputs
    reference = store.kept(key(scene, ("reference", *names)), lambda: converged(scene, REFERENCE_ERROR, names))
    points = {config: point_of(scene, store.points.get(key(scene, config))) for config in configs}
    missing = [config for config, point in points.items() if point is None]
    tasks = [(measure, scene, config, reference.run, repeats) for config in missing]
    for point in progress(finished(executor, tasks), len(tasks)):
        store.add(key(scene, point.config), point._asdict())
        points[point.config] = point
    return reference, list(points.values())


def point_of(scene, stored):
    """A point from what the store holds, its cost by the present unit costs; or None."""
    if stored is None:
        return None
    config = Config(*stored["config"])
    return Point(**{**stored, "config": config, "cost": cost(scene, config, stored["calls"], stored["work"])})


def cheapest(points, level, names):
    """The cheapest point with an error of at most `level`, or None."""
    good = [point for point in points if point.error(names) <= level]
    return min(good, key=lambda point: point.cost) if good else None


def front(points, names):
    """Points that no other beats in both cost and error, from cheap to exact."""
    best, chosen = float("inf"), []
    for point in sorted(points, key=lambda each: (each.cost, each.error(names))):
        if point.error(names) < best:
            best = point.error(names)
            chosen.append(point)
    return chosen
