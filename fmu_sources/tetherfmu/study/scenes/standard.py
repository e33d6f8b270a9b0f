"""The scenes of the benchmark: a tether on a circling kite, on one that flies figures of eight, and a released one.

Circle, figure of eight: the flights of `flights.Circle` and `flights.FigureOfEight` as they are by default, with a tether of
525 m and a taut one of 499 m, in a wind of 8 m/s. They start turning with the kite (`initial_shape = quasi_steady`).

Release: 70 m held between (0, 0, 0) and (-40, 0, -47) until at rest; then the lower end is free and the tether reels out
at 0.3 m/s.
"""

from typing import NamedTuple

import numpy as np

from tetherfmu import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.variants import VARIANTS, class_name

from .flights import Circle, FigureOfEight, Flight

STEP = 0.02  # communication step [s]
REVOLUTION = 2.0 * np.pi / Circle().rate
CIRCLE_LENGTH, EIGHT_LENGTH, RELEASE_LENGTH = 525.0, 499.0, 70.0
RELEASE_POINT = (-40.0, 0.0, -47.0)
MODELS = {variant: getattr(models, class_name(variant)) for variant in VARIANTS}
QUASI_STEADY_START = 2


class RaceScene(NamedTuple):
    """What all solvers are given. SI units."""

    name: str
    flight: Flight | None  # of the kite; None: it is free
    tether: Tether
    wind: tuple
    reel_out_speed: float
    duration: float
    every: float  # time between two outputs that are compared with the reference
    environment: Environment = Environment()

    @property
    def kite_is_free(self):
        """Whether nothing holds the kite end."""
        return self.flight is None

    @property
    def times(self):
        """Times [s] of the outputs, the start included."""
        return self.every * np.arange(round(self.duration / self.every) + 1)

    def path(self, time):
        """Position [m] and velocity [m/s] of a driven kite."""
        return self.flight.motion(time)[:2]


def circle_scene(segments, duration=REVOLUTION):
    """The circle with so many segments."""
    every = 0.5 if duration > 5.0 else 10 * STEP
    tether = Tether(segments=segments, initial_length=CIRCLE_LENGTH)
    return RaceScene("circle", Circle(), tether, (8.0, 0.0, 0.0), 0.0, every * int(duration / every), every)


def figure_of_eight_scene(segments, duration=40.0):
    """The figures of eight with so many segments."""
    tether = Tether(segments=segments, initial_length=EIGHT_LENGTH)
    return RaceScene("figure of eight", FigureOfEight(), tether, (8.0, 0.0, 0.0), 0.0, duration, 0.2)


def release_scene(segments, duration=10.0):
    """The release with so many segments."""
    tether = Tether(segments=segments, initial_length=RELEASE_LENGTH)
    return RaceScene("release", None, tether, (0.0, 0.0, 0.0), 0.3, duration, 0.1)


def circle_inputs(count):
    """Inputs of `count` communication steps of the circle, array (count, `layout.INPUTS`)."""
    return inputs_of(circle_scene(1), STEP, count)


def inputs_of(scene, step, count=None):
    """Inputs of `count` communication steps [s] of a scene, all of them by default, array (count, `layout.INPUTS`)."""
    count = round(scene.duration / step) if count is None else count
    inputs = np.zeros((count, at.INPUTS))
    if not scene.kite_is_free:
        inputs[:, at.KITE_POSITION : at.KITE_VELOCITY + 3] = np.hstack(scene.path(step * np.arange(count)))
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
