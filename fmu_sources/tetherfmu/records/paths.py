"""Where the ends of a tether are: from angles, and along paths that are functions of time."""

from __future__ import annotations

import reprlib
from collections.abc import Callable
from dataclasses import dataclass
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetherfmu.runtime.inputs import COUNT, KITE_AT_START, ZERO, by_name
from tetherfmu.runtime.naming import check_names, names_checked

from .problems import PlausibilityWarning

TURNS = 4.0 * np.pi  # of an azimuth [rad], beyond which degrees were probably meant


def polar(distance, elevation, azimuth):
    """Point [m] at a distance [m] and two angles [rad] from the origin: x, y, z; numbers or arrays, also complex ones."""
    across = distance * np.cos(elevation)
    return across * np.cos(azimuth), across * np.sin(azimuth), distance * np.sin(elevation)


def kite_at(elevation: float, azimuth: float, distance: float, ground_position: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray:
    """Position [m] of a kite, array (3,), from its direction as seen from the ground end.

    elevation : above the horizon [rad].  azimuth : from the x axis, anti-clockwise seen from above [rad], as the output
    `ground_azimuth`.  distance : along a straight line [m].  ValueError if the elevation is beyond pi/2; an azimuth of more
    than two turns causes a `PlausibilityWarning`.

    >>> kite_at(elevation=0.0, azimuth=0.0, distance=500.0).tolist()
    [500.0, 0.0, 0.0]
    """
    if not np.all(np.abs(elevation) <= 0.5 * np.pi):  # NaN is not
        raise ValueError(
            f"elevation is {elevation!r}; it must be at least -pi/2 and at most pi/2 rad: angles are in rad, "
            "math.radians converts degrees"
        )
    if np.any(np.abs(azimuth) > TURNS):
        said = f"azimuth is {azimuth!r} rad, more than two turns; angles are in rad, math.radians converts degrees"
        warn(said, PlausibilityWarning, stacklevel=2)
    return np.add(ground_position, polar(distance, elevation, azimuth))


@names_checked
@dataclass(frozen=True)
class MovingEnd:
    """An end of a tether that moves along a path.

    Parameters
    ----------
    position : function
        Returns the position [m], three numbers, at a time [s].
    velocity : function or None
        Returns the velocity [m/s]; None: central differences of the position over 2 `difference`.
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
        """Position [m] and velocity [m/s] at a time [s], arrays (3,); ValueError if the functions return something else."""
        position = self._vector(self.position, "position", time)
        if self.velocity is not None:
            return position, self._vector(self.velocity, "velocity", time)
        ahead, back = (self._vector(self.position, "position", time + way * self.difference) for way in (1.0, -1.0))
        return position, (ahead - back) / (2.0 * self.difference)

    @staticmethod
    def _vector(function, name, time):
        """Value of a function at a time, checked."""
        found = np.asarray(function(time), dtype=float)
        if found.shape != (3,):
            raise ValueError(f"the {name} of the moving end at {time} s has the shape {found.shape}; it must be (3,)")
        return found


def end_along(name, given, times, step):
    """Positions [m] and velocities [m/s] of an end at equidistant times [s], two arrays (times, 3).

    given : as an end of `inputs_along`.  ValueError for anything else.
    """
    if isinstance(given, MovingEnd):
        both = [given.at(time) for time in times]
        return np.array(both, dtype=float).reshape(-1, 2, 3).swapaxes(0, 1)
    if callable(given):
        raise ValueError(f"{name} is a function; make a MovingEnd of it")
    positions = values_along(name, given, times, 3, "or a MovingEnd")
    if not np.all(np.isfinite(positions)):  # otherwise the error would blame the differences
        k, i = np.argwhere(~np.isfinite(positions))[0]
        raise ValueError(f"{name} is {positions[k, i]} in row {k}, column {i}, counted from 0; it must be a finite number")
    if np.ndim(given) == 1 or len(times) < 2:
        return positions, np.zeros_like(positions)
    return positions, np.gradient(positions, step, axis=0, edge_order=min(2, len(times) - 1))


def values_along(name, given, times, size, otherwise="or a function of the time"):
    """Numbers of an input at times [s], array (times, size): constant, a row for each, or from a function.

    ValueError for another shape; otherwise : other permitted forms, in words.
    """
    constant, rows = ((size,), (len(times), size)) if size > 1 else ((), (len(times),))
    try:
        found = np.array([given(time) for time in times] if callable(given) else given, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {reprlib.repr(given)}; it must be numbers, {otherwise}") from None
    if found.shape not in (constant, rows):
        raise ValueError(f"{name} has the shape {found.shape}; it must be {constant or 'a number'}, {rows} {otherwise}")
    return np.broadcast_to(found.reshape(-1, size), (len(times), size))


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

    kite, ground : ends that move; positions [m] of ends that stay, (3,); positions from a log, (steps, 3), with central
    differences as velocities; None: at the start values of `kite_position` and `ground_position`, wherever `initialize` put
    them.  start : time of the first step [s].  signals : the other inputs by name, see `Inputs`: constant, a row for each
    step, or functions of time [s]; 0 where they are not given; `kite_velocity` and `ground_velocity`, as from a log, in the
    place of those of the ends.  ValueError if something has another shape, TypeError if there is no such input.

    >>> inputs_along(3, 0.02, wind_velocity=(8.0, 0.0, 0.0), reel_out_speed=[0.0, 0.1, 0.2]).shape
    (3, 22)
    """
    rows, times = np.zeros((steps, COUNT)), start + step * np.arange(steps)
    columns = by_name(rows)
    known = ["kite", "ground", *(name for name in columns if name not in ("kite_position", "ground_position"))]
    check_names("inputs_along", signals, known)
    for name, end in (("kite", KITE_AT_START if kite is None else kite), ("ground", ZERO if ground is None else ground)):
        columns[f"{name}_position"][:], columns[f"{name}_velocity"][:] = end_along(name, end, times, step)
    for name, signal in signals.items():
        columns[name][:] = values_along(name, signal, times, columns[name].shape[1])
    return rows
