"""Flights of a scene: the motion of both ends of the tether, and the payout.

A flight declares its numbers as quantities and its path as a formula; velocities are the derivatives of the formula.
Frame: z up, ground station at the origin at the start, azimuth from the x axis. SI units.
"""

import re
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import numpy as np

from tetherfmu.records.paths import polar
from tetherfmu.runtime.quantities import check, quantity

TINY = 1e-30  # step of the complex-step derivative [s]: exact to rounding


class Motion(NamedTuple):
    """Both ends and the reel at several times; vectors are arrays (times, 3). SI units."""

    kite: np.ndarray
    kite_velocity: np.ndarray
    ground: np.ndarray
    ground_velocity: np.ndarray
    reeled: np.ndarray  # length paid out since the start
    reel_out_speed: np.ndarray


def declared(unit, minimum, maximum):
    """A function of default and meaning that declares a quantity of this unit within these limits."""
    return lambda default, meaning: quantity(default, unit, meaning, minimum=minimum, maximum=maximum)


metres = declared("m", 1e-3, 1e5)
seconds = declared("s", 1e-3, 1e6)
radians = declared("rad", -np.pi / 2, np.pi / 2)
metres_per_second = declared("m/s", -200.0, 200.0)


def swing(amplitude, period, time):
    """To and fro with an amplitude and a period [s]."""
    return amplitude * np.sin(2.0 * np.pi / period * time)


def ramp(u):
    """A smooth step from 0 to 1 for u from 0 to 1: 6 u^5 - 15 u^4 + 10 u^3."""
    u = np.where(np.real(u) < 0.0, 0.0, np.where(np.real(u) > 1.0, 1.0, u))
    return u**3 * (u * (6.0 * u - 15.0) + 10.0)


def ramp_integral(u):
    """Integral of `ramp` from 0 to u: u^6 - 3 u^5 + 2.5 u^4 up to 1, then u - 1/2."""
    inside = np.where(np.real(u) < 0.0, 0.0, u)
    return np.where(np.real(u) > 1.0, u - 0.5, inside**4 * (inside * (inside - 3.0) + 2.5))


@dataclass(frozen=True)
class Flight:
    """A flight by formulas. A kind gives `kite`, its position [m], and where they move, `ground` and `reeled`.

    The formulas take numbers, arrays of them and CasADi symbols; points are triples x, y, z.
    """

    wind = initial_length = force = None  # a series may bring its own, ...
    duration, release_time, contents = np.inf, np.inf, b""  # ... has an end [s] and a file, ...
    has_velocities, scatter, shaking = True, 0.0, 0.0  # ... may lack velocities of moving ends, have noise, ...
    has_length = has_force = False  # ... and return the unstretched length or the winch force instead of the speed
    has_release = False  # only a series releases the kite
    kite_is_free = False  # whether the kite end is a mass that the tether moves
    __post_init__ = check

    def ground(self, time):
        """Position of the ground end [m]."""
        return 0.0 * time, 0.0 * time, 0.0 * time

    def reeled(self, time):
        """Length paid out since the start [m]."""
        return 0.0 * time

    def motion(self, time):
        """`Motion` at times [s]; the rate of a formula f is Im f(t + i TINY) / TINY."""

        def values(t):
            ends = [np.stack(np.broadcast_arrays(*end(t)), -1) for end in (self.kite, self.ground)]
            return *ends, self.reeled(t)

        beyond = values(np.asarray(time, float) + 1j * TINY)
        return Motion(*chain(*((f, np.imag(df) / TINY) for f, df in zip(values(time), beyond, strict=True))))


@dataclass(frozen=True)
class Circle(Flight):
    """The kite circles on a cone whose axis points towards -y."""

    distance: float = metres(500.0, "distance of the kite from the ground station")
    half_angle: float = radians(np.radians(10.0), "half angle of the cone")
    axis_elevation: float = radians(np.radians(20.0), "elevation of the cone axis")
    rate: float = quantity(0.05, "rad/s", "angular rate on the circle", minimum=-20.0, maximum=20.0)

    def kite(self, time):
        """A circle about z, tilted about x."""
        x, y, z = polar(self.distance, np.pi / 2 - self.half_angle, self.rate * time)
        cos, sin = np.sin(self.axis_elevation), np.cos(self.axis_elevation)
        return x, cos * y - sin * z, sin * y + cos * z


@dataclass(frozen=True)
class FigureOfEight(Flight):
    """The kite flies horizontal figures of eight downwind: azimuth a sin u, elevation e + f a sin 2u, 2 pi in u per lap."""

    distance: float = metres(500.0, "distance of the kite from the ground station")
    elevation: float = radians(np.radians(30.0), "elevation of the centre")
    lap: float = seconds(20.0, "period of one figure")
    speed: float = metres_per_second(40.0, "mean kite speed (as on a plane)")
    flatness: float = quantity(0.3, "", "height of a half figure divided by its width, f", minimum=0.0, maximum=1.0)

    def kite(self, time):
        """The curve on the sphere."""
        u, width = 2.0 * np.pi / self.lap * time, self.width()
        return polar(self.distance, self.elevation + self.flatness * width * np.sin(2.0 * u), width * np.sin(u))

    def width(self):
        """Half width a [rad] for which one lap is lap times speed long: a c times the length of the unit figure."""
        u = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
        unit = 2.0 * np.pi * np.mean(np.hypot(np.cos(u), 2.0 * self.flatness * np.cos(2.0 * u)))
        return self.speed * self.lap / (self.distance * unit)


@dataclass(frozen=True)
class Parked(Flight):
    """The kite hovers downwind and sways across the wind."""

    distance: float = metres(300.0, "distance of the kite from the ground station")
    elevation: float = radians(np.radians(60.0), "elevation of the kite")
    sway: float = quantity(5.0, "m", "amplitude of the sway across the wind", minimum=0.0, maximum=1e4)
    sway_period: float = seconds(15.0, "period of the sway")

    def kite(self, time):
        """To and fro at constant distance."""
        return polar(self.distance, self.elevation, swing(self.sway / self.distance, self.sway_period, time))


@dataclass(frozen=True)
class Launch(Flight):
    """The kite climbs on an arc at the end of a short tether."""

    distance: float = metres(30.0, "distance of the kite from the ground station")
    elevation: float = radians(np.radians(15.0), "elevation at the start")
    final_elevation: float = radians(np.radians(70.0), "elevation at the end of the climb")
    climb_time: float = seconds(8.0, "duration of the climb")

    def kite(self, time):
        """Along the arc."""
        part = ramp(time / self.climb_time)
        return polar(self.distance, self.elevation + part * (self.final_elevation - self.elevation), 0.0 * time)


@dataclass(frozen=True)
class Landing(Flight):
    """The kite sinks towards the ground station faster than the winch reels in, so the tether goes slack."""

    distance: float = metres(100.0, "distance of the kite at the start")
    final_distance: float = metres(70.0, "distance of the kite at the end")
    elevation: float = radians(np.radians(60.0), "elevation at the start")
    final_elevation: float = radians(np.radians(10.0), "elevation at the end")
    landing_time: float = seconds(20.0, "duration of the landing")
    reeled_in: float = quantity(20.0, "m", "length reeled in during the landing", minimum=0.0, maximum=1e5)

    def kite(self, time):
        """Down and nearer."""
        part = ramp(time / self.landing_time)
        distance = self.distance + part * (self.final_distance - self.distance)
        return polar(distance, self.elevation + part * (self.final_elevation - self.elevation), 0.0 * time)

    def reeled(self, time):
        """Taken in along the same ramp."""
        return -self.reeled_in * ramp(time / self.landing_time)


@dataclass(frozen=True)
class Towing(Flight):
    """A vehicle accelerates along x and tows the kite, which weaves behind it."""

    distance: float = metres(150.0, "distance of the kite from the vehicle")
    elevation: float = radians(np.radians(40.0), "elevation of the kite, seen from the vehicle")
    speed: float = metres_per_second(10.0, "final speed of the vehicle")
    ramp_time: float = seconds(10.0, "acceleration time of the vehicle")
    weave: float = radians(np.radians(10.0), "azimuth amplitude of the kite")
    weave_period: float = seconds(12.0, "period of the weave")

    def ground(self, time):
        """The vehicle."""
        way = self.speed * self.ramp_time * ramp_integral(time / self.ramp_time)
        return way, 0.0 * time, 0.0 * time

    def kite(self, time):
        """Behind the vehicle."""
        x, y, z = polar(self.distance, self.elevation, np.pi + swing(self.weave, self.weave_period, time))
        return self.ground(time)[0] + x, y, z


@dataclass(frozen=True)
class Reel(Flight):
    """The winch pays out, then reels in the same length; the kite moves away and back, weaving across the wind."""

    distance: float = metres(200.0, "distance of the kite from the ground station at the start")
    elevation: float = radians(np.radians(35.0), "elevation of the kite")
    speed: float = metres_per_second(8.0, "winch speed in both phases")
    phase_time: float = seconds(15.0, "duration of each phase, including ramps")
    ramp_time: float = seconds(3.0, "duration of each speed change")
    weave: float = radians(np.radians(5.0), "azimuth amplitude of the kite")
    weave_period: float = seconds(10.0, "period of the weave")

    def reeled(self, time):
        """Out with smooth ramps, then back in."""
        r, phase = self.ramp_time, self.phase_time
        turns = [(1.0, 0.0), (-2.0, phase - 0.5 * r), (1.0, 2.0 * phase - r)]
        return self.speed * r * sum(factor * ramp_integral((time - begin) / r) for factor, begin in turns)

    def kite(self, time):
        """As far as the tether has been paid out."""
        return polar(self.distance + self.reeled(time), self.elevation, swing(self.weave, self.weave_period, time))


@dataclass(frozen=True)
class FreeEnd(Flight):
    """A mass at the free kite end, on a crane or pulled by a force, starts at rest; the ground end moves."""

    kite_is_free = True
    kite_mass: float = quantity(10.0, "kg", "point mass at the free end", minimum=1e-6, maximum=1e9)
    pull: float = quantity(0.0, "N", "constant force on the mass in addition to its weight", minimum=0.0, maximum=1e9)
    elevation: float = radians(np.pi / 2, "elevation of the pull, which acts along x")
    height: float = quantity(100.0, "m", "height of the ground end at the start", minimum=-1e5, maximum=1e5)
    radius: float = quantity(0.0, "m", "radius of the slewing circle of the ground end", minimum=0.0, maximum=1e4)
    rate: float = quantity(0.0, "rad/s", "final slewing rate", minimum=-10.0, maximum=10.0)
    speed: float = metres_per_second(0.0, "final winch speed; negative hoists")
    ramp_time: float = seconds(10.0, "acceleration time of slewing and winch")
    heave: float = quantity(0.0, "m", "vertical amplitude of the ground end", minimum=0.0, maximum=1e3)
    heave_period: float = seconds(8.0, "period of the heave")

    def ground(self, time):
        """Around, up and down, both from rest."""
        angle = self.rate * self.ramp_time * ramp_integral(time / self.ramp_time)
        up = self.height + self.heave * (1.0 - np.cos(2.0 * np.pi / self.heave_period * time))
        return self.radius * np.cos(angle), self.radius * np.sin(angle), up

    def reeled(self, time):
        """The winch accelerates along a ramp."""
        return self.speed * self.ramp_time * ramp_integral(time / self.ramp_time)

    def kite(self, time):
        """Where the ground end is at the start: where the free end is follows from the tether, see `at_rest`."""
        return tuple(each + 0.0 * time for each in self.ground(0.0 * time))

    def load(self, time=0.0):
        """Constant force on the mass besides its weight [N], array (3,)."""
        return self.pull * np.array((np.cos(self.elevation), 0.0, np.sin(self.elevation)))

    def at_rest(self, tether, gravity, load=None, ground=None):
        """Equilibrium position [m] of the free end, array (3,): along the sum of the forces, with half of the tether weight.

        The stretch is T L/EA with the mean tension; the wave times, which do not count, cover the bending by the other
        half of the weight.  load [N], ground [m] : at the start; None: from the flight.
        """
        mass = self.kite_mass + 0.5 * tether.mass_per_length * tether.initial_length
        force = (self.load() if load is None else load) - (0.0, 0.0, mass * gravity)
        tension = float(np.linalg.norm(force))
        along = force / tension if tension else np.array((0.0, 0.0, -1.0))
        length = tether.initial_length * (1.0 + tension / tether.axial_stiffness)
        return np.array(self.ground(0.0) if ground is None else ground, float) + length * along


KINDS = {re.sub(r"\B([A-Z])", r"_\1", kind.__name__).lower(): kind for kind in Flight.__subclasses__()}
