"""Dimensionless numbers of a scene, which show why a simpler tether is insufficient.

    weight    mu g L / T
    drag      |ground_force + kite_force - weight| / T
    stretch   T / EA
    slack     L / c - 1, unstretched length over distance of the ends; 0 if taut
    wave      wave_time rms|dF/dt| / rms|F|:  travel time of a wave times the rate at which the force on the kite changes

T: tension at the kite, root mean square over the scene; the others are means. All from a coarse quasi-steady flight,
or for a free end from the finer model, where the load includes the inertia of the tether.

thresholds.csv lists the numbers at which a tether ceases to be adequate, measured by `docs/make/make_thresholds.py`.
Between the measured levels the error grows as a power of the number of a group, below the lowest as its square.
"""

from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd

from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring import runs
from tetherfmu.study.measuring.errors import rms, size

from .configurations import SEGMENTS

TABLE = Path(__file__).with_name("thresholds.csv")
LEVELS = (0.001, 0.01, 0.1)  # errors that the thresholds are for
COARSE = 8  # segments of the flight that the numbers come from
GROUPS = ("weight", "drag", "slack", "wave")
LARGEST = 1e3  # replaces a threshold that the sweep did not reach ...
BEYOND = 10.0  # ... as does every larger one than this
STEEPEST = 3.0  # exponent of the error beyond the last threshold
# thresholds: a row for each group, variant, number of segments and stretch, a column for each level
CURVES = pd.read_csv(TABLE).set_index(["group", "variant", "segments", "stretch", "level"]).value.unstack()


def numbers(scene, flown=None):
    """All numbers of a scene, as attributes; StepRefused if a coarse quasi-steady tether refuses it.

    flown : `Flown` as their source, required for a free end, which no quasi-steady tether can have.
    """
    if flown is None:
        flown = runs.run(scene, runs.Config("quasi_steady", COARSE, 0.0, scene.every), exact=True).flown
    motion = scene.flight.motion(scene.times[1:])
    tether, force = scene.tether, flown.kite_force
    tension, length = rms(flown.outputs[:, at.KITE_TENSION]), flown.outputs[:, at.TETHER_LENGTH]
    weight = tether.mass_per_length * scene.environment.gravity * length
    load = force + flown.ground_force + np.multiply.outer(weight, [0.0, 0.0, 1.0])
    rate = rms(size(np.diff(force, axis=0))) / scene.every / rms(size(force))
    kite = flown.outputs[:, at.OUTPUT_KITE_POSITION : at.OUTPUT_KITE_POSITION + 3] if scene.kite_is_free else motion.kite
    slack = length / size(kite - motion.ground) - 1.0
    return SimpleNamespace(
        weight=float(np.mean(weight)) / tension,
        drag=float(np.mean(size(load))) / tension,
        stretch=tension / tether.axial_stiffness,
        slack=max(0.0, float(np.mean(slack))),
        wave=float(np.mean(flown.outputs[:, at.WAVE_TIME])) * rate,
    )


@cache
def thresholds_at(group, variant, segments, stretch):
    """Numbers of a group at which the error of a tether reaches `LEVELS`, at a stretch [-]; infinite: never."""
    if group == "wave":
        variant = "catenary" if variant == "straight" else variant
        segments = CURVES.loc[group, variant].index[-1][0]
    elif variant == "dynamic":  # in equilibrium it is the same chain
        variant = "quasi_steady"
    table = CURVES.loc[group, variant, segments]
    if len(table) == 1:
        return table.to_numpy()[0]
    place = np.log(np.clip(stretch, table.index[0], table.index[-1]))
    return np.exp([np.interp(place, np.log(table.index), np.log(column.clip(upper=LARGEST))) for _, column in table.items()])


def group_error(group, config, found):
    """Error [-] for one number of a scene."""
    x = getattr(found, group)
    values = np.minimum(thresholds_at(group, config.variant, config.segments, found.stretch), LARGEST)
    if x <= values[0]:
        return LEVELS[0] * (x / values[0]) ** 2
    if x < values[-1]:
        return float(np.exp(np.interp(np.log(x), np.log(values), np.log(LEVELS))))
    return float(min(LEVELS[-1] * (x / values[-1]) ** STEEPEST, 1.0 / LEVELS[0]))


def limit(group, config, found, level):
    """Number of a group at which the error of a configuration reaches a level [-]; infinite if never."""
    values = thresholds_at(group, config.variant, config.segments, found.stretch)
    known, levels = values < BEYOND, np.log(LEVELS)
    if not known.any() or (np.log(level) > levels[known][-1] + 1e-9 and not known.all()):
        return float("inf")
    return float(np.exp(np.interp(np.log(level), levels[known], np.log(values[known]))))


def reasons(config, found, level):
    """Why not a simpler tether, with as many segments: triples of variant, number that hurts it most, its limit."""
    for variant in runs.ADVISED[: runs.ADVISED.index(config.variant)]:
        segments = (config.segments or SEGMENTS[-1]) if variant == "quasi_steady" else 0
        simpler = runs.Config(variant, segments, 0.0, config.step)
        errors = {group: group_error(group, simpler, found) for group in GROUPS}
        group = max(errors, key=errors.get)
        yield variant, group, limit(group, simpler, found, level)
