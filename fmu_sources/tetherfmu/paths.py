"""Where the ends of a tether are: from angles, and along paths that are functions of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetherfmu.runtime import layout as at


def polar(distance, elevation, azimuth):
    """Point [m] at a distance [m] and two angles [rad] from the origin: x, y, z; numbers or arrays, also complex ones."""
    across = distance * np.cos(elevation)
    return across * np.cos(azimuth), across * np.sin(azimuth), distance * np.sin(elevation)


def kite_at(elevation: float, azimuth: float, distance: float, ground_position: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray:
    """Position [m] of a kite, array (3,), from its direction as seen from the ground end.

    elevation : above the horizon [rad].  azimuth : from the x axis, anti-clockwise seen from above [rad], as the output
    `ground_azimuth`.  distance : along a straight line [m].

    >>> kite_at(elevation=0.0, azimuth=0.0, distance=500.0).tolist()
    [500.0, 0.0, 0.0]
    """
    return np.add(ground_position, polar(distance, elevation, azimuth))


@dataclass(frozen=True)
class MovingEnd:
    """An end of a tether that moves along a path.

    Parameters
    ----------
    position : function
        Of the time [s] (a number), gives the position [m], three numbers.
    velocity : function or None
        Gives the velocity [m/s]; None: central differences of the position over 2 `difference`.
    difference : float
        Half the time between the positions of a difference [s]; the error of the velocity is difference^2/6 times the third
        derivative of the position.

    Examples
    --------
    >>> circle = MovingEnd(lambda t: (300.0 * np.cos(0.1 * t), 300.0 * np.sin(0.1 * t), 400.0))
    >>> position, velocity = circle.at(0.0)
    >>> velocity.round(6).tolist()
    [0.0, 30.0, 0.0]
    """

    position: Callable[[float], ArrayLike]
    velocity: Callable[[float], ArrayLike] | None = None
    difference: float = 1e-4

    def at(self, time: float) -> tuple[NDArray, NDArray]:
        """Position [m] and velocity [m/s] at a time [s], arrays (3,); ValueError if the functions give something else."""
        position = self._vector(self.position, "position", time)
        if self.velocity is not None:
            return position, self._vector(self.velocity, "velocity", time)
        ahead, back = (self._vector(self.position, "position", time + way * self.difference) for way in (1.0, -1.0))
        return position, (ahead - back) / (2.0 * self.difference)

    @staticmethod
    def _vector(function, name, time):
        """What a function gives at a time, checked."""
        found = np.asarray(function(time), dtype=float)
        if found.shape != (3,):
            raise ValueError(f"the {name} of the moving end at {time} s has the shape {found.shape}; it must be (3,)")
        return found


def inputs_along(
    steps: int,
    step: float,
    kite: MovingEnd | None = None,
    ground: MovingEnd | None = None,
    reel_out_speed: Callable[[float], float] | float = 0.0,
    wind_velocity: Callable[[float], ArrayLike] | ArrayLike = (0.0, 0.0, 0.0),
    start: float = 0.0,
    kite_load: Callable[[float], ArrayLike] | ArrayLike = (0.0, 0.0, 0.0),
) -> NDArray:
    """Inputs of `steps` communication steps [s] for `TetherModel.fly`, array (steps, INPUTS).

    kite, ground : ends that move; None: at (300, 0, 400) m and at the origin.  reel_out_speed [m/s], wind_velocity [m/s],
    kite_load (of a free kite end) [N] : constant, or functions of time [s].  start : time of the first step [s].

    >>> inputs_along(3, 0.02, wind_velocity=(8.0, 0.0, 0.0)).shape
    (3, 19)
    """
    rows = np.zeros((steps, at.INPUTS))
    still = MovingEnd(lambda time: (0.0, 0.0, 0.0), lambda time: (0.0, 0.0, 0.0))
    parked = MovingEnd(lambda time: (300.0, 0.0, 400.0), still.velocity)
    for k, row in enumerate(rows):
        time = start + k * step
        for place, end in ((at.KITE_POSITION, kite or parked), (at.GROUND_POSITION, ground or still)):
            row[place : place + 6] = np.concatenate(end.at(time))
        row[at.REEL_OUT_SPEED] = reel_out_speed(time) if callable(reel_out_speed) else reel_out_speed
        for place, vector in ((at.WIND_VELOCITY, wind_velocity), (at.KITE_LOAD, kite_load)):
            row[place : place + 3] = vector(time) if callable(vector) else vector
    return rows
