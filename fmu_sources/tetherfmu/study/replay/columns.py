"""Meaning of the columns of a log: maps, files in TOML; see docs/use/your_log.md, "Maps"."""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tetherfmu.files import csv_files
from tetherfmu.files.scene_files import NOT_OF_A_SCENE, RECORDS, SceneError
from tetherfmu.files.toml_files import GROUND, factors, ground_of, record, require, tables_of
from tetherfmu.runtime.naming import meant_or_all, prefixed
from tetherfmu.runtime.parameters import SCALED, Environment, Ground, Tether, changed
from tetherfmu.runtime.quantities import check, quantity

MAPS = {path.stem: path for path in sorted(Path(__file__).parent.glob("*.toml"))}  # that this package has
BY_YEAR = {2019: "kitepower_2019", 2023: "kitepower_2023", 2025: "kitepower_2025"}  # of the first row of a log
KITEPOWER = "kitepower"  # common name of these
AXES = {"east": (0, 1.0), "x": (0, 1.0), "west": (0, -1.0)}  # of a column: its axis, and its sign along it
AXES |= {"north": (1, 1.0), "y": (1, 1.0), "south": (1, -1.0), "up": (2, 1.0), "z": (2, 1.0), "down": (2, -1.0)}
GEODETIC = ("latitude", "longitude", "altitude")
POINTS, SPEEDS = ("kite_position", "origin"), ("kite_velocity", "wind_velocity")
SCALARS = {"tether_length": "m", "reel_out_speed": "m/s", "ground_tension": "N", "airspeed": "m/s"}  # and their units
LABELS = ("phase", "cycle")
PLAIN, GEODETIC_POINT, FROM_ANGLES, WIND_FROM = "plain", "geodetic", "from angles", "wind from"  # kinds of numbers
MAY_MISS = ("kite_velocity", "wind_velocity", *SCALARS)  # quantities that a map may declare optional
SMALL_TIMES = {"us": 1e-6, "ns": 1e-9}  # units of time that only logs have, and the factor to s
ANGLES = {"deg": 1.0, "rad": math.degrees(1.0), "1e-7 deg": 1e-7}  # of geodetic coordinates, and the factor to deg


class MapError(SceneError):
    """An unusable map; the message is one line with file, key, value and the permitted values."""


@dataclass(frozen=True)
class Kite:
    """The kite, and where its sensor sits."""

    end_below: float = quantity(
        0.0, "m", "distance of the tether end from the logged position, towards the station", -100.0, 100.0
    )
    area: float = quantity(0.0, "m2", "projected area, to check the tension; 0: unknown", 0.0, 1e5)
    __post_init__ = check


@dataclass(frozen=True)
class Station:
    """The ground station: where the tether leaves the winch, seen from the origin, and the rope inside."""

    outlet_east: float = quantity(0.0, "m", "winch outlet, distance east of the origin", -1e4, 1e4)
    outlet_north: float = quantity(0.0, "m", "winch outlet, distance north of the origin", -1e4, 1e4)
    outlet_up: float = quantity(0.0, "m", "winch outlet, height above the origin: the height of a mast", -1e4, 1e4)
    drum_to_outlet: float = quantity(0.0, "m", "tether length from drum to outlet, included in the logged length", -1e4, 1e4)
    length_offset: float = quantity(0.0, "m", "correction to add to the logged length, if known", -1e4, 1e4)
    __post_init__ = check

    @property
    def outlet(self):
        """Where the tether leaves the winch [m], x east, y north, z up."""
        return self.outlet_east, self.outlet_north, self.outlet_up

    def length_outside(self, logged):
        """Unstretched length [m] from the outlet to the kite, of a logged one."""
        return logged - self.drum_to_outlet + self.length_offset


@dataclass(frozen=True)
class Smoothing:
    """Noise levels that the smoother assumes."""

    position_noise: float = quantity(1.0, "m", "standard deviation of a logged position", 1e-4, 1e3)
    velocity_noise: float = quantity(0.2, "m/s", "standard deviation of a logged velocity", 1e-4, 1e2)
    acceleration_change: float = quantity(5.0, "m/s2", "typical change of the kite's acceleration in 1 s", 1e-3, 1e3)
    wind_mean: float = quantity(30.0, "s", "averaging time of the wind", 0.0, 1e4)
    longest_gap: float = quantity(2.0, "s", "longest bridged time without data", 0.0, 1e3)
    __post_init__ = check


@dataclass(frozen=True)
class Delay:
    """Latency of a quantity relative to the other channels of the log [s]."""

    kite_position: float = quantity(0.0, "s", "latency of the position", -10.0, 10.0)
    kite_velocity: float = quantity(0.0, "s", "latency of the velocity", -10.0, 10.0)
    tether_length: float = quantity(0.0, "s", "latency of the length", -10.0, 10.0)
    reel_out_speed: float = quantity(0.0, "s", "latency of the reel-out speed", -10.0, 10.0)
    ground_tension: float = quantity(0.0, "s", "latency of the tension", -10.0, 10.0)
    __post_init__ = check


OWN = {"kite": Kite, "station": Station, "smoothing": Smoothing, "delay": Delay}
OF_SCENES = ("tether", "environment", "ground")


@dataclass(frozen=True)
class Column:
    """Column of a number, and the factor to its unit; `others` are alternatives, the first one in a log counts.

    `unit` : of the number, if the log may specify another one; "" if the map specifies it.
    """

    name: str
    factor: float = 1.0
    others: tuple = ()
    unit: str = ""

    def among(self, table):
        """The same number in the first of its columns in a `csv_files.Table`; its first one if it has none."""
        found = next(filter(None, map(table.column, (self.name, *self.others))), self.name)
        return replace(self, name=found, factor=self.factor * self.units.get(table.unit(found), 1.0))

    @property
    def units(self):
        """Units that a log may specify, and their factors, a dict."""
        return factors(self.unit) | (SMALL_TIMES if self.unit == "s" else {}) if self.unit else {}


@dataclass(frozen=True)
class Source:
    """Columns of a quantity in a log: a `Column` for each component, and the kind of these numbers.

    PLAIN : a scalar, or a vector x east, y north, z up.  GEODETIC_POINT : latitude, longitude [deg], altitude [m].
    FROM_ANGLES : elevation, azimuth [rad] and distance [m], see `csv_files.from_angles`.
    WIND_FROM : the speed of the wind [m/s], and the direction from which it blows [rad, clockwise from north].
    `instead` : a `Source` for logs with its columns only.
    """

    numbers: tuple
    kind: str = PLAIN
    instead: Any = None

    @property
    def columns(self):
        """Names of its columns."""
        return tuple(each.name for each in self.numbers)

    def among(self, table):
        """The same quantity with the columns of each number in a `csv_files.Table`."""
        found = replace(self, numbers=tuple(each.among(table) for each in self.numbers))
        other = self.instead.among(table) if self.instead else found
        is_there = [all(name in table.cells for name in each.columns) for each in (found, other)]
        return other if is_there == [False, True] else found

    def read(self, raw):
        """Its numbers, array (rows, numbers); raw : dict from a column of the log to its readings."""
        return np.column_stack([raw[each.name] * each.factor for each in self.numbers])


@dataclass(frozen=True)
class Columns:
    """A map: meaning of the columns of a log, and the constants of the flight.

    `sources` : dict from a name of the interface to its `Source`.  `labels` : dict "phase", "cycle" to a column.  `origin` :
    the station in geodetic coordinates (deg, deg, m), or the `Source` pair (geodetic, in metres) of one receiver; None:
    positions are relative to the station.  `optional` : quantities that a log may lack.  `names_tether` : whether it
    describes the tether of the flight.
    """

    name: str
    about: str = ""
    time: Column = Column("time")
    sources: dict = field(default_factory=dict)
    labels: dict = field(default_factory=dict)
    origin: tuple | None = None
    optional: tuple = ()
    tether: Tether = field(default_factory=Tether)
    names_tether: bool = False
    environment: Environment = field(default_factory=Environment)
    ground: Ground = field(default_factory=Ground)
    kite: Kite = field(default_factory=Kite)
    station: Station = field(default_factory=Station)
    smoothing: Smoothing = field(default_factory=Smoothing)
    delay: Delay = field(default_factory=Delay)

    @property
    def columns(self):
        """Names of all columns that a log must have, except labels."""
        of_origin = [each for each in self.origin or () if isinstance(each, Source)]
        listed = [name for source in (*self.sources.values(), *of_origin) for name in source.columns]
        return tuple(dict.fromkeys([self.time.name, *listed]))

    @property
    def weight(self):
        """Weight of a metre of tether [N/m]."""
        return self.tether.mass_per_length * self.environment.gravity

    def columns_of(self, name):
        """Names of the columns of a quantity, () if the map does not have it."""
        return self.sources[name].columns if name in self.sources else ()

    def without(self, name):
        """The map without a quantity."""
        return replace(self, sources={key: each for key, each in self.sources.items() if key != name})

    def for_log(self, table, report):
        """The map for a `csv_files.Table`: without optional quantities that it lacks, in its units."""
        sources = {name: each.among(table) for name, each in self.sources.items()}
        found = replace(self, time=self.time.among(table), sources=sources)
        for name in self.optional:
            missing = [column for column in found.columns_of(name) if column not in table.cells]
            if missing:
                report.say(f"no column {missing[0]}: the flight has no {name}")
                found = found.without(name)
        numbers = [found.time, *(each for source in found.sources.values() for each in source.numbers)]
        said = {each.name: table.unit(each.name) for each in numbers if table.unit(each.name)}
        taken = [each.name for each in numbers if said.get(each.name) in each.units]
        if taken:
            report.say(f"units of the log: {csv_files.shown(f'{each} in {said[each]}' for each in taken)}")
        if others := [each for each in said if each not in taken]:
            report.say(f"units are those of the map, not {csv_files.shown(f'{said[each]} of {each}' for each in others)}")
        return found

    def with_constants(self, changes):
        """The map with other constants; changes : dict "section.key" to a value as in a file. MapError names a key."""
        records = {}
        for key, value in changes.items():
            section, _, name = key.partition(".")
            if section not in (known := (*OWN, *OF_SCENES)):
                raise MapError(f"{key} is not a constant of a map{meant_or_all(section, known, 'sections are {}')}")
            records.setdefault(section, {})[name] = value
        with prefixed("", MapError):
            return replace(self, **read_records(records, self))


def load(name):
    """`Columns` of a map of this package, by name, or of a file; MapError describes a problem in one line."""
    path = MAPS.get(str(name), Path(name))
    if path not in MAPS.values() and path.suffix != ".toml":
        known = [KITEPOWER, *MAPS]
        raise MapError(f"there is no map {name}{meant_or_all(str(name), known, 'it must be one of {}, or a file (.toml)')}")
    try:
        return read(tables_of(path), path.stem)
    except ValueError as error:
        raise MapError(f"{path}: {' '.join(str(error).split())}") from None


def read(table, name):
    """`Columns` from the table of a file; ValueError names the key."""
    vectors = (*POINTS, *SPEEDS)
    require(table, "", ("about", "optional", "time", *vectors, *SCALARS, *LABELS, *OWN, *OF_SCENES), ())
    found = {"name": name, "about": str(table.get("about", "")), "optional": optional(table.get("optional", []), table)}
    found["time"] = number(table.get("time", {"column": "time"}), "time", "s", SMALL_TIMES)
    scalars = {key: Source((number(table[key], key, unit),)) for key, unit in SCALARS.items() if key in table}
    found["labels"] = {key: number(table[key], key, None).name for key in LABELS if key in table}
    found["sources"] = {key: vector(table[key], key) for key in vectors if key in table and key != "origin"} | scalars
    if "kite_position" not in found["sources"]:
        raise ValueError("the table [kite_position] is missing")
    if found["sources"]["kite_position"].kind == GEODETIC_POINT:
        if "origin" not in table:
            raise ValueError("kite_position is in degrees: the table [origin] of the station is missing")
        found["origin"] = origin(table["origin"])
    elif "origin" in table:
        raise ValueError("origin is given, but kite_position is not in degrees; station.outlet_east, ... move the station")
    return Columns(**found, **read_records(table, Columns(name)))


def read_records(table, base):
    """Records of the constants of a map, dict by section: `base` with the changes in a table of a file."""
    kinds = OWN | {section: RECORDS[section] for section in OF_SCENES}
    found = {section: given(kind, table, section) for section, kind in kinds.items()}
    whole = vars(ground_of(RECORDS["ground"](**found["ground"]), Environment()))
    found["ground"] = {GROUND + name: whole[GROUND + name] for name in found["ground"]}
    if "diameter" in found["tether"]:
        found["tether"] = own_stiffness(base.tether) | found["tether"]
    records = {section: changed(getattr(base, section), values) for section, values in found.items()}
    return records | {"names_tether": base.names_tether or bool(found["tether"])}


def own_stiffness(tether):
    """Stiffness and damping of the tether of a map, dict, unless they are those of the default material."""
    default = Tether(diameter=tether.diameter)
    return {name: getattr(tether, name) for name in SCALED if getattr(tether, name) != getattr(default, name)}


def given(kind, table, section):
    """Values from a table of a file for a record, dict by name; ValueError names the key."""
    if section not in table:
        return {}
    made = record(kind, table[section], section, left_out=NOT_OF_A_SCENE)
    return {name: getattr(made, name) for name in table[section]}


def text_of(table, section, key):
    """Name of a column; ValueError if it is not a text."""
    value = table[key]
    if not isinstance(value, str) or not value:
        raise ValueError(f"{section}.{key} is {value!r}; it must be the name of a column")
    return value


def optional(names, table):
    """Names of the quantities of a map that a log need not have, a tuple; ValueError if one cannot be missed."""
    allowed = [name for name in MAY_MISS if name in table]
    if not isinstance(names, list) or any(name not in allowed for name in names):
        raise ValueError(f"optional is {names!r}; it must be a list of some of {', '.join(allowed) or 'nothing'}")
    return tuple(names)


def factor_of(table, section, unit, key="unit", more=None):
    """Factor from the unit in a table to the unit of its quantity; ValueError names the permitted units."""
    spelled = table.get(key, unit)
    known = factors(unit) | (more or {})
    if not isinstance(spelled, str) or spelled not in known:
        raise ValueError(f"{section}.{key} is {spelled!r}; it must be one of {', '.join(known)}")
    return known[spelled]


def number(table, section, unit, more=None):
    """`Column` of a table {column, unit}, or of a column; unit : of the quantity, None for texts; more : units.

    From a list of columns, the first one in a log counts.
    """
    table = {"column": table} if isinstance(table, str | list) else table
    require(table, section, ("column", "unit") if unit else ("column",))
    if "column" not in table:
        raise ValueError(f"the key {section}.column is missing")
    return among(table, section, "column", unit, more=more)


def among(table, section, key, unit, named="unit", more=None, factor=1.0):
    """`Column` of a column, or of a list of columns, under a key of a table.

    unit : of the number, None for texts.  named : the key of another one.  more : units.  factor : additional factor.
    """
    listed = table[key] if isinstance(table[key], list) and table[key] else [table[key]]
    name, *others = (text_of({key: each}, section, key) for each in listed)
    if unit is None or named not in table:
        return Column(name, factor, tuple(others), unit or "")
    return Column(name, factor * factor_of(table, section, unit, named, more), tuple(others))


def wind(table, section):
    """`Source` of a wind from its speed and the direction from which it blows."""
    require(table, section, ("speed", "from", "unit", "angle"))
    if "from" not in table:
        raise ValueError(f"the key {section}.from is missing: the column of the direction from which the wind comes")
    direction = among({"angle": "deg"} | table, section, "from", "rad", "angle")
    return Source((among(table, section, "speed", "m/s"), direction), WIND_FROM)


def vector(table, section):
    """`Source` of a table with a column for each axis, or for geodetic coordinates, angles, or a wind."""
    if section == "wind_velocity" and "speed" in table:
        return wind(table, section)
    unit = "m" if section in POINTS else "m/s"
    of_points = (*GEODETIC, "angle") if section in POINTS else ()
    require(table, section, (*AXES, *of_points, *(csv_files.ANGLES if section == "kite_position" else ()), "unit"))
    if any(key in table for key in GEODETIC):
        require(table, section, (*GEODETIC, "angle", "unit"), GEODETIC)
        angle = factor_of(table, section, "deg", "angle", ANGLES)
        height = factor_of(table, section, unit)
        factors_of = zip(GEODETIC, (angle, angle, height), strict=True)
        return Source(tuple(Column(text_of(table, section, key), each) for key, each in factors_of), GEODETIC_POINT)
    angles = None
    if any(key in table for key in csv_files.ANGLES):
        require(table, section, table, csv_files.ANGLES)
        elevation, azimuth = (among(table, section, key, "rad", "angle") for key in csv_files.ANGLES[:2])
        angles = Source((elevation, azimuth, among(table, section, csv_files.ANGLES[2], unit)), FROM_ANGLES)
    axes = {AXES[key][0]: among(table, section, key, unit, factor=AXES[key][1]) for key in table if key in AXES}
    if angles and not axes:
        return angles
    if len(axes) != 3 or sum(key in AXES for key in table) != 3:
        raise ValueError(f"{section} must name one column for each axis: east or x, north or y, up or down or z")
    return Source(tuple(axes[k] for k in range(3)), instead=angles)


def origin(table):
    """The station: three numbers (deg, deg, m), or the two `Source` of a receiver that is logged in degrees and metres."""
    section = "origin"
    require(table, section, (*GEODETIC, *AXES, "angle", "unit"), GEODETIC)
    values = [table[key] for key in GEODETIC]
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        require(table, section, GEODETIC)
        latitude, longitude, altitude = map(float, values)
        if not (abs(latitude) < 90.0 and abs(longitude) <= 360.0 and abs(altitude) <= 1e4):
            raise ValueError(f"origin is {values}; it must be latitude and longitude in deg, altitude in m")
        return latitude, longitude, altitude
    degrees = {key: value for key, value in table.items() if key in (*GEODETIC, "angle")}
    metres = {key: value for key, value in table.items() if key in (*AXES, "unit")}
    return vector(degrees, section), vector(metres, section)
