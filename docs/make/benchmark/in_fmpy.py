"""Time of the FMUs in FMPy: flights of the circle, each in a process of its own."""

import numpy as np
import pandas as pd

from tetherfmu.study.measuring.runs import Config

from .hosted import hosted
from .scenes import STEP, circle_scene


def measured(path, steps, repeats):
    """Medians over so many flights of the circle: times [s] of the start, of setting, stepping and getting."""
    flights = hosted(path, circle_scene(20), Config("dynamic", 20, 0.0, STEP), steps, repeats)
    return np.median([(start, *np.median(costs, axis=0)) for start, costs, _ in flights], axis=0).tolist()


def host_table(paths, quick):
    """Cost of the FMUs in FMPy, and their start-up time: the least of all rounds, in which they take turns."""
    steps, rounds = (100, 1) if quick else (3000, 5)
    found = [{name: measured(path, steps, 1) for name, path in paths.items()} for _ in range(rounds)]
    rows = []
    for name in paths:
        start, *costs = np.min([each[name] for each in found], axis=0)
        rows.append((name, *(1e6 * cost for cost in costs), 1e6 * sum(costs), 1e3 * start))
    return pd.DataFrame(rows, columns=("FMU", "set us", "step us", "get us", "together us", "start ms"))
