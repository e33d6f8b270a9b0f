"""Clock offsets between the recorders of a log: delays between its columns, from correlation.

For two signals that should be proportional, on an equidistant grid and averaged over `SMOOTHED`, the delay is
at the largest correlation within +-`RANGE`, refined by a parabola. Its interval follows from the jackknife over
`PARTS` of the log. Signals of a flight are almost periodic: among several peaks of almost equal height the nearest counts.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from .readings import POSITION, VELOCITY, WIND, between

RANGE = 10.0  # s, largest delay
STEP, SMOOTHED = 0.1, 1.0  # s, minimum grid spacing; averaging time of signals
LEAST, OF_VECTORS = 0.6, 0.95  # minimum correlation of related signals; of all axes together
AS_HIGH = 0.03  # permitted deficit of a nearer peak
PARTS, QUANTILE = 10, 2.26  # of the jackknife, and of Student's distribution with one degree less, 95 %
SHORTEST = 20.0  # s of a log
ROUNDING = 1e-12  # of the squares of a signal that does not vary
CLEAR, CLEAR_OF_SPEED = 0.2, 2.0  # s, doubtful delay; the second one if the speed is not the airspeed


class Signal(NamedTuple):
    """Comparable signal of a column: its name, and values on the grid, array (times, components); NaN: unknown."""

    column: str
    values: np.ndarray
    what: str


class Delay(NamedTuple):
    """By how much [s] a column is later in the log than another, half of its interval [s], correlations with it, without."""

    late: Signal
    early: Signal
    seconds: float
    half: float
    correlation: float
    before: float
    clear: float

    @property
    def is_clear(self):
        """Whether it is large enough to matter, and its interval does not have 0."""
        return self.seconds >= max(self.clear, self.half)


def found(log, position):
    """`Delay` of all pairs of columns that can be compared; position : seen from the outlet, array (rows, 3)."""
    pairs = ((one, other, clear) for one, other, clear in pairs_of(log, position) if one and other)
    return list(filter(None, (delay_between(log, *pair) for pair in pairs)))


def pairs_of(log, position):
    """Pairs of `Signal` that should be proportional, and their doubtful delay [s]."""
    velocity, direction = log.of(VELOCITY), position / np.linalg.norm(position, axis=1)[:, None]
    moved = Signal("kite_position", rate(log, on_grid(log, position)), "motion")
    flown = radial = airspeed = None
    if velocity is None:
        radial = Signal("kite_position", rate(log, on_grid(log, np.linalg.norm(position, axis=1)[:, None])), "radial speed")
    else:
        flown = Signal("kite_velocity", on_grid(log, velocity), "velocity")
        towards = on_grid(log, direction)
        radial = Signal("kite_velocity", np.sum(towards * flown.values, axis=1, keepdims=True), "radial speed")
    reeled, length, pulled = (column(log, name) for name in ("reel_out_speed", "tether_length", "ground_tension"))
    length = length and length._replace(values=rate(log, length.values), what="rate")
    clear, wind = CLEAR, log.of(WIND)
    if measured := column(log, "airspeed"):
        airspeed = measured._replace(values=measured.values**2, what="dynamic pressure")
    else:
        through = (flown or moved).values - (0.0 if wind is None else on_grid(log, wind))
        squared = np.sum(through**2, axis=1, keepdims=True)
        airspeed, clear = Signal((flown or moved).column, squared, "square of the speed"), CLEAR_OF_SPEED
    yield moved, flown, CLEAR
    yield radial, reeled, CLEAR
    yield radial, length, CLEAR
    yield length, reeled, CLEAR
    yield airspeed, pulled, clear


def column(log, name):
    """`Signal` of a column; None if the log does not have it."""
    return Signal(name, on_grid(log, log.of((name,))), "") if name in log.table else None


def step_of(log):
    """Step of the grid [s]."""
    return max(STEP, float(np.median(np.diff(log.time))))


def on_grid(log, values):
    """Values, array (rows, columns), averaged on the grid, array (times, columns); NaN in longer gaps."""
    step, time = step_of(log), log.time
    grid, found = np.arange(time[0], time[-1], step), []
    for each in values.T:
        known = np.isfinite(each)
        own = between(grid, time[known], each[known], log.map.smoothing.longest_gap) if known.sum() > 1 else np.nan * grid
        found.append(pd.Series(own).rolling(max(1, round(SMOOTHED / step)) // 2 * 2 + 1, center=True, min_periods=1).mean())
    return np.stack(found, axis=1)


def rate(log, values):
    """Rate of change on the grid, by central differences over `SMOOTHED`."""
    half = max(1, round(0.5 * SMOOTHED / step_of(log)))
    changes = np.full(values.shape, np.nan)
    changes[half:-half] = (values[2 * half :] - values[: -2 * half]) / (2 * half * step_of(log))
    return changes


def delay_between(log, one, other, clear):
    """`Delay` of two signals; None if they do not belong to each other, or too little is known."""
    step, count = step_of(log), len(one.values)
    if count * step < SHORTEST:
        return None
    seconds, best, before = peak(one.values, other.values, step)
    if not abs(best) >= (LEAST if one.values.shape[1] == 1 else OF_VECTORS):
        return None
    several = []
    for part in np.array_split(np.arange(count), PARTS):
        without = one.values.copy()
        without[part] = np.nan
        several.append(peak(without, other.values, step, around=seconds)[0])
    half = QUANTILE * np.sqrt((PARTS - 1) * np.nanvar(several))
    late, early = (one, other) if seconds >= 0.0 else (other, one)
    return Delay(late, early, abs(seconds), float(half), best, before, clear)


def peak(a, b, step, around=None):
    """Delay [s] of a behind b, correlation with and without it; within +-`RANGE`, or `SMOOTHED` around a delay [s]."""
    most = min(round(RANGE / step), len(a) // 3)
    shifts = np.arange(-most, most + 1)
    if around is not None:
        shifts = shifts[np.abs(step * shifts - around) <= max(SMOOTHED, 2.0 * step)]
    if len(shifts) < 3:
        return np.nan, np.nan, np.nan
    found = correlations(a, b, shifts)
    if not np.isfinite(found).any():
        return np.nan, np.nan, np.nan
    size = np.nan_to_num(np.abs(found))
    tops = np.flatnonzero((size[1:-1] >= size[:-2]) & (size[1:-1] >= size[2:])) + 1
    tops = tops[size[tops] >= size.max() - AS_HIGH] if len(tops) else tops
    k = tops[np.argmin(np.abs(shifts[tops]))] if len(tops) else int(size.argmax())
    part = 0.0
    if 0 < k < len(size) - 1 and (bend := size[k - 1] - 2.0 * size[k] + size[k + 1]) < 0.0:
        part = 0.5 * (size[k - 1] - size[k + 1]) / bend
    return step * (shifts[k] + part), found[k], correlations(a, b, np.zeros(1, int))[0]


def correlations(a, b, shifts):
    """Correlations of a, later by consecutive numbers of steps, with b, over all components; NaN with too few values."""
    (a, of_a), (b, of_b) = filled(a), filled(b)
    both = sums(of_a, of_b, shifts)  # number of known pairs
    products, squares = 0.0, np.zeros((2, 2, len(shifts)))  # of a and of b: about their means, and about 0
    with np.errstate(invalid="ignore", divide="ignore"):
        for x, y in zip(a.T, b.T, strict=True):
            of_x, of_y = sums(x, of_b, shifts), sums(of_a, y, shifts)
            about_0 = np.array([sums(x * x, of_b, shifts), sums(of_a, y * y, shifts)])
            squares += about_0 - np.square([of_x, of_y]) / both, about_0
            products = products + sums(x, y, shifts) - of_x * of_y / both
        varies = (squares[0] > ROUNDING * squares[1]).all(axis=0)
        enough = both >= 0.3 * (len(a) - np.abs(shifts))
        return np.where(varies & enough, products / np.sqrt(squares[0].prod(axis=0)), np.nan)


def filled(values):
    """Values about their means, 0 where a component is unknown, and as (times,) 1.0 where all are known."""
    known = np.isfinite(values).all(axis=1)
    return np.where(known[:, None], values - (values[known].mean(axis=0) if known.any() else 0.0), 0.0), known.astype(float)


def sums(a, b, shifts):
    """Sums of a, later by each of consecutive numbers of steps, times b; beyond its ends a is 0."""
    first = len(a) + shifts[0]
    return np.correlate(np.pad(a, len(a))[first : first + len(a) + len(shifts) - 1], b)


def judge(log, delays):
    """Say all of them, doubt the clear ones."""
    for each in filter(lambda each: each.is_clear, delays):
        late, early = each.late.column, each.early.column
        sign = " with the opposite sign" if each.correlation < 0.0 else ""
        known = vars(log.map.delay)
        name, seconds = (late, each.seconds) if late in known else (early, -each.seconds)
        way = f"delay.{name} = {known[name] + seconds:.2g} s"
        log.report.doubt(
            f"{late} is {each.seconds:.2g} s later in the log than {early}: {in_words(each)}{sign} have a correlation of "
            f"{abs(each.correlation):.2f}, without a delay of {abs(each.before):.2f}; set {way}, or fit it (--fit delay)"
        )
    listed = [f"{each.late.column} and {each.early.column}, {each.seconds:.2f} ± {each.half:.2f} s" for each in delays]
    if listed:
        log.report.say(f"delays by correlation: {'; '.join(listed)}")


def in_words(delay):
    """Compared signals."""
    return " and ".join(f"{each.column} ({each.what})" if each.what else each.column for each in (delay.late, delay.early))


def with_one_clock(log, delays):
    """The log with its columns shifted by clear delays, so that they can be compared; what the kite carries is unchanged."""
    moved = {"kite_position": 0.0, "airspeed": 0.0}
    for each in delays:
        pair = (each.late.column, each.early.column)
        for one, other, sign in ((*pair, 1.0), (*pair[::-1], -1.0)):
            if one in moved and other not in moved:
                moved[other] = moved[one] - sign * each.seconds * each.is_clear
    return moved_by(log, moved)


def moved_by(log, late):
    """The log with corrected readings; late : latency, dict of name to [s]."""
    time, table = log.time, log.table.copy()
    for name in table.columns.drop("time"):
        if (seconds := late.get(name.partition("[")[0], 0.0)) and pd.api.types.is_numeric_dtype(table[name]):
            table[name] = np.interp(time + seconds, time, table[name].to_numpy(), np.nan, np.nan)
    return replace(log, table=table)


def of_position(log):
    """Latency of the position relative to the winch in a log [s], by correlation; 0 if it is not clear."""
    log = moved_by(log, vars(log.map.delay))
    for each in found(log, log.of(POSITION) - np.array(log.map.station.outlet)):
        names = each.late.column, each.early.column
        if (
            each.is_clear
            and {*names} & {"reel_out_speed", "tether_length"}
            and not {*names} <= {"reel_out_speed", "tether_length"}
        ):
            return each.seconds if names[0].startswith("kite") else -each.seconds
    return 0.0
