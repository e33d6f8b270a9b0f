"""Inputs of a system of tethers that are given by the names of points and lines: into the rows of its arrays."""

import reprlib
from collections.abc import Mapping
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike

from tetherfmu.records.arguments import check_release, numbers_in_shape
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.inputs import PLACES
from tetherfmu.runtime.naming import check_names, meant_or_all
from tetherfmu.wiring.portions import portions_of
from tetherfmu.wiring.system_variables import GIVEN, RELEASE, SPEED
from tetherfmu.wiring.winches import holding

from .compiled_flight import put_node_winds
from .given_inputs import check_effect

Vectors = Mapping[str, ArrayLike]


class SystemInputs(TypedDict, total=False):
    """Inputs of a system besides the motion of its points and the loads on them, by their names.

    Attributes
    ----------
    reel_out_speeds : dict of str to float
        Of lines and of winches that hold several, by name [m/s]; winches that are controlled by force or length start with
        them.
    wind_velocity : (3,) array, or dict of str to (segments + 1, 3) array
        Wind [m/s] at `wind_reference_height`; or at each node of lines, by name, whatever the wind profile says, until there
        is another one at that height (not in `fly`).
    winch_forces, winch_lengths : dict of str to float
        Of lines with this `Winch.winch_control`, by name: forces with which winches pull [N], from the first step on, and
        unstretched lengths that they should have paid out [m]; 0: `initial_length`. Of winches that hold several lines the
        length paid out since the start [m].
    releases : dict of str to bool
        True lets lines, by name, go at their last ends, at the beginning of the step and for good.
    wind_at : dict of str to (wind_points, 3) array
        Wind [m/s] at the wind points of lines, by name; over sheaves at those of the portions, one after the other.
    """

    reel_out_speeds: Vectors
    wind_velocity: ArrayLike | Vectors
    winch_forces: Vectors
    winch_lengths: Vectors
    releases: Vectors
    wind_at: Vectors


_WINCHES = {f"{name}s": name for name in (*GIVEN, RELEASE)}  # arguments: inputs of a line
_KNOWN = ("positions", "velocities", "loads", *_WINCHES, "wind_velocity", "wind_at")


def starts(lines, shared, free, wind_points):
    """All inputs but the motion of points as they are at a start where they are not given, a dict by name.

    shared : the winches that hold several lines.
    """
    winches = {}
    for each, name in _WINCHES.items():
        alone = [line for line in lines if name == RELEASE or not holding(shared, line.name)]
        turned = (*alone, *(winch for winch in shared if name in (winch.input, SPEED)))
        winches[each] = {one.name: getattr(one, name, 0.0) for one in turned}
    points = {line.name: (len(portions_of(line)) * wind_points, 3) for line in lines}
    winds = {"wind_at": {name: np.zeros(shape) for name, shape in points.items()}} if wind_points else {}
    return {"wind_velocity": (0.0, 0.0, 0.0), "loads": dict.fromkeys(free, (0.0, 0.0, 0.0)), **winches, **winds}


def check_dicts(given):
    """TypeError unless inputs that are given exist, and are dicts by the names of points and lines, where they must be."""
    check_names("TetherSystem", given, _KNOWN)
    for name, value in given.items():
        if name != "wind_velocity" and not isinstance(value, Mapping | None):
            raise TypeError(f"{name} is {reprlib.repr(value)}; it must be a dict by the names of points or lines")


def completed(given, before):
    """Inputs by name where they are given, and as they were `before` where they are not; names of points and lines alike."""
    found = dict(before)
    for name, value in given.items():
        if value is not None:
            found[name] = {**before[name], **value} if isinstance(before.get(name), dict) else value
    return found


def put(given, arrays, points, lines, inputs=None, at_start=False):
    """Set the inputs that are given; ValueError if a name does not exist or a value has another shape.

    given : arguments of `TetherSystem.step` by name; None is none.  arrays : `Arrays` of the system, whose inputs are
    modified unless others are given.  inputs : array (steps, inputs) to be set instead of those of the next step.  Returns
    what the winches that hold several lines are told then, an array (steps, winches) or (winches,).
    at_start : of free points, too.  TypeError if there is no such argument.
    """
    check_dicts(given)
    given = {name: value for name, value in given.items() if value is not None}
    whole = arrays.inputs if inputs is None else inputs
    rows = [arrays.inputs_in(k, whole) for k in range(len(lines))]
    movable = dict.fromkeys(point.name for point in points if at_start or point.is_driven)
    loaded = {name: k for k, name in enumerate(arrays.instance.free)}
    steps = whole.shape[:-1]
    for what, own in (("positions", "position"), ("velocities", "velocity")):
        for name, value in given.get(what, {}).items():
            _check_known(f"{own} of a {'point' if at_start else 'driven point'}", name, movable)
            numbers = _numbers(f"{name}.{own}", value, (3,), steps)
            arrays.put_point_in(rows, name, own, numbers)
            if what == "velocities" and name not in arrays.instance.free:
                check_effect("ground_velocity", numbers, arrays.instance.parameters_of(0), at_start, f"{name}.velocity")
    for name, value in given.get("loads", {}).items():
        _check_known("load on a free point", name, loaded)
        load = _numbers(f"{name}.load", value, (3,), steps)
        if not np.all(np.abs(load) <= at.LARGEST_INPUT):
            raise StepRefused(
                f"the input {name}.load is {value!r}; its numbers must be finite and at most {at.LARGEST_INPUT:g} in "
                "magnitude",
                status.INPUT_NOT_FINITE,
            )
        arrays.loads_in(whole)[..., loaded[name], :] = load
    number, told = {line.name: k for k, line in enumerate(lines)}, np.tile(arrays.turned.told, (*steps, 1))
    whole_lines = dict.fromkeys(line.name for line in lines if line.number == 0)
    held = set(arrays.turned.held)
    alone = [line.name for k, line in enumerate(lines) if k not in held and line.number == 0]
    speeds = {}
    for each, what in _WINCHES.items():
        shared = arrays.turned.by(what)
        starting = [winch.name for winch in arrays.turned.winches if at_start and what == SPEED != winch.input]
        told_alone = dict.fromkeys([*alone, *shared, *starting])
        for name, value in given.get(each, {}).items():
            if what == RELEASE:
                _check_known("release of a line", name, whole_lines)
                check_release(_numbers(f"{name}.{what}", value, (), steps), f"{name}.{what}")
            else:
                _check_known(f"{what} of a line or a winch", name, told_alone)
            numbers = _numbers(f"{name}.{what}", value, (), steps)
            if name in starting:
                speeds[name] = numbers
                continue
            if name in shared:
                told[..., arrays.turned.place_of(name)] = numbers
                continue
            own = rows[number[name]][..., PLACES[what] : PLACES[what] + 1]
            own[..., 0] = numbers
            check_effect(what, own, arrays.instance.parameters_of(number[name]), at_start, f"{name}.{what}")
    if arrays.turned.winches:
        arrays.turned.put(told, rows)
    if speeds:
        arrays.turned.put_starts(speeds, rows)
    points = arrays.instance.lines[0].wind_points
    for name, value in given.get("wind_at", {}).items():
        _check_known("wind_at of a line", name, whole_lines)
        if not points:
            raise ValueError("this TetherSystem has no wind points for wind_at: make it with wind_points=11")
        own = range(number[name], number[name] + sum(line.line.name == name for line in lines))
        winds = _numbers(f"{name}.wind_at", value, (len(own) * points, 3), steps)
        for j, k in enumerate(own):
            of_portion = winds[..., j * points : (j + 1) * points, :]
            rows[k][..., at.INPUTS :] = of_portion.reshape(*winds.shape[:-2], 3 * points)
    if "wind_velocity" in given:
        _put_wind(given["wind_velocity"], arrays, rows, number, at_start)
    return told


def _put_wind(wind, arrays, rows, number, at_start):
    """Set the wind [m/s] of all lines, (3,), or at each node of some, a dict by name; errors as those of `put`.

    number : of each portion by its name.
    """
    instance, at_nodes, steps = arrays.instance, isinstance(wind, Mapping), rows[0].shape[:-1]
    if not at_nodes:
        wind = _numbers("wind_velocity", wind, (3,), steps)
    if instance.lines[0].wind_points and (at_nodes or np.any(wind)):
        raise ValueError("wind_velocity is given to a TetherSystem with wind points; give wind_at")
    if at_nodes and steps:
        raise ValueError("wind_velocity is given at nodes; in a flight it must be (3,), or (steps, 3)")
    winds = []
    for name, value in wind.items() if at_nodes else ():
        _check_known("wind_velocity of a line", name, [line.name for line in arrays.lines if line.number == 0])
        first = number[name]
        own = range(first, first + sum(line.line.name == name for line in arrays.lines))
        shape, node = (sum(instance.counts[k] for k in own) + 1, 3), 0
        value = numbers_in_shape(f"wind_velocity of {name}", value, shape)
        for k in own:
            winds.append((k, value[node : node + instance.counts[k] + 1]))
            node += instance.counts[k]
    if at_start or not at_nodes:
        for row in rows:
            row[..., at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = 0.0 if at_nodes else wind
        arrays.put_profile()
    for k, each in winds:
        put_node_winds(instance, each, k)


def _check_known(what, name, names):
    """ValueError if a name does not exist."""
    if name not in names:
        raise ValueError(f"there is no {what} with the name {name!r}{meant_or_all(name, names or ['none'])}")


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
