"""Scenes as files: flight, tether and wind; see docs/use/scene_files.md."""

import hashlib
import sys
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import COUNT, by_name
from tetherfmu.runtime.naming import meant_or_all, prefixed
from tetherfmu.runtime.parameters import Environment, Ground, Tether, Winch
from tetherfmu.runtime.plausibility import LARGEST_STRETCH, UNDER
from tetherfmu.runtime.quantities import check, doubts_of, quantities, quantity

from . import driven, lean
from .flights import KINDS
from .lean import Lean
from .named import path_of
from .settings import keys_of_parameters, with_settings
from .toml_files import TABLE_OF_GROUND, WrongUse, ground_of, name_in, record, require, tables_of, value_of, without
from .winds import BoxedWind, Wind, read_wind

OUTPUTS = ("kite_force", "kite_direction", "ground_force", "ground_direction", "peak_force", "power", "shape")
EVERY = 0.1  # `every` of a scene [s], about
NOT_OF_A_SCENE = ("segments", "control")
NO_ADVICE = "series.release is for fly and sweep only: the error of a recoiling tether does not converge"
ENDS = ("kite_position", "kite_velocity", "ground_position", "ground_velocity")  # inputs, in the order of `Motion`
WINCH = "winch_"  # begins the names of most quantities of a `Winch`
REQUIRED = {
    "": ("duration", "flight", "tether", "wanted"),
    "tether": ("initial_length",),
    "wanted": ("allowed_error",),
    "ground": ("contact",),
    "flight of kind series": ("file",),
}


class SceneError(WrongUse):
    """An unusable scene file; the message is one line with file, key, value and the permitted values."""


@contextmanager
def flown_from(path, what="scene"):
    """SceneError where a tether refuses to fly the scene, or the system, of a file."""
    try:
        yield
    except StepRefused as refusal:
        raise SceneError(f"{path}: this {what} cannot be flown: {refusal}") from None


def output_names(value):
    """Names of `OUTPUTS`."""
    if not isinstance(value, list) or not value or any(each not in OUTPUTS for each in value):
        raise ValueError(f"it must be a list of some of {', '.join(OUTPUTS)}")
    return tuple(value)


def yes_or_no(value):
    """True or false."""
    if not isinstance(value, bool):
        raise ValueError("it must be true or false")
    return value


@dataclass(frozen=True)
class Wanted:
    """Requirements of the user; errors are relative, see docs/use/quality_of_advice.md, "Errors and cost"."""

    outputs: tuple = field(default=("kite_force",), metadata={"read": output_names})
    allowed_error: float = quantity(0.01, "", "allowed error of each output", minimum=1e-4, maximum=0.5)
    real_time_factor: float = quantity(
        0.0, "", "required speed relative to real time; 0: no requirement", minimum=0.0, maximum=1e9
    )
    communication_step: float = quantity(
        0.0, "s", "communication step of the simulator; 0: the advisor chooses", minimum=0.0, maximum=1.0
    )
    fixed: bool = field(default=False, metadata={"read": yes_or_no})
    time_per_step: float = quantity(
        0.0,
        "s",
        "longest kernel time of a communication step, with fixed = true; 0: no requirement",
        minimum=0.0,
        maximum=1.0,
    )
    __post_init__ = check


@dataclass(frozen=True)
class TableOfWinch(without(WINCH, Winch)):
    """Winch of a scene file: its drum and its constant force."""

    force: float = quantity(0.0, "N", "constant force with which the winch pulls; 0: no force control", 0.0, 1e9)


RECORDS = {"tether": Tether, "environment": Environment, "ground": TABLE_OF_GROUND}  # of a scene, by section
RECORDS |= {"winch": TableOfWinch, "wind": Wind, "wanted": Wanted}


@dataclass(frozen=True)
class Scene:
    """A scene; `digest` distinguishes those of files by their entire content."""

    name: str
    duration: float = quantity(60.0, "s", "duration of the flight", minimum=0.5, maximum=86400.0)
    flight: Any = None
    tether: Tether = None
    environment: Environment = field(default_factory=Environment)
    ground: Ground = field(default_factory=Ground)
    winch: Winch = field(default_factory=Winch)  # its drum, where the winch is controlled by force
    winch_force: float = 0.0  # constant winch force [N]; 0: none, or from the flight
    wind: Any = field(default_factory=Wind)  # a function of times [s], at the reference height; or a `BoxedWind`
    wanted: Wanted = Wanted()
    digest: str = ""
    every: float = EVERY  # time between two compared outputs [s]: a whole number of communication steps
    build: Lean = field(default_factory=Lean)  # of its FMU
    __post_init__ = check

    @property
    def count(self):
        """Number of compared outputs after the start."""
        return int(self.duration / self.every + 1e-9)

    @property
    def times(self):
        """Times [s] of the compared outputs, the start included."""
        return self.every * np.arange(self.count + 1)

    @property
    def wind_points(self):
        """Number of points with box wind along the tether, 0 without a box."""
        return self.wind.box.wind_points if isinstance(self.wind, BoxedWind) else 0

    @property
    def kite_is_free(self):
        """Whether the kite end is a mass that the tether moves."""
        return self.flight.kite_is_free

    @property
    def has_force(self):
        """Whether a force controls the winch."""
        return self.winch_force > 0.0 or self.flight.has_force

    def doubts(self):
        """Sentences on probable errors: other units, a tether far too short for its ends."""
        yield from doubts_of(self.tether, "tether.")
        yield from doubts_of(self.environment, "environment.")
        if self.wind_points:
            yield from self.wind.doubts()
        if self.kite_is_free or self.has_force:
            yield from self.doubts_on_ground()
            return
        motion = self.flight.motion(self.times)
        distance = np.linalg.norm(motion.kite - motion.ground, axis=-1)
        length = self.tether.initial_length + motion.reeled
        k = np.argmax(distance - LARGEST_STRETCH * length)
        if distance[k] > LARGEST_STRETCH * length[k]:
            yield (
                f"the ends are {distance[k]:.6g} m apart at {self.times[k]:.6g} s, the tether is {length[k]:.6g} m long: "
                f"stretched by {100.0 * (distance[k] / length[k] - 1.0):.3g} %, where any rope is broken; check "
                "tether.initial_length, and the unit m of the positions"
            )

    def doubts_on_ground(self):
        """A sentence on a free end that begins under the ground, which would throw it out."""
        ground = self.ground
        if self.kite_is_free and ground.ground_contact == at.FLAT:
            deep = ground.ground_height - self.flight.at_rest(self.tether, self.environment.gravity)[2]
            if deep > max(UNDER, ground.ground_sink):
                yield f"the free end begins {deep:.3g} m below ground.height; check tether.initial_length and flight.height"

    def inputs(self, step, exact=False):
        """Inputs of all communication steps, array (steps, INPUTS), in the order of `runtime.inputs`.

        step : communication step [s], a whole part of `every`.  exact : use the mean reel-out speed and the wind at the
        middle of each step instead of its start; no importer knows them, a reference does.
        """
        time = step * np.arange(self.count * round(self.every / step))
        motion = self.flight.motion(time)
        speed = (self.flight.motion(time + step).reeled - motion.reeled) / step if exact else motion.reel_out_speed
        if self.has_force or (self.flight.has_length and not exact):
            speed = np.full_like(speed, self.start_speed(motion))  # only for the start of the winch
        given = dict(zip(ENDS, motion[: len(ENDS)], strict=True))
        given |= {"reel_out_speed": speed[:, np.newaxis], "wind_velocity": self.wind(time + 0.5 * step * exact)}
        if self.has_force:
            given["winch_force"] = self.winch_force
        if self.flight.has_force:
            given["winch_force"] = self.flight.force(time + 0.5 * step * exact)[:, np.newaxis]
        if self.flight.has_length and not exact:
            given["winch_length"] = (self.tether.initial_length + motion.reeled)[:, np.newaxis]
        if self.flight.has_release:
            given["release"] = (time >= self.flight.release_time - 1e-6)[:, np.newaxis]
        if self.kite_is_free:
            given["kite_position"] = self.flight.at_rest(self.tether, self.environment.gravity)
            given["kite_load"] = self.flight.load(time + 0.5 * step * exact)
        rows = np.zeros((len(time), COUNT))
        columns = by_name(rows)
        for name, numbers in given.items():
            columns[name][:] = numbers
        return rows

    def start_speed(self, motion):
        """Start speed [m/s] of a winch without speed control; motion : of the flight, from its start on.

        A force-controlled drum starts at the rate at which the ends separate, unless the flight specifies it: no jerk.
        """
        if not self.has_force or self.kite_is_free or np.any(motion.reel_out_speed):
            return motion.reel_out_speed[0]
        apart, parting = motion.kite[0] - motion.ground[0], motion.kite_velocity[0] - motion.ground_velocity[0]
        return float(apart @ parting / max(np.linalg.norm(apart), 1e-9))

    def wind_at(self, step, exact=False):
        """Wind at the wind points in all communication steps [m/s], array (steps, wind_points, 3); None without them.

        step, exact : as for `inputs`.
        """
        if not self.wind_points:
            return None
        time = step * (np.arange(self.count * round(self.every / step)) + 0.5 * exact)
        motion = self.flight.motion(time)
        return self.wind.at(time, motion.ground, motion.kite)


def load(path, settings=(), *, quiet=False):
    """`Scene` of a file; SceneError describes a problem in one line. Doubts are printed to stderr,
    unless it is to be quiet.

    path : of the file, or the name of one of `named.named_scenes`.
    settings : pairs (name, value) that replace values of the file, see `settings.with_settings`.
    """
    with prefixed("", SceneError):
        path = path_of(path)
    with prefixed(f"{path}: ", SceneError):
        scene = read(with_settings(tables_of(path), settings), path.parent, path.stem)
    for doubt in () if quiet else scene.doubts():
        print(f"{path}: {doubt}", file=sys.stderr)
    return scene


def load_for_advice(path, settings=()):
    """`load` for a scene to be advised on; SceneError for one that releases its tether, for which no error is defined."""
    scene = load(path, settings)
    if scene.flight.has_release:
        raise SceneError(f"{path}: {NO_ADVICE}")
    return scene


def read(table, folder, name):
    """`Scene` from the table of a file in a folder; ValueError names the key."""
    if "points" in table:
        raise ValueError("describes a system of tethers, not a scene; use tetherfmu fly, advise, sweep or build --system")
    require(table, "", ("name", "duration", "flight", "series", *RECORDS, "build"), REQUIRED[""])
    flight = read_flight(table["flight"], folder)
    if "series" in table:
        require(table["series"], "series", table["series"])
        flight = driven.of_scene(table["series"], flight, folder)
    if flight.initial_length is not None and isinstance(table["tether"], dict):
        table = {**table, "tether": {"initial_length": flight.initial_length, **table["tether"]}}
    table = in_balance(table, flight)
    records = {}
    for key, kind in (pair for pair in RECORDS.items() if pair[0] != "wind"):
        records[key] = record(kind, table[key], key, REQUIRED.get(key, ()), NOT_OF_A_SCENE) if key in table else kind()
    records["ground"] = ground_of(records["ground"], records["environment"])
    force = records["winch"].force
    records["winch"] = winch_of(records["winch"], flight)
    if flight.wind and "wind" in table:
        raise ValueError("wind is given here and in the columns of the series; it must be given once")
    records["wind"] = flight.wind or read_wind(table.get("wind", {}), folder, records["environment"])
    if isinstance(records["wind"], BoxedWind) and flight.kite_is_free:
        raise ValueError("wind.file is given to a free end, whose path is unknown; give wind.velocity only")
    length, first = records["tether"].initial_length, flight.initial_length
    if first is not None and not np.isclose(first, length, rtol=1e-6):
        raise ValueError(f"tether.initial_length is {length!r} m; tether_length of the series begins with {first!r} m")
    name, duration = name_in(table, name), value_of(Scene, "duration", table["duration"], "")
    if duration > flight.duration + 1e-9:
        raise ValueError(f"duration is {duration!r}; it must be at most {flight.duration:g} s, the length of the series")
    step, digest = records["wanted"].communication_step, hashlib.sha256(repr((name, table, flight.contents)).encode())
    if isinstance(records["wind"], BoxedWind):
        digest.update(repr(records["wind"].state_of_file).encode())
    every = step * max(1, round(EVERY / step)) if step else EVERY
    own = {"winch_force": force, "digest": digest.hexdigest()[:16], "every": every, "build": build_of(table)}
    scene = Scene(name, duration, flight, **records, **own)
    scene.wind_at(every)  # refused here rather than in a flight
    return scene


def build_of(table):
    """`Lean` of the table of a file; ValueError for a start value that the scene has elsewhere."""
    found, keys = lean.read(table.get("build", {})), keys_of_parameters()
    for name, _ in found.starts:
        if name in keys:
            raise ValueError(f"build.set has {name}, which is {keys[name]} in a scene: set it there")
    return found


def in_balance(table, flight):
    """The table of a file; with a force-controlled winch and without a length, with that at which both are in balance."""
    tether, winch = table["tether"], table.get("winch", {})
    has_force = flight.has_force or (not flight.kite_is_free and isinstance(winch, dict) and "force" in winch)
    is_read = isinstance(tether, dict) and isinstance(winch, dict)  # others are refused later
    if not has_force or not is_read or "initial_length" in tether:
        return table
    motion = flight.motion(0.0)
    distance = float(np.linalg.norm(motion.kite - motion.ground))  # where the search begins
    return {**table, "tether": {"initial_length": distance, **tether}, "winch": {"start": "equilibrium", **winch}}


def winch_of(table, flight):
    """The `Winch` of a table of a file; ValueError if no force, or two, control it."""
    if table.force and (flight.has_force or flight.has_length):
        raise ValueError("winch.force is given beside the column of the series that controls the winch; remove one of them")
    names = {each.removeprefix(WINCH): each for each, _ in quantities(Winch)}
    winch = Winch(**{names[key]: value for key, value in vars(table).items() if key in names})
    if winch != Winch() and not (flight.has_force or table.force):
        needs = "winch.force, or a series with a column winch_force or ground_tension"
        raise ValueError(f"winch is given without a force; a drum needs {needs}")
    return winch


@lru_cache(maxsize=4)
def series(path, state):
    """`Series` of a CSV file, read once for all scenes of a sweep; state : another one for a file written anew."""
    from .series import Series  # importing its splines needs half a second

    return Series(path)


def read_flight(table, folder):
    """A flight of `flights.KINDS`, or the series of a CSV file."""
    require(table, "flight", table)
    if "kind" not in table:
        raise ValueError("the key flight.kind is missing")
    kind, table = table["kind"], {key: value for key, value in table.items() if key != "kind"}
    if kind == "series":
        require(table, "flight of kind series", ("file",), REQUIRED["flight of kind series"])
        if not isinstance(table["file"], str):
            raise ValueError(f"flight.file is {table.get('file')!r}; it must be the name of a CSV file")
        path = folder / table["file"]
        status = path.stat() if path.is_file() else None
        return series(path, (status.st_size, status.st_mtime_ns) if status else object())
    kinds = [*KINDS, "series"]
    if kind not in tuple(KINDS):
        raise ValueError(f"flight.kind is {kind!r}{meant_or_all(str(kind), kinds, 'it must be one of {}')}")
    return record(KINDS[kind], table, "flight")
