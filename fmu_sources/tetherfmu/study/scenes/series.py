"""A flight from a CSV file: any time series of the user, made smooth by splines."""

from io import BytesIO
from itertools import chain

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

from tetherfmu.input_files import contents_of
from tetherfmu.runtime.inputs import components, inputs_of
from tetherfmu.runtime.limits import LARGEST_INPUT

from .flights import Motion

VECTORS = {each.name: components(each.name, each.size) for each in inputs_of(kite_is_free=False) if each.size > 1}
LENGTHS = ("tether_length", "winch_length")  # unstretched: as it is logged; by the name of the input of an FMU
FORCES = ("ground_tension", "winch_force")  # of the winch, likewise
REELING = ("reel_out_speed", *LENGTHS, *FORCES)
COLUMNS = ("time", *chain(*VECTORS.values()), *REELING)
FEWEST_ROWS = 4  # that a C2 spline needs
LONGEST_NAME = 40  # characters of a column's name in a message
JUDGED_ROWS = 10_000  # of which noise is sought
ALTERNATING = -0.5  # correlation of neighbours: noise has -0.8 in fourth differences, a smooth path nearly 1


def read_columns(path, contents):
    """Columns of a CSV file (bytes) with a header row, a DataFrame of numbers; ValueError says in one line what is wrong.

    The head line is quoted, no other: the file may be none that was meant.
    """
    try:
        cells = pd.read_csv(BytesIO(contents), header=None, dtype=str, skipinitialspace=True, na_filter=False)
    except ValueError as error:
        raise ValueError(f"{path}: is no CSV file with a header row ({str(error).strip()})") from None
    table = cells[1:].set_axis(cells.iloc[0].str.strip(), axis=1)
    numbers = table.apply(pd.to_numeric, errors="coerce").astype(float)
    for problem in problems(table, numbers):
        raise ValueError(f"{path}: {problem}")
    return numbers


def problems(table, numbers):
    """What is wrong with the columns of a flight, texts; `numbers` are those of the texts of a table."""
    for name in table.columns.difference(COLUMNS, sort=False):
        shown = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}..."
        yield f"unknown column {shown!r}; known are {', '.join(COLUMNS)}"
    for name in table.columns[table.columns.duplicated()]:
        yield f"has the column {name} twice"
    for row, column in np.argwhere(~np.isfinite(numbers.to_numpy())):
        yield f"row {row + 2}, column {table.columns[column]} has no number; it must be a finite number"
    inputs = numbers.drop(columns="time", errors="ignore")  # which may be that of Unix
    for row, column in np.argwhere(np.abs(inputs.to_numpy()) > LARGEST_INPUT):
        found = f"row {row + 2}, column {inputs.columns[column]} is {inputs.iat[row, column]:g}"
        yield f"{found}; it must be at most {LARGEST_INPUT:g} in magnitude"
    given = {"kite_position", *(name.partition("[")[0] for name in table)}
    needed = {"time", *chain(*(VECTORS[name] for name in given.intersection(VECTORS)))}
    for name in sorted(needed.difference(table)):
        yield f"the column {name} is missing"
    if "ground_velocity" in given and "ground_position" not in given:
        yield "has columns of ground_velocity, but none of ground_position"
    if len(controls := [name for name in REELING if name in table]) > 1:
        yield f"has the columns {' and '.join(controls)}; it must have one of them"
    if len(table) < FEWEST_ROWS:
        yield f"has {len(table)} rows; it must have at least {FEWEST_ROWS}"
    for row in np.flatnonzero(np.diff(numbers["time"]) <= 0.0):
        yield f"row {row + 3}: time must grow from row to row"


def curve(time, positions, velocities):
    """A smooth path through positions [m]; without them at the origin, without velocities [m/s] a C2 spline."""
    if positions is None or velocities is None:
        return CubicSpline(time, np.zeros((len(time), 3)) if positions is None else positions)
    return CubicHermiteSpline(time, positions, velocities)


def noise(time, positions):
    """Scatter [m] of positions about a smooth path, and the accelerations [m/s2] in it; 0 of a path without noise.

    Five neighbours: their fourth divided difference, with weights whose squares have the sum 1, so that it scatters as one
    position does. It alternates from row to row where that is noise. Accelerations are second differences.
    """
    t, x = time[:JUDGED_ROWS], positions[:JUDGED_ROWS]
    if len(t) < 2 * FEWEST_ROWS:
        return 0.0, 0.0
    t, x = (np.lib.stride_tricks.sliding_window_view(each, 5, axis=0) for each in (t, x))
    weights = 1.0 / np.prod(t[:, :, None] - t[:, None, :] + np.eye(5), axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    rest = np.einsum("rk,rik->ri", weights, x)
    if np.sum(rest[1:] * rest[:-1]) > ALTERNATING * np.sum(rest**2) or not rest.any():
        return 0.0, 0.0
    scatter = float(np.sqrt(np.mean(rest**2)))
    return scatter, float(np.sqrt(6.0) * scatter / np.median(np.diff(time)) ** 2)


class Series:
    """The flight of a CSV file, from its first time on.

    Positions are splines with continuous acceleration, or cubic Hermite curves where the file gives the velocity. Reel-out
    speed (or the unstretched length, whose rate it then is) and wind are monotone cubic curves. `wind` and `initial_length`
    [m] are None if the file has none; `has_velocities` is whether the file gives those of all ends that it moves,
    `has_length` whether it gives the unstretched length, `has_force` whether the force of the winch (`force`), with which
    nothing is known of the length. `scatter` [m] and `shaking` [m/s2] are those of `noise` at the
    kite. `columns` are the names of the columns, `contents` the bytes of the file.
    """

    kite_is_free = False

    def __init__(self, path):
        try:
            self.contents = contents_of(path)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        table = read_columns(path, self.contents)
        self.columns = tuple(table)
        time = table["time"].to_numpy() - table["time"].iloc[0]
        given = {name: table[[*each]].to_numpy() for name, each in VECTORS.items() if each[0] in table}
        self.duration = float(time[-1])
        self.has_velocities = all(f"{end}_velocity" in given for end in ("kite", "ground") if f"{end}_position" in given)
        self.scatter, self.shaking = noise(time, given["kite_position"])
        self._ends = [curve(time, given.get(f"{end}_position"), given.get(f"{end}_velocity")) for end in ("kite", "ground")]
        lengths = next((table[name] for name in LENGTHS if name in table), None)
        self.has_length = lengths is not None
        if self.has_length:
            self._length = PchipInterpolator(time, lengths)
            self._speed, self.initial_length = self._length.derivative(), float(lengths.iloc[0])
        else:
            self._speed, self.initial_length = PchipInterpolator(time, table.get("reel_out_speed", 0.0 * time)), None
            self._length = self._speed.antiderivative()
        forces = next((table[name] for name in FORCES if name in table), None)
        self.has_force = forces is not None
        self.force = PchipInterpolator(time, forces) if self.has_force else None
        wind = given.get("wind_velocity")
        self.wind = None if wind is None else PchipInterpolator(time, wind)

    def motion(self, time):
        """`Motion` at an array of times [s]."""
        ends = (end(time, order) for end in self._ends for order in (0, 1))
        return Motion(*ends, self._length(time) - self._length(0.0), self._speed(time))
