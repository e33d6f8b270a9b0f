"""A flight from a CSV file: any time series of the user, made smooth by splines."""

from itertools import chain

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

from tetherfmu.runtime.inputs import components, inputs_of

from .flights import Motion

VECTORS = {each.name: components(each.name, each.size) for each in inputs_of(kite_is_free=False) if each.size > 1}
COLUMNS = ("time", *chain(*VECTORS.values()), "reel_out_speed", "tether_length")
FEWEST_ROWS = 4  # that a C2 spline needs


def read_columns(path):
    """Columns of a CSV file with a header row, a DataFrame of numbers; ValueError says in one line what is wrong."""
    try:
        cells = pd.read_csv(path, header=None, dtype=str, skipinitialspace=True, na_filter=False)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise ValueError(f"{path}: is no CSV file with a header row ({str(error).strip()})") from None
    table = cells[1:].set_axis(cells.iloc[0].str.strip(), axis=1)
    numbers = table.apply(pd.to_numeric, errors="coerce").astype(float)
    for problem in problems(table, numbers):
        raise ValueError(f"{path}: {problem}")
    return numbers


def problems(table, numbers):
    """What is wrong with the columns of a flight, texts; `numbers` are those of the texts of a table."""
    for row, column in np.argwhere(~np.isfinite(numbers.to_numpy())):
        yield f"row {row + 2}, column {table.columns[column]} is {table.iat[row, column]!r}; it must be a finite number"
    for name in table.columns.difference(COLUMNS, sort=False):
        yield f"unknown column {name!r}; known are {', '.join(COLUMNS)}"
    given = {"kite_position", *(name.partition("[")[0] for name in table)}
    needed = {"time", *chain(*(VECTORS[name] for name in given.intersection(VECTORS)))}
    for name in sorted(needed.difference(table)):
        yield f"the column {name} is missing"
    if "ground_velocity" in given and "ground_position" not in given:
        yield "has columns of ground_velocity, but none of ground_position"
    if {"reel_out_speed", "tether_length"} <= {*table}:
        yield "has the columns reel_out_speed and tether_length; it must have one of them"
    if len(table) < FEWEST_ROWS:
        yield f"has {len(table)} rows; it must have at least {FEWEST_ROWS}"
    if not numbers["time"].is_monotonic_increasing or not numbers["time"].is_unique:
        yield "time must grow from row to row"


def curve(time, positions, velocities):
    """A smooth path through positions [m]; without them at the origin, without velocities [m/s] a C2 spline."""
    if positions is None or velocities is None:
        return CubicSpline(time, np.zeros((len(time), 3)) if positions is None else positions)
    return CubicHermiteSpline(time, positions, velocities)


class Series:
    """The flight of a CSV file, from its first time on.

    Positions are splines with continuous acceleration, or cubic Hermite curves where the file gives the velocity. Reel-out
    speed (or the unstretched length, whose rate it then is) and wind are monotone cubic curves. `wind` and `initial_length`
    [m] are None if the file has none; `contents` are the bytes of the file.
    """

    def __init__(self, path):
        table, self.contents = read_columns(path), path.read_bytes()
        time = table["time"].to_numpy() - table["time"].iloc[0]
        given = {name: table[[*each]].to_numpy() for name, each in VECTORS.items() if each[0] in table}
        self.duration = float(time[-1])
        self._ends = [curve(time, given.get(f"{end}_position"), given.get(f"{end}_velocity")) for end in ("kite", "ground")]
        if "tether_length" in table:
            self._length = PchipInterpolator(time, table["tether_length"])
            self._speed, self.initial_length = self._length.derivative(), float(table["tether_length"].iloc[0])
        else:
            self._speed, self.initial_length = PchipInterpolator(time, table.get("reel_out_speed", 0.0 * time)), None
            self._length = self._speed.antiderivative()
        wind = given.get("wind_velocity")
        self.wind = None if wind is None else PchipInterpolator(time, wind)

    def motion(self, time):
        """`Motion` at an array of times [s]."""
        ends = (end(time, order) for end in self._ends for order in (0, 1))
        return Motion(*ends, self._length(time) - self._length(0.0), self._speed(time))
