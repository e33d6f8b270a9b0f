"""A flight from a CSV file: any time series of the user, made smooth by splines."""

import csv
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

from .flights import Motion

AXES = ("[1]", "[2]", "[3]")
VECTORS = ("kite_position", "kite_velocity", "ground_position", "ground_velocity", "wind_velocity")
COLUMNS = ("time", *(name + axis for name in VECTORS for axis in AXES), "reel_out_speed")
FEWEST_ROWS = 4  # that a C2 spline needs


def read_columns(path):
    """Columns of a CSV file with a head line, dict of arrays; ValueError says in one line what is wrong."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            head, *rows = [row for row in csv.reader(file) if row]
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror})") from None
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}: is no CSV file with a head line ({error})") from None
    head = [name.strip() for name in head]
    table = [[number(cell, path, k, name) for name, cell in zip(head, row, strict=False)] for k, row in enumerate(rows, 2)]
    if any(len(row) != len(head) for row in rows):
        raise ValueError(f"{path}: every row must have {len(head)} cells, as the head line has")
    return dict(zip(head, np.array(table).reshape(len(rows), len(head)).T, strict=True))


def number(text, path, row, name):
    """A finite number from a cell, or ValueError with its place."""
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise ValueError(f"{path}: row {row}, column {name} is {text!r}; it must be a finite number")
    return value


def check_columns(columns, path):
    """ValueError unless the columns make a flight."""
    for name in columns:
        if name not in COLUMNS:
            raise ValueError(f"{path}: unknown column {name!r}; known are {', '.join(COLUMNS)}")
    wanted = {"time", *(name for name in COLUMNS if name.startswith("kite_position"))}
    for vector in VECTORS:
        if any(name.startswith(vector) for name in columns):
            wanted |= {vector + axis for axis in AXES}
    for name in sorted(wanted - set(columns)):
        raise ValueError(f"{path}: the column {name} is missing")
    time = columns["time"]
    if len(time) < FEWEST_ROWS:
        raise ValueError(f"{path}: has {len(time)} rows; it must have at least {FEWEST_ROWS}")
    if not np.all(np.diff(time) > 0.0):
        raise ValueError(f"{path}: time must grow from row to row")


class Series:
    """The flight of a CSV file, from its first time on.

    Positions are splines with continuous acceleration, or cubic Hermite curves where the file gives the velocity. Reel-out
    speed and wind are monotone cubic curves.
    """

    def __init__(self, path):
        columns = read_columns(Path(path))
        check_columns(columns, path)
        time = columns["time"] - columns["time"][0]
        self.duration = float(time[-1])
        self._kite, self._ground = (self._path(columns, time, f"{end}_") for end in ("kite", "ground"))
        self._reeling = self._smooth(time, columns.get("reel_out_speed"))
        self._wind = self._smooth(time, self._vectors(columns, "wind_velocity"))

    @staticmethod
    def _vectors(columns, name):
        return np.stack([columns[name + axis] for axis in AXES], -1) if name + "[1]" in columns else None

    def _path(self, columns, time, end):
        positions, velocities = (self._vectors(columns, end + what) for what in ("position", "velocity"))
        if positions is None:
            return CubicSpline(time, np.zeros((len(time), 3)))
        return CubicSpline(time, positions) if velocities is None else CubicHermiteSpline(time, positions, velocities)

    @staticmethod
    def _smooth(time, values):
        return None if values is None else PchipInterpolator(time, values)

    def motion(self, time):
        """`Motion` at an array of times [s]."""
        reel = self._reeling
        paid_out = (reel.antiderivative()(time), reel(time)) if reel else (0.0 * time, 0.0 * time)
        ends = [curve(time, order) for curve in (self._kite, self._ground) for order in (0, 1)]
        return Motion(*ends, *paid_out)

    def wind(self, time):
        """Wind [m/s] of the file, array (times, 3); None: it has none."""
        return self._wind(time) if self._wind else None
