"""Flights of systems: driven points go straight on with their velocity, lines are paid out at their speed, a wind blows."""

from dataclasses import dataclass, field, replace
from warnings import catch_warnings

import numpy as np

from tetherfmu.files import system_files as files
from tetherfmu.files.scene_files import EVERY, SceneError
from tetherfmu.files.settings import put, with_settings
from tetherfmu.files.system_files import SystemFile
from tetherfmu.files.toml_files import check_once, record, require, tables_of, value_of, vector_in
from tetherfmu.files.winds import Wind
from tetherfmu.python.system import TetherSystem
from tetherfmu.records.problems import PlausibilityWarning
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.naming import meant_or_all, prefixed
from tetherfmu.runtime.parameters import changed
from tetherfmu.runtime.quantities import check, quantity

OF_THE_FLIGHT = ("duration", "wind", "loads", "wanted")  # begin the settings that no file of a system has
STEP = 0.02  # communication step, where it is not given [s]


@dataclass(frozen=True)
class Wanted:
    """What is asked for of a system."""

    allowed_error: float = quantity(0.01, "", "of each force", minimum=1e-4, maximum=0.5)
    communication_step: float = quantity(STEP, "s", "of the simulator", minimum=1e-4, maximum=1.0)
    __post_init__ = check


@dataclass(frozen=True)
class SystemFlight:
    """A flight of the system of a file."""

    found: SystemFile
    duration: float = quantity(20.0, "s", "of the flight", minimum=0.5, maximum=86400.0)
    wind: Wind = field(default_factory=Wind)
    loads: dict = field(default_factory=dict)  # constant forces on free points [N], by name
    wanted: Wanted = Wanted()
    __post_init__ = check

    @property
    def every(self):
        """Time between two compared outputs [s]: a whole number of communication steps."""
        step = self.wanted.communication_step
        return step * max(1, round(EVERY / step))

    @property
    def count(self):
        """Number of compared outputs after the start."""
        return max(1, int(self.duration / self.every + 1e-9))

    def fly(self, segments, solver, step, exact=False):
        """The `TetherSystem` and its `SystemFlown` at a communication step [s]; StepRefused if it refuses one.

        segments : of each line, dict by name.  solver : `Solver`.  exact : with the wind of the middle of each step.
        """
        of = self.found
        lines = [replace(each, tether=changed(each.tether, {"segments": segments[each.name]})) for each in of.lines]
        system = TetherSystem(of.points, lines, of.environment, solver, of.ground, winches=of.winches)
        time, every = step * np.arange(self.calls(step)), round(self.every / step)
        given = {"loads": self.loads, "every": every, "wind_velocity": self.wind(time + 0.5 * step * exact)}
        with catch_warnings(action="ignore", category=PlausibilityWarning):  # `implausible` has them
            system.initialize(self.wind(0.0), loads=self.loads)
            return system, system.fly(len(time), step, straight_on(of, time), **given)

    @property
    def flown_time(self):
        """From the start to the last compared output [s]."""
        return self.count * self.every

    def calls(self, step):
        """Number of communication steps [s]."""
        return self.count * round(self.every / step)

    def segments_of_lines(self, factor):
        """Segments of each line, those of the file times a factor, dict by name; at least 1."""
        own = {each.name: each.tether.segments for each in self.found.lines}
        return {name: min(at.MAX_SEGMENTS, max(1, round(factor * count))) for name, count in own.items()}


def straight_on(found, time):
    """Positions [m] of the driven points of a `SystemFile` at times [s], arrays (times, 3) by name."""
    driven = (each for each in found.points if each.is_driven)
    return {each.name: np.add(each.position, np.multiply.outer(time, each.velocity)) for each in driven}


def is_system(path):
    """Whether a TOML file (Path) describes a system of tethers, by its table of points."""
    try:
        return "points" in tables_of(path)
    except ValueError:
        return False  # said where it is read


def load(path, settings=()):
    """`SystemFlight` of the file (Path) of a system; SceneError says in one line what is wrong with it.

    settings : pairs of keys of the file and values in their place; or of ``duration``, ``wind.velocity`` and the like,
    ``wanted.allowed_error`` and ``wanted.communication_step``, as of a scene file, and ``loads.NAME`` of a free point.
    """
    of_flight = [pair for pair in settings if pair[0].partition(".")[0] in OF_THE_FLIGHT]
    with prefixed(f"{path}: ", SceneError):
        check_once(name for name, _ in settings)
        table, flight = tables_of(path), with_settings({}, of_flight)
        for key, value in (pair for pair in settings if pair not in of_flight):
            put(table, key, value)
        given = {"wind": record(Wind, flight.get("wind", {}), "wind")}
        given["loads"] = loads_in(flight.get("loads", {}))
        given["wanted"] = record(Wanted, flight.get("wanted", {}), "wanted")
        if "duration" in flight:
            given["duration"] = value_of(SystemFlight, "duration", flight["duration"], "")
        found = SystemFlight(files.read(table, path.stem), **given)
        refuse(found)
        return found


def loads_in(table):
    """Loads on free points [N], dict by name; ValueError names one that is none."""
    require(table, "loads", table)
    read, found = vector_in("N", at.LARGEST_INPUT), {}
    for name, value in table.items():
        with prefixed(f"loads.{name} is {value!r}; "):
            found[name] = read(value)
    return found


def refuse(flight):
    """ValueError if a winch of a `SystemFlight` needs a force, which nothing gives here, or a load is on no free point."""
    for each in flight.found.lines:
        if each.winch.winch_control == at.WINCH_BY_FORCE:
            raise ValueError(f"lines.{each.name}.winch_control is force, and nothing gives that; it must be speed or length")
    free = [each.name for each in flight.found.points if not each.is_driven]
    for name in flight.loads:
        if name not in free:
            raise ValueError(f"loads.{name} is given, and {name} is no free point{meant_or_all(name, free, 'those are {}')}")
