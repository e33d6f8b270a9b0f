"""What a run costs: counted work times measured unit costs, so that it does not depend on the load of the machine.

    cost = calls (a + b n) + work (c + d n),   n segments

calls: communication steps, each with its outputs. work: internal steps of the dynamic tether, Newton iterations of others.
a, b, c, d are fitted to times measured on one machine and stored in costs.csv, see `unit_costs`.
"""

from pathlib import Path

import numpy as np
import pandas as pd

TABLE = Path(__file__).with_name("costs.csv")
UNITS = pd.read_csv(TABLE, index_col="variant")  # unit costs [s]: a row of `COLUMNS` for each variant and one for the host
HOST = "host"  # row of what FMPy adds to each communication step: set 6, step, get 6
HOST_COST = float(UNITS.at[HOST, "per call"])  # [s]
COLUMNS = ("per call", "per call and segment", "per work", "per work and segment")


def regressors(config, calls, work):
    """What the four unit costs are multiplied with."""
    return np.array([calls, calls * config.segments, work, work * config.segments], float)


def cost(scene, config, calls, work):
    """Kernel time per simulated second [-], of the machine of costs.csv."""
    return float(UNITS.loc[config.variant].to_numpy() @ regressors(config, calls, work)) / (scene.count * scene.every)


def least_cost(scene, config):
    """What a configuration costs at least: one internal step or iteration in each communication step."""
    calls = round(scene.count * scene.every / config.step)
    return cost(scene, config, calls, 0 if config.variant == "straight" else calls)
