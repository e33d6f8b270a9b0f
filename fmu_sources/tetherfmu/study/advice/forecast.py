"""The error of a configuration in a scene, forecast from its dimensionless numbers and the measured thresholds.

    error = sum over the groups of the error that its number had in the sweep + error of the communication step

Between the measured levels the error grows as a power of the number; below the lowest as its square.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from tetherfmu.study.measuring.costs import cost
from tetherfmu.study.measuring.runs import Config

from .numbers import Numbers, lead_error, numbers
from .thresholds import LEVELS, read
from .tradeoff import ladder

GROUPS = ("weight", "drag", "slack", "wave")
MARGIN = 0.5  # part of the allowed error that a forecast may use up
LARGEST = 1e3  # stands for a threshold that the sweep did not reach ...
BEYOND = 10.0  # ... as does every larger one than this
STEEPEST = 3.0  # exponent with which a forecast goes on beyond the last threshold


class Forecast(NamedTuple):
    """A configuration, and the errors that are expected of it, by group; "step" is that of the communication step."""

    config: Config
    errors: dict

    @property
    def error(self):
        """Expected error of the force on the kite [-]."""
        return sum(self.errors.values())


@cache
def curves():
    """Thresholds of each (group, variant, segments): DataFrames with a row for each stretch and a column for each level."""
    tables = read().groupby(["group", "variant", "segments"])
    return {key: table.pivot(index="stretch", columns="level", values="value") for key, table in tables}


def thresholds_at(group, variant, segments, stretch):
    """Numbers of a group at which a tether is wrong by `thresholds.LEVELS`, at a stretch [-]; None: it never is."""
    if group == "wave":
        variant = "catenary" if variant == "straight" else variant
        segments = max((n for g, v, n in curves() if (g, v) == (group, variant)), default=0)
    elif variant == "dynamic":  # in equilibrium it is the same chain
        variant = "quasi_steady"
    table = curves()[group, variant, segments]
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
    below = int(np.searchsorted(values, x, side="right")) - 1
    if below + 1 < len(values):
        part = np.log(x / values[below]) / np.log(values[below + 1] / values[below])
        return float(LEVELS[below] * (LEVELS[below + 1] / LEVELS[below]) ** part)
    return float(min(LEVELS[-1] * (x / values[-1]) ** STEEPEST, 1.0 / LEVELS[0]))


def limit(group, config, found, level):
    """Number of a group at which a configuration is wrong by a level [-]; infinite if it never is."""
    values = thresholds_at(group, config.variant, config.segments, found.stretch)
    finite = [(np.log(each), np.log(v)) for each, v in zip(LEVELS, values, strict=True) if v < BEYOND]
    if not finite:
        return float("inf")
    levels, logs = zip(*finite, strict=True)
    if np.log(level) > levels[-1] + 1e-9 and len(finite) < len(LEVELS):
        return float("inf")
    return float(np.exp(np.interp(np.log(level), levels, logs)))


def forecast(scene, config, found, step_errors):
    """`Forecast` of a configuration; `step_errors` maps communication steps to `numbers.lead_error`."""
    groups = {group: group_error(group, config, found) for group in GROUPS}
    return Forecast(config, {**groups, "step": step_errors[config.step]})


class Fast(NamedTuple):
    """Advice from numbers alone."""

    forecast: Forecast
    numbers: Numbers
    met: bool


def fast_advice(scene):
    """The cheapest configuration whose forecast stays within half of the allowed error; `Fast`."""
    found = numbers(scene)
    allowed = scene.wanted.allowed_error
    tolerance = 1e-3 if allowed >= 0.03 else 1e-4
    configs = [config for config in ladder(scene) if config.tolerance in (0.0, tolerance)]
    step_errors = {step: lead_error(scene, step, found) for step in {config.step for config in configs}}
    forecasts = [forecast(scene, config, found, step_errors) for config in configs]
    good = [each for each in forecasts if each.error <= MARGIN * allowed]
    if not good:
        return Fast(min(forecasts, key=lambda each: each.error), found, False)
    return Fast(min(good, key=lambda each: least_cost(scene, each.config)), found, True)


def least_cost(scene, config):
    """What a configuration costs at least: one internal step or iteration in each communication step."""
    calls = round(scene.count * scene.every / config.step)
    return cost(scene, config, calls, 0 if config.variant == "straight" else calls)
