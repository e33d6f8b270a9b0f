"""Maps: what they say of the columns of a log, and how a wrong one is refused in one line that names the key."""

import re
import tomllib

import pandas as pd
import pytest

from study.replay.known_flight import FULL, enu, full, map_of, written
from tetherfmu.files.series import COLUMNS
from tetherfmu.runtime.inputs import INPUT_TABLE, components
from tetherfmu.study.replay import columns, log, readings

LEAST = 'kite_position = {x = "x", y = "y", z = "z"}\n'
GEODETIC = '[kite_position]\nlatitude = "a"\nlongitude = "b"\naltitude = "c"\n'


@pytest.mark.parametrize("name", columns.MAPS)
def test_maps_of_this_package_are_right(name):
    found = columns.load(name)
    assert found.name == name
    assert found.about
    assert "kite_position" in found.sources
    assert len(found.columns) == len(set(found.columns))


def test_there_are_maps_for_plain_logs_names_of_fmus_and_kitepower():
    assert {"enu", "fmu", *columns.BY_YEAR.values()} == set(columns.MAPS)


def test_the_least_map_has_a_position():
    found = columns.read(tomllib.loads(LEAST), "least")
    assert found.columns == ("time", "x", "y", "z")
    assert found.sources["kite_position"] == columns.Source(tuple(columns.Column(name, unit="m") for name in "xyz"))
    assert found.tether == columns.Tether()


def test_a_map_says_columns_signs_and_units(tmp_path):
    found = map_of(FULL, tmp_path)
    velocity = [(each.name, each.factor) for each in found.sources["kite_velocity"].numbers]
    assert velocity == [("ve", 1.0), ("vn", 1.0), ("vd", -1.0)]
    assert found.sources["kite_position"].kind == columns.GEODETIC_POINT
    assert found.origin == (52.0, 4.0, 10.0)
    assert found.sources["ground_tension"].numbers == (columns.Column("force", 9.80665),)
    assert found.tether.diameter == pytest.approx(0.010)
    assert found.tether.axial_stiffness == pytest.approx(3.8e6)
    others = {"airspeed", "wind", "wind_from"}
    assert set(found.columns) == {"time", "lat", "lon", "alt", "ve", "vn", "vd", "length", "speed", "force"} | others


AT = "[origin]\nlatitude = {}\nlongitude = {}\naltitude = {}\n"
WRONG = {  # a map, and the sentence
    "": "the table [kite_position] is missing",
    "kite_position = 3": "kite_position is 3; it must be a table [kite_position]",
    'kite_position = "x"': "kite_position is 'x'; it must be a table",
    'kite_position = {x = "x", y = "y"}': "kite_position must name one column for each axis",
    'kite_position = {x = "x", east = "e", y = "y", z = "z"}': "kite_position must name one column for each axis",
    'kite_position = {x = "x", west = "e", z = "z"}': "kite_position must name one column for each axis",
    'kite_position = {x = 1, y = "y", z = "z"}': "kite_position.x is 1; it must be the name of a column",
    'kite_position = {x = "", y = "y", z = "z"}': "kite_position.x is ''; it must be the name of a column",
    'kite_position = {x = "x", y = "y", z = "z", unit = "yd"}': "kite_position.unit is 'yd'; it must be one of m, mm",
    'kite_position = {x = "x", y = "y", z = "z", unit = ["m"]}': "kite_position.unit is ['m']; it must be one of",
    'kite_position = {x = "x", y = "y", z = "z", units = "m"}': "unknown key kite_position.units; did you mean unit?",
    '[kite_position]\nlatitude = "a"\nlongitude = "b"\n': "the key kite_position.altitude is missing",
    "kite_position = [": "",  # of tomllib
    "[" * 2000: "",
}
WRONG_IN_DEGREES = {  # behind a position in degrees
    "": "kite_position is in degrees: the table [origin] of the station is missing",
    'east = "e"\n': "unknown key kite_position.east",
    'angle = "grad"\n': "kite_position.angle is 'grad'; it must be one of deg, rad, 1e-7 deg",
    AT.format(91.0, 2.0, 3.0): "origin is [91.0, 2.0, 3.0]; it must be latitude",
    AT.format(1.0, "nan", 3.0): "origin is [1.0, nan, 3.0]; it must be",
    AT.format(1.0, 2.0, 3.0) + 'unit = "ft"\n': "unknown key origin.unit",
    AT.format(1.0, 2.0, '"h"'): "origin.latitude is 1.0; it must be the name",
    "[origin]\nlatitude = 1.0\n": "the key origin.longitude is missing",
    AT.format('"d"', '"e"', '"f"'): "origin must name one column for each axis",
}
WRONG_BEHIND = {  # behind the least map
    AT.format(1.0, 2.0, 3.0): "origin is given, but kite_position is not in degrees",
    "speed = 3": "unknown key speed; did you mean reel_out_speed?",
    "time = 3": "time is 3; it must be a table [time]",
    'time = {unit = "ms"}': "the key time.column is missing",
    'time = {column = "t", unit = "days"}': "time.unit is 'days'; it must be one of s, ms, min, h, us, ns",
    "ground_tension = []": "ground_tension.column is []; it must be the name of a column",
    'ground_tension = ["a", 3]': "ground_tension.column is 3; it must be the name of a column",
    'ground_tension = {column = "f", unit = "kg"}': "ground_tension.unit is 'kg'; it must be one of N, kN, MN, kgf, lbf",
    'tether_length = {column = "l", unit = "N"}': "tether_length.unit is 'N'; it must be one of m, mm",
    'phase = {column = "p", unit = "m"}': "unknown key phase.unit",
    'kite_velocity = {speed = "s", from = "d"}': "unknown key kite_velocity.speed",
    'wind_velocity = "wind"': "wind_velocity is 'wind'; it must be a table",
    'wind_velocity = {speed = "w"}': "the key wind_velocity.from is missing",
    'wind_velocity = {speed = "w", from = "d", angle = "turns"}': "wind_velocity.angle is 'turns'; it must be one of rad",
    'wind_velocity = {speed = "w", from = "d", x = "x"}': "unknown key wind_velocity.x",
    'optional = "airspeed"': "optional is 'airspeed'; it must be a list of some of nothing",
    'airspeed = "v"\noptional = ["time"]': "optional is ['time']; it must be a list of some of airspeed",
    'optional = ["airspeed"]': "optional is ['airspeed']; it must be a list of some of nothing",
    "[kite]\narea = -1.0": "kite.area is -1.0; it must be at least 0 m2",
    '[kite]\nend_below = "11 N"': "kite.end_below is '11 N'",
    "[station]\noutlet = 3.0": "unknown key station.outlet",
    "[smoothing]\nposition_noise = 0.0": "smoothing.position_noise is 0.0; it must be at least 0.0001 m",
    "[delay]\nground_tension = 11.0": "delay.ground_tension is 11.0",
    "[tether]\nsegments = 20": "unknown key tether.segments",
    '[tether]\ndiameter = "10 kg"': "tether.diameter is '10 kg'",
    '[environment]\nwind_profile = "steep"': "environment.wind_profile is 'steep'",
    '[ground]\ncontact = "bumpy"': "ground.contact is 'bumpy'",
    "kite = 3": "kite is 3; it must be a table [kite]",
}
WRONG |= {GEODETIC + text: said for text, said in WRONG_IN_DEGREES.items()}
WRONG |= {LEAST + text: said for text, said in WRONG_BEHIND.items()}


@pytest.mark.parametrize("text", WRONG)
def test_a_wrong_map_is_refused_in_one_line(text, tmp_path):
    with pytest.raises(columns.MapError) as raised:
        map_of(text, tmp_path, "wrong")
    message = str(raised.value)
    assert "\n" not in message
    assert "wrong.toml: " in message
    assert WRONG[text] in message


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("kitepower_2020", "there is no map kitepower_2020; did you mean kitepower_20"),
        ("nowhere.toml", r"nowhere.toml: cannot be read \(No such file or directory\)"),
    ],
)
def test_a_map_that_is_not_there_is_refused(name, sentence):
    with pytest.raises(columns.MapError, match=sentence):
        columns.load(name)


def test_a_map_may_say_the_mass_of_a_metre(tmp_path):
    """In the place of the density, for the diameter of the map; a constant that is set changes it."""
    found = map_of(LEAST + "[tether]\ndiameter = '1 mm'\nmass_per_length = '140 g/m'\n", tmp_path, "wire")
    assert found.tether.mass_per_length == pytest.approx(0.14)
    changed = found.with_constants({"tether.mass_per_length": 0.2})
    assert (changed.tether.diameter, changed.tether.mass_per_length) == (found.tether.diameter, pytest.approx(0.2))


def test_a_map_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "m.toml").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(columns.MapError, match=r"m\.toml: "):
        columns.load(tmp_path / "m.toml")


def test_constants_can_be_changed(tmp_path):
    found = map_of(FULL, tmp_path).with_constants(
        {"tether.diameter": "12 mm", "kite.area": 30.0, "smoothing.longest_gap": "5 s"}
    )
    assert found.tether.diameter == pytest.approx(0.012)
    assert found.tether.axial_stiffness == pytest.approx(3.8e6)
    assert (found.kite.area, found.smoothing.longest_gap) == (30.0, 5.0)
    assert found.sources == map_of(FULL, tmp_path).sources


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"airspeed.column": "v"}, "airspeed.column is not a constant of a map; sections are kite, station"),
        ({"diameter": 3}, "diameter is not a constant of a map"),
        ({"tether.size": 3}, "unknown key tether.size"),
        ({"tether.diameter": -1.0}, "tether.diameter is -1.0; it must be"),
    ],
)
def test_wrong_constants_are_refused(changes, sentence):
    with pytest.raises(columns.MapError, match=re.escape(sentence)):
        columns.load("enu").with_constants(changes)


OPTIONAL = ["kite_velocity", "wind_velocity", "tether_length", "reel_out_speed", "ground_tension", "airspeed"]
COLUMNS_OF = {"kite_velocity": ["vx", "vy", "vz"], "wind_velocity": ["wind_x", "wind_y", "wind_z"]}


@pytest.mark.parametrize("name", OPTIONAL)
def test_what_is_optional_may_be_missing(name, tmp_path):
    left_out = COLUMNS_OF.get(name, [name])
    read = log.read(written(tmp_path, enu(duration=10.0).drop(columns=left_out)), "enu")
    assert f"no column {left_out[0]}: the flight has no {name}" in read.report.lines
    assert not any(each.startswith(name) for each in read.table)
    assert not read.map.columns_of(name)


def test_a_part_of_an_optional_vector_is_no_vector(tmp_path):
    read = log.read(written(tmp_path, enu(duration=10.0).drop(columns="vz")), "enu")
    assert "no column vz: the flight has no kite_velocity" in read.report.lines
    assert readings.VELOCITY[0] not in read.table


def test_what_is_not_optional_must_be_there(tmp_path):
    with pytest.raises(log.LogError, match="the column force of the map own is missing; there are time, lat, lon"):
        log.read(written(tmp_path, full(duration=10.0).drop(columns="force")), map_of(FULL, tmp_path))


def test_a_wind_of_speed_and_direction_may_be_missing(tmp_path):
    found = map_of('optional = ["wind_velocity"]\n' + FULL, tmp_path)
    read = log.read(written(tmp_path, full(duration=10.0).drop(columns="wind_from")), found)
    assert "no column wind_from: the flight has no wind_velocity" in read.report.lines
    assert "wind_velocity" not in read.map.sources


def test_unused_columns_are_named(tmp_path):
    read = log.read(written(tmp_path, enu(duration=10.0).assign(pitch=1.0)), "enu")
    assert "columns that are not used: pitch" in read.report.lines


@pytest.mark.parametrize(("length", "force"), [("tether_length", "ground_tension"), ("winch_length", "winch_force")])
def test_a_log_with_the_names_of_a_series_is_read(length, force, tmp_path):
    """All names that a series of a scene may have, except those of a ground end that moves."""
    table = enu(duration=10.0).rename(columns={"tether_length": length, "ground_tension": force})
    for name, letters in {"kite_position": "xyz", **COLUMNS_OF}.items():
        table = table.rename(columns=dict(zip(letters, components(name, 3), strict=True)))
    read = log.read(written(tmp_path, table), "fmu")
    assert read.report.doubts == []
    plain = log.read(written(tmp_path, enu(duration=10.0)), "enu")
    assert read.table.equals(plain.table[read.table.columns])
    assert {*table} - {"airspeed", "phase"} <= {*COLUMNS}


def test_the_map_fmu_names_inputs_of_a_tether():
    names = {name for each in INPUT_TABLE for name in components(each.name, each.size)}
    found = columns.load("fmu")
    assert {name for source in found.sources.values() if len(source.numbers) == 3 for name in source.columns} <= names
    assert {found.sources[name].numbers[0].others[0] for name in ("tether_length", "ground_tension")} <= names


def test_the_map_of_kitepower_is_that_of_the_year():
    cells = pd.DataFrame({"time": ["1570533128.8", "1570533128.9"]})
    assert log.map_for("kitepower", cells).name == "kitepower_2019"
    with pytest.raises(ValueError, match="name its map: enu, fmu, kitepower_2019, kitepower_2023, "):
        log.map_for("kitepower", pd.DataFrame({"time": ["0.0"]}))
    with pytest.raises(ValueError, match="name its map"):
        log.map_for("kitepower", pd.DataFrame({"t": ["0.0"]}))


def test_a_ground_end_that_moves_is_doubted(tmp_path):
    table = enu(duration=10.0).rename(columns=dict(zip("xyz", components("kite_position", 3), strict=True)))
    read = log.read(written(tmp_path, table.assign(**{"ground_position[1]": 5.0})), "fmu")
    assert read.report.doubts == [
        "ground_position is not used; the outlet of the winch must stand still, and kite_position be seen from there"
    ]
