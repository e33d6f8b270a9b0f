"""Measure where each tether ceases to be adequate: thresholds.csv of the package, and sweeps.csv.

Sweeps of one of the numbers of `study.advice.reasons` each, against a converged reference, with so short communication
steps that these do not count:

    weight   a kite at rest, no wind; gravity grows, the tension is kept; at three stretches
    drag     a kite circling about the vertical, no gravity; the speed grows, the tension is kept; at three stretches
    slack    a kite at rest, weight only; the tether gets longer than the distance
    wave     figures of eight of one size on a tether with 0.3 % slack; laps get shorter
"""

from itertools import chain
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.files.flights import Circle, FigureOfEight, Parked
from tetherfmu.files.scene_files import Scene, Wind
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.study.advice.configurations import SEGMENTS, measure
from tetherfmu.study.advice.reasons import LEVELS, TABLE, numbers
from tetherfmu.study.measuring import runs
from tetherfmu.study.measuring.errors import FINER, converged, fine_enough
from tetherfmu.study.measuring.executors import progress_bar

NAMES = ("kite_force",)
SWEEPS = Path(__file__).with_name("sweeps.csv")
STRETCHES = (1e-4, 1e-3, 1e-2)
LOADS = np.geomspace(0.003, 3.0, 13)  # weight or drag over tension
SLACKS = np.geomspace(1e-4, 0.5, 12)
LAPS = np.geomspace(300.0, 9.0, 13)  # [s]
LENGTH, SIZE = 200.0, 300.0  # of the tether; of the way of a lap [m]
AT_REST = Parked(distance=LENGTH, elevation=np.pi / 6, sway=0.0)
ENOUGH = 32  # segments for waves
STEP = 0.01  # communication step [s]
CURVE = ["group", "stretch", "variant", "segments"]  # what a curve of errors over the number of its group belongs to


def taut(distance, load, stretch):
    """Unstretched length [m] whose tension is about stretch times EA under a load over tension: c = L (1 + s - q^2/24)."""
    return distance / (1.0 + stretch - min(load, 1.0) ** 2 / 24.0)


def weight_scene(load, stretch):
    """A kite at rest whose tether weighs `load` times its tension T = s EA: g = q s EA/(mu L)."""
    tether = Tether(initial_length=taut(LENGTH, load, stretch), density=10000.0, drag_coefficient=0.0)
    gravity = load * stretch * tether.axial_stiffness / (tether.mass_per_length * LENGTH)
    return Scene("sweep", 2.0, AT_REST, tether, Environment(gravity=float(gravity)))


def drag_scene(load, stretch):
    """A kite circling 45 deg about the vertical with the drag `load` times T = s EA: 1/6 rho cd d L v^2 = q s EA."""
    tether, air = Tether(initial_length=taut(LENGTH, load, stretch), density=50.0), Environment(gravity=0.0)
    width = tether.drag_coefficient * tether.diameter
    speed = np.sqrt(6.0 * load * stretch * tether.axial_stiffness / (air.air_density * width * LENGTH))
    flight = Circle(distance=LENGTH, half_angle=np.pi / 4, axis_elevation=np.pi / 2, rate=speed / (LENGTH * np.sqrt(0.5)))
    return Scene("sweep", 4.0, flight, tether, air)


def slack_scene(slack):
    """A kite at rest, nearer than the tether is long."""
    return Scene("sweep", 2.0, AT_REST, Tether(initial_length=LENGTH * (1.0 + slack)))


def wave_scene(lap):
    """Figures of eight on a tether with 0.3 % slack."""
    flight = FigureOfEight(distance=LENGTH, lap=lap, speed=SIZE / lap)
    return Scene("sweep", min(60.0, 1.5 * lap), flight, Tether(initial_length=1.003 * LENGTH), wind=Wind((8.0, 0.0, 0.0)))


def sweeps():
    """Triples (group, stretch, scene); the stretch is 0 where it does not count."""
    return [
        *(("weight", s, weight_scene(q, s)) for s in STRETCHES for q in LOADS),
        *(("drag", s, drag_scene(q, s)) for s in STRETCHES for q in LOADS),
        *(("slack", 0.0, slack_scene(x)) for x in SLACKS),
        *(("wave", 0.0, wave_scene(lap)) for lap in LAPS),
    ]


def configs(group):
    """What is swept: the number of segments does not matter to waves once there are enough."""
    if group == "wave":  # the straight line is wrong there for its sag alone
        lines = [("catenary", 0, 0.0), ("quasi_steady", ENOUGH, 0.0), ("dynamic", ENOUGH, 1e-4)]
    else:
        lines = [("straight", 0, 0.0), ("catenary", 0, 0.0), *(("quasi_steady", n, 0.0) for n in SEGMENTS)]
    return [runs.Config(*line, STEP) for line in lines]


def points(group, stretch, scene):
    """Rows (`CURVE`, value, error) of the configurations in a scene; none if its reference was refused.

    The number of the group, and the error of the force on the kite, infinite if the tether was refused.
    """
    try:
        value = getattr(numbers(scene), group)
        reference = converged(scene, LEVELS[0] / FINER, NAMES)
    except StepRefused:
        return []
    if not fine_enough(reference.own_error(NAMES), LEVELS):
        raise SystemExit(f"{group} {value:.2g}: the reference is not ten times finer than {LEVELS[0]:g}")
    measured = [measure(scene, config, reference.run.flown, exact=True) for config in configs(group)]
    return [(group, stretch, *each.config[:2], value, max(each.error(NAMES), 1e-12)) for each in measured]


def crossing(values, found, level):
    """The number from which on an error is above a level, between the points on logarithmic axes; infinite if never."""
    above = np.flatnonzero(np.greater(found, level))
    if not len(above):
        return float("inf")
    last, first = max(0, above[0] - 1), above[0]  # below and above the level
    if last == first or np.isinf(found[first]):
        return values[last]
    return float(np.exp(np.interp(np.log(level), np.log(found[last : first + 1]), np.log(values[last : first + 1]))))


def thresholds(executor):
    """All thresholds, and the points that they come from, as `write` stores them: two DataFrames.

    Columns: `CURVE`, level, value, where the error exceeds `level` from the number `value` of the group on, infinite if it
    never does in the sweep; and `CURVE`, value, error, the points of each curve.
    """
    jobs = sweeps()
    found = executor.map(points, *zip(*jobs, strict=True))
    rows = chain.from_iterable(progress_bar(found, len(jobs), "thresholds"))
    measured = pd.DataFrame(rows, columns=[*CURVE, "value", "error"])
    curves = [(key, curve.sort_values("value", kind="stable")) for key, curve in measured.groupby(CURVE, sort=False)]
    crossings = [(*key, level, crossing([*curve.value], [*curve.error], level)) for key, curve in curves for level in LEVELS]
    return pd.DataFrame(crossings, columns=[*CURVE, "level", "value"]), pd.concat([curve for _, curve in curves])


def write(found, measured, table=TABLE, sweep_table=SWEEPS):
    """Store thresholds, and the points that they come from."""
    for path, frame in ((table, found), (sweep_table, measured)):
        rounded = {name: frame[name].map("{:.4g}".format) for name in ("value", "error") if name in frame}
        frame.assign(**rounded).to_csv(path, index=False, lineterminator="\r\n")
