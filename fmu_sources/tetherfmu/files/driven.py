"""The table [series] of a file: courses of points, and in a scene the driven flight."""

from itertools import pairwise

import numpy as np

from tetherfmu.records.paths import polar
from tetherfmu.runtime.inputs import BY_NAME
from tetherfmu.runtime.naming import meant_or_all, prefixed

from .courses import RELEASE, course
from .csv_files import ANGLES, UNITS_OF_ANGLES
from .flights import TINY

MOVED = {
    "position": ("m", 3),
    "velocity": ("m/s", 3),
    **{name: (unit, 1) for name, unit in zip(ANGLES, UNITS_OF_ANGLES, strict=True)},
}
WINCH = ("reel_out_speed", "winch_force", "winch_length")
OF_A_SCENE = ("kite_position", "kite_velocity", *ANGLES, "ground_position", "ground_velocity")
OF_A_SCENE += ("kite_load", *WINCH, "wind_velocity", RELEASE)


class Path:
    """A point that follows its courses, a dict: by position, by velocity from a start [m] on, or by angles.

    ValueError if it has none of these, or more than one.
    """

    def __init__(self, courses, start=(0.0, 0.0, 0.0)):
        ways = [way for way in (("position",), ("velocity",), ANGLES) if courses.keys() & {*way}]
        for one, other in pairwise(ways):
            raise ValueError(f"has {one[0]} and {other[0]}; it must have one of position, velocity and the angles")
        for name in ways[0]:
            if name not in courses:
                raise ValueError(f"has {', '.join(courses)} and no {name}; a direction needs {', '.join(ANGLES)}")
        self.courses, self.start = courses, np.asarray(start, float)

    def position(self, time):
        """Positions [m] at times [s], array (times, 3)."""
        if "position" in self.courses:
            return self.courses["position"](time)
        if "velocity" in self.courses:
            return self.start + self.courses["velocity"].integral(time)
        return np.stack(polar(*(each(time) for each in self._polar())), -1)

    def velocity(self, time):
        """Velocities [m/s] at times [s], array (times, 3)."""
        if "position" in self.courses:
            return self.courses["position"].rate(time)
        if "velocity" in self.courses:
            return self.courses["velocity"](time)
        return np.imag(np.stack(polar(*(each(time) + 1j * TINY * each.rate(time) for each in self._polar())), -1)) / TINY

    def _polar(self):
        """Courses of distance, elevation and azimuth."""
        return [self.courses[name] for name in ("distance", "elevation", "azimuth")]


class AtDistance:
    """The kite of a flight in the direction that it has, at another distance from the origin, a course."""

    def __init__(self, flight, distance):
        self.flight, self.distance = flight, distance

    def position(self, time):
        """Positions [m] at times [s], array (times, 3)."""
        return self.distance(time)[..., None] * self._direction(time)[0]

    def velocity(self, time):
        """Velocities [m/s] at times [s], array (times, 3)."""
        direction, rate = self._direction(time)
        return self.distance.rate(time)[..., None] * direction + self.distance(time)[..., None] * rate

    def _direction(self, time):
        """Unit vectors from the origin to the kite, and their rates [1/s]: u = p/|p|, du/dt = (v - u (u v))/|p|."""
        motion = self.flight.motion(time)
        far = np.linalg.norm(motion.kite, axis=-1, keepdims=True)
        direction = motion.kite / far
        along = np.sum(direction * motion.kite_velocity, axis=-1, keepdims=True)
        return direction, (motion.kite_velocity - along * direction) / far


class Driven:
    """A flight of a scene with courses that replace its inputs, dict by input name; see `flights.Flight`."""

    def __init__(self, flight, courses):
        self.flight, self.courses = flight, courses
        self.contents = flight.contents + b"".join(each.contents for each in courses.values())
        self.wind = courses.get("wind_velocity") or flight.wind
        self.has_length, self.has_force = ("winch_length" in courses), ("winch_force" in courses)
        controlled = {"winch_length", "winch_force"} & courses.keys()
        if not controlled:
            self.has_length, self.has_force = flight.has_length, flight.has_force
        self.force = courses.get("winch_force") or flight.force
        self.initial_length = float(courses["winch_length"](0.0)) if "winch_length" in courses else flight.initial_length
        self.has_release = RELEASE in courses or flight.has_release
        self.release_time = courses[RELEASE].first() if RELEASE in courses else flight.release_time
        first = flight.motion(np.zeros(1))
        self._paths = {}
        for end in ("kite", "ground"):
            own = {name: courses[f"{end}_{name}"] for name in ("position", "velocity") if f"{end}_{name}" in courses}
            own |= {name: courses[name] for name in ANGLES if name in courses} if end == "kite" else {}
            if [*own] == ["distance"]:
                self._paths[end] = AtDistance(flight, courses["distance"])
            elif own:
                with prefixed(f"series: {end} "):
                    self._paths[end] = Path(own, getattr(first, end)[0])
        self.has_velocities = flight.has_velocities or len(self._paths) == 2  # of all ends

    def motion(self, time):
        """`Motion` at times [s]."""
        found = self.flight.motion(time)
        for end, path in self._paths.items():
            found = found._replace(**{end: path.position(time), f"{end}_velocity": path.velocity(time)})
        if "winch_length" in self.courses:
            length = self.courses["winch_length"]
            return found._replace(reeled=length(time) - length(0.0), reel_out_speed=length.rate(time))
        if "reel_out_speed" in self.courses:
            speed = self.courses["reel_out_speed"]
            return found._replace(reeled=speed.integral(time), reel_out_speed=speed(time))
        return found

    def ground(self, time):
        """Position of the ground end [m]."""
        return tuple(self.motion(np.atleast_1d(np.asarray(time, float))).ground[0])

    def load(self, time=0.0):
        """Force on the free end besides its weight [N], (3,), or (times, 3)."""
        return self.courses["kite_load"](time) if "kite_load" in self.courses else self.flight.load(time)

    def at_rest(self, tether, gravity):
        """Where the free end rests at the start [m], array (3,)."""
        return self.flight.at_rest(tether, gravity, self.load(0.0), self.ground(0.0))

    def __getattr__(self, name):
        """Other attributes of the flight, such as its kite mass."""
        return getattr(self.__dict__["flight"], name) if "flight" in self.__dict__ else super().__getattribute__(name)


def of_scene(table, flight, folder):
    """`Driven` of a flight and the table [series] of a scene in a folder; ValueError names the key."""
    courses = {}
    for name, value in table.items():
        if name not in OF_A_SCENE:
            raise ValueError(f"unknown key series.{name}{meant_or_all(name, OF_A_SCENE, 'known are {}')}")
        unit, size = MOVED.get(name) or (BY_NAME[name].unit, BY_NAME[name].size)
        courses[name] = course(f"series.{name}", value, name, unit, size, folder)
    moved = [name for name in courses if (name.startswith("kite_") and name != "kite_load") or name in ANGLES]
    if moved and flight.kite_is_free:
        raise ValueError(f"series.{moved[0]} moves the kite, which is a free end; give kite_load")
    if "kite_load" in courses and not flight.kite_is_free:
        raise ValueError("series.kite_load is a force on a free end; flight.kind must be 'free_end'")
    if len(controls := [name for name in WINCH[1:] if name in courses]) > 1:
        raise ValueError(f"series has {' and '.join(controls)}; only one of them can control the winch: remove the other")
    if "winch_length" in courses and "reel_out_speed" in courses:
        raise ValueError("series has winch_length and reel_out_speed, which follows from it; remove one of them")
    return Driven(flight, courses)
