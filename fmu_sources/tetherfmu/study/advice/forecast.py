"""The error of a configuration in a scene, forecast from its dimensionless numbers and the measured thresholds.

    error = sum over the groups of the error that its number had in the sweep + error of the communication step

Between the measured levels the error grows as a power of the number; below the lowest as its square.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from tetherfmu.study.measuring.costs import cost
from tetherfmu.study.measuring.errors import Reference
from tetherfmu.study.measuring.runs import Config

from .numbers import lead_error, numbers
from .thresholds import LEVELS, read
from .tradeoff import Measured, ladder

# thresholds: a row for each group, variant, number of segments and stretch, a column for each level
CURVES = read().set_index(["group", "variant", "segments", "stretch", "level"]).value.unstack()
GROUPS = ("weight", "drag", "slack", "wave")
MARGIN = 0.5  # part of the allowed error that a forecast may use up
LARGEST = 1e3  # stands for a threshold that the sweep did not reach ...
BEYOND = 10.0  # ... as does every larger one than this
STEEPEST = 3.0  # exponent with which a forecast goes on beyond the last threshold


class Advice(NamedTuple):
    """What to use. The fast advice gives the errors that it forecasts by group, the other what it measured."""

    config: Config
    expected: float  # error: forecast, or measured against the finer model plus the finer model's own
    met: bool  # whether that is allowed
    forecast: dict | None = None  # see `forecast`
    point: Measured | None = None  # errors against the finer model
    finer: Reference | None = None
    tried: int = 0  # configurations that were flown


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


def forecast(config, found, step_errors):
    """Errors [-] expected of a configuration, by group; "step": that of its communication step, by `numbers.lead_error`."""
    return {**{group: group_error(group, config, found) for group in GROUPS}, "step": step_errors[config.step]}


def fast_advice(scene):
    """`Advice`: the cheapest configuration whose forecast stays within half of the allowed error."""
    found, allowed = numbers(scene), scene.wanted.allowed_error
    tolerance = 1e-3 if allowed >= 0.03 else 1e-4
    configs = [config for config in ladder(scene) if config.tolerance in (0.0, tolerance)]
    step_errors = {step: lead_error(scene, step, found) for step in {config.step for config in configs}}
    forecasts = {config: forecast(config, found, step_errors) for config in configs}
    expected = {config: sum(errors.values()) for config, errors in forecasts.items()}
    good = [config for config in configs if expected[config] <= MARGIN * allowed]
    config = min(good, key=lambda each: least_cost(scene, each)) if good else min(configs, key=expected.get)
    return Advice(config, expected[config], bool(good), forecasts[config])


def least_cost(scene, config):
    """What a configuration costs at least: one internal step or iteration in each communication step."""
    calls = round(scene.count * scene.every / config.step)
    return cost(scene, config, calls, 0 if config.variant == "straight" else calls)
