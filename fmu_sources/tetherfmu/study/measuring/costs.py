"""What a run costs: counted work times measured unit costs, so that it does not depend on the load of the machine.

    cost = calls (a + b n) + work (c + d n),   n segments

calls: communication steps, each with its outputs. work: internal steps of the dynamic tether, Newton iterations of the
others.
a, b, c, d are fitted to times measured on one machine and stored in costs.csv: `python -m tetherfmu.study costs`.
"""

import csv
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from tetherfmu.export.archive import build
from tetherfmu.models import StepRefused
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.study.scenes.random_scenes import random_scenes

from .runs import VARIANTS, Config, run
from .through_fmpy import measured

TABLE = Path(__file__).with_name("costs.csv")
HOST = "host"  # row of what FMPy adds to each communication step: set 6, step, get 6
COLUMNS = ("variant", "per call", "per call and segment", "per work", "per work and segment")
SEGMENTS, STEPS, REPEATS = (2, 8, 20, 40), (0.1, 0.02, 0.005), 9
SCENES, HOST_STEPS = 4, 3000


def regressors(config, calls, work):
    """What the four unit costs are multiplied with."""
    return np.array([calls, calls * config.segments, work, work * config.segments], float)


@cache
def units(table=TABLE):
    """Unit costs [s] by variant, arrays of four; and those of the host."""
    with open(table, newline="", encoding="utf-8") as file:
        return {row["variant"]: np.array([float(row[name]) for name in COLUMNS[1:]]) for row in csv.DictReader(file)}


def cost(scene, config, calls, work):
    """Kernel time per simulated second [-], of the machine of costs.csv."""
    return float(units()[config.variant] @ regressors(config, calls, work)) / (scene.count * scene.every)


def host_cost(step):
    """What FMPy adds per simulated second [-] at a communication step [s]."""
    return float(units()[HOST][0]) / step


def fitted(scenes, variant):
    """Unit costs [s] of a variant, fitted to the fastest of a few runs of some scenes."""
    rows, times = [], []
    for scene in scenes:
        for n in SEGMENTS if variant in ("quasi_steady", "dynamic") else (0,):
            for step in STEPS:
                config = Config(variant, n, 1e-4 if variant == "dynamic" else 0.0, step)
                try:
                    runs = [run(scene, config) for _ in range(REPEATS)]
                except StepRefused:
                    continue
                rows.append(regressors(config, runs[0].calls, runs[0].steps))
                times.append(min(each.seconds for each in runs))
    weights = 1.0 / np.array(times)  # relative errors count
    return nnls(np.array(rows) * weights[:, None], np.ones(len(rows)))[0]


def measure_costs(table=TABLE):
    """Measure all unit costs in random scenes and store them."""
    scenes = random_scenes(SCENES)
    with open(table, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for variant in VARIANTS:
            writer.writerow([variant, *(f"{each:.3g}" for each in fitted(scenes, variant))])
        writer.writerow([HOST, f"{host_seconds():.3g}", 0, 0, 0])
    units.cache_clear()


def host_seconds():
    """What FMPy adds to a communication step [s]: time of a straight tether's FMU, whose kernel costs next to nothing."""
    with tempfile.TemporaryDirectory() as folder:
        path = build("TetherStraight", folder, platforms=(this_platform(),))
        return sum(measured("costs", path, HOST_STEPS, REPEATS))
