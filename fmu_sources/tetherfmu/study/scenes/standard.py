"""The scenes of the benchmark: a tether on a circling kite, on one that flies figures of eight, and a released one.

The first two start turning with the kite (`initial_shape = quasi_steady`). The third is held until at rest; then its lower
end is free and the tether reels out.
"""

import numpy as np

from tetherfmu import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Solver, Tether
from tetherfmu.runtime.variants import VARIANTS, class_name

from .files import Scene, Wind
from .flights import Circle, FigureOfEight, Flight

STEP = 0.02  # communication step [s]
REVOLUTION = 2.0 * np.pi / Circle().rate
BREEZE = Wind((8.0, 0.0, 0.0))
MODELS = {variant: getattr(models, class_name(variant)) for variant in VARIANTS}
STATIC_START, QUASI_STEADY_START = 1, 2


class Release(Flight):
    """The kite end is held at a point until it is let go, and the winch pays out."""

    reel_out_speed = 0.3  # [m/s]

    def kite(self, time):
        """Where it is held."""
        return 0.0 * time - 40.0, 0.0 * time, 0.0 * time - 47.0

    def reeled(self, time):
        """Out at a constant speed."""
        return self.reel_out_speed * time


def circle_scene(segments, duration=REVOLUTION):
    """The circle with so many segments."""
    every = 0.5 if duration > 5.0 else 10 * STEP
    tether = Tether(segments=segments, initial_length=525.0)
    return Scene("circle", every * int(duration / every), Circle(), tether, wind=BREEZE, every=every)


def figure_of_eight_scene(segments, duration=40.0):
    """The figures of eight with so many segments."""
    tether = Tether(segments=segments, initial_length=499.0)
    return Scene("figure of eight", duration, FigureOfEight(), tether, wind=BREEZE, every=0.2)


def release_scene(segments, duration=10.0):
    """The release with so many segments."""
    tether, winch = Tether(segments=segments, initial_length=70.0), Release.reel_out_speed
    return Scene("release", duration, Release(), tether, kite_is_free=True, reel_out_speed=winch)


def tether_at_start(scene, tolerance=0.0, variant="dynamic", first=None, held=False, **options):
    """A tether of a variant, initialized for a scene; `tolerance` 0 is the solver's default.

    first : inputs to start with, array (`layout.INPUTS`,); None: those of the start.  held : whether the reel-out speed
    stays as it is during a step.  options : of TetherModel.
    """
    shape = QUASI_STEADY_START
    if isinstance(scene.flight, Release):
        shape, options["free_ends"] = STATIC_START, (False, True)
    solver = Solver(tolerance, initial_shape=shape, input_continuation=at.HELD if held else at.LINEAR)
    model = MODELS[variant](scene.tether, scene.environment, solver, **options)
    first = scene.inputs(scene.every)[0] if first is None else first
    ends, wind_velocity = first[: at.REEL_OUT_SPEED].reshape(4, 3), first[at.WIND_VELOCITY : at.KITE_LOAD]
    model.initialize(*ends, first[at.REEL_OUT_SPEED], wind_velocity)
    return model
