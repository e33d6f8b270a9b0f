"""A table in any usual form has the same numbers, for a series as for a log; units are those that the file says."""

import numpy as np
import pandas as pd
import pytest

from study.replay.known_flight import enu
from tetherfmu.files import csv_files
from tetherfmu.files.series import Series
from tetherfmu.records.paths import kite_at
from tetherfmu.study.replay import log

TIME = np.arange(0.0, 3.01, 0.25)
ELEVATION, AZIMUTH, DISTANCE = 0.5 + 0.02 * TIME, 0.1 * np.sin(TIME) - 0.2, 200.0 + 3.0 * TIME
KITE = np.stack([kite_at(*each) for each in zip(ELEVATION, AZIMUTH, DISTANCE, strict=True)])
NAMES = ["time", "kite_position[1]", "kite_position[2]", "kite_position[3]", "winch_length"]
ROWS = [[f"{cell:.6f}" for cell in row] for row in np.column_stack([TIME, KITE, DISTANCE])]
ANGLES = ("elevation", "azimuth", "distance")


def joined(separator=",", names=NAMES, rows=ROWS, more=()):
    """Text of a table; more : rows between the header and the others."""
    return "\n".join(separator.join(row) for row in [names, *more, *rows]) + "\n"


COMMAS = [[cell.replace(".", ",") for cell in row] for row in ROWS]
UNITS = ["s", "m", "m", "m", "m"]
KILOMETRES = [[row[0], *(f"{float(cell) / 1000:.9f}" for cell in row[1:])] for row in ROWS]
FORMATS = {
    "commas": joined(),
    "semicolons": joined(";"),
    "semicolons and decimal commas": joined(";", rows=COMMAS),
    "tabs": joined("\t"),
    "tabs and decimal commas": joined("\t", rows=COMMAS),
    "blanks": joined(" "),
    "aligned with blanks": joined("   ").replace("\n", "\n  "),
    "blanks and decimal commas": joined(" ", rows=COMMAS),
    "quotes": joined(names=[f'"{each}"' for each in NAMES], rows=[[f'"{each}"' for each in row] for row in ROWS]),
    "quoted names with blanks between": joined(" ", [f'"{each}"' for each in NAMES]),
    "comments": "# a logger\n" + joined() + "# end\n",
    "empty lines": joined().replace("\n", "\n\n"),
    "separators at the ends of lines": joined().replace("\n", ",,\n"),
    "carriage returns": joined().replace("\n", "\r"),
    "UTF-16": ("\ufeff" + joined("\t")).encode("utf-16-le"),
    "a byte order mark": b"\xef\xbb\xbf" + joined().encode(),
    "Latin-1": ("# 20 °C\n" + joined()).encode("latin-1"),
    "a row of units": joined(more=[UNITS]),
    "a row of units in brackets": joined(more=[[f"[{each}]" for each in UNITS]]),
    "a row of km": joined(rows=KILOMETRES, more=[["s", "km", "km", "km", "km"]]),
    "km in the header": joined(names=["time [s]", *(f"{each} [km]" for each in NAMES[1:])], rows=KILOMETRES),
    "ms in the header": joined(
        names=["time (ms)", *NAMES[1:]], rows=[[f"{1000 * float(row[0]):.0f}", *row[1:]] for row in ROWS]
    ),
}


def series_of(folder, contents):
    """`Series` of a file."""
    place = folder / "flight.csv"
    place.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
    return Series(place)


def assert_is_the_flight(found):
    """Positions and first length are those of `ROWS`, to their last digit."""
    np.testing.assert_allclose(found.motion(TIME).kite, KITE, rtol=0, atol=2e-6)
    assert found.initial_length == pytest.approx(DISTANCE[0], abs=1e-6)


@pytest.mark.parametrize("kind", FORMATS)
def test_a_series_is_the_same_in_another_form(kind, tmp_path):
    assert_is_the_flight(series_of(tmp_path, FORMATS[kind]))


def angles(names, factors, more=()):
    """Text of a table with elevation, azimuth and distance instead of a position, in other units."""
    numbers = np.column_stack([TIME, *(each / f for each, f in zip((ELEVATION, AZIMUTH, DISTANCE), factors, strict=True))])
    rows = [[f"{cell:.12g}" for cell in row] for row in np.column_stack([numbers, DISTANCE])]
    return joined(names=["time", *names, "winch_length"], rows=rows, more=more)


DEGREE = np.pi / 180.0
OF_ANGLES = {
    "rad": angles(ANGLES, (1.0, 1.0, 1.0)),
    "degrees by the name": angles(("elevation_deg", "azimuth_deg", "distance"), (DEGREE, DEGREE, 1.0)),
    "degrees in brackets": angles(("elevation [deg]", "azimuth (deg)", "distance [km]"), (DEGREE, DEGREE, 1000.0)),
    "one of both": angles(("elevation_deg", "azimuth_rad", "distance"), (DEGREE, 1.0, 1.0)),
    "degrees by the row": angles(ANGLES, (DEGREE, DEGREE, 0.3048), [["s", "deg", "deg", "ft", "-"]]),
}


@pytest.mark.parametrize("kind", OF_ANGLES)
def test_elevation_azimuth_and_distance_are_a_position(kind, tmp_path):
    """x = d cos(elevation) cos(azimuth), y = d cos(elevation) sin(azimuth), z = d sin(elevation): that of `kite_at`."""
    assert_is_the_flight(series_of(tmp_path, OF_ANGLES[kind]))


@pytest.mark.parametrize("map_name", ["enu", "fmu"])
@pytest.mark.parametrize("unit", ["_deg", " [deg]", ""])
def test_a_log_may_have_angles_too(unit, map_name, tmp_path):
    """The same positions, with the same units by the same rules; the report says so."""
    table = enu(duration=12.0)
    right = log.read(written(tmp_path, table), "enu").table
    distance = np.linalg.norm(table[["x", "y", "z"]], axis=1)
    factor = DEGREE if unit else 1.0
    seen = table.drop(columns=["x", "y", "z"]).assign(
        **{
            f"elevation{unit}": np.arcsin(table["z"] / distance) / factor,
            f"azimuth{unit}": np.arctan2(table["y"], table["x"]),
        }
    )
    seen[f"azimuth{unit}"] /= factor
    read = log.read(written(tmp_path, seen.assign(distance=distance)), map_name)
    names = [f"kite_position[{i}]" for i in (1, 2, 3)]
    np.testing.assert_allclose(read.table[names], right[names], rtol=0, atol=1e-6)
    assert f"kite_position is that of elevation, azimuth and distance: elevation{unit}, " in str(read.report)
    assert ("units of the log: elevation" in str(read.report)) == bool(unit)


def written(folder, table):
    """Path of a DataFrame as a file."""
    table.to_csv(folder / "log.csv", index=False)
    return folder / "log.csv"


def test_units_of_a_log_count_where_the_map_has_none(tmp_path):
    """kgf in the header, ft in the row below; the map `own` says N of the same column, and that is reported."""
    table = enu(duration=12.0)
    right = log.read(written(tmp_path, table), "enu").table
    table["ground_tension"] /= 9.80665
    table["tether_length"] /= 0.3048
    table = table.rename(columns={"ground_tension": "ground_tension [kgf]"})
    units = pd.DataFrame([["ft" if name == "tether_length" else "-" for name in table]], columns=table.columns)
    path = written(tmp_path, pd.concat([units, table.astype(object)]))
    found = log.read(path, "enu")
    np.testing.assert_allclose(found.table[["ground_tension", "tether_length"]], right[["ground_tension", "tether_length"]])
    assert "units of the log: tether_length in ft, ground_tension [kgf] in kgf" in str(found.report)
    own = tmp_path / "own.toml"
    own.write_text('[kite_position]\nx = "x"\ny = "y"\nz = "z"\n[ground_tension]\ncolumn = "ground_tension"\nunit = "N"\n')
    mapped = log.read(path, own)
    np.testing.assert_allclose(mapped.table["ground_tension"], right["ground_tension"] / 9.80665)
    assert "units are those of the map, not kgf of ground_tension [kgf]" in str(mapped.report)


WRONG = {
    "an unknown unit": (
        joined(more=[["s", "m", "m", "m", "yard"]]),
        "the unit of winch_length is 'yard'; it must be one of m, ",
    ),
    "a unit of something else": (
        joined(names=["time", *NAMES[1:4], "winch_length [s]"]),
        "winch_length [s] is 's'; it must",
    ),
    "more cells than names": (joined(rows=[*ROWS[:3], [*ROWS[3], "1"]]), "row 5 has more cells than the header"),
    "more cells below units": (joined(more=[["#", "no", "row"], UNITS], rows=[[*ROWS[0], "1"]]), "row 4 has more cells"),
    "fewer cells than names": (joined(rows=[*ROWS[:3], ROWS[3][:-1]]), "row 5, column winch_length has no number"),
    "a quote that does not end": (joined().replace("0.250000", '"0.250000'), "row 3, column time has no number"),
    "only numbers": (joined(names=ROWS[0]), "has a number in each cell of the first row"),
    "commas in both places": (joined(";", rows=[COMMAS[0], *ROWS[1:]]), "time has decimal commas and points, as '0,000000'"),
    "degrees taken for rad": (
        angles(ANGLES, (DEGREE, DEGREE, 1.0)),
        "elevation is 30.37 rad in the middle, at most 1.57 rad",
    ),
    "angles without a distance": (joined(names=["time", "elevation", "azimuth", "winch_length", ""]), "distance is missing"),
    "angles and a position": (
        joined(names=[*NAMES, *ANGLES], rows=[[*row, "0.5", "0", "200"] for row in ROWS]),
        "has columns of kite_position and azimuth, distance, elevation; it must have one of both",
    ),
    "half of UTF-16": (("\ufeff" + joined()).encode("utf-16-le")[:-1], "is not a text file"),
    "a misspelt name": (joined(names=[NAMES[0], "kite_positon[1]", *NAMES[2:]]), "release; did you mean kite_position[1]?"),
    "half a release": (joined(names=[*NAMES[:4], "release"]), "row 2, column release is 200; it must be 0 or 1"),
    "bytes": (bytes(range(256)) * 4, "is not a text file"),
    "one column": ("time\n" + "1\n" * 9, "the column kite_position[1] is missing"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_no_series_is_told_in_one_line(kind, tmp_path):
    contents, says = WRONG[kind]
    with pytest.raises(ValueError, match=r"flight\.csv: ") as raised:
        series_of(tmp_path, contents)
    assert says in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (["s", "m"], ["0.0", "1"], True),
        (["s", "1"], ["0.0", "1"], True),
        (["[s]", ""], ["0.0", "1"], True),
        (["nan", "NaN"], ["0.0", "1"], False),
        (["", "-"], ["0.0", "1"], False),
        (["0", "m"], ["0.0", "1"], False),
        (["s", "m"], ["x", "y"], False),
        (["s", "m"], [], False),
    ],
)
def test_which_row_has_units(first, second, expected):
    assert csv_files.is_row_of_units(first, second) == expected
