"""Which column of a log is what: maps, files in TOML; see docs/use/your_log.md, "Maps"."""

import math
import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path

from tetherfmu.input_files import contents_of, factors, ground_of, record, require
from tetherfmu.runtime.parameters import Environment, Ground, Tether
from tetherfmu.runtime.quantities import check, quantity
from tetherfmu.study.scenes.files import NOT_OF_A_SCENE, RECORDS, SceneError

MAPS = {path.stem: path for path in sorted(Path(__file__).parent.glob("*.toml"))}  # that this package has
BY_YEAR = {2019: "kitepower_2019", 2023: "kitepower_2023", 2025: "kitepower_2025"}  # of the first row of a log
KITEPOWER = "kitepower"  # stands for them
AXES = {  # of a column: its axis, and its sign along it
    "east": (0, 1.0),
    "x": (0, 1.0),
    "west": (0, -1.0),
    "north": (1, 1.0),
    "y": (1, 1.0),
    "south": (1, -1.0),
    "up": (2, 1.0),
    "z": (2, 1.0),
    "down": (2, -1.0),
}
GEODETIC = ("latitude", "longitude", "altitude")
POINTS, SPEEDS = ("kite_position", "origin"), ("kite_velocity", "wind_velocity")
SCALARS = {"tether_length": "m", "reel_out_speed": "m/s", "ground_tension": "N", "airspeed": "m/s"}  # and their units
LABELS = ("phase", "cycle")
MAY_MISS = ("kite_velocity", "wind_velocity", *SCALARS)  # what a map may call optional
SMALL_TIMES = {"us": 1e-6, "ns": 1e-9}  # units of time that only logs have, and the factor to s
ANGLES = {"deg": 1.0, "rad": math.degrees(1.0), "1e-7 deg": 1e-7}  # of geodetic coordinates, and the factor to deg


class MapError(SceneError):
    """A map that cannot be used; the message is one line with file, key, value and what is allowed."""


@dataclass(frozen=True)
class Kite:
    """The kite, and where its sensor sits."""

    end_below: float = quantity(
        0.0, "m", "how far the end of the tether lies from the logged position, towards the station", -100.0, 100.0
    )
    area: float = quantity(0.0, "m2", "projected area, to judge the size of the tension; 0: not known", 0.0, 1e5)
    __post_init__ = check


@dataclass(frozen=True)
class Station:
    """The ground station: where the tether leaves the winch, seen from the origin, and the rope inside."""

    outlet_east: float = quantity(0.0, "m", "outlet of the winch east of the origin", -1e4, 1e4)
    outlet_north: float = quantity(0.0, "m", "north of it", -1e4, 1e4)
    outlet_up: float = quantity(0.0, "m", "above it: the height of a mast", -1e4, 1e4)
    drum_to_outlet: float = quantity(0.0, "m", "length of tether from drum to outlet that the log counts", -1e4, 1e4)
    length_offset: float = quantity(0.0, "m", "what has to be added to the logged length, where it is known", -1e4, 1e4)
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
    """What the smoother assumes of the noise; see `smoothing.Noise`."""

    position_noise: float = quantity(1.0, "m", "standard deviation of a logged position", 1e-4, 1e3)
    velocity_noise: float = quantity(0.2, "m/s", "standard deviation of a logged velocity", 1e-4, 1e2)
    acceleration_change: float = quantity(5.0, "m/s2", "by which the kite's acceleration changes in 1 s", 1e-3, 1e3)
    wind_mean: float = quantity(30.0, "s", "time over which the wind is averaged", 0.0, 1e4)
    longest_gap: float = quantity(2.0, "s", "longest time without data that is bridged", 0.0, 1e3)
    __post_init__ = check


@dataclass(frozen=True)
class Delay:
    """By how much later than the rest a quantity stands in the log [s]."""

    kite_position: float = quantity(0.0, "s", "of the position", -10.0, 10.0)
    kite_velocity: float = quantity(0.0, "s", "of the velocity", -10.0, 10.0)
    tether_length: float = quantity(0.0, "s", "of the length", -10.0, 10.0)
    reel_out_speed: float = quantity(0.0, "s", "of the reel-out speed", -10.0, 10.0)
    ground_tension: float = quantity(0.0, "s", "of the tension", -10.0, 10.0)
    __post_init__ = check


OWN = {"kite": Kite, "station": Station, "smoothing": Smoothing, "delay": Delay}
OF_SCENES = ("tether", "environment", "ground")


@dataclass(frozen=True)
class Vector:
    """Columns of a vector: those of its components x east, y north, z up with their signs; or geodetic coordinates."""

    columns: tuple
    signs: tuple = (1.0, 1.0, 1.0)
    factor: float = 1.0  # to m or m/s; of geodetic coordinates, of the altitude
    is_geodetic: bool = False
    angle: float = 1.0  # factor of latitude and longitude to deg


@dataclass(frozen=True)
class Scalar:
    """Column of a number, and the factor to its unit; `others` may stand for it, the first one that a log has."""

    column: str
    factor: float = 1.0
    others: tuple = ()

    def among(self, there):
        """The same number in the first of its columns that is there; its first one if none is."""
        return replace(self, column=next((each for each in (self.column, *self.others) if each in there), self.column))


@dataclass(frozen=True)
class Columns:
    """A map: what the columns of a log mean, and the constants of the flight.

    `vectors`, `scalars` : dict from a name of the interface to `Vector` or `Scalar`.  `labels` : dict "phase", "cycle" to a
    column.  `origin` : the station in geodetic coordinates (deg, deg, m), or the `Vector` pair (geodetic, in metres) of one
    receiver; None: positions are seen from the station.  `wind_from` : column of the direction from which the wind comes
    [deg, clockwise from north], beside the `Scalar` of its speed.  `optional` : quantities that a log need not have.
    """

    name: str
    about: str = ""
    time: Scalar = Scalar("time")
    vectors: dict = field(default_factory=dict)
    scalars: dict = field(default_factory=dict)
    labels: dict = field(default_factory=dict)
    origin: tuple | None = None
    wind_from: Scalar | None = None
    optional: tuple = ()
    tether: Tether = field(default_factory=Tether)
    environment: Environment = field(default_factory=Environment)
    ground: Ground = field(default_factory=Ground)
    kite: Kite = field(default_factory=Kite)
    station: Station = field(default_factory=Station)
    smoothing: Smoothing = field(default_factory=Smoothing)
    delay: Delay = field(default_factory=Delay)

    @property
    def columns(self):
        """Names of all columns that a log must have, except labels."""
        listed = [self.time.column, *(name for vector in self.vectors.values() for name in vector.columns)]
        if self.origin and isinstance(self.origin[0], Vector):
            listed += [name for vector in self.origin for name in vector.columns]
        scalars = [*self.scalars.values(), *([self.wind_from] if self.wind_from else [])]
        return tuple(dict.fromkeys([*listed, *(scalar.column for scalar in scalars)]))

    @property
    def weight(self):
        """Weight of a metre of tether [N/m]."""
        return self.tether.mass_per_meter * self.environment.gravity

    def columns_of(self, name):
        """Names of the columns of a quantity, () if the map does not have it."""
        if name in self.vectors:
            return self.vectors[name].columns
        if name == "wind_velocity" and self.wind_from:
            return self.scalars["wind_speed"].column, self.wind_from.column
        return (self.scalars[name].column,) if name in self.scalars else ()

    def without(self, name):
        """The same map without a quantity."""
        keep = {name, "wind_speed"} if name == "wind_velocity" else {name}
        vectors = {key: each for key, each in self.vectors.items() if key not in keep}
        scalars = {key: each for key, each in self.scalars.items() if key not in keep}
        wind_from = None if name == "wind_velocity" else self.wind_from
        return replace(self, vectors=vectors, scalars=scalars, wind_from=wind_from)

    def for_log(self, there, report):
        """The same map for a log that has the columns `there`: without optional quantities whose columns are missing."""
        scalars = {key: each.among(there) for key, each in self.scalars.items()}
        found = replace(self, scalars=scalars, wind_from=self.wind_from.among(there) if self.wind_from else None)
        for name in self.optional:
            missing = [column for column in found.columns_of(name) if column not in there]
            if missing:
                report.say(f"no column {missing[0]}: the flight has no {name}")
                found = found.without(name)
        return found

    def with_constants(self, changes):
        """The same map with other constants; changes : dict "section.key" to a value as in a file. MapError names a key."""
        records = {}
        for key, value in changes.items():
            section, _, name = key.partition(".")
            if section not in (*OWN, *OF_SCENES):
                raise MapError(f"{key} is no constant of a map; sections are {', '.join((*OWN, *OF_SCENES))}")
            records.setdefault(section, {})[name] = value
        try:
            return replace(self, **read_records(records, self))
        except ValueError as error:
            raise MapError(str(error)) from None


def load(name):
    """`Columns` of a map of this package, by its name, or of a file; MapError says in one line what is wrong."""
    path = MAPS.get(str(name), Path(name))
    if path not in MAPS.values() and path.suffix != ".toml":
        raise MapError(f"there is no map {name}; it must be one of {', '.join([KITEPOWER, *MAPS])}, or a file (.toml)")
    try:
        return read(tomllib.loads(contents_of(path).decode("utf-8")), path.stem)
    except (ValueError, RecursionError) as error:
        raise MapError(f"{path}: {' '.join(str(error).split())}") from None


def read(table, name):
    """`Columns` from the table of a file; ValueError names the key."""
    vectors = (*POINTS, *SPEEDS)
    require(table, "", ("about", "optional", "time", *vectors, *SCALARS, *LABELS, *OWN, *OF_SCENES), ())
    found = {"name": name, "about": str(table.get("about", "")), "optional": optional(table.get("optional", []), table)}
    found["time"] = scalar(table.get("time", {"column": "time"}), "time", "s", SMALL_TIMES)
    found["scalars"] = {key: scalar(table[key], key, unit) for key, unit in SCALARS.items() if key in table}
    found["labels"] = {key: scalar(table[key], key, None).column for key in LABELS if key in table}
    found["vectors"] = {key: vector(table[key], key) for key in vectors if key in table and key != "origin"}
    if "kite_position" not in found["vectors"]:
        raise ValueError("the table [kite_position] is missing")
    if "speed" in table.get("wind_velocity", {}):
        found["scalars"]["wind_speed"], found["wind_from"] = wind(table["wind_velocity"])
        del found["vectors"]["wind_velocity"]
    if found["vectors"]["kite_position"].is_geodetic:
        if "origin" not in table:
            raise ValueError("kite_position is in degrees: the table [origin] of the station is missing")
        found["origin"] = origin(table["origin"])
    elif "origin" in table:
        raise ValueError("origin is given, but kite_position is not in degrees; station.outlet_east, ... move the station")
    return Columns(**found, **read_records(table, Columns(name)))


def read_records(table, base):
    """Records of the constants of a map, dict by section, those of `base` with what a table of a file changes."""
    found = {}
    for section, kind in OWN.items():
        found[section] = replace(getattr(base, section), **given(kind, table, section))
    for section in OF_SCENES:
        if section == "ground":
            found[section] = replace(base.ground, **vars_of_ground(table)) if section in table else base.ground
        else:
            found[section] = replace(getattr(base, section), **given(RECORDS[section], table, section))
    return found


def given(kind, table, section):
    """Values that a table of a file gives to a record, dict by name; ValueError names the key."""
    if section not in table:
        return {}
    made = record(kind, table[section], section, left_out=NOT_OF_A_SCENE)
    return {name: getattr(made, name) for name in table[section]}


def vars_of_ground(table):
    """Values that the table [ground] gives to a `Ground`."""
    made = given(RECORDS["ground"], table, "ground")
    names = [f"ground_{name}" for name in made]
    whole = ground_of(RECORDS["ground"](**made), Environment())
    return {name: getattr(whole, name) for name in names}


def text_of(table, section, key):
    """Name of a column; ValueError if it is none."""
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
    """Factor of the unit that a table names to the unit of its quantity; ValueError says what is allowed."""
    spelled = table.get(key, unit)
    known = factors(unit) | (more or {})
    if not isinstance(spelled, str) or spelled not in known:
        raise ValueError(f"{section}.{key} is {spelled!r}; it must be one of {', '.join(known)}")
    return known[spelled]


def scalar(table, section, unit, more=None):
    """`Scalar` of a table {column, unit}, or of a column; unit : of the quantity, None for texts; more : units.

    A list of columns stands for the first of them that a log has.
    """
    table = {"column": table} if isinstance(table, str | list) else table
    require(table, section, ("column", "unit") if unit else ("column",))
    if "column" not in table:
        raise ValueError(f"the key {section}.column is missing")
    return among(table, section, "column", factor_of(table, section, unit, more=more) if unit else 1.0)


def among(table, section, key, factor):
    """`Scalar` of a column, or of a list of columns, under a key of a table."""
    listed = table[key] if isinstance(table[key], list) and table[key] else [table[key]]
    column, *others = (text_of({key: each}, section, key) for each in listed)
    return Scalar(column, factor, tuple(others))


def wind(table):
    """`Scalar` of the speed of the wind, and that of the direction from which it comes."""
    section = "wind_velocity"
    require(table, section, ("speed", "from", "unit", "angle"))
    if "from" not in table:
        raise ValueError(f"the key {section}.from is missing: the column of the direction from which the wind comes")
    speed = among(table, section, "speed", factor_of(table, section, "m/s"))
    return speed, among(table, section, "from", factor_of({"angle": "deg"} | table, section, "rad", "angle"))


def vector(table, section):
    """`Vector` of a table that names a column for each axis; None of a wind that has speed and direction."""
    if section == "wind_velocity" and "speed" in table:
        return None
    is_position = section in POINTS
    require(table, section, (*AXES, *((*GEODETIC, "angle") if is_position else ()), "unit"))
    factor = factor_of(table, section, "m" if is_position else "m/s")
    if any(key in table for key in GEODETIC):
        require(table, section, (*GEODETIC, "angle", "unit"), GEODETIC)
        columns = tuple(text_of(table, section, key) for key in GEODETIC)
        return Vector(columns, factor=factor, is_geodetic=True, angle=angle_of(table, section))
    axes = {AXES[key][0]: (text_of(table, section, key), AXES[key][1]) for key in table if key in AXES}
    if len(axes) != 3 or sum(key in AXES for key in table) != 3:
        raise ValueError(f"{section} must name one column for each axis: east or x, north or y, up or down or z")
    columns, signs = zip(*(axes[k] for k in range(3)), strict=True)
    return Vector(columns, signs, factor)


def angle_of(table, section):
    """Factor of the unit of latitude and longitude to deg; ValueError says what is allowed."""
    spelled = table.get("angle", "deg")
    if not isinstance(spelled, str) or spelled not in ANGLES:
        raise ValueError(f"{section}.angle is {spelled!r}; it must be one of {', '.join(ANGLES)}")
    return ANGLES[spelled]


def origin(table):
    """The station: three numbers (deg, deg, m), or the two `Vector` of a receiver that is logged in degrees and metres."""
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
