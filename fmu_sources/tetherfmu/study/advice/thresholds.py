"""Where each tether stops being enough: measured over dimensionless groups, one at a time.

`python -m tetherfmu.study thresholds` writes thresholds.csv, which the advisor reads (`forecast.py`). Sweeps, each against a
converged reference, with so short communication steps that these do not count:

    weight   a kite at rest, no wind; gravity grows, the tension is kept; at three stretches
    drag     a kite circling about the vertical, no gravity; the speed grows, the tension is kept; at three stretches
    slack    a kite at rest, weight only; the tether gets longer than the distance
    wave     figures of eight of one size on a tether with 0.3 % slack; laps get shorter
"""

import csv
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tetherfmu.models import StepRefused
from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.study.measuring.converged import converged
from tetherfmu.study.measuring.errors import errors
from tetherfmu.study.measuring.runs import Config, run
from tetherfmu.study.scenes.files import Scene, Wanted, Wind
from tetherfmu.study.scenes.flights import Circle, FigureOfEight, Parked

from .numbers import line_density, numbers
from .tradeoff import SEGMENTS

TABLE = Path(__file__).with_name("thresholds.csv")
SWEEPS = TABLE.with_name("sweeps.csv")
LEVELS = (0.001, 0.01, 0.1)
STRETCHES = (1e-4, 1e-3, 1e-2)
LOADS = np.geomspace(0.003, 3.0, 13)  # weight or drag over tension
SLACKS = np.geomspace(1e-4, 0.5, 12)
LAPS = np.geomspace(300.0, 9.0, 13)  # [s]
LENGTH, SIZE = 200.0, 300.0  # of the tether; of the way of a lap [m]
ENOUGH = 32  # segments for waves
STEP = 0.01  # communication step [s]
COLUMNS = ("group", "stretch", "variant", "segments", "level", "value")
SWEEP_COLUMNS = ("group", "stretch", "variant", "segments", "value", "error")


class Threshold(NamedTuple):
    """A variant with so many segments is wrong by more than `level` where the number of the group exceeds `value`."""

    group: str
    stretch: float  # of the sweep, T / EA; 0 where it does not count
    variant: str
    segments: int
    level: float
    value: float  # infinite if that is never reached in the sweep


def scene_of(flight, tether, gravity=9.81, wind=(0.0, 0.0, 0.0), duration=8.0):
    """A scene of a sweep."""
    return Scene("sweep", duration, flight, tether, Environment(gravity=float(gravity)), Wind(wind), Wanted())


def taut(distance, load, stretch):
    """Unstretched length [m] whose tension is about stretch times EA under a load over tension: c = L (1 + s - q^2/24)."""
    return distance / (1.0 + stretch - min(load, 1.0) ** 2 / 24.0)


def weight_scene(load, stretch):
    """A kite at rest whose tether weighs `load` times its tension T = s EA: g = q s EA/(mu L)."""
    tether = Tether(initial_length=taut(LENGTH, load, stretch), density=10000.0, drag_coefficient=0.0)
    gravity = load * stretch * tether.axial_stiffness / (line_density(tether) * LENGTH)
    return scene_of(Parked(distance=LENGTH, elevation=np.pi / 6, sway=0.0), tether, gravity, duration=2.0)


def drag_scene(load, stretch):
    """A kite circling 45 deg about the vertical with the drag `load` times T = s EA: 1/6 rho cd d L v^2 = q s EA."""
    tether = Tether(initial_length=taut(LENGTH, load, stretch), density=50.0)
    width = tether.drag_coefficient * tether.diameter
    speed = np.sqrt(6.0 * load * stretch * tether.axial_stiffness / (1.225 * width * LENGTH))
    flight = Circle(distance=LENGTH, half_angle=np.pi / 4, axis_elevation=np.pi / 2, rate=speed / (LENGTH * np.sqrt(0.5)))
    return scene_of(flight, tether, 0.0, duration=4.0)


def slack_scene(slack):
    """A kite at rest, nearer than the tether is long."""
    tether = Tether(initial_length=LENGTH * (1.0 + slack))
    return scene_of(Parked(distance=LENGTH, elevation=np.pi / 6, sway=0.0), tether, duration=2.0)


def wave_scene(lap):
    """Figures of eight on a tether with 0.3 % slack."""
    flight = FigureOfEight(distance=LENGTH, lap=lap, speed=SIZE / lap)
    return scene_of(flight, Tether(initial_length=1.003 * LENGTH), wind=(8.0, 0.0, 0.0), duration=min(60.0, 1.5 * lap))


def sweeps():
    """Rows (group, stretch, scenes)."""
    rows = [("weight", s, [weight_scene(q, s) for q in LOADS]) for s in STRETCHES]
    rows += [("drag", s, [drag_scene(q, s) for q in LOADS]) for s in STRETCHES]
    return [*rows, ("slack", 0.0, [slack_scene(x) for x in SLACKS]), ("wave", 0.0, [wave_scene(lap) for lap in LAPS])]


def configs(group):
    """What is swept: the number of segments does not matter to waves once there are enough."""
    segments = (ENOUGH,) if group == "wave" else SEGMENTS
    lines = [Config("straight", 0, 0.0, STEP)] if group != "wave" else []  # wrong there for its sag alone
    lines.append(Config("catenary", 0, 0.0, STEP))
    kinds = [("quasi_steady", 0.0)] if group != "wave" else [("quasi_steady", 0.0), ("dynamic", 1e-4)]
    return lines + [Config(variant, n, tolerance, STEP) for variant, tolerance in kinds for n in segments]


def points(group, scene):
    """The number of the group of a scene, and the error of the kite's force of each configuration; None if refused."""
    try:
        value = getattr(numbers(scene), group)
        reference = converged(scene, 1e-4, ("kite_force",)).run
    except StepRefused:
        return None
    found = {}
    for config in configs(group):
        try:
            found[config] = errors(scene, run(scene, config, exact=True), reference)["kite_force"]
        except StepRefused:
            found[config] = float("inf")
    return value, found


def crossing(values, found, level):
    """The number from which on an error is above a level, between the points on logarithmic axes; infinite if never."""
    if found[0] > level:
        return values[0]
    for (x, e), (y, f) in pairwise(zip(values, found, strict=True)):
        if f > level:
            part = np.log(level / e) / np.log(f / e) if np.isfinite(f) and e > 0.0 else 0.0
            return float(np.exp(np.log(x) + part * np.log(y / x)))
    return float("inf")


def thresholds(executor, progress):
    """All thresholds, and the points (group, stretch, value, variant, segments, error) that they come from."""
    rows, measured = [], []
    jobs = sweeps()
    futures = [[executor.submit(points, group, scene) for scene in scenes] for group, _, scenes in jobs]
    flat = progress([each for row in futures for each in row], sum(map(len, futures)))
    for future in flat:
        future.result()
    for (group, stretch, _), row in zip(jobs, futures, strict=True):
        done = sorted((each.result() for each in row if each.result()), key=lambda each: each[0])
        values = [value for value, _ in done]
        for config in configs(group):
            found = [max(each[config], 1e-12) for _, each in done]
            measured += [(group, stretch, *config[:2], f"{x:.4g}", e) for x, e in zip(values, found, strict=True)]
            rows += [Threshold(group, stretch, *config[:2], level, crossing(values, found, level)) for level in LEVELS]
    return rows, measured


def write(rows, points, table=TABLE, sweep_table=SWEEPS):
    """Store thresholds, and the points that they come from."""
    for path, head, lines in ((table, COLUMNS, rows), (sweep_table, SWEEP_COLUMNS, points)):
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(head)
            writer.writerows([*line[:-1], f"{line[-1]:.4g}"] for line in lines)
    read.cache_clear()


@cache
def read(table=TABLE):
    """Thresholds as they were stored, a list."""
    kinds = Threshold.__annotations__
    with open(table, newline="", encoding="utf-8") as file:
        return [Threshold(**{name: kinds[name](row[name]) for name in COLUMNS}) for row in csv.DictReader(file)]
