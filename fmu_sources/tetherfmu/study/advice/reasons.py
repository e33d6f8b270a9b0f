"""Why not a simpler tether: the error that a dimensionless number of a scene stands for, by the measured thresholds.

Between the measured levels the error grows as a power of the number; below the lowest as its square.
"""

from functools import cache

import numpy as np

from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.measuring.runs import Config

from .thresholds import LEVELS, read
from .tradeoff import SEGMENTS

# thresholds: a row for each group, variant, number of segments and stretch, a column for each level
CURVES = read().set_index(["group", "variant", "segments", "stretch", "level"]).value.unstack()
GROUPS = ("weight", "drag", "slack", "wave")
LARGEST = 1e3  # stands for a threshold that the sweep did not reach ...
BEYOND = 10.0  # ... as does every larger one than this
STEEPEST = 3.0  # exponent with which the error goes on beyond the last threshold


@cache
def thresholds_at(group, variant, segments, stretch):
    """Numbers of a group at which a tether is wrong by `thresholds.LEVELS`, at a stretch [-]; infinite: it never is."""
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
    """Error [-] that one number of a scene stands for."""
    x = getattr(found, group)
    values = np.minimum(thresholds_at(group, config.variant, config.segments, found.stretch), LARGEST)
    if x <= values[0]:
        return LEVELS[0] * (x / values[0]) ** 2
    if x < values[-1]:
        return float(np.exp(np.interp(np.log(x), np.log(values), np.log(LEVELS))))
    return float(min(LEVELS[-1] * (x / values[-1]) ** STEEPEST, 1.0 / LEVELS[0]))


def limit(group, config, found, level):
    """Number of a group at which a configuration is wrong by a level [-]; infinite if it never is."""
    values = thresholds_at(group, config.variant, config.segments, found.stretch)
    known, levels = values < BEYOND, np.log(LEVELS)
    if not known.any() or (np.log(level) > levels[known][-1] + 1e-9 and not known.all()):
        return float("inf")
    return float(np.exp(np.interp(np.log(level), levels[known], np.log(values[known]))))


def reasons(config, found, level):
    """Why not a simpler tether, with as many segments: triples of variant, number that hurts it most, its limit."""
    for variant in VARIANTS[: VARIANTS.index(config.variant)]:
        segments = (config.segments or SEGMENTS[-1]) if variant == "quasi_steady" else 0
        simpler = Config(variant, segments, 0.0, config.step)
        errors = {group: group_error(group, simpler, found) for group in GROUPS}
        group = max(errors, key=errors.get)
        yield variant, group, limit(group, simpler, found, level)
