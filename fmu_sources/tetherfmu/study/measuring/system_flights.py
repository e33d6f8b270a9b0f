"""Flights of systems: motion follows the courses of the table [series], or continues from the start; with wind.

A system starts in motion. Free points without a position, and force-controlled drums, start in equilibrium at rest. While
driven points move or winches turn, that equilibrium moves, and so do they at the start: at its rate, a central difference
over `SHORT` before and after the start. A point that started at rest would be jerked.
"""

import hashlib
from copy import deepcopy
from dataclasses import dataclass, field, replace
from warnings import catch_warnings

import numpy as np

from tetherfmu.files import system_files as files
from tetherfmu.files.courses import RELEASE, course
from tetherfmu.files.driven import MOVED, WINCH
from tetherfmu.files.driven import Path as Way
from tetherfmu.files.named import named_scenes, named_systems, path_of
from tetherfmu.files.scene_files import EVERY, SceneError
from tetherfmu.files.settings import put, with_settings
from tetherfmu.files.system_files import OF_THE_FLIGHT, SystemFile
from tetherfmu.files.toml_files import check_once, record, require, tables_of, value_of, vector
from tetherfmu.files.winds import Wind
from tetherfmu.python.given_inputs import LEADS
from tetherfmu.python.tether_system import TetherSystem
from tetherfmu.records.problems import PlausibilityWarning
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import BY_NAME
from tetherfmu.runtime.naming import meant_or_all, prefixed
from tetherfmu.runtime.parameters import changed
from tetherfmu.runtime.quantities import check, quantities, quantity

STEP = 0.02  # default communication step [s]
SHORT = 0.01  # before and after the start, of a difference [s]
STILL = (0.0, 0.0, 0.0)
ARGUMENTS = {name: f"{name}s" for name in (*WINCH, RELEASE)}  # of `TetherSystem.fly`, by the names of inputs


@dataclass(frozen=True)
class Wanted:
    """Requirements for a system."""

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
    series: dict = field(default_factory=dict)  # motions: by argument of `TetherSystem.fly` a function of time by name
    wanted: Wanted = Wanted()
    digest: str = ""  # of all that is in its files
    __post_init__ = check

    @property
    def name(self):
        """Name of the system."""
        return self.found.name

    @property
    def has_release(self):
        """Whether a line is let go."""
        return "releases" in self.series

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
        lines = [replace(each, tether=changed(each.tether, {"segments": segments[each.name]})) for each in self.found.lines]
        system = TetherSystem.of(self.found, lines=lines, solver=solver)
        time, every = step * np.arange(self.calls(step)), round(self.every / step)
        wind = self.wind_at(time + 0.5 * step * exact)
        with catch_warnings(action="ignore", category=PlausibilityWarning):  # `implausible` has them
            self.start(system)
            return system, system.fly(len(time), step, **self.given(time) | {"wind_velocity": wind}, every=every)

    def wind_at(self, time):
        """Wind [m/s] at times [s], array (times, 3)."""
        return self.series.get("wind_velocity", self.wind)(time)

    def given(self, time):
        """Arguments of `TetherSystem.fly` at times [s], a dict; of `step` and `initialize` at a time."""
        found = {"wind_velocity": self.wind_at(time), "loads": dict(self.loads)}
        driven = (each for each in self.found.points if each.is_driven)  # straight on
        found["positions"] = {each.name: np.add(each.position, np.multiply.outer(time, each.velocity)) for each in driven}
        for what, own in self.series.items():
            if what != "wind_velocity":
                found[what] = found.get(what, {}) | {name: each(time) for name, each in own.items()}
        return found

    def start(self, system):
        """Initialize a `TetherSystem` in motion (modified); its `SystemOutputs`."""
        given = started(self.found, self.given(0.0))
        for what, own in motion_of_equilibrium(self.found, given).items():
            given[what] = given.get(what, {}) | own
        return system.initialize(**given)

    @property
    def flown_time(self):
        """From the start to the last compared output [s]."""
        return self.count * self.every

    def calls(self, step):
        """Number of communication steps [s]."""
        return self.count * round(self.every / step)

    def segments_of_lines(self, factor):
        """Segments of each line, from the file times a factor, dict by name; at least 1."""
        own = {each.name: each.tether.segments for each in self.found.lines}
        return {name: min(at.MAX_SEGMENTS, max(1, round(factor * count))) for name, count in own.items()}


def file_of(given):
    """Path of a scene or a system from a path or a name, and whether it is a system; SceneError for an unknown name."""
    with prefixed("", SceneError):
        path = path_of(given, named_scenes() | named_systems())
    try:
        return path, "points" in tables_of(path)
    except ValueError:
        return path, False  # reported on reading


def load(path, settings=()):
    """`SystemFlight` of the file (Path) of a system; SceneError describes a problem in one line.

    settings : pairs of keys of the file and their values; or ``duration``, ``wind.velocity`` and the like,
    ``wanted.allowed_error`` and ``wanted.communication_step``, as in a scene file, and ``loads.NAME`` of a free point.
    """
    with prefixed(f"{path}: ", SceneError):
        return read(with_values(tables_of(path), settings), path.parent, path.stem)


def with_values(table, settings):
    """Table of a file of a system, dict, with replaced values, `settings` as for `load`; ValueError for one given twice."""
    check_once(name for name, _ in settings)
    of_flight = [pair for pair in settings if pair[0].partition(".")[0] in OF_THE_FLIGHT]
    table = with_settings(deepcopy(table), of_flight)
    for key, value in (pair for pair in settings if pair not in of_flight):
        put(table, key, value)
    return table


def read(table, folder, name):
    """`SystemFlight` from the table of a file in a folder; ValueError names the key. name : of the system without one."""
    found = files.read(table, name)
    series, courses = series_in(table.get("series", {}), found, folder)
    end, contents = max((each.times[-1] for each in courses), default=0.0), b"".join(each.contents for each in courses)
    if "wind_velocity" in series and "wind" in table:
        raise ValueError("wind is given here and as series.wind_velocity; it must be given once")
    given = {"wind": record(Wind, table.get("wind", {}), "wind"), "series": series}
    given["loads"] = loads_in(table.get("loads", {}))
    given["wanted"] = record(Wanted, table.get("wanted", {}), "wanted")
    if "duration" in table:
        given["duration"] = value_of(SystemFlight, "duration", table["duration"], "")
    elif end > 0.0:
        given["duration"] = max(float(end), dict(quantities(SystemFlight))["duration"].minimum)
    digest = hashlib.sha256(repr((found.name, table, contents)).encode()).hexdigest()[:16]
    flight = SystemFlight(found, **given, digest=digest)
    refuse(flight)
    return flight


def series_in(table, found, folder):
    """Courses of the table [series] of a file, as `SystemFlight.series`, and a list of them.

    found : `SystemFile`.  folder : of CSV files.  ValueError names the key.
    """
    require(table, "series", table)
    known, series, courses, ways = driven_by(found), {}, [], {}
    for name, own in table.items():
        if name == "wind_velocity":
            series[name] = course("series.wind_velocity", own, name, "m/s", 3, folder)
            courses.append(series[name])
            continue
        if name not in known:
            raise ValueError(f"unknown key series.{name}{meant_or_all(name, [*known, 'wind_velocity'], 'known are {}')}")
        require(own, f"series.{name}", known[name])
        for what, value in own.items():
            made = course(f"series.{name}.{what}", value, what, *known[name][what], folder)
            courses.append(made)
            if what in MOVED:
                ways.setdefault(name, {})[what] = made
            else:
                series.setdefault({"load": "loads"}.get(what) or ARGUMENTS[what], {})[name] = made
    starts = {each.name: each.position for each in found.points}
    for name, own in ways.items():
        with prefixed(f"series.{name} "):
            way = Way(own, starts[name])
        series.setdefault("positions", {})[name] = way.position
        series.setdefault("velocities", {})[name] = way.velocity
    return series, courses


def driven_by(found):
    """Keys of the table [series] of a `SystemFile`, by name of a point, a line or a winch: unit and size by input."""
    known = {}
    for each in found.points:
        known[each.name] = dict(MOVED) if each.is_driven else {"load": ("N", 3)}
    held = {name for winch in found.winches for name in winch.lines}
    units = {name: BY_NAME[name].unit for name in WINCH}
    for line in found.lines:
        known[line.name] = {RELEASE: ("", 1)}
        if line.name not in held:
            name = next(name for name, control in LEADS.items() if control == line.winch.winch_control)
            known[line.name][name] = (units[name], 1)
    for winch in found.winches:
        known[winch.name] = {winch.input: (units[winch.input], 1)}
    return known


def loads_in(table):
    """Loads on free points [N], dict by name; ValueError names an unknown one."""
    require(table, "loads", table)
    found = {}
    for name, value in table.items():
        with prefixed(f"loads.{name} is {value!r}; "):
            found[name] = vector(value, "N")
    return found


def refuse(flight):
    """ValueError if a winch of a `SystemFlight` needs a force that is not specified, or a load is not on a free point."""
    forces = flight.series.get("winch_forces", {})
    for each in flight.found.lines:
        if each.winch.winch_control == at.WINCH_BY_FORCE and each.name not in forces:
            raise ValueError(
                f"lines.{each.name}.winch_control is force, and nothing gives that; give series.{each.name}.winch_force"
            )
    free = [each.name for each in flight.found.points if not each.is_driven]
    for name in flight.loads:
        if name not in free:
            raise ValueError(
                f"loads.{name} is given, and {name} is not a free point{meant_or_all(name, free, 'those are {}')}"
            )
        if name in flight.series.get("loads", {}):
            raise ValueError(f"loads.{name} and series.{name}.load are both given; give one of them")


def started(found, given):
    """Arguments of `TetherSystem.initialize` from those of a step at the start; found : `SystemFile`."""
    own = {what: value for what, value in given.items() if what not in ("releases", "winch_lengths")}
    driven = {each.name: each.velocity for each in found.points if each.is_driven}
    return own | {"velocities": driven | own.get("velocities", {})}


def motion_of_equilibrium(found, given):
    """Velocities of sought free points and speeds of sought drums: arguments of `initialize`, by name.

    found : `SystemFile`.  given : its arguments, as for `started`.  {} if nothing moves, or nothing is sought.
    """
    points = [each.name for each in found.points if each.position is None and not any(each.velocity)]
    drums = [each.name for each in found.lines if is_sought(each.winch) and not each.reel_out_speed]
    shared = [each.name for each in found.winches if is_sought(each.drum) and not each.reel_out_speed]
    speeds = speeds_of_lines(found, given.get("reel_out_speeds", {}))
    moves = any(map(np.any, given["velocities"].values())) or any(speeds.values())
    if not moves or not (points or drums or shared):
        return {}
    before, after = (equilibrium(found, given, speeds, time) for time in (-SHORT, SHORT))

    def rate(value):
        """Of something of the outputs, a function of them."""
        return (value(after) - value(before)) / (2.0 * SHORT)

    velocities = {name: rate(lambda now, name=name: now.points[name].position) for name in points}
    turning = {name: rate(lambda now, name=name: now.lines[name].tether_length) for name in drums}
    turning |= {name: rate(lambda now, name=name: now.winches[name].payout) for name in shared}
    return {"velocities": velocities, "reel_out_speeds": turning}


def is_sought(winch):
    """Whether a `Winch` starts with the length that balances its force."""
    return winch.winch_control == at.WINCH_BY_FORCE and winch.winch_start == at.WINCH_IN_BALANCE


def speeds_of_lines(found, given):
    """Reel-out speeds [m/s] of lines, by name, whose winch is not sought; given : input speeds, by name."""
    by_speed = [each for each in found.winches if each.control == "speed"]
    speeds = {
        each.name: 0.0 if is_sought(each.winch) else float(given.get(each.name, each.reel_out_speed)) for each in found.lines
    }
    for winch in by_speed:
        for line, ratio in winch.lines.items():
            speeds[line] += ratio * float(given.get(winch.name, winch.reel_out_speed))
    return speeds


def equilibrium(found, given, speeds, time):
    """`SystemOutputs` of the system at rest where it would be at a time [s] before or after its start."""
    system = TetherSystem.of(found, lines=[with_length(each, time * speeds[each.name]) for each in found.lines])
    velocities = given["velocities"]
    positions = {name: np.add(place, time * np.asarray(velocities[name])) for name, place in given["positions"].items()}
    own = {what: value for what, value in given.items() if what != "reel_out_speeds"}
    return system.initialize(**own | {"positions": positions, "velocities": dict.fromkeys(velocities, STILL)})


def with_length(line, more):
    """A line with this additional unstretched length [m]; one with portions of given lengths is unchanged."""
    if not more or line.initial_portions is not None:
        return line
    return replace(line, tether=changed(line.tether, {"initial_length": line.tether.initial_length + more}))
