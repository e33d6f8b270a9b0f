"""Scenes as files: what is flown with which tether in which wind; see docs/use/how_much_tether.md, "Scene files"."""

import hashlib
import stat
import sys
import tomllib
from dataclasses import dataclass, field, fields, make_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tetherfmu.console.ending import WrongUse
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import COUNT, by_name
from tetherfmu.runtime.parameters import GROUND_WITHOUT_GRAVITY, Environment, Ground, Tether, diameter_in_doubt
from tetherfmu.runtime.plausibility import LARGEST_STRETCH, UNDER
from tetherfmu.runtime.quantities import check, quantities, quantity

from .flights import KINDS

# what else a quantity may be given in than in its unit, and the factor to the unit
UNITS = pd.read_csv(Path(__file__).with_name("units.csv"), keep_default_na=False, converters={"factor": float})
OUTPUTS = ("kite_force", "kite_direction", "ground_force", "ground_direction", "peak_force", "power", "shape")
EVERY = 0.1  # `every` of a scene [s], about
LARGEST_FILE = 1_000_000_000  # [B]
REQUIRED = {
    "": ("duration", "flight", "tether", "wanted"),
    "tether": ("initial_length",),
    "wanted": ("allowed_error",),
    "ground": ("contact",),
    "flight of kind series": ("file",),
}


class SceneError(WrongUse):
    """A scene file that cannot be used; the message is one line with file, key, value and what is allowed."""


@dataclass(frozen=True)
class Wind:
    """Wind at the reference height of the environment: a mean and a gust that comes again, v (1 + g sin^2(pi t/P))."""

    velocity: tuple = (0.0, 0.0, 0.0)
    gust: float = quantity(0.0, "", "strength of a gust over the mean wind, g", minimum=0.0, maximum=10.0)
    gust_period: float = quantity(10.0, "s", "time from gust to gust, P", minimum=1e-3, maximum=1e6)
    __post_init__ = check

    def __call__(self, time):
        """Wind [m/s] at times [s], array (times, 3)."""
        factor = 1.0 + self.gust * np.sin(np.pi / self.gust_period * time) ** 2
        return np.multiply.outer(factor, self.velocity)


@dataclass(frozen=True)
class Wanted:
    """What the user asks for; errors are relative, see docs/use/how_much_tether.md, "Errors and cost"."""

    outputs: tuple = ("kite_force",)
    allowed_error: float = quantity(0.01, "", "of each output", minimum=1e-4, maximum=0.5)
    real_time_factor: float = quantity(0.0, "", "how much faster than real time, 0: no matter", minimum=0.0, maximum=1e9)
    communication_step: float = quantity(0.0, "s", "of the simulator, 0: to be advised", minimum=0.0, maximum=1.0)
    __post_init__ = check


def without(prefix, record):
    """A record like another one, the names of whose quantities all begin with a prefix, without it."""
    copies = [(each, field(default=each.default, metadata=each.metadata)) for each in fields(record)]
    named = [(each.name.removeprefix(prefix), each.type, copy) for each, copy in copies]
    return make_dataclass(record.__name__, named, frozen=True, namespace={"__post_init__": check})


GROUND = "ground_"  # begins the names of the quantities of a `Ground`
TABLE_OF_GROUND = without(GROUND, Ground)
RECORDS = {  # of a scene, by section
    "tether": Tether,
    "environment": Environment,
    "ground": TABLE_OF_GROUND,
    "wind": Wind,
    "wanted": Wanted,
}


@dataclass(frozen=True)
class Scene:
    """A scene; `digest` tells those of files apart by all that they hold."""

    name: str
    duration: float = quantity(60.0, "s", "of the flight", minimum=0.5, maximum=86400.0)
    flight: Any = None
    tether: Tether = None
    environment: Environment = field(default_factory=Environment)
    ground: Ground = field(default_factory=Ground)
    wind: Any = Wind()  # a function of times [s], at the reference height
    wanted: Wanted = Wanted()
    digest: str = ""
    every: float = EVERY  # time between two compared outputs [s]: a whole number of communication steps
    kite_is_free: bool = False  # after the start
    reel_out_speed: float = 0.0  # constant, of the winch, in races only [m/s]
    __post_init__ = check

    @property
    def count(self):
        """Number of compared outputs after the start."""
        return int(self.duration / self.every + 1e-9)

    @property
    def times(self):
        """Times [s] of the compared outputs, the start included."""
        return self.every * np.arange(self.count + 1)

    def doubts(self):
        """Sentences on what was hardly meant: a diameter in millimetres, a tether far too short for its ends."""
        if doubt := diameter_in_doubt(self.tether.diameter):
            yield f"tether.{doubt}"
        if self.flight.kite_is_free or self.flight.has_force:
            yield from self.doubts_on_ground()
            return
        motion = self.flight.motion(self.times)
        distance = np.linalg.norm(motion.kite - motion.ground, axis=-1)
        length = self.tether.initial_length + motion.reeled
        k = np.argmax(distance - LARGEST_STRETCH * length)
        if distance[k] > LARGEST_STRETCH * length[k]:
            yield (
                f"the ends are {distance[k]:.6g} m apart at {self.times[k]:.6g} s, the tether is {length[k]:.6g} m long; "
                "check tether.initial_length, and the unit m of the positions"
            )

    def doubts_on_ground(self):
        """A sentence on a free end that begins under the ground, which would throw it out."""
        ground = self.ground
        if self.flight.kite_is_free and ground.ground_contact == at.FLAT:
            deep = ground.ground_height - self.flight.at_rest(self.tether, self.environment.gravity)[2]
            if deep > max(UNDER, ground.ground_sink):
                yield f"the free end begins {deep:.3g} m below ground.height; check tether.initial_length and flight.height"

    def inputs(self, step, exact=False):
        """Inputs of all communication steps, array (steps, INPUTS), in the order of `runtime.inputs`.

        step : communication step [s], a whole part of `every`.  exact : give the mean reel-out speed and the wind of the
        middle of each step instead of those of its start; no importer knows them, a reference does.
        """
        time = step * np.arange(self.count * round(self.every / step))
        motion = self.flight.motion(time)
        speed = (self.flight.motion(time + step).reeled - motion.reeled) / step if exact else motion.reel_out_speed
        given = {
            "kite_position": motion.kite,
            "kite_velocity": motion.kite_velocity,
            "ground_position": motion.ground,
            "ground_velocity": motion.ground_velocity,
            "reel_out_speed": speed[:, np.newaxis],
            "wind_velocity": self.wind(time + 0.5 * step * exact),
        }
        if self.flight.has_force:
            given["winch_force"] = self.flight.force(time + 0.5 * step * exact)[:, np.newaxis]
        if self.flight.has_length:
            given["winch_length"] = (self.tether.initial_length + motion.reeled)[:, np.newaxis]
        if self.flight.kite_is_free:
            given["kite_position"] = self.flight.at_rest(self.tether, self.environment.gravity)
            given["kite_load"] = self.flight.load()
        rows = np.zeros((len(time), COUNT))
        columns = by_name(rows)
        for name, numbers in given.items():
            columns[name][:] = numbers
        return rows


def load(path):
    """`Scene` of a file; SceneError says in one line what is wrong with it. What is only doubtful is said on stderr."""
    path = Path(path)
    try:
        scene = read(tomllib.loads(contents_of(path).decode("utf-8")), path.parent, path.stem)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: is no TOML file ({error})") from None
    except RecursionError:
        raise SceneError(f"{path}: is no scene (its tables or lists are nested too deeply)") from None
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from None
    for doubt in scene.doubts():
        print(f"{path}: {doubt}", file=sys.stderr)
    return scene


def contents_of(path):
    """Bytes of a regular file; ValueError for others, which may have no end, and for one that cannot be read."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise ValueError("cannot be read (it is no regular file)")
        if status.st_size > LARGEST_FILE:
            raise ValueError(f"cannot be read (it has more than {LARGEST_FILE / 1e9:g} GB)")
        with path.open("rb") as file:
            return file.read(status.st_size)  # a file without a known size has 0
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror})") from None


def read(table, folder, name):
    """`Scene` from the table of a file in a folder; ValueError names the key."""
    require(table, "", ("name", "duration", "flight", *RECORDS))
    flight = read_flight(table["flight"], folder)
    if flight.initial_length is not None and isinstance(table["tether"], dict):
        table = {**table, "tether": {"initial_length": flight.initial_length, **table["tether"]}}
    records = {key: record(kind, table[key], key) if key in table else kind() for key, kind in RECORDS.items()}
    records["ground"] = ground_of(records["ground"], records["environment"])
    if flight.wind and "wind" in table:
        raise ValueError("wind is given here and in the columns of the series; it must be given once")
    records["wind"] = flight.wind or records["wind"]
    length, first = records["tether"].initial_length, flight.initial_length
    if first is not None and not np.isclose(first, length, rtol=1e-6):
        raise ValueError(f"tether.initial_length is {length!r} m; tether_length of the series begins with {first!r} m")
    name, duration = table.get("name", name), value_of(Scene, "duration", table["duration"], "")
    if duration > flight.duration + 1e-9:
        raise ValueError(f"duration is {duration!r}; it must be at most {flight.duration:g} s, the length of the series")
    step, digest = records["wanted"].communication_step, hashlib.sha256(repr((name, table, flight.contents)).encode())
    every = step * max(1, round(EVERY / step)) if step else EVERY
    return Scene(
        name, duration, flight, **records, digest=digest.hexdigest()[:16], every=every, kite_is_free=flight.kite_is_free
    )


def ground_of(table, environment):
    """The `Ground` of a table of a file; ValueError if it does not go with the environment."""
    ground = Ground(**{GROUND + name: value for name, value in vars(table).items()})
    if ground.ground_contact == at.FLAT and environment.gravity == 0.0:
        raise ValueError(GROUND_WITHOUT_GRAVITY.replace(GROUND, "ground."))
    return ground


def require(table, section, known, needed=None):
    """ValueError unless a table has what it must have and nothing unknown; needed : keys, None: those of `REQUIRED`."""
    label = f"{section}." if section else ""
    if not isinstance(table, dict):
        raise ValueError(f"{section} is {table!r}; it must be a table [{section}]")
    for key in REQUIRED.get(section, ()) if needed is None else needed:
        if key not in table:
            raise ValueError(f"the key {label}{key} is missing")
    for key in table:
        if key not in known:
            raise ValueError(f"unknown key {label}{key}; known are {', '.join(known)}")


def read_flight(table, folder):
    """A flight of `flights.KINDS`, or the series of a CSV file."""
    require(table, "flight", table)
    if "kind" not in table:
        raise ValueError("the key flight.kind is missing")
    kind, table = table["kind"], {key: value for key, value in table.items() if key != "kind"}
    if kind == "series":
        require(table, "flight of kind series", ("file",))
        if not isinstance(table["file"], str):
            raise ValueError(f"flight.file is {table.get('file')!r}; it must be the name of a CSV file")
        from .series import Series  # its splines take half a second to import

        return Series(folder / table["file"])
    if kind not in KINDS:
        raise ValueError(f"flight.kind is {kind!r}; it must be one of {', '.join([*KINDS, 'series'])}")
    return record(KINDS[kind], table, "flight")


def record(kind, table, section, needed=None):
    """A record from a table of a file; ValueError names the key. The number of segments is no matter of a scene."""
    require(table, section, [item.name for item in fields(kind) if item.name != "segments"], needed)
    given = {key: value_of(kind, key, value, f"{section}.") for key, value in table.items()}
    try:
        return kind(**given)
    except ValueError as error:
        raise ValueError(f"{section}.{error}") from None


def value_of(kind, key, value, label):
    """A value of a field of a record in SI units; ValueError names it and says what is allowed."""
    declared = dict(quantities(kind)).get(key)
    try:
        if declared is None:
            return SPECIAL[key](value)
        is_named = isinstance(value, str) and value in declared.numbers
        number = declared.numbers[value] if is_named else in_si(value, declared.unit)
    except ValueError as error:
        more = f", {declared.range()}" if declared else ""
        raise ValueError(f"{label}{key} is {value!r}; {error}{more}") from None
    if not declared.allows(number):
        raise ValueError(f"{label}{key} is {value!r}; it must be {declared.range()}")
    return number


def factors(unit):
    """Units in which a quantity may be given, and their factors to its unit."""
    return {unit: 1.0} | UNITS[UNITS.unit == unit].set_index("spelled").factor.to_dict()


def spellings(unit):
    """Units in which a quantity may be given, in words."""
    return ", ".join(each or "no unit" for each in factors(unit))


def in_si(value, unit):
    """A number, or a text like "4 mm", as a number in the unit of its quantity; ValueError says what is allowed."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"it must be a number, or a text with a unit ({spellings(unit)})")
    if not isinstance(value, str):
        return value
    amount, _, spelled = value.strip().partition(" ")
    try:
        return float(amount) * factors(unit)[spelled.strip()]
    except (ValueError, KeyError):
        raise ValueError(f"it must be a number with one of the units {spellings(unit)}") from None


def velocity(value):
    """Three finite numbers [m/s]."""
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError("it must be three numbers [x, y, z] in m/s")
    numbers = tuple(float(in_si(each, "m/s")) for each in value)
    if not np.all(np.abs(numbers) <= 200.0):  # NaN is not
        raise ValueError("each must be a finite number from -200 to 200 m/s")
    return numbers


def output_names(value):
    """Names of `OUTPUTS`."""
    if not isinstance(value, list) or not value or any(each not in OUTPUTS for each in value):
        raise ValueError(f"it must be a list of some of {', '.join(OUTPUTS)}")
    return tuple(value)


SPECIAL = {"velocity": velocity, "outputs": output_names}
