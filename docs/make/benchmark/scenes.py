"""The scenes of the benchmark: a tether on a circling kite, on one that flies figures of eight, and a released one.

The first two start turning with the kite (`initial_shape = quasi_steady`). The third is held until at rest; then its lower
end is free and the tether reels out.
"""

from dataclasses import dataclass

import numpy as np

from tetherfmu.files.flights import Circle, FigureOfEight, Flight
from tetherfmu.files.scene_files import Scene
from tetherfmu.files.winds import Wind
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Tether
from tetherfmu.study.measuring.start import tether_at_start

STEP = 0.02  # communication step [s]
REVOLUTION = 2.0 * np.pi / Circle().rate
BREEZE = Wind((8.0, 0.0, 0.0))


@dataclass(frozen=True)
class Race(Scene):
    """A scene in which the kite end may be let go after the start, while the winch pays out at a constant speed [m/s]."""

    end_is_free: bool = False
    reel_out_speed: float = 0.0


def at_start(race, tolerance=0.0, **options):
    """As `tether_at_start`."""
    if race.end_is_free:
        options |= {"free_ends": (False, True), "initial_shape": at.STATIC_EQUILIBRIUM}
    return tether_at_start(race, tolerance, **options)


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
    return Race("circle", every * int(duration / every), Circle(), tether, wind=BREEZE, every=every)


def figure_of_eight_scene(segments, duration=40.0):
    """The figures of eight with so many segments."""
    tether = Tether(segments=segments, initial_length=499.0)
    return Race("figure of eight", duration, FigureOfEight(), tether, wind=BREEZE, every=0.2)


def release_scene(segments, duration=10.0):
    """The release with so many segments."""
    tether, winch = Tether(segments=segments, initial_length=70.0), Release.reel_out_speed
    return Race("release", duration, Release(), tether, end_is_free=True, reel_out_speed=winch)
