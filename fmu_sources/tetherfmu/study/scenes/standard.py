"""The scenes of the benchmark: a tether on a circling kite, on one that flies figures of eight, and a released one.

Circle: the kite flies on a cone of half angle 10 deg about an axis 20 deg above the horizon, 500 m away, 0.05 rad/s, in a
wind of 8 m/s; tether 525 m. It starts turning with the kite (`initial_shape = quasi_steady`).

Figure of eight: laps of 20 s at 40 m/s, 500 m away, in a wind of 8 m/s; taut tether of 499 m (`flights.FigureOfEight`).

Release: 70 m held between (0, 0, 0) and (-40, 0, -47) until at rest; then the lower end is free and the tether reels out
at 0.3 m/s.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tetherfmu import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.variants import VARIANTS, class_name

from .flights import FigureOfEight

STEP = 0.02  # communication step [s]
CIRCLE_RATE = 0.05  # [rad/s]
REVOLUTION = 2.0 * np.pi / CIRCLE_RATE
CIRCLE_LENGTH = 525.0
EIGHT, EIGHT_LENGTH = FigureOfEight(), 499.0
RELEASE_LENGTH = 70.0
RELEASE_POINT = (-40.0, 0.0, -47.0)
MODELS = {variant: getattr(models, class_name(variant)) for variant in VARIANTS}
QUASI_STEADY_START = 2


class RaceScene(NamedTuple):
    """What all solvers are given. SI units."""

    name: str
    tether: Tether
    environment: Environment
    wind: tuple
    reel_out_speed: float
    kite_is_free: bool
    duration: float
    every: float  # time between two outputs that are compared with the reference
    path: Callable | None = None  # position and velocity of a driven kite, a function of (time, sin, cos)

    @property
    def times(self):
        """Times [s] of the outputs, the start included."""
        return self.every * np.arange(round(self.duration / self.every) + 1)


def circle(time, sin=np.sin, cos=np.cos):
    """Position [m] and velocity [m/s] of the circling kite, lists of three; `sin` and `cos` may be symbolic."""
    half_angle, tilt = np.radians([10.0, 70.0])
    radius, height = 500.0 * np.sin(half_angle), 500.0 * np.cos(half_angle)
    c, s = cos(CIRCLE_RATE * time), sin(CIRCLE_RATE * time)

    def turn(x, y, z):
        return [x, np.cos(tilt) * y - np.sin(tilt) * z, np.sin(tilt) * y + np.cos(tilt) * z]

    speed = radius * CIRCLE_RATE
    return turn(radius * c, radius * s, height), turn(-speed * s, speed * c, 0.0 * c)


def circle_scene(segments, duration=REVOLUTION):
    """The circle with so many segments."""
    every = 0.5 if duration > 5.0 else 10 * STEP
    duration = every * int(duration / every)
    tether = Tether(segments=segments, initial_length=CIRCLE_LENGTH)
    return RaceScene("circle", tether, Environment(), (8.0, 0.0, 0.0), 0.0, False, duration, every, circle)


def figure_of_eight(time, sin=np.sin, cos=np.cos):
    """Position [m] and velocity [m/s] of the kite of `EIGHT`, lists of three; `sin` and `cos` may be symbolic."""
    r, width, rate = EIGHT.distance, EIGHT.width(), 2.0 * np.pi / EIGHT.lap
    u = rate * time
    azimuth, azimuth_rate = width * sin(u), width * rate * cos(u)
    elevation = EIGHT.elevation + EIGHT.flatness * width * sin(2.0 * u)
    elevation_rate = EIGHT.flatness * width * 2.0 * rate * cos(2.0 * u)
    ce, se, ca, sa = cos(elevation), sin(elevation), cos(azimuth), sin(azimuth)
    outward = (-se * ca * elevation_rate - ce * sa * azimuth_rate, -se * sa * elevation_rate + ce * ca * azimuth_rate)
    return [r * ce * ca, r * ce * sa, r * se], [r * outward[0], r * outward[1], r * ce * elevation_rate]


def figure_of_eight_scene(segments, duration=40.0):
    """The figures of eight with so many segments."""
    tether = Tether(segments=segments, initial_length=EIGHT_LENGTH)
    return RaceScene("figure of eight", tether, Environment(), (8.0, 0.0, 0.0), 0.0, False, duration, 0.2, figure_of_eight)


def release_scene(segments, duration=10.0):
    """The release with so many segments."""
    tether = Tether(segments=segments, initial_length=RELEASE_LENGTH)
    return RaceScene("release", tether, Environment(), (0.0, 0.0, 0.0), 0.3, True, duration, 0.1)


def circle_inputs(count):
    """Inputs of `count` communication steps of the circle, array (count, `layout.INPUTS`)."""
    return inputs_of(circle_scene(1), STEP, count)


def inputs_of(scene, step, count=None):
    """Inputs of `count` communication steps [s] of a scene, all of them by default, array (count, `layout.INPUTS`)."""
    count = round(scene.duration / step) if count is None else count
    inputs = np.zeros((count, at.INPUTS))
    if scene.path:
        position, velocity = scene.path(step * np.arange(count))
        inputs[:, at.KITE_POSITION : at.KITE_POSITION + 3] = np.transpose(position)
        inputs[:, at.KITE_VELOCITY : at.KITE_VELOCITY + 3] = np.transpose(velocity)
    inputs[:, at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = scene.wind
    inputs[:, at.REEL_OUT_SPEED] = scene.reel_out_speed
    return inputs


def tether_at_start(scene, tolerance=0.0, variant="dynamic", library=None):
    """A tether of a variant, initialized for a scene; `tolerance` 0 is the solver's default, `library` as in TetherModel."""
    if scene.kite_is_free:
        solver = Solver(relative_tolerance=tolerance)
        model = models.TetherDynamic(scene.tether, scene.environment, solver, free_ends=(False, True), library=library)
        model.initialize(RELEASE_POINT, reel_out_speed=scene.reel_out_speed)
        return model
    solver = Solver(relative_tolerance=tolerance, initial_shape=QUASI_STEADY_START)
    model = MODELS[variant](scene.tether, scene.environment, solver, library=library)
    model.initialize(*scene.path(0.0), wind_velocity=scene.wind)
    return model
