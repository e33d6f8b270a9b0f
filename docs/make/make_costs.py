"""Measure the unit costs that the advisor reads (costs.csv), on an idle machine; `python docs/make/make_costs.py`."""

import sys
import tempfile
from itertools import product
from warnings import catch_warnings

import numpy as np
import pandas as pd
from scipy.optimize import nnls

from advice.random_scenes import random_scenes
from benchmark.in_fmpy import measured
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.console.progress import now
from tetherfmu.export.archive import build
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE
from tetherfmu.runtime.variants import BY_NAME, VARIANTS
from tetherfmu.study.measuring import runs
from tetherfmu.study.measuring.runs import COLUMNS, FIXED, HOST, TABLE, regressors
from tetherfmu.study.measuring.start import tether_at_start

SEGMENTS, STEPS, REPEATS = (2, 8, 20, 40), (0.1, 0.02, 0.005), 9
SCENES, HOST_STEPS = 4, 3000


def fitted(scenes, variant):
    """Unit costs [s] of a variant, fitted to the fastest of a few runs of some scenes."""
    rows = []
    segments = SEGMENTS if BY_NAME[variant].has_nodes else (0,)
    for scene, n, step in product(scenes, segments, STEPS):
        config = runs.Config(variant, n, DEFAULT_TOLERANCE if BY_NAME[variant].has_waves else 0.0, step)
        try:
            flights = [runs.run(scene, config) for _ in range(REPEATS)]
        except StepRefused:
            continue
        seconds = min(each.flown.seconds for each in flights)
        rows.append(regressors(config, flights[0].calls, flights[0].work) / seconds)  # relative errors count
    return nnls(np.array(rows), np.ones(len(rows)))[0]


def fitted_to_fixed_steps(scenes):
    """The same of fixed steps of order 2: one, or four, in each communication step."""
    rows = []
    for scene, n, step, parts in product(scenes, SEGMENTS, STEPS[1:], (1, 4)):
        inputs = scene.inputs(step)
        options = {"segments": n, "fixed_step": step / parts, "shape_points": runs.SHAPE_POINTS}
        with catch_warnings(**runs.UNWARNED):
            flights = []
            for _ in range(REPEATS):
                model = tether_at_start(scene, 0.0, "dynamic", inputs[0], **options)
                before = model.counters["iterations"]
                flown = model.fly(inputs, step, every=round(scene.every / step))
                flights.append((flown.seconds, model.counters["iterations"] - before))
        seconds, work = min(flights)
        rows.append(regressors(runs.Config("dynamic", n, 0.0, step), len(inputs), work) / seconds)
    return nnls(np.array(rows), np.ones(len(rows)))[0]


@command
def main(arguments=None):
    """Measure all unit costs in random scenes, store and print them; returns the exit status.

    What FMPy adds to a communication step is the time of a straight tether's FMU, whose kernel costs next to nothing.
    """
    Parser(prog="make_costs.py", description="measure the unit costs that the advisor reads").parse_args(arguments)
    now("measuring the unit costs")
    scenes = random_scenes(SCENES)
    rows = {variant: fitted(scenes, variant) for variant in VARIANTS}
    rows[FIXED] = fitted_to_fixed_steps(scenes)
    with tempfile.TemporaryDirectory() as folder:
        path = build("TetherStraight", folder)
        rows[HOST] = [sum(measured(path, HOST_STEPS, REPEATS)[1:]), 0.0, 0.0, 0.0]
    found = pd.DataFrame.from_dict(rows, orient="index", columns=COLUMNS).rename_axis("variant")
    found.map("{:.3g}".format).to_csv(TABLE, lineterminator="\r\n")
    print(TABLE.read_text(encoding="utf-8"), end="")


if __name__ == "__main__":
    sys.exit(main())
