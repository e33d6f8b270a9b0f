"""The log of a flight as it was written: read, in SI units, x east, y north, z up, with what is impossible left out."""

import codecs
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
    "tether_length": 2e4,
    "reel_out_speed": 50.0,
    "ground_tension": 1e7,
    "airspeed": 150.0,
}
FLOOR = {  # a reading that is farther than this from the median of its neighbours may be a spike; and what 1 s adds to it
    **dict.fromkeys(POSITION, (5.0, 15.0)),
    **dict.fromkeys(VELOCITY, (7.0, 20.0)),
    "tether_length": (2.0, 5.0),
    "reel_out_speed": (3.0, 3.0),
}
SPIKE = 8.0  # times the typical distance from the median of the neighbours, from which on it is one
NEARBY = 1.1  # s, in which neighbours lie
NEIGHBOURS = 5, 111  # rows: fewest and most neighbours
OF_TENSION = 0.3  # of its 99th percentile: floor of a spike of the tension
STANDS_FOR_NONE = 999.0, 9999.0, 99999.0, 999999.0, 32767.0, 32768.0, 65535.0  # numbers that loggers write without a reading
ALONE = 0.1  # of such a number: if no other reading is so near to it, it is none
AWAY = 20.0  # m, from which on a position that is exactly 0 beside another one is no reading
FEWEST_ROWS = 20
COVERED = 0.5  # of the time that readings of a quantity must cover
COARSE = 3.0  # times its smallest difference: a reading that changes by less, in the median, has few digits
HELD = 0.5  # of the rows: if so many repeat the reading above, a slower sensor is held
FROZEN = 5.0  # s, from which on a reading that does not change is doubtful
AT_REST = 0.2  # m/s: a position, or a length, may stay the same below it
FASTEST = 150.0  # m/s, of a kite
FAR_FROM_USUAL = 5.0  # times the median of such differences, which a noisy receiver has in all rows
JUMP = 5.0, 5.0  # m by which a position may differ from what its velocity says from row to row, and what 1 s adds to it
LONGEST_NAMES = 400  # characters of a message about columns
COMMENT = "#"  # begins lines that are no rows


class LogError(SceneError):
    """A log that cannot be used; the message is one line with file, column, and what is wrong."""


@dataclass(frozen=True)
class Log:
    """A log in SI units, its map and what was done to it.

    `table` : DataFrame with the column `time` [s], growing, from 0 at the first row; the components of `kite_position` [m]
    and, where the log has them, of `kite_velocity`, `wind_velocity` [m/s], and `tether_length`, `reel_out_speed`,
    `ground_tension`, `airspeed`; NaN where a reading is missing; `phase`, `cycle` as texts.  `map` : without the optional
    quantities that the log does not have.  `source` : the file, for messages.  `begin` : time of the
    first row in the file [s].
    """

    table: pd.DataFrame
    map: columns.Columns
    report: Report
    source: str = ""
    begin: float = 0.0

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


def read(path, of):
    """`Log` of a CSV file; of : a `Columns`, or the name or the file of a map. LogError says in one line what is wrong."""
    path, report = Path(path), Report()
    try:
        cells = read_cells(path, report)
        found = of if isinstance(of, columns.Columns) else map_for(of, cells)
        return log_of(cells, found, report, str(path))
    except columns.MapError:
        raise
    except ValueError as error:
        raise LogError(f"{path}: {' '.join(str(error).split())}") from None


def read_cells(path, report):
    """Cells of a CSV file as texts, a DataFrame; ValueError says why there are none."""
    written = [line for line in text_of(contents_of(path)).split("\n") if line.strip()]
    lines = [line for line in written if not line.lstrip().startswith(COMMENT)]
    if len(lines) < 2:
        raise ValueError(f"has {len(lines)} lines; it must have a header row and {FEWEST_ROWS} rows at least")
    report.count("dropped", len(written) - len(lines), len(written), f"which begin with {COMMENT}")
    separator = max(",;\t", key=lines[0].count)
    lines = [line.rstrip(f"{separator} \r") for line in lines]
    options = {"sep": separator, "header": None, "dtype": str, "skipinitialspace": True, "na_filter": False}
    try:
        cells = pd.read_csv(StringIO("\n".join(lines)), on_bad_lines="skip", **options)
    except ValueError as error:
        raise ValueError(f"is no CSV file with a header row ({error})") from None
    names = cells.iloc[0].str.strip()
    if pd.to_numeric(names, errors="coerce").notna().all():
        raise ValueError("has a number in each cell of the first row; it must have the names of the columns there")
    repeated = names[names.duplicated() & (names != "")]
    if len(repeated):
        raise ValueError(f"the column {shown(repeated)} is there twice")
    report.count("dropped", len(lines) - len(cells), len(lines), "which have more cells than the header")
    cells = cells[1:].set_axis(names, axis=1).reset_index(drop=True)
    return cells if separator == "," else cells.apply(with_points)


def text_of(contents):
    """Text of the bytes of a file, lines separated by newlines; ValueError if it is none."""
    utf_16 = contents.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if b"\0" in contents and not utf_16:
        raise ValueError("is no text file (it has bytes that are 0)")
    try:
        text = contents.decode("utf-16" if utf_16 else "utf-8-sig")
    except UnicodeDecodeError:
        text = contents.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def with_points(cells):
    """Texts of a column with decimal points for commas; ValueError if it has both."""
    commas = cells.str.fullmatch(r"[-+\d]*,\d*([eE][-+]?\d+)?")
    if commas.any() and cells.str.fullmatch(r"[-+\d]*\.\d*([eE][-+]?\d+)?").any():
        raise ValueError(f"the column {shown([cells.name])} has decimal commas and points, as {cells[commas].iloc[0]!r}")
    return cells.where(~commas, cells.str.replace(",", ".", regex=False)) if commas.any() else cells


def shown(names):
    """Names of columns in words, what is printable of them and not too many."""
    text = ", ".join("".join(each for each in str(name) if each.isprintable()) for name in names)
    return text if len(text) <= LONGEST_NAMES else f"{text[:LONGEST_NAMES]}..."


def map_for(name, cells):
    """`Columns` of a map by its name; `kitepower` stands for that of the year of the log."""
    if str(name) != columns.KITEPOWER:
        return columns.load(name)
    times = pd.to_numeric(cells["time"], errors="coerce") if "time" in cells else pd.Series(dtype=float)
    year = pd.to_datetime(times, unit="s", errors="coerce").dt.year.median()
    if year not in columns.BY_YEAR:
        choices = f"{', '.join(columns.MAPS)}, or a file (.toml)"
        raise ValueError(f"has no column time of a year that Kitepower has published; name its map: {choices}")
    return columns.load(columns.BY_YEAR[year])


def log_of(cells, found, report=None, source=""):
    """`Log` of the cells of a file (texts); ValueError says what is wrong."""
    report = Report() if report is None else report
    report.say(f"map {found.name}: {found.about}" if found.about else f"map {found.name}")
    found = found.for_log(cells, report)
    missing = [name for name in found.columns if name not in cells]
    if missing:
        raise ValueError(f"the column {missing[0]} of the map {found.name} is missing; there are {shown(cells.columns)}")
    if len(cells) < FEWEST_ROWS:
        raise ValueError(f"has {len(cells)} rows; it must have at least {FEWEST_ROWS}")
    say_units(cells, found, report)
    time, kept = clock.repaired(cells, found.time.column, found.time.factor, report)
    cells, table = cells.iloc[kept], pd.DataFrame({"time": time - time[0]})
    raw = {name: numbers(cells, name, report) for name in found.columns if name != found.time.column}
    frames.convert(raw, found, table, report)
    leave_out_zeros(table, report)
    for names in (POSITION, VELOCITY, ("tether_length",), ("ground_tension",)):
        leave_out_held(table, names, found.smoothing.longest_gap, report)
    for name in table.columns.drop("time"):
        leave_out_impossible(table, name, report)
    table, found = usable(table, found, report)
    judge_frozen(table, report)
    judge_jumps(table, report)
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
    return Log(table, found, report, source, float(time[0]))


def say_units(cells, found, report):
    """A line on a second header row, which has units."""
    first = cells.iloc[0][list(found.columns)].astype(str)
    if not first.str.contains(r"^[-+.]*\d").any() and first.str.contains(r"[a-zA-Z]").any():
        report.say(f"the first row has no numbers ({shown(first)}); units are those of the map")


def numbers(cells, name, report):
    """Readings of a column, array (rows,), NaN where a cell has no number, or one that stands for none."""
    found = pd.to_numeric(cells[name], errors="coerce").to_numpy(float, copy=True)
    found[~(np.abs(found) < clock.HUGE)] = np.nan
    found[np.abs(found) < 1.0 / clock.HUGE] = 0.0
    report.count(f"left out of {name}", int(np.isnan(found).sum()), len(found), "which have no number")
    for number in STANDS_FOR_NONE:
        equal = np.abs(found) == number
        if equal.any() and not np.any(~equal & (np.abs(np.abs(found) - number) < ALONE * number)):
            report.count(
                f"left out of {name}", int(equal.sum()), len(found), f"which have {number:g}, and others nothing like it"
            )
            found[equal] = np.nan
    return found


def leave_out_zeros(table, report):
    """Put NaN for positions that are exactly 0 while the next ones are far away: no reading of a receiver yet."""
    position = table[[*POSITION]].to_numpy(copy=True)
    zero = ~position.any(axis=1)
    away = pd.Series(np.where(zero, np.nan, np.linalg.norm(position, axis=1)))
    nearest = np.fmin(away.ffill().to_numpy(), away.bfill().to_numpy())
    none = zero & (nearest > AWAY)
    report.count(
        "left out of kite_position", int(none.sum()), len(none), f"which are 0, {AWAY:g} m or more from the next one"
    )
    position[none] = np.nan
    table[[*POSITION]] = position


def runs_of(values):
    """First and last rows of the runs of the same readings, arrays (runs,); values : array (rows, columns)."""
    last = np.flatnonzero(np.append(np.any(np.diff(values, axis=0) != 0.0, axis=1), True))
    return np.concatenate([[0], last[:-1] + 1]), last


def leave_out_held(table, names, longest_gap, report):
    """Put NaN for readings that repeat the one above, if most do: a slower sensor, or receiver, whose reading is held.

    They would be late by half the time for which they are held. Runs that are longer than the longest gap [s] stay.
    """
    if names[0] not in table:
        return
    values, time = table[[*names]].to_numpy(copy=True), table["time"].to_numpy()
    first, last = runs_of(values)
    held = np.zeros(len(time), bool)
    for i, j in zip(first, last, strict=True):
        held[i + 1 : j + 1] = time[j] - time[i] <= longest_gap
    if held.mean() > HELD and not is_coarse(values):
        name = names[0].partition("[")[0]
        report.count(
            f"left out of {name}", int(held.sum()), len(held), "which repeat the reading above: a sensor that is slower"
        )
        values[held] = np.nan
        table[[*names]] = values


def is_coarse(values):
    """Whether readings, array (rows, columns), repeat because they have few digits: changes are one or two of the last."""
    for column in values.T:
        known = column[np.isfinite(column)]
        changes, differences = np.abs(np.diff(known)), np.diff(np.unique(known))
        if len(differences) and np.median(changes[changes > 0.0]) > COARSE * differences.min():
            return False
    return True


def leave_out_impossible(table, name, report):
    """Put NaN for readings that no kite has, and for spikes."""
    values, time = table[name].to_numpy(copy=True), table["time"].to_numpy()
    with np.errstate(invalid="ignore"):
        impossible = np.abs(values) > LARGEST[name]
        if name == "tether_length":
            impossible |= values <= 0.0
    leave_out(values, impossible, name, time, report, "no kite has such a one")
    there = time[np.isfinite(values)]
    step = float(np.median(np.diff(there))) if len(there) > 1 else 1.0
    leave_out(values, spikes_of(values, floor_of(name, values, step), step), name, time, report, "they stand out of others")
    table[name] = values


def leave_out(values, which, name, time, report, why):
    """Put NaN for some readings, and a line that says when the first one was."""
    if which.any():
        k = int(np.argmax(which))
        report.say(
            f"left out of {name}: {which.sum()} of {len(which)} rows, from {time[k]:.1f} s on ({values[k]:.4g}): {why}"
        )
        values[which] = np.nan


def floor_of(name, values, step):
    """Distance from the median of the neighbours below which a reading is no spike; None: spikes are not sought."""
    if name == "ground_tension":
        return OF_TENSION * np.nanpercentile(np.abs(values), 99.0) if np.isfinite(values).any() else None
    floor, grows = FLOOR.get(name, (None, 0.0))
    return floor if floor is None else floor + grows * step


def spikes_of(values, floor, step):
    """Which readings lie far from the median of their neighbours (Hampel 1974), array (rows,) of bool.

    step : time between two readings [s].  The first and the last ones have neighbours on one side only: not judged.
    """
    found, known = np.zeros(len(values), bool), np.isfinite(values)
    if floor is None:
        return found
    near = int(np.clip(round(NEARBY / step), *NEIGHBOURS)) // 2 * 2 + 1
    readings = pd.Series(values[known])
    distance = (readings - readings.rolling(near, center=True).median()).abs()
    typical = 1.4826 * distance.rolling(5 * near, center=True, min_periods=1).median()
    found[known] = distance > np.maximum(SPIKE * typical, floor)
    return found


def usable(table, found, report):
    """The table and the map without optional quantities that have too few readings; ValueError if another one has."""
    for name in [*found.vectors, *(["wind_velocity"] if found.wind_from else []), *found.scalars]:
        places = [each for each in table if each.partition("[")[0] == name]
        known = np.isfinite(table[places].to_numpy()).all(axis=1)
        if not places or is_covered(table["time"].to_numpy(), known, found.smoothing.longest_gap):
            continue
        text = (
            f"{name} has readings in {known.sum()} of {len(known)} rows, too few; check its columns "
            f"{', '.join(found.columns_of(name))}, their units{' and the origin' if name == 'kite_position' else ''}"
        )
        if name not in found.optional:
            raise ValueError(f"{text} ({'; '.join(reasons(report, (name, *found.columns_of(name))))})")
        report.doubt(f"{text}; the flight has no {name}")
        table, found = table.drop(columns=places), found.without(name)
    return table, found


def reasons(report, names):
    """Lines of a report on what was left out of some columns."""
    left_out = tuple(f"left out of {name}{end}" for name in names for end in (":", "["))
    return [line for line in report.lines if line.startswith(left_out)]


def is_covered(time, known, longest_gap):
    """Whether enough readings are known for most of the time."""
    steps = np.diff(time[known])
    return known.sum() >= FEWEST_ROWS and steps[steps <= longest_gap].sum() >= COVERED * (time[-1] - time[0])


def judge_frozen(table, report):
    """Doubt readings that stay the same to the last digit for long although something moves."""
    time = table["time"].to_numpy()
    for names in (POSITION, ("tether_length",), ("ground_tension",)):
        if names[0] not in table:
            continue
        values = table[[*names]].to_numpy()
        first, last = runs_of(values)
        frozen = np.flatnonzero(time[last] - time[first] > FROZEN)
        long = [(first[k], last[k]) for k in frozen if moves(table, names, slice(first[k], last[k] + 1))]
        if long:
            i, j = max(long, key=lambda pair: time[pair[1]] - time[pair[0]])
            name, shown_values = names[0].partition("[")[0], ", ".join(f"{each:g}" for each in values[i])
            report.doubt(f"{name} reads {shown_values} from {time[i]:.1f} to {time[j]:.1f} s without any change")


def moves(table, names, rows):
    """Whether the rest of a log contradicts, or cannot confirm, that a reading stays the same in some rows."""
    others = {POSITION: VELOCITY, ("tether_length",): ("reel_out_speed",)}.get(names, (None,))
    if others[0] in table:
        speed = np.linalg.norm(table[[*others]].to_numpy()[rows], axis=1)
        return not np.nanmean(np.append(speed, AT_REST)) < AT_REST
    if names != ("tether_length",):
        return True
    distance = np.linalg.norm(table[[*POSITION]].to_numpy()[rows], axis=1)
    return bool(np.nanmax(distance) - np.nanmin(distance) > FLOOR[POSITION[0]][0]) if np.isfinite(distance).any() else True


def judge_jumps(table, report):
    """Doubt positions between which no kite can fly, and steps of position or length that their speeds do not explain."""
    allowed = JUMP if VELOCITY[0] in table else (JUMP[0], FASTEST)
    judge_steps(table, POSITION, VELOCITY, allowed, report)
    if "reel_out_speed" in table and "tether_length" in table:
        judge_steps(table, ("tether_length",), ("reel_out_speed",), FLOOR["tether_length"], report)


def judge_steps(table, names, speeds, allowed, report):
    """Doubt steps of a reading that are longer than allowed, (m, m/s), beside what the speeds explain, if they are known."""
    table = table[["time", *names, *(name for name in speeds if name in table)]].dropna()
    steps = np.diff(table[[*names]].to_numpy(), axis=0)
    time, speed = np.diff(table["time"].to_numpy()), np.zeros((len(table), 1))
    if speeds[0] in table:
        speed = table[[*speeds]].to_numpy()
    way = np.linalg.norm(steps - 0.5 * (speed[1:] + speed[:-1]) * time[:, None], axis=1)
    jumps = np.flatnonzero(way > allowed[0] + allowed[1] * time + FAR_FROM_USUAL * np.median(way)) if len(way) else []
    if len(jumps):
        k = jumps[0]
        name, why = (
            names[0].partition("[")[0],
            f", which {speeds[0].partition('[')[0]} does not explain" * (speeds[0] in table),
        )
        at = table["time"].iloc[k]
        report.doubt(f"{name} jumps {len(jumps)} times, first by {way[k]:.3g} m at {at:.1f} s{why}")
