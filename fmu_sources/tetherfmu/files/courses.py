"""Inputs over time in files, the table [series]: rows of a few numbers, a column of a CSV file, or a constant.

    reel_out_speed = [[0, 0.0], [2, 1.5], [10, 1.5], [10, 0.0]]     a ramp, and a step at 10 s
    ground_position = [[0, [0, 0, 60]], [20, [0, 25, 60]]]
    winch_force = {file = "crane.csv", column = "force [kN]"}
    winch_force = {rows = [[0, 2e3], [5, 3e3]], factor = 1.1, delay = 2, time_factor = 0.5}

`factor` multiplies the values. A row at the time t is at `delay` + `time_factor` t.

Speeds, forces and winds are linear between rows; two rows at the same time are a step. `release` is false before the first
row, then piecewise constant. Positions and lengths are smooth: a
monotone cubic curve that is at rest at the first and at the last row, or a C2 spline through the rows of a CSV file. All
others are constant before the first row, and all are constant after the last one.
"""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from tetherfmu.runtime.limits import LARGEST_INPUT
from tetherfmu.runtime.naming import prefixed

from . import csv_files
from .toml_files import contents_of, in_si, require

POSITIONS = ("position", "winch_length", *csv_files.ANGLES)  # names, or their endings, of smooth inputs
RELEASE = "release"
ROUNDING = 1e-9  # of times [s]
CHANGES = {"factor": "", "delay": "s", "time_factor": ""}  # of the rows of a course, and their units
ROWS = "it must be a number, rows [[time, value], ...], or a table with file and column, or with rows"
VECTOR_ROWS = "it must be three numbers, rows [[time, [x, y, z]], ...], or a table with file and column, or with rows"


@dataclass(frozen=True, eq=False)
class Course:
    """An input over time, by rows; `curve` is None where it is linear between them.

    times : (rows,) [s].  values : (rows, size).  curve : function of times, with the order of a derivative as second one.
    """

    times: np.ndarray
    values: np.ndarray
    curve: object = None
    contents: bytes = b""  # of its file

    @property
    def size(self):
        """How many numbers it has."""
        return self.values.shape[1]

    def shaped(self, values):
        """Values as (times,) of a scalar, (times, 3) of a vector."""
        return values if self.size > 1 else values[..., 0]

    def inside(self, time):
        """Times [s] from the first row to the last one."""
        return np.clip(np.asarray(time, float), self.times[0], self.times[-1])

    def __call__(self, time):
        """Values at times [s]."""
        if self.curve is not None:
            return self.shaped(self.curve(self.inside(time)))
        time = np.asarray(time, float)
        row = self.times[np.minimum(np.searchsorted(self.times, time - ROUNDING), len(self.times) - 1)]
        time = np.where(np.abs(row - time) <= ROUNDING, row, time)  # at a step the later value
        return self.shaped(np.stack([np.interp(time, self.times, each) for each in self.values.T], -1))

    def rate(self, time):
        """Derivatives at times [s], 0 before the first row and after the last one."""
        time = np.asarray(time, float)
        if self.curve is None:
            place = np.clip(np.searchsorted(self.times, time + ROUNDING, "right") - 1, 0, max(len(self.times) - 2, 0))
            spans = np.diff(self.times, append=self.times[-1] + 1.0)
            slopes = np.diff(self.values, axis=0, append=self.values[-1:]) / np.where(spans > 0.0, spans, np.inf)[:, None]
            found = slopes[place]
        else:
            found = self.curve(self.inside(time), 1)
        moves = (time >= self.times[0] - ROUNDING) & (time < self.times[-1] - ROUNDING)
        return self.shaped(np.where(moves[..., None], found, 0.0))

    def integral(self, time):
        """Integral from 0 to times [s], exact; for courses linear between rows."""
        corners = np.unique([0.0, *self.times])
        middle = 0.5 * (corners[1:] + corners[:-1])
        means = self(middle) if len(middle) else np.zeros((0, *self.values.shape[1:]))
        means = means.reshape(len(middle), self.size)
        sums = np.concatenate([np.zeros((1, self.size)), np.cumsum(means * np.diff(corners)[:, None], axis=0)])
        sums -= sums[np.searchsorted(corners, 0.0)]
        time = np.asarray(time, float)
        k = np.clip(np.searchsorted(corners, time, "right") - 1, 0, len(corners) - 1)
        first, last = (np.reshape(self(each), (*time.shape, self.size)) for each in (corners[k], time - 2.0 * ROUNDING))
        return self.shaped(sums[k] + (time - corners[k])[..., None] * 0.5 * (first + last))

    def first(self, value=1.0):
        """First time [s] at which a row has this value; infinity if none."""
        return float(self.times[self.values[:, 0] == value].min(initial=np.inf))


def is_smooth(name):
    """Whether an input is a position or a length, which has a continuous rate."""
    return name.rpartition("_")[2] == "position" or name in POSITIONS


def course(label, value, name, unit, size, folder=Path(), changes=None):
    """`Course` of a value of a file; ValueError names its key, `label`, and the permitted forms.

    name : of the input without its point or line.  size : number of components.  folder : of files.
    changes : some of `CHANGES` by name, of rows.
    """
    with prefixed(f"{label}: "):
        if isinstance(value, dict):
            return of_table(label, value, name, unit, size, folder)
        is_rows = isinstance(value, list) and any(isinstance(each, list) for each in value)
        rows = value if is_rows else [[0.0, value]]
        found = [row_of(k, row, unit, size) for k, row in enumerate(rows, 1)]
        times, values = np.array([each[0] for each in found]), np.array([each[1] for each in found])
        times, values = changed(times, values, changes or {})
        return checked(times, values, name, lambda k: f"row {k + 1}")


def of_table(label, table, name, unit, size, folder):
    """`course` of a table with a file or rows, and changes of them."""
    source = next((each for each in ("file", "rows") if each in table), None)
    require(table, label, ("file", "column", "rows", *CHANGES), (source or "rows",))
    changes = {}
    for key in CHANGES.keys() & table.keys():
        with prefixed(f"{key} is {table[key]!r}; "):
            changes[key] = float(in_si(table[key], CHANGES[key]))
    if not changes.get("time_factor", 1.0) > 0.0:
        raise ValueError(f"time_factor is {table['time_factor']!r}; it must be above 0")
    if source == "file":
        if "rows" in table:
            raise ValueError("has file and rows; it must have one of them")
        return of_file(label, table, name, unit, size, folder, changes)
    if "column" in table:
        raise ValueError("has column without file")
    if isinstance(table["rows"], dict):
        raise ValueError(f"rows is {table['rows']!r}; {VECTOR_ROWS if size > 1 else ROWS}")
    return course("rows", table["rows"], name, unit, size, folder, changes)


def changed(times, values, changes):
    """Times and values with `CHANGES`, a dict of some of them."""
    return changes.get("delay", 0.0) + changes.get("time_factor", 1.0) * times, changes.get("factor", 1.0) * values


def row_of(k, row, unit, size):
    """Time [s] and numbers of row k; ValueError describes a problem."""
    if not isinstance(row, list) or len(row) != 2:
        raise ValueError(f"row {k} is {row!r}; {VECTOR_ROWS if size > 1 else ROWS}")
    time, given = row
    given = given if size > 1 else [given]
    if not isinstance(given, list) or len(given) != size or any(isinstance(each, list) for each in given):
        raise ValueError(f"row {k} has {row[1]!r}; {VECTOR_ROWS if size > 1 else ROWS}")
    with prefixed(f"row {k} is {row!r}; "):
        return float(in_si(time, "s")), [
            float(each) if isinstance(each, bool) else float(in_si(each, unit)) for each in given
        ]


def checked(times, values, name, place, spline=False, contents=b""):
    """`Course` of rows; ValueError if it cannot be one.

    place : names a row by its place.  spline : whether it is a C2 spline where it is smooth.
    """
    allowed = f"it must be a finite number of at most {LARGEST_INPUT:g} in magnitude"
    for k, numbers in enumerate(values):
        if not np.all(np.abs(numbers) <= LARGEST_INPUT):
            raise ValueError(f"{place(k)} has {numbers.tolist()}; {allowed}")
        if name == RELEASE and numbers[0] not in (0.0, 1.0):
            raise ValueError(f"{place(k)} has {numbers[0]:g}; it must be true or false")
    if not times[0] >= 0.0:
        raise ValueError(f"{place(0)} has the time {times[0]:g} s; it must be at least 0 s")
    smooth = is_smooth(name)
    for k, (before, after) in enumerate(pairwise(times), 1):
        if not (after > before or (after == before and not smooth)):
            grow = "be later than" if smooth else "not be before"
            raise ValueError(f"{place(k)} has the time {after:g} s; it must {grow} that of the row before, {before:g} s")
    if name == RELEASE:
        times, values = held(times, values)
    curve = smooth_curve(times, values, spline) if smooth and len(times) > 1 else None
    return Course(times, values, curve, contents)


def held(times, values):
    """Rows of a piecewise constant course; before the first row it is 0."""
    before = np.concatenate([[[0.0]], values[:-1]])
    return np.repeat(times, 2), np.stack([before, values], 1).reshape(-1, 1)


def smooth_curve(times, values, spline):
    """A curve through rows that is at rest at both ends, or a C2 spline."""
    if spline:
        return csv_files.curve(times, values)
    from scipy.interpolate import PchipInterpolator  # slow to import

    beyond = [times[0] - 1.0, *times, times[-1] + 1.0]
    return PchipInterpolator(beyond, np.concatenate([values[:1], values, values[-1:]]))


def of_file(label, table, name, unit, size, folder, changes):
    """`course` of a table with the name of a CSV file and of a column, by default the input name.

    changes : as for `course`.
    """
    for key, text in ((key, table[key]) for key in ("file", "column") if key in table):
        if not isinstance(text, str):
            raise ValueError(f"{key} is {text!r}; it must be a text")
    vector = table.get("column", label.partition(".")[2])
    names = [vector] if size == 1 else [f"{vector}[{i}]" for i in (1, 2, 3)]
    with prefixed(f"{table['file']}: "):
        contents = contents_of(folder / table["file"])
        cells = csv_files.read(contents, 2)
        numbers = [numbers_of(cells, *each) for each in (("time", "s"), *((each, unit) for each in names))]
        rows = np.column_stack(numbers)
        for k in np.flatnonzero(~np.all(np.isfinite(rows), axis=1)):
            raise ValueError(f"row {cells.cells.index[k]} has no number where it must be a finite number")
        times, values = changed(rows[:, 0], rows[:, 1:], changes)
        return checked(times, values, name, lambda k: f"row {cells.cells.index[k]}", len(rows) > 3, contents)


def numbers_of(table, name, unit):
    """Numbers of a column of a `csv_files.Table` in SI units, array (rows,); ValueError if there is no such column."""
    column = table.column(name)
    if column is None:
        raise ValueError(f"has no column {name}; it has {csv_files.shown(table.cells)}")
    return table.numbers(column, unit)
