"""Inputs of a system of tethers that are given by the names of points and lines: into the rows of its arrays."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tetherfmu.results import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.inputs import PLACES


class Given(NamedTuple):
    """Inputs that are given, as arguments of `TetherSystem.step`; those of winches by `winches_of`."""

    positions: Mapping
    velocities: Mapping
    loads: Mapping
    winches: Mapping  # names of inputs of winches, with values by the names of lines
    wind_velocity: ArrayLike | None
    wind_at: Mapping  # by the names of lines with wind points


def put(given, arrays, points, lines, inputs=None, at_start=False):
    """Set the inputs that are given; ValueError if a name does not exist or a value has another shape.

    given : Given.  arrays : `Arrays` of the system, whose inputs are modified unless others are given.
    inputs : array (steps, inputs) to be set instead of those of the next step.  at_start : of free points, too.
    """
    whole = arrays.inputs if inputs is None else inputs
    rows = [arrays.inputs_in(k, whole) for k in range(len(lines))]
    movable = [point.name for point in points if at_start or point.is_driven]
    steps = whole.shape[:-1]
    for what, values in (("position", given.positions), ("velocity", given.velocities)):
        for name, value in values.items():
            _check_known(f"{what} of a {'point' if at_start else 'driven point'}", name, movable)
            arrays.put_point_in(rows, name, what, _numbers(f"{name}.{what}", value, (3,), steps))
    for name, value in given.loads.items():
        _check_known("load on a free point", name, arrays.instance.free)
        load = _numbers(f"{name}.load", value, (3,), steps)
        if not np.all(np.abs(load) <= at.LARGEST_INPUT):
            raise StepRefused(
                f"the input {name}.load is {value!r}; its numbers must be finite and at most {at.LARGEST_INPUT:g} in "
                "magnitude",
                status.INPUT_NOT_FINITE,
            )
        arrays.loads_in(whole)[..., arrays.instance.free.index(name), :] = load
    names = [line.name for line in lines]
    for what, values in given.winches.items():
        for name, value in values.items():
            _check_known(f"{what} of a line", name, names)
            rows[names.index(name)][..., PLACES[what]] = _numbers(f"{name}.{what}", value, (), steps)
    points = arrays.instance.lines[0].wind_points
    for name, value in given.wind_at.items():
        _check_known("wind_at of a line", name, names)
        if not points:
            raise ValueError("this TetherSystem has no wind points for wind_at: make it with wind_points=11")
        winds = _numbers(f"{name}.wind_at", value, (points, 3), steps)
        rows[names.index(name)][..., at.INPUTS :] = winds.reshape(*winds.shape[:-2], 3 * points)
    if given.wind_velocity is not None:
        wind = _numbers("wind_velocity", given.wind_velocity, (3,), steps)
        if points and np.any(wind):
            raise ValueError("wind_velocity is given to a TetherSystem with wind points; give wind_at")
        for row in rows:
            row[..., at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = wind


def winches_of(speeds, forces, lengths):
    """Inputs of winches that are given, by name, each by the names of lines."""
    return {"reel_out_speed": speeds or {}, "winch_force": forces or {}, "winch_length": lengths or {}}


def first_winches_of(lines, speeds, forces, lengths):
    """As `winches_of` at the start: of all lines, what is not given is as their records say, or 0."""
    none = {line.name: 0.0 for line in lines}
    return {
        "reel_out_speed": {**{line.name: line.reel_out_speed for line in lines}, **(speeds or {})},
        "winch_force": {**none, **(forces or {})},
        "winch_length": {**none, **(lengths or {})},
    }


def _check_known(what, name, names):
    """ValueError if a name does not exist."""
    if name not in names:
        raise ValueError(f"there is no {what} with the name {name!r}; there are {', '.join(names) or 'none'}")


def _numbers(name, value, shape, steps):
    """Numbers of an input, constant or of all steps; ValueError for another shape."""
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; it must be {'three numbers' if shape else 'a number'}") from None
    if found.shape not in (shape, (*steps, *shape)):
        wanted = f"{shape} or {(*steps, *shape)}" if steps else f"{shape}"
        raise ValueError(f"{name} has the shape {found.shape}; it must be {wanted}")
    return found
