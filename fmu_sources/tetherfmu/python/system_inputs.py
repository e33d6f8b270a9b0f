"""Inputs of a system of tethers, by the names of points and lines: written to the rows of its arrays."""

import reprlib
from collections.abc import Mapping
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike

from tetherfmu.records.arguments import check_release, numbers_in_shape
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.inputs import ZERO
from tetherfmu.runtime.naming import check_names, meant_or_all
from tetherfmu.wiring.portions import portions_of
from tetherfmu.wiring.system_variables import GIVEN, RELEASE, SPEED

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
        set points of the unstretched length [m]; 0: `initial_length`. For winches of several lines, the length paid out
        since the start [m].
    releases : dict of str to bool
        True: lines, by name, permanently let go of their last points at the start of the step.
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


def starts(system):
    """Default values of all inputs at a start, except the motion of points, a dict by name."""
    winches = {}
    for each, name in _WINCHES.items():
        alone = [line for line in system.lines if name == RELEASE or not system.holding(line.name)]
        turned = (*alone, *(winch for winch in system.winches if name in (winch.input, SPEED)))
        winches[each] = {one.name: getattr(one, name, 0.0) for one in turned}
    points = {line.name: (len(portions_of(line)) * system.wind_points, 3) for line in system.lines}
    winds = {"wind_at": {name: np.zeros(shape) for name, shape in points.items()}} if system.wind_points else {}
    return {"wind_velocity": ZERO, "loads": dict.fromkeys(system.free, ZERO), **winches, **winds}


def check_dicts(given):
    """TypeError unless inputs exist, and are dicts by the names of points and lines where required."""
    check_names("TetherSystem", given, _KNOWN)
    for name, value in given.items():
        if name != "wind_velocity" and not isinstance(value, Mapping | None):
            raise TypeError(f"{name} is {reprlib.repr(value)}; it must be a dict by the names of points or lines")


def completed(given, before):
    """Inputs by name, completed by those of `before`, likewise for names of points and lines."""
    found = dict(before)
    for name, value in given.items():
        if value is not None:
            found[name] = {**before[name], **value} if isinstance(before.get(name), dict) else value
    return found


def put(given, arrays, inputs=None, at_start=False):
    """Set the given inputs; ValueError if a name does not exist or a value has another shape.

    given : arguments of `TetherSystem.step` by name; None is omitted.  arrays : `Arrays` of the system, whose inputs are
    modified unless others are given.  inputs : array (steps, inputs) to set instead of the next step.  Returns
    the inputs of the shared winches, an array (steps, winches) or (winches,).
    at_start : of free points, too.  TypeError for an unknown argument.
    """
    check_dicts(given)
    given = {name: value for name, value in given.items() if value is not None}
    inputs = arrays.inputs if inputs is None else inputs
    system, turned, steps = arrays.system, arrays.turned, inputs.shape[:-1]
    first = {each.line.name: k for k, each in enumerate(arrays.lines) if each.number == 0}  # portions of lines
    movable = dict.fromkeys(point.name for point in system.points if at_start or point.is_driven)
    for what, own in (("positions", "position"), ("velocities", "velocity")):
        for name, value in given.get(what, {}).items():
            _check_known(f"{own} of a {'point' if at_start else 'driven point'}", name, movable)
            numbers = _numbers(f"{name}.{own}", value, (3,), steps)
            arrays.put(inputs, f"{name}.{'initial_' if name in system.free_names else ''}{own}", numbers)
            if what == "velocities" and name not in system.free_names:
                check_effect("ground_velocity", numbers, arrays.instance.parameters_of(0), at_start, f"{name}.velocity")
    for name, value in given.get("loads", {}).items():
        _check_known("load on a free point", name, dict.fromkeys(system.free))
        load = _numbers(f"{name}.load", value, (3,), steps)
        if not np.all(np.abs(load) <= at.LARGEST_INPUT):
            raise StepRefused(
                f"the input {name}.load is {value!r}; its numbers must be finite and at most {at.LARGEST_INPUT:g} in "
                "magnitude",
                status.INPUT_NOT_FINITE,
            )
        arrays.put(inputs, f"{name}.load", load)
    winches, told = {each.name: j for j, each in enumerate(system.winches)}, np.tile(turned.told, (*steps, 1))
    alone, speeds = [line.name for line in system.lines if not system.holding(line.name)], np.zeros(told.shape)
    for each, what in _WINCHES.items():
        shared = [winch.name for winch in system.winches if winch.input == what]
        starting = [winch.name for winch in system.winches if at_start and what == SPEED != winch.input]
        for name, value in given.get(each, {}).items():
            is_release = what == RELEASE
            known = first if is_release else dict.fromkeys([*alone, *shared, *starting])
            _check_known("release of a line" if is_release else f"{what} of a line or a winch", name, known)
            numbers = _numbers(f"{name}.{what}", value, (), steps)
            if is_release:
                check_release(numbers, f"{name}.{what}")
            if name in winches:
                (speeds if name in starting else told)[..., winches[name]] = numbers
                continue
            vector = f"{name}.{what}"
            arrays.put(inputs, vector, numbers)
            check_effect(
                what, inputs[..., arrays.vectors[vector][0]], arrays.instance.parameters_of(first[name]), at_start, vector
            )
    turned.put(inputs, told, speeds if at_start else None)
    for name, value in given.get("wind_at", {}).items():
        _check_known("wind_at of a line", name, first)
        if not system.wind_points:
            raise ValueError("this TetherSystem has no wind points for wind_at: make it with wind_points=11")
        vector = f"{name}.wind_at"
        arrays.put(inputs, vector, _numbers(vector, value, (arrays.vectors[vector].shape[1] // 3, 3), steps))
    if "wind_velocity" in given:
        _put_wind(given["wind_velocity"], arrays, inputs, first, at_start)
    return told


def _put_wind(wind, arrays, inputs, first, at_start):
    """Set the wind [m/s] of all lines, (3,), or at each node of some, a dict by name; errors as in `put`.

    first : first portions of lines by name.
    """
    instance, at_nodes, steps = arrays.instance, isinstance(wind, Mapping), inputs.shape[:-1]
    if not at_nodes:
        wind = _numbers("wind_velocity", wind, (3,), steps)
    if arrays.system.wind_points and (at_nodes or np.any(wind)):
        raise ValueError("wind_velocity is given to a TetherSystem with wind points; give wind_at")
    if at_nodes and steps:
        raise ValueError("wind_velocity is given at nodes; in a flight it must be (3,), or (steps, 3)")
    winds = []
    for name, value in wind.items() if at_nodes else ():
        _check_known("wind_velocity of a line", name, first)
        own = range(first[name], first[name] + sum(line.line.name == name for line in arrays.lines))
        shape, node = (sum(instance.counts[k] for k in own) + 1, 3), 0
        value = numbers_in_shape(f"wind_velocity of {name}", value, shape)
        for k in own:
            winds.append((k, value[node : node + instance.counts[k] + 1]))
            node += instance.counts[k]
    if at_start or not at_nodes:
        arrays.put(inputs, "wind_velocity", np.zeros(3) if at_nodes else wind)
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
