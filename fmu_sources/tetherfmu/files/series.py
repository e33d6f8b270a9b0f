"""A flight from a CSV file: any time series of the user, made smooth by splines."""

from itertools import chain

import numpy as np
import pandas as pd
from scipy.interpolate import PchipInterpolator

from tetherfmu.runtime.inputs import components, inputs_of
from tetherfmu.runtime.limits import LARGEST_INPUT
from tetherfmu.runtime.naming import meant, prefixed

from . import csv_files
from .flights import Motion
from .toml_files import contents_of

INPUTS = inputs_of(kite_is_free=False)
VECTORS = {each.name: components(each.name, each.size) for each in INPUTS if each.size > 1}
KITE = VECTORS["kite_position"]
LENGTHS = ("tether_length", "winch_length")  # unstretched: name in logs; name of the FMU input
FORCES = ("ground_tension", "winch_force")  # of the winch, likewise
RELEASE = "release"  # 0 or 1
REELING = ("reel_out_speed", *LENGTHS, *FORCES)
UNITS = {"time": "s"} | {name: each.unit for each in INPUTS for name in components(each.name, each.size)}
UNITS |= dict(zip(csv_files.ANGLES, csv_files.UNITS_OF_ANGLES, strict=True)) | {
    "tether_length": "m",
    "ground_tension": "N",
    RELEASE: "",
}
COLUMNS = ("time", *chain(*VECTORS.values()), *csv_files.ANGLES, *REELING, RELEASE)
FEWEST_ROWS = 4  # that a C2 spline needs
LONGEST_NAME = 40  # characters of a column's name in a message
JUDGED_ROWS = 10_000  # rows used to estimate noise
ALTERNATING = -0.5  # correlation of neighbours: noise has -0.8 in fourth differences, a smooth path nearly 1


def read_columns(contents):
    """Columns of a CSV file (bytes) by name, a DataFrame of numbers in SI units; its index is the row of the file.

    Angles and distance are converted to a position.  ValueError describes a problem in one line; it quotes only the header
    and units of the file, which may be the wrong one.
    """
    table = csv_files.read(contents, FEWEST_ROWS)
    names = [csv_files.split(each)[0] for each in table.cells]
    numbers = pd.DataFrame({column: table.numbers(column) for column in table.cells}, table.cells.index)
    for problem in chain(problems_of_names(names), problems(table, numbers.set_axis(names, axis=1))):
        raise ValueError(problem)
    for column, name in zip(table.cells, names, strict=True):
        numbers[column] *= csv_files.factor(table.unit(column), UNITS[name], column)
    numbers.columns = names
    if "elevation" in numbers:
        numbers[[*KITE]] = csv_files.from_angles(numbers[[*csv_files.ANGLES]].to_numpy())
        numbers = numbers.drop(columns=[*csv_files.ANGLES])
    for problem in too_large(numbers.drop(columns="time")):  # which may be Unix time
        raise ValueError(problem)
    if len(numbers) < FEWEST_ROWS:
        raise ValueError(f"has {len(numbers)} rows; it must have at least {FEWEST_ROWS}")
    return numbers


def problems_of_names(names):
    """Problems of the column names of a flight, texts."""
    for name in names:
        if name not in COLUMNS:
            shown = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}..."
            yield f"unknown column {shown!r}; known are {', '.join(COLUMNS)}{meant(name, COLUMNS)}"
        if names.count(name) > 1:
            yield f"the column {name} appears twice"
    given = {name.partition("[")[0] for name in names}
    angles = given.intersection(csv_files.ANGLES)
    if angles and "kite_position" in given:
        yield f"has columns of kite_position and {', '.join(sorted(angles))}; it must have one of both"
    where = csv_files.ANGLES if angles else KITE
    needed = ("time", *where, *chain(*(VECTORS[name] for name in VECTORS if name in given)))
    for name in needed:
        if name not in names:
            yield f"the column {name} is missing"
    if "ground_velocity" in given and "ground_position" not in given:
        yield "has columns of ground_velocity, but none of ground_position"
    if len(controls := [name for name in REELING if name in names]) > 1:
        yield f"has the columns {' and '.join(controls)}; it must have one of them"


def problems(table, numbers):
    """Problems in the rows of a `csv_files.Table` with these numbers, texts."""
    for row in table.broken:
        yield f"row {row} has more cells than the header"
    for row, column in np.argwhere(~np.isfinite(numbers.to_numpy())):
        yield f"row {numbers.index[row]}, column {numbers.columns[column]} has no number; it must be a finite number"
    for k in np.flatnonzero(~numbers.get(RELEASE, pd.Series(dtype=float)).isin((0.0, 1.0))):
        yield f"row {numbers.index[k]}, column {RELEASE} is {numbers[RELEASE].iloc[k]:g}; it must be 0 or 1"
    for k in np.flatnonzero(np.diff(numbers["time"]) <= 0.0):
        before, after = numbers["time"].iloc[k : k + 2]
        yield f"row {numbers.index[k + 1]}: time is {after:.10g} after {before:.10g}; it must grow from row to row"


def too_large(inputs):
    """Numbers that are too large for inputs, texts."""
    for row, column in np.argwhere(np.abs(inputs.to_numpy()) > LARGEST_INPUT):
        found = f"row {inputs.index[row]}, column {inputs.columns[column]} is {inputs.iat[row, column]:g}"
        yield f"{found}; it must be at most {LARGEST_INPUT:g} in magnitude"


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

    Positions are splines with continuous acceleration, or cubic Hermite curves if the file contains the velocity. Reel-out
    speed (or the unstretched length, from which the rate then follows) and wind are monotone cubic curves. `wind` and
    `initial_length` [m] are None if the file has none; `has_velocities` is whether the file has velocities of all moving
    ends, `has_length` whether it has the unstretched length, `has_force` whether the winch force (`force`), which leaves
    the length unknown. `has_release` is whether it has the release of the kite, `release_time` [s],
    infinity if never. `scatter` [m] and `shaking` [m/s2] are the results of `noise` at the kite. `columns` are the names of
    the columns, those of a position for angles, `contents` the bytes of the file.
    """

    kite_is_free = False

    def __init__(self, path):
        with prefixed(f"{path}: "):
            self.contents = contents_of(path)
            table = read_columns(self.contents)
        self.columns = tuple(table)
        time = table["time"].to_numpy() - table["time"].iloc[0]
        given = {name: table[[*each]].to_numpy() for name, each in VECTORS.items() if each[0] in table}
        self.duration = float(time[-1])
        self.has_velocities = all(f"{end}_velocity" in given for end in ("kite", "ground") if f"{end}_position" in given)
        self.scatter, self.shaking = noise(time, given["kite_position"])
        still = np.zeros((len(time), 3))
        ends = ((given.get(f"{end}_position"), given.get(f"{end}_velocity")) for end in ("kite", "ground"))
        self._ends = [csv_files.curve(time, still if place is None else place, speed) for place, speed in ends]
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
        self.has_release = RELEASE in table
        self.release_time = float(time[table[RELEASE] == 1.0].min(initial=np.inf)) if self.has_release else np.inf
        wind = given.get("wind_velocity")
        self.wind = None if wind is None else PchipInterpolator(time, wind)

    def motion(self, time):
        """`Motion` at an array of times [s]."""
        ends = (end(time, order) for end in self._ends for order in (0, 1))
        return Motion(*ends, self._length(time) - self._length(0.0), self._speed(time))
