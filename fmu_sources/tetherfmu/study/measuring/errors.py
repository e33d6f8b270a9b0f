"""Errors of a flight against a reference flight of the same scene, and the reference.

See docs/use/quality_of_advice.md, "Errors and cost".

With F of a flight, R of the reference, rms over the output times after `settled`:

    kite_force        rms(|F| - |R|) / rms |R|                     the same for ground_force
    kite_direction    rms(|R| |F/|F| - R/|R||) / rms |R|           the same for ground_direction; 0.01 is about 0.6 deg
    peak_force        |max |F| - max |R|| / max |R|                over all communication points
    power             rms(F . v - R . v) / rms(R . v)              or of ground_tension times reel_out_speed, if larger
    shape             rms distance of points at equal unstretched length / mean unstretched length

The reference is the dynamic tether, refined in space and in time until its own error is small enough. It is the only run
that knows the mean reel-out speed of each step and the wind of its middle (`Scene.inputs`, exact).
"""

import json
import zipfile
from functools import partial
from math import ceil, inf
from typing import NamedTuple

import numpy as np

from tetherfmu.python.results import Flown
from tetherfmu.runtime import layout as at

from .runs import Config, Run, cost, run

SETTLING = 3.0  # wave times after which the start is forgotten ...
LONGEST_SETTLING = 0.25  # ... at most this part of the scene
FIRST_SEGMENTS, MOST_SEGMENTS = 16, 256
LONGEST_STEP, SHORTEST_STEP = 0.004, 0.00025  # communication step [s], about
TOLERANCE = 1e-6
# exceptions on reading a file without a `Reference`
DAMAGED = (KeyError, OSError, TypeError, ValueError, EOFError, zipfile.BadZipFile)
FINER = 10.0  # times that the own error of a reference is smaller than the errors that it judges
size = partial(np.linalg.norm, axis=-1)  # length of vectors along the last axis


def rms(values):
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def settled(scene, wave_time):
    """First output row that counts: after 3 wave times [s] of the reference, at most a quarter of the scene."""
    return min(int(np.ceil(SETTLING * wave_time / scene.every)), int(LONGEST_SETTLING * scene.count))


def power_error(scene, flown, reference, first):
    """Error of the power at the kite or at the winch, the larger one; 0 where there is no power."""
    motion, both = scene.flight.motion(scene.times[1:]), (flown, reference)
    moved = [each.outputs[:, at.OUTPUT_KITE_VELOCITY : at.OUTPUT_KITE_VELOCITY + 3] for each in both]
    velocities = moved if scene.kite_is_free else [motion.kite_velocity] * 2
    at_kite = [np.sum(each.kite_force * v, -1)[first:] for each, v in zip(both, velocities, strict=True)]
    at_winch = [(each.outputs[:, at.GROUND_TENSION] * motion.reel_out_speed)[first:] for each in both]
    return max((rms(mine - right) / rms(right) for mine, right in (at_kite, at_winch) if rms(right) > 0.0), default=0.0)


def errors(scene, flown, reference):
    """Errors [-] of a flight against a reference, both `Flown`; dict by the names of `scene_files.OUTPUTS`."""
    first = settled(scene, reference.outputs[0, at.WAVE_TIME])
    peak, right = flown.peak[first:].max(), reference.peak[first:].max()
    distances, lengths = size(flown.shape - reference.shape)[first:], reference.outputs[first:, at.TETHER_LENGTH]
    found = {
        "peak_force": float(abs(peak - right) / right),
        "power": power_error(scene, flown, reference, first),
        "shape": rms(distances) / float(np.mean(lengths)),
    }
    for end in ("kite", "ground"):
        forces = [getattr(each, f"{end}_force")[first:] for each in (flown, reference)]
        mine, right = map(size, forces)
        turned = np.subtract(*(force / np.maximum(size(force), 1e-12)[:, None] for force in forces))
        found[f"{end}_force"] = rms(mine - right) / rms(right)
        found[f"{end}_direction"] = rms(right * size(turned)) / rms(right)
    return found


def worst(found, names=None):
    """Largest error of some outputs; None: of all."""
    return max(found.values() if names is None else (found[name] for name in names))


class Reference(NamedTuple):
    """A reference run and its properties."""

    config: Config
    run: Run
    space: dict  # change of each output against half of the segments
    time: dict  # change of each output against the double communication step and ten times the tolerance
    spent: float  # cost of all flights, by `runs.cost` [s]

    def own_error(self, names=None):
        """Bound of its own error in some or all outputs: sum of both changes, each of which exceeds the remaining error."""
        return worst(self.space, names) + worst(self.time, names)


def write_reference(path, reference):
    """Write a `Reference` to a file: arrays, and its facts as JSON."""
    config, (flown, *counts), *rest = reference
    with open(path, "wb") as file:
        facts = json.dumps([config, counts, flown.seconds, *rest])
        np.savez_compressed(file, outputs=flown.outputs, peak=flown.peak, time=flown.time, facts=facts)


def read_reference(path):
    """The `Reference` in a file; one of `DAMAGED` otherwise."""
    with np.load(path, allow_pickle=False) as file:
        config, (work, calls, implausible, length), seconds, space, time, spent = json.loads(str(file["facts"]))
        flown = Flown(file["outputs"], file["peak"], None, seconds, (), file["time"])
    return Reference(Config(*config), Run(flown, work, calls, tuple(implausible), length), space, time, spent)


def fine_enough(own, shown):
    """Whether the own error of a reference [-] is at most a tenth of the smallest of the errors that it judges [-]."""
    return FINER * own <= min(shown)


def judging(scene, measure, names, target):
    """`Reference` that is fine enough for the errors that it judges, or the finest allowed; and these errors [-].

    measure : errors against a `Flown`, a sequence.  names : as of `converged`.  target : own error [-] to begin with.
    """
    while True:
        reference = converged(scene, target, names)
        own, found = reference.own_error(names), measure(reference.run.flown)
        if own > target or fine_enough(own, found):
            return reference, found
        target = min(found) / FINER


def even_part(every, longest):
    """Communication step [s] of approximately the longest at most, an even number of which fills the output interval [s]."""
    return every / (2 * ceil(every / (2.0 * longest) - 1e-6))


def converged(scene, target, names, first_segments=FIRST_SEGMENTS, longest_step=LONGEST_STEP, budget=inf):
    """`Reference` of a scene, refined until its `own_error` is at most `target` [-], or until the finest allowed.

    names : outputs that count, of `scene_files.OUTPUTS`.  first_segments, longest_step : to begin with, the step [s] about.
    budget : as of `refined`.
    """

    def fly(config):
        flight = run(scene, config, exact=True)
        return flight, cost(scene, config, flight.calls, flight.work) * scene.count * scene.every

    first = Config("dynamic", first_segments, TOLERANCE, even_part(scene.every, longest_step))
    return refined(fly, partial(errors, scene), first, MOST_SEGMENTS, target, names, budget)


def refined(fly, compare, config, most, target, names, budget=inf):
    """`Reference`, refined from a configuration on until its `own_error` is at most `target` [-].

    fly : returns the `Run` of a configuration, and its cost [s].  compare : errors of a flight against another one, dict
    by output.  most : segments.  names : relevant outputs, None: all.  Each refinement doubles the segments or halves the
    communication step, whichever helps more. It stops before a refinement, at about twice the cost, would exceed the
    budget [s].
    """
    known = {}

    def flown(config):
        if config not in known:
            known[config] = fly(config)
        return known[config][0]

    while True:
        finest, step = flown(config), config.step
        space = compare(flown(config._replace(segments=config.segments // 2)).flown, finest.flown)
        time = compare(flown(config._replace(step=2.0 * step, tolerance=10.0 * TOLERANCE)).flown, finest.flown)
        total = sum(spent for _, spent in known.values())
        found = Reference(config, finest, space, time, total)
        finer = 2 * config.segments <= most, step / 2.0 >= SHORTEST_STEP
        if found.own_error(names) <= target or not any(finer) or total + 3.0 * known[config][1] > budget:
            return found
        if (worst(space, names) >= worst(time, names) and finer[0]) or not finer[1]:
            config = config._replace(segments=2 * config.segments)
        else:
            config = config._replace(step=step / 2.0)
