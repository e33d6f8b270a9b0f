"""What a run costs: counted work times measured unit costs, so that it does not depend on the load of the machine.

    cost = calls (a + b n) + work (c + d n),   n segments

calls: communication steps, each with its outputs. work: internal steps of the dynamic tether, Newton iterations of others.
a, b, c, d are fitted to times measured on one machine and stored in costs.csv: `python -m tetherfmu.study costs`.
"""

import tempfile
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import nnls

from tetherfmu.export.archive import build
from tetherfmu.results import StepRefused
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.scenes.random_scenes import random_scenes

from .runs import Config, run
from .through_fmpy import measured

TABLE = Path(__file__).with_name("costs.csv")
UNITS = pd.read_csv(TABLE, index_col="variant")  # unit costs [s]: a row of `COLUMNS` for each variant and one for the host
HOST = "host"  # row of what FMPy adds to each communication step: set 6, step, get 6
COLUMNS = ("per call", "per call and segment", "per work", "per work and segment")
SEGMENTS, STEPS, REPEATS = (2, 8, 20, 40), (0.1, 0.02, 0.005), 9
SCENES, HOST_STEPS = 4, 3000


def regressors(config, calls, work):
    """What the four unit costs are multiplied with."""
    return np.array([calls, calls * config.segments, work, work * config.segments], float)


def cost(scene, config, calls, work):
    """Kernel time per simulated second [-], of the machine of costs.csv."""
    return float(UNITS.loc[config.variant].to_numpy() @ regressors(config, calls, work)) / (scene.count * scene.every)


def host_cost(step):
    """What FMPy adds per simulated second [-] at a communication step [s]."""
    return float(UNITS.at[HOST, "per call"]) / step


def fitted(scenes, variant):
    """Unit costs [s] of a variant, fitted to the fastest of a few runs of some scenes."""
    rows = []
    segments = SEGMENTS if variant in ("quasi_steady", "dynamic") else (0,)
    for scene, n, step in product(scenes, segments, STEPS):
        config = Config(variant, n, 1e-4 if variant == "dynamic" else 0.0, step)
        try:
            runs = [run(scene, config) for _ in range(REPEATS)]
        except StepRefused:
            continue
        seconds = min(each.flown.seconds for each in runs)
        rows.append(regressors(config, runs[0].calls, runs[0].work) / seconds)  # relative errors count
    return nnls(np.array(rows), np.ones(len(rows)))[0]


def measure_costs():
    """Measure all unit costs in random scenes, store and print them.

    What FMPy adds to a communication step is the time of a straight tether's FMU, whose kernel costs next to nothing.
    """
    scenes = random_scenes(SCENES)
    rows = {variant: fitted(scenes, variant) for variant in VARIANTS}
    with tempfile.TemporaryDirectory() as folder:
        path = build("TetherStraight", folder)
        rows[HOST] = [sum(measured(path, HOST_STEPS, REPEATS)[1:]), 0.0, 0.0, 0.0]
    found = pd.DataFrame.from_dict(rows, orient="index", columns=COLUMNS).rename_axis("variant")
    found.map("{:.3g}".format).to_csv(TABLE, lineterminator="\r\n")
    print(TABLE.read_text(encoding="utf-8"), end="")
