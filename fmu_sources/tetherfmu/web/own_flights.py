"""Flights of the page in addition to scene files: a kite that follows the pointer, a free kite, a hanging load.

Also the settings that a user changes during a run.
"""

import tomllib
from dataclasses import dataclass
from math import pi, radians
from pathlib import Path

from tetherfmu.runtime.inputs import BY_NAME
from tetherfmu.runtime.quantities import DEGREES, choice, quantity


@dataclass(frozen=True)
class Pointer:
    """The kite follows the pointer on a sphere around the ground station."""

    distance: float = quantity(100.0, "m", "of the kite from the ground station", 1.0, 1e4)
    elevation: float = quantity(radians(40.0), "rad", "of the kite at the start", 0.0, 1.5, display=DEGREES)
    speed: float = quantity(30.0, "m/s", "of the kite at most", 0.1, 200.0)
    response_time: float = quantity(1.5, "s", "in which the kite comes to the pointer, about", 0.1, 60.0)


@dataclass(frozen=True)
class FreeFlight:
    """The kite flies free: the tether moves it under lift and drag of a soft wing, which a person or a controller steers."""

    autopilot: int = choice(
        "who steers",
        2,
        by_hand="a person",
        figures_of_eight="a controller, figures of eight at constant reel-out speed",
        pumping_cycles="a controller, pumping cycles",
    )
    initial_elevation: float = quantity(radians(30.0), "rad", "of the kite at the start", 0.0, 1.5, display=DEGREES)


@dataclass(frozen=True)
class Hand:
    """Manual controls during a flight."""

    steering: float = quantity(0.0, "", "of the free kite; positive turns right as seen from the ground station", -1.0, 1.0)
    depower: float = quantity(0.0, "", "of the free kite, 0: full lift, 1: depowered", 0.0, 1.0)
    reel_out_speed: float = quantity(0.0, "m/s", BY_NAME["reel_out_speed"].meaning, -20.0, 20.0)
    winch_force: float = quantity(2000.0, "N", BY_NAME["winch_force"].meaning, -1e9, 1e9)


@dataclass(frozen=True)
class WindVelocity:
    """The horizontal wind by speed and direction."""

    speed: float = quantity(8.0, "m/s", "of the wind at wind_reference_height", 0.0, 200.0)
    direction: float = quantity(
        0.0, "rad", "to which the wind blows, anti-clockwise from the x axis", -pi, pi, display=DEGREES
    )


@dataclass(frozen=True)
class Log:
    """The ends move as in a log: positions of the kite over time, and what else it has of motion, winch and wind."""


KINDS = {"pointer": Pointer, "free": FreeFlight, "log": Log}
with Path(__file__).with_name("assets").joinpath("own_scenes.toml").open("rb") as _file:
    SCENES = {name: {"duration": None, **scene} for name, scene in tomllib.load(_file).items()}
