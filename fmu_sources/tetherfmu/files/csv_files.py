"""Tables that users write: CSV files with any usual separator, decimal sign and encoding, and with units."""

import codecs
import csv
import re
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from tetherfmu.records.paths import polar

from .toml_files import factors

SEPARATORS = ",;\t"  # or blanks, if the header contains no separator
COMMENT = "#"  # begins lines that are no rows
NUMBER = re.compile(r"[-+]?[.,]?\d")  # begins a number, a date or a time
NO_READING = ("nan", "inf", "none", "null", "na", "n/a")  # placeholders of loggers: neither a number nor a unit
NO_UNIT = ("", "-", "1")  # below the name of a column without one
HEADER = re.compile(r"(?P<name>.+?)(?:\s*[\[(]\s*(?P<unit>[^\d\s\])][^\])]*?)\s*[\])]|_(?P<angle>deg|rad))")
LONGEST_NAMES = 400  # characters of a message about columns
ANGLES = ("elevation", "azimuth", "distance")  # alternatives to a position
UNITS_OF_ANGLES = ("rad", "rad", "m")
LARGEST_ANGLES = 0.5 * np.pi, 2.0 * np.pi  # rad, of elevation and azimuth


@dataclass(frozen=True)
class Table:
    """A table as it was written.

    `cells` : DataFrame of texts by the names in the header; its index is the row in the file, 1 for the first line.
    `units` : units in the row below the header, dict by column; {} without such a row.  `comments` : number of
    lines that begin with `COMMENT`.  `broken` : omitted rows with more cells than the header.
    """

    cells: pd.DataFrame
    units: dict = field(default_factory=dict)
    comments: int = 0
    broken: tuple = ()

    def column(self, name):
        """The column with this name, or the only one with a unit after it, as "time [ms]"; None if there is none."""
        if name in self.cells:
            return name
        found = [each for each in self.cells if split(each)[0] == name]
        return found[0] if len(found) == 1 else None

    def unit(self, column):
        """Unit of a column from the header or the row below it; "" if there is none."""
        below = self.units.get(column, "").strip("[]() ")
        return split(column)[1] or ("" if below in NO_UNIT else below)

    def numbers(self, column, unit=None):
        """Numbers of a column in a unit, NaN for other cells, array (rows,); unit None: as they are written."""
        found = pd.to_numeric(self.cells[column], errors="coerce").to_numpy(float)
        return found if unit is None else found * factor(self.unit(column), unit, column)


def read(contents, fewest):
    """`Table` from the bytes of a file; ValueError describes a problem in one line.  fewest : required rows."""
    numbered = [(row, line) for row, line in enumerate(text_of(contents).split("\n"), 1) if line.strip()]
    lines = [(row, line) for row, line in numbered if not line.lstrip().startswith(COMMENT)]
    comments = len(numbered) - len(lines)
    if len(lines) < 2:
        raise ValueError(f"has {len(lines)} lines; it must have a header row and at least {fewest} rows")
    separator = max(SEPARATORS, key=lines[0][1].count)
    separator = separator if separator in lines[0][1] else None
    names, units, rows, places, broken = cells_of(lines[0][1], separator), {}, [], [], []
    refuse_names(names)
    first = [cells_of(line, separator) for _, line in lines[1:3]]
    if is_row_of_units(*first):
        units = dict(zip(names, first[0], strict=False))
    for row, line in lines[2 if units else 1 :]:
        cells = cells_of(line, separator)
        if len(cells) > len(names):
            broken.append(row)
            continue
        rows.append(cells + [""] * (len(names) - len(cells)))
        places.append(row)
    cells = pd.DataFrame(rows, places, names, dtype=str)
    return Table(cells if separator == "," else cells.apply(with_points), units, comments, tuple(broken))


def text_of(contents):
    """Text from the bytes of a file, lines separated by newlines; ValueError if it is not text."""
    utf_16 = contents.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if b"\0" in contents and not utf_16:
        raise ValueError("is not a text file (it contains zero bytes)")
    try:
        text = contents.decode("utf-16" if utf_16 else "utf-8-sig")
    except UnicodeDecodeError:
        if utf_16:
            raise ValueError("is not a text file (it begins like UTF-16, but is not valid)") from None
        text = contents.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def cells_of(line, separator):
    """Cells of a line, a list of texts without blanks around them, without empty ones at its end; separator None: blanks."""
    if '"' in line:
        try:
            (cells,) = csv.reader([line.strip()], delimiter=separator or " ", skipinitialspace=True)
        except csv.Error:  # a cell that is too long for any number
            cells = []
    else:
        cells = line.split(separator)
    if " " in line:
        cells = [each.strip() for each in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def refuse_names(names):
    """ValueError unless a header names its columns, each once."""
    if all(NUMBER.match(each) for each in names):
        raise ValueError("has a number in each cell of the first row; it must have the names of the columns there")
    if repeated := [each for each in dict.fromkeys(names) if each and names.count(each) > 1]:
        raise ValueError(f"the column {shown(repeated)} appears twice")


def is_row_of_units(first, second=()):
    """Whether the cells of the first row below a header are units of the numbers in the second one."""
    beside = [cell for cell, below in zip(first, second, strict=False) if NUMBER.match(below) and cell != "1"]
    words = [cell for cell in beside if re.search("[a-zA-Z]", cell) and cell.lower().lstrip("+-") not in NO_READING]
    return bool(words) and not any(NUMBER.match(cell) for cell in beside)


def with_points(cells):
    """Texts of a column with decimal points for commas; ValueError if it has both."""
    commas = cells.str.fullmatch(r"[-+\d]*,\d*([eE][-+]?\d+)?")
    if commas.any() and cells.str.fullmatch(r"[-+\d]*\.\d*([eE][-+]?\d+)?").any():
        raise ValueError(f"the column {shown([cells.name])} has decimal commas and points, as {cells[commas].iloc[0]!r}")
    return cells.where(~commas, cells.str.replace(",", ".", regex=False)) if commas.any() else cells


def shown(names):
    """Names of columns in words, printable characters and a limited number only."""
    text = ", ".join("".join(each for each in str(name) if each.isprintable()) for name in names)
    return text if len(text) <= LONGEST_NAMES else f"{text[:LONGEST_NAMES]}..."


def split(header):
    """Name and unit of a column, as of "time [ms]", "speed (km/h)" or "elevation_deg"; the unit "" if it has none."""
    found = HEADER.fullmatch(header)
    return (found["name"], found["unit"] or found["angle"]) if found else (header, "")


def factor(spelled, unit, column):
    """Factor from the unit of a column to the quantity's unit; ValueError for other dimensions."""
    known = factors(unit)
    if (spelled or unit) not in known:
        raise ValueError(f"the unit of {shown([column])} is {spelled!r}; it must be one of {', '.join(known)}")
    return known[spelled or unit]


def curve(times, values, rates=None):
    """A C2 spline through rows of a file, or with their rates a cubic curve."""
    from scipy.interpolate import CubicHermiteSpline, CubicSpline  # slow to import

    return CubicSpline(times, values) if rates is None else CubicHermiteSpline(times, values, rates)


def from_angles(numbers):
    """Positions [m], array (rows, 3), from elevation and azimuth [rad] and distance [m], defined as in `kite_at`.

    ValueError if most of the angles are not plausible in rad.
    """
    for name, angles, most in zip(ANGLES, numbers.T, LARGEST_ANGLES, strict=False):
        known = angles[np.isfinite(angles)]
        if len(known) and np.median(np.abs(known)) > most:
            raise ValueError(
                f"{name} is {np.median(known):.4g} rad in the middle, at most {most:.3g} rad is possible; degrees are "
                f"those of a column {name}_deg or {name} [deg], or with deg in a row below the header"
            )
    elevation, azimuth, distance = numbers.T
    return np.column_stack(polar(distance, elevation, azimuth))
