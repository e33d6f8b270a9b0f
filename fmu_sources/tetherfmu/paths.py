"""Where the ends of a tether are: from angles, and along paths that are functions of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetherfmu.naming import check_names
from tetherfmu.runtime.inputs import COUNT, KITE_AT_START, ZERO, by_name


def polar(distance, elevation, azimuth):
    """Point [m] at a distance [m] and two angles [rad] from the origin: x, y, z; numbers or arrays, also complex ones."""
    across = distance * np.cos(elevation)
    return across * np.cos(azimuth), across * np.sin(azimuth), distance * np.sin(elevation)


def kite_at(elevation: float, azimuth: float, distance: float, ground_position: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray:
    """Position [m] of a kite, array (3,), from its direction as seen from the ground end.

    elevation : above the horizon [rad].  azimuth : from the x axis, anti-clockwise seen from above [rad], as the output
    `ground_azimuth`.  distance : along a straight line [m].  ValueError if the elevation is beyond pi/2.

    >>> kite_at(elevation=0.0, azimuth=0.0, distance=500.0).tolist()
    [500.0, 0.0, 0.0]
    """
    if not np.all(np.abs(elevation) <= 0.5 * np.pi):  # NaN is not
        raise ValueError(
            f"elevation is {elevation!r}; it must be at least -pi/2 and at most pi/2 rad: angles are in rad, "
            "math.radians makes them of degrees"
        )
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


def end_of(name, given):
    """A moving end as it is, three numbers as an end that stays there [m]; ValueError for anything else."""
    if isinstance(given, MovingEnd):
        return given
    try:
        place = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        place = np.empty(0)
    if place.shape != (3,):
        raise ValueError(f"{name} is {given!r}; it must be a MovingEnd, or three numbers where it stays")
    return MovingEnd(lambda time: place, lambda time: (0.0, 0.0, 0.0))


def inputs_along(
    steps: int,
    step: float,
    kite: MovingEnd | ArrayLike | None = None,
    ground: MovingEnd | ArrayLike | None = None,
    *,
    start: float = 0.0,
    **signals: Callable[[float], ArrayLike] | ArrayLike,
) -> NDArray:
    """Inputs of `steps` communication steps [s] for `TetherModel.fly`, array (steps, INPUTS).

    kite, ground : ends that move, or positions [m] of ends that stay; None: at the start values of `kite_position` and
    `ground_position`, wherever `initialize` put them.  start : time of the first step [s].  signals : the other inputs by
    name, see `Inputs`: constant, or functions of time [s]; 0 where they are not given.  ValueError if an end is something
    else, TypeError if there is no such input.

    >>> inputs_along(3, 0.02, wind_velocity=(8.0, 0.0, 0.0)).shape
    (3, 21)
    """
    rows = np.zeros((steps, COUNT))
    ends = [("kite", KITE_AT_START if kite is None else kite), ("ground", ZERO if ground is None else ground)]
    ends = [(name, end_of(name, end)) for name, end in ends]
    columns = by_name(rows)
    of_ends = [f"{name}_{what}" for name, _ in ends for what in ("position", "velocity")]
    check_names("inputs_along", signals, [name for name in columns if name not in of_ends])
    for k in range(steps):
        time = start + k * step
        for name, end in ends:
            columns[f"{name}_position"][k], columns[f"{name}_velocity"][k] = end.at(time)
        for name, signal in signals.items():
            columns[name][k] = signal(time) if callable(signal) else signal
    return rows
