"""The log of a flight as it was written: read, in SI units, x east, y north, z up, without impossible values."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.files import csv_files
from tetherfmu.files.csv_files import shown
from tetherfmu.files.scene_files import SceneError
from tetherfmu.files.toml_files import contents_of

from . import clock, columns, frames, readings

UNCHECKED = "not checked"  # prefix of doubts on quantities that cannot be compared
STANDS_FOR_NONE = 999.0, 9999.0, 99999.0, 999999.0, 32767.0, 32768.0, 65535.0  # numbers that loggers write without a reading
ALONE = 0.1  # of such a number: distance to the next reading above which it is invalid


class LogError(SceneError):
    """An unusable log; the message is one line with file, column, and problem."""


@dataclass
class Report:
    """Changes to a log before its replay, a line each, and its doubtful signals."""

    lines: list = field(default_factory=list)  # texts
    doubts: list = field(default_factory=list)  # texts: possible errors that were not corrected
    of_units: list = field(default_factory=list)  # the doubts that suggest another unit

    def say(self, text):
        """Add a line."""
        self.lines.append(text)

    def doubt(self, text, of_unit=False):
        """Add a possible error; of_unit : whether it suggests another unit."""
        self.doubts.append(text)
        if of_unit:
            self.of_units.append(text)

    def count(self, done, rows, total, why):
        """Add a line on a number of rows, unless it is zero."""
        if rows:
            self.say(f"{done}: {rows} of {total} rows, {why}")

    def __str__(self):
        """All lines, the doubts last."""
        return "\n".join([*self.lines, *(each if each.startswith(UNCHECKED) else f"doubt: {each}" for each in self.doubts)])


@dataclass(frozen=True)
class Log:
    """A log in SI units, with its map and its report.

    `table` : DataFrame with the column `time` [s], increasing, from 0 at the first row; components of `kite_position` [m]
    and, if logged, of `kite_velocity`, `wind_velocity` [m/s], and `tether_length`, `reel_out_speed`,
    `ground_tension`, `airspeed`; NaN for missing readings; `phase`, `cycle` as texts.  `map` : without missing optional
    quantities.  `source` : the file, for messages.  `begin` : time of the
    first row in the file [s].  `rows` : row numbers in the file, from 1, array (rows,).
    """

    table: pd.DataFrame
    map: columns.Columns
    report: Report
    source: str = ""
    begin: float = 0.0
    rows: np.ndarray | None = None

    @property
    def time(self):
        """Times [s], array (rows,)."""
        return self.table["time"].to_numpy()

    def of(self, names):
        """Readings of columns, array (rows, names); None if the log does not have them."""
        return self.table[list(names)].to_numpy() if names[0] in self.table else None

    def wrong(self, text):
        """`LogError` that names the file of the log."""
        return LogError(f"{self.source}: {text}" if self.source else text)

    def cannot_fly(self, text):
        """`LogError` on implausible behaviour, with the probable units."""
        return self.wrong("; ".join([text, *self.report.of_units]))


def read(path, of, constants=()):
    """`Log` of a CSV file; of : a `Columns`, or the name or the file of a map. LogError describes a problem in one line.

    constants : that override those of the map, see `Columns.with_constants`.
    """
    path, report = Path(path), Report()
    try:
        table = csv_files.read(contents_of(path), readings.FEWEST)
        lines = 1 + table.comments + len(table.broken) + len(table.cells)
        report.count("dropped", table.comments, lines, f"which begin with {csv_files.COMMENT}")
        report.count("dropped", len(table.broken), lines, "which have more cells than the header")
        found = of if isinstance(of, columns.Columns) else map_for(of, table.cells)
        return log_of(table, found.with_constants(dict(constants)), report, str(path))
    except columns.MapError:
        raise
    except ValueError as error:
        raise LogError(f"{path}: {' '.join(str(error).split())}") from None


def map_for(name, cells):
    """`Columns` of a map by name; `kitepower` selects the map for the year of the log."""
    if str(name) != columns.KITEPOWER:
        return columns.load(name)
    times = pd.to_numeric(cells["time"], errors="coerce") if "time" in cells else pd.Series(dtype=float)
    year = pd.to_datetime(times, unit="s", errors="coerce").dt.year.median()
    if year not in columns.BY_YEAR:
        choices = f"{', '.join(columns.MAPS)}, or a file (.toml)"
        raise ValueError(f"has no column time of a year that Kitepower has published; name its map: {choices}")
    return columns.load(columns.BY_YEAR[year])


def log_of(table, found, report=None, source=""):
    """`Log` of a `csv_files.Table`; ValueError describes a problem."""
    report = Report() if report is None else report
    report.say(f"map {found.name}: {found.about}" if found.about else f"map {found.name}")
    found, cells = found.for_log(table, report), table.cells
    missing = [name for name in found.columns if name not in cells]
    if missing:
        raise ValueError(f"the column {missing[0]} of the map {found.name} is missing; there are {shown(cells.columns)}")
    if len(cells) < readings.FEWEST:
        raise ValueError(f"has {len(cells)} rows; it must have at least {readings.FEWEST}")
    time, kept = clock.repaired(cells, found.time.name, found.time.factor, report)
    cells, table = cells.iloc[kept], pd.DataFrame({"time": time - time[0]})
    raw = {name: numbers(cells, name, report) for name in found.columns if name != found.time.name}
    frames.convert(raw, found, table, report)
    readings.repair(table, found.smoothing.longest_gap, report)
    table, found = usable(table, found, report)
    readings.judge_frozen(table, report)
    readings.judge_jumps(table, report)
    for label, name in found.labels.items():
        if name in cells:
            table[label] = cells[name].to_numpy()
        else:
            report.say(f"no column {name}: the flight has no {label}")
    unused = [name for name in cells if name not in (*found.columns, *found.labels.values(), "")]
    if unused:
        report.say(f"columns that are not used: {shown(unused)}")
    if any(str(name).startswith("ground_position") for name in unused):
        report.doubt(
            "ground_position is not used; the outlet of the winch must stand still, and kite_position be seen from there"
        )
    return Log(table, found, report, source, float(time[0]), cells.index.to_numpy())


def numbers(cells, name, report):
    """Readings of a column, array (rows,), NaN for a cell without a number, or with a placeholder."""
    found = pd.to_numeric(cells[name], errors="coerce").to_numpy(float, copy=True)
    found[~(np.abs(found) < clock.HUGE)] = np.nan
    found[np.abs(found) < 1.0 / clock.HUGE] = 0.0
    report.count(f"left out of {name}", int(np.isnan(found).sum()), len(found), "which have no number")
    for number in STANDS_FOR_NONE:
        equal = np.abs(found) == number
        if equal.any() and not np.any(~equal & (np.abs(np.abs(found) - number) < ALONE * number)):
            report.count(f"left out of {name}", int(equal.sum()), len(found), f"which have {number:g}, far from all others")
            found[equal] = np.nan
    return found


def usable(table, found, report):
    """The table and the map without optional quantities that have too few readings; ValueError if another one has."""
    for name in list(found.sources):
        places = [each for each in table if each.partition("[")[0] == name]
        known = np.isfinite(table[places].to_numpy()).all(axis=1)
        if not places or readings.is_covered(table["time"].to_numpy(), known, found.smoothing.longest_gap):
            continue
        text = (
            f"{name} has readings in {known.sum()} of {len(known)} rows, too few; check its columns "
            f"{', '.join(found.columns_of(name))}, their units{' and the origin' if name == 'kite_position' else ''}"
        )
        if name not in found.optional:
            left_out = tuple(f"left out of {each}{end}" for each in (name, *found.columns_of(name)) for end in (":", "["))
            raise ValueError(f"{text} ({'; '.join(line for line in report.lines if line.startswith(left_out))})")
        report.doubt(f"{text}; the flight has no {name}")
        table, found = table.drop(columns=places), found.without(name)
    return table, found
