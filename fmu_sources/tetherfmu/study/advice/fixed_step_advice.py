"""Fixed steps for real time: segments and step that meet an allowed error within a time per communication step.

The study runs the dynamic tether with `fixed_step`, like the importer, against the finer model of `advise`. The time of
a communication step is counted work times unit costs, as in `measuring/runs.py`, with the most iterations of any
communication step in the flight. The code guarantees an upper bound, `limits.WORST_WORK`.
"""

from math import inf
from typing import NamedTuple
from warnings import catch_warnings

import numpy as np

from tetherfmu.python.results import Flown
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime.limits import STAGES
from tetherfmu.study.measuring.errors import errors, worst
from tetherfmu.study.measuring.runs import FIXED, SHAPE_POINTS, UNITS, UNWARNED, end_velocities, fmu_of, winch
from tetherfmu.study.measuring.start import tether_at_start
from tetherfmu.study.measuring.tables import page

from .configurations import CLEARLY, SEGMENTS, STEPS, advice_on

PARTS = (1, 2, 4, 8, 16)  # fixed steps in a given communication step
LEAST = STAGES  # iterations of a fixed step of order 2
BLOCK = 50  # compared outputs that are flown at once: all communication steps between them are kept meanwhile


class Fixed(NamedTuple):
    """A dynamic tether with fixed steps."""

    segments: int
    step: float  # communication step [s]
    parts: int  # fixed steps in it

    variant, tolerance = "dynamic", 0.0  # not annotated: constants of the class

    @property
    def fixed_step(self):
        """The parameter of that name [s]."""
        return self.step / self.parts

    def time(self, iterations):
        """Time [s] of a communication step with this number of iterations, on the machine of costs.csv."""
        work = np.array([1.0, self.segments, iterations, iterations * self.segments])
        return float(UNITS.loc[FIXED].to_numpy() @ work)

    @property
    def smooth_time(self):
        """Time [s] of a communication step in smooth flight."""
        return self.time(LEAST * self.parts)

    @property
    def cost(self):
        """Kernel time per simulated second in smooth flight [-]."""
        return self.smooth_time / self.step

    def is_finer(self, other):
        """Whether it is finer than another one in some respect."""
        return self.segments > other.segments or self.step < other.step or self.fixed_step < other.fixed_step


class Point(NamedTuple):
    """Result of a flight with fixed steps."""

    config: Fixed
    errors: dict  # by output; empty if refused
    iterations: int  # the most in a communication step
    most: int  # upper bound for one step
    implausible: tuple  # sentences

    def error(self, names):
        """Largest error of some outputs [-]; infinite if it was refused."""
        return worst(self.errors, names) if self.errors else inf

    @property
    def time(self):
        """Longest time [s] of a communication step in the flight."""
        return self.config.time(self.iterations)

    @property
    def bound(self):
        """Factorizations and time [s] of a communication step that its code allows."""
        return self.most, self.config.time(self.most)


def candidates(scene):
    """All configurations from cheap to dear that need no longer than allowed in smooth flight."""
    step, most = scene.wanted.communication_step, scene.wanted.time_per_step or inf
    pairs = [(step, parts) for parts in PARTS] if step else [(each, 1) for each in STEPS]
    found = [Fixed(n, each, parts) for n in SEGMENTS for each, parts in pairs]
    possible = [each for each in found if each.smooth_time <= most]
    return sorted(possible or found[:1], key=lambda each: each.cost)


def fly(scene, config, reference):
    """`Point` of a configuration in a scene against a reference, a `Flown`."""
    inputs, wind, every = scene.inputs(config.step), scene.wind_at(config.step), round(scene.every / config.step)
    outputs, peaks, most, limit = [], [], 0, 0
    options = {"segments": config.segments, "fixed_step": config.fixed_step, "shape_points": SHAPE_POINTS}
    options |= {"end_velocities": end_velocities(scene), **winch(scene)}
    with catch_warnings(**UNWARNED):
        try:
            model = tether_at_start(scene, 0.0, "dynamic", inputs[0], None if wind is None else wind[0], **options)
            limit = config.parts * model.most_factorizations
            for start in range(0, len(inputs), BLOCK * every):
                rows, before = slice(start, start + BLOCK * every), model.counters["iterations"]
                flown = model.fly(inputs[rows], config.step, wind_at=None if wind is None else wind[rows])
                most = max(most, np.diff(flown.of("solver_iterations"), prepend=before).max())
                outputs.append(flown.outputs[every - 1 :: every])
                peaks.append(flown.peak.reshape(-1, every).max(axis=1))
        except StepRefused as refusal:
            return Point(config, {}, 0, limit, (str(refusal),))
    compared = Flown(np.concatenate(outputs), np.concatenate(peaks), None, 0.0)
    return Point(config, errors(scene, compared, reference), int(most), limit, tuple(model.implausible))


def advise_fixed(scene, finer, budget):
    """`Advice` for a scene, met if time is, too: the cheapest sufficient configuration against a finer model, a `Reference`.

    budget : maximum cost of all flights [s].
    """
    names, allowed, most = scene.wanted.outputs, scene.wanted.allowed_error, scene.wanted.time_per_step or inf
    own, left, points = finer.own_error(names), budget, []
    for config in candidates(scene):
        if points and config.cost * scene.duration > left:
            continue
        if any(done.error(names) + own > CLEARLY * allowed and not config.is_finer(done.config) for done in points):
            continue
        points.append(fly(scene, config, finer.run.flown))
        left -= points[-1].config.cost * scene.duration
        if points[-1].error(names) + own <= allowed and points[-1].time <= most:
            break
    in_time = [each for each in points if each.time <= most] or points
    best = min(in_time, key=lambda each: each.error(names))
    found = advice_on(best, points, finer, scene.wanted, names)
    return found._replace(met=found.met and best.time <= most)


def explain_fixed(scene, advice):
    """Lines of text: recommendation, expected error and time, and guarantees."""
    facts = {"own_error": advice.finer.own_error(scene.wanted.outputs), "fmu": fmu_of(scene, advice.point.config)}
    return page("advice/fixed.txt.j2", scene=scene, advice=advice, **facts).rstrip("\n")
