"""The log of a flight as it was written: read, in SI units, x east, y north, z up, with what is impossible left out."""

from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.runtime.inputs import components
from tetherfmu.study.scenes.files import SceneError, contents_of

from . import clock, columns, frames
from .report import Report

POSITION, VELOCITY, WIND = (components(name, 3) for name in ("kite_position", "kite_velocity", "wind_velocity"))
LARGEST = {  # what is larger in magnitude is no reading of a kite
    **dict.fromkeys(POSITION, 2e4),  # [m]
    **dict.fromkeys(VELOCITY, 150.0),  # [m/s]
    **dict.fromkeys(WIND, 80.0),
    **{"tether_length": 2e4, "reel_out_speed": 50.0, "ground_tension": 1e7, "airspeed": 150.0},
}
FLOOR = {  # a reading that is farther than this from the median of its neighbours may be a spike
    **dict.fromkeys(POSITION, 5.0),
    **dict.fromkeys(VELOCITY, 8.0),
    **{"tether_length": 2.0, "reel_out_speed": 3.0},
}
SPIKE = 8.0  # times the typical distance from the median of the neighbours, from which on it is one
NEIGHBOURS = 11  # rows
OF_TENSION = 0.3  # of its 99th percentile: floor of a spike of the tension
FEWEST_ROWS = 20
MOST_LOST = 0.5  # of the rows of a column that is needed
STUCK = 5.0  # s, from which on a reading that does not change is doubtful
CHANGING = ("ground_tension", "kite_position[1]", "tether_length")  # readings that change in flight
LONGEST_NAMES = 400  # characters of a message about columns


class LogError(SceneError):
    """A log that cannot be used; the message is one line with file, column, and what is wrong."""


@dataclass(frozen=True)
class Log:
    """A log in SI units, its map and what was done to it.

    `table` : DataFrame with the column `time` [s], growing, from 0 at the first row; the components of `kite_position` [m]
    and, where the log has them, of `kite_velocity`, `wind_velocity` [m/s], and `tether_length`, `reel_out_speed`,
    `ground_tension`, `airspeed`; NaN where a reading is missing; `phase`, `cycle` as texts.
    """

    table: pd.DataFrame
    map: columns.Columns
    report: Report

    @property
    def time(self):
        """Times [s], array (rows,)."""
        return self.table["time"].to_numpy()

    def of(self, names):
        """Readings of columns, array (rows, names); None if the log does not have them."""
        return self.table[list(names)].to_numpy() if names[0] in self.table else None


def read(path, of):
    """`Log` of a CSV file; of : a `Columns`, or the name or the file of a map. LogError says in one line what is wrong."""
    path = Path(path)
    try:
        cells, skipped = read_cells(path)
        found = of if isinstance(of, columns.Columns) else map_for(of, cells)
        return log_of(cells, found, skipped)
    except columns.MapError:
        raise
    except ValueError as error:
        raise LogError(f"{path}: {' '.join(str(error).split())}") from None


def read_cells(path):
    """Cells of a CSV file as texts, a DataFrame, and the number of rows that have too many of them."""
    contents = contents_of(path)
    try:
        text = contents.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = contents.decode("latin-1")
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) < 2:
        raise ValueError(f"has {len(lines)} lines; it must have a header row and {FEWEST_ROWS} rows at least")
    separator = max(",;\t", key=lines[0].count)
    options = {"sep": separator, "header": None, "dtype": str, "skipinitialspace": True, "na_filter": False}
    try:
        cells = pd.read_csv(StringIO("\n".join(lines)), on_bad_lines="skip", **options)
    except ValueError as error:
        raise ValueError(f"is no CSV file with a header row ({error})") from None
    names = cells.iloc[0].str.strip()
    repeated = names[names.duplicated() & (names != "")]
    if len(repeated):
        raise ValueError(f"the column {repeated.iloc[0]} is there twice")
    cells = cells[1:].set_axis(names, axis=1).reset_index(drop=True)
    if separator == ";":
        cells = cells.apply(lambda column: column.str.replace(",", ".", regex=False))
    return cells, len(lines) - 1 - len(cells)


def map_for(name, cells):
    """`Columns` of a map by its name; `kitepower` stands for that of the year of the log."""
    if str(name) != columns.KITEPOWER:
        return columns.load(name)
    years = pd.to_datetime(pd.to_numeric(cells.get("time"), errors="coerce"), unit="s", errors="coerce")
    year = years.dropna().dt.year.median() if years is not None and len(years.dropna()) else None
    if year not in columns.BY_YEAR:
        choices = ", ".join(columns.BY_YEAR.values())
        raise ValueError(f"has no column time of a year that Kitepower has published; name the map: {choices}")
    return columns.load(columns.BY_YEAR[year])


def log_of(cells, found, skipped=0):
    """`Log` of the cells of a file (texts); ValueError says what is wrong."""
    report = Report()
    report.say(f"map {found.name}: {found.about}" if found.about else f"map {found.name}")
    report.count("dropped", skipped, skipped + len(cells), "which have more cells than the header")
    missing = [name for name in found.columns if name not in cells]
    if missing:
        there = ", ".join(map(str, cells.columns))
        there = there if len(there) <= LONGEST_NAMES else f"{there[:LONGEST_NAMES]}..."
        raise ValueError(f"the column {missing[0]} of the map {found.name} is missing; there are {there}")
    if len(cells) < FEWEST_ROWS:
        raise ValueError(f"has {len(cells)} rows; it must have at least {FEWEST_ROWS}")
    time, kept = clock.repaired(cells[found.time.column], found.time.factor, report)
    cells = cells.iloc[kept]
    table = pd.DataFrame({"time": time})
    raw = {name: numbers(cells, name, report) for name in found.columns if name != found.time.column}
    frames.convert(raw, found, table, report)
    for name in table.columns.drop("time"):
        leave_out_impossible(table, name, report)
    judge_stuck(table, report)
    for label, name in found.labels.items():
        if name in cells:
            table[label] = cells[name].to_numpy()
        else:
            report.say(f"no column {name}: the flight has no {label}")
    return Log(table, found, report)


def numbers(cells, name, report):
    """Readings of a column, array (rows,), NaN where a cell has no number."""
    found = pd.to_numeric(cells[name], errors="coerce").to_numpy(float, copy=True)
    found[~np.isfinite(found)] = np.nan
    report.count(f"left out of {name}", int(np.isnan(found).sum()), len(found), "which have no number")
    return found


def leave_out_impossible(table, name, report):
    """Put NaN for readings that no kite has, and for spikes; ValueError if too few are left of a column."""
    values = table[name].to_numpy(copy=True)
    there = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        impossible = np.abs(values) > LARGEST[name]
    if name == "tether_length":
        impossible |= values <= 0.0
    values[impossible] = np.nan
    report.count(f"left out of {name}", int(impossible.sum()), len(values), "which no kite has")
    spikes = spikes_of(values, floor_of(name, values))
    values[spikes] = np.nan
    report.count(f"left out of {name}", int(spikes.sum()), len(values), "which stand out of their neighbours")
    lost = 1.0 - np.isfinite(values).mean()
    if lost > MOST_LOST:
        raise ValueError(f"{name} has no usable reading in {100.0 * lost:.0f} % of the rows (of {int(there.sum())} numbers)")
    table[name] = values


def floor_of(name, values):
    """Distance from the median of the neighbours below which a reading is no spike; None: spikes are not sought."""
    if name == "ground_tension":
        return OF_TENSION * np.nanpercentile(np.abs(values), 99.0) if np.isfinite(values).any() else None
    return FLOOR.get(name)


def spikes_of(values, floor):
    """Which readings lie far from the median of their neighbours (Hampel 1974), array (rows,) of bool."""
    if floor is None:
        return np.zeros(len(values), bool)
    series = pd.Series(values)
    distance = (series - series.rolling(NEIGHBOURS, center=True, min_periods=3).median()).abs()
    typical = 1.4826 * distance.rolling(5 * NEIGHBOURS, center=True, min_periods=3).median()
    return (distance > np.maximum(SPIKE * typical, floor)).to_numpy()


def judge_stuck(table, report):
    """Doubt readings that stay the same to the last digit for long."""
    for name in CHANGING:
        if name not in table:
            continue
        values, time = table[name].to_numpy(), table["time"].to_numpy()
        ends = np.flatnonzero(np.diff(values, append=np.nan) != 0.0)
        first = np.concatenate([[0], ends[:-1] + 1])
        k = np.argmax(time[ends] - time[first])
        if time[ends[k]] - time[first[k]] > STUCK:
            report.doubt(
                f"{name} reads {values[ends[k]]:g} from {time[first[k]]:.1f} to {time[ends[k]]:.1f} s without any change"
            )
