"""Named inputs of a tether in the Python API: checked, and written to its arrays."""

from typing import NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from tetherfmu.records import arguments
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import DRIVEN_KITE, INPUT_TABLE, PLACES, WIND_AT
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.naming import check_names
from tetherfmu.runtime.variants import Variant

from . import compiled_flight


class Receiver(NamedTuple):
    """The tether with the inputs."""

    name: str  # of its class, for messages
    variant: Variant
    instance: Instance  # its values and parameters are modified
    inputs: np.ndarray  # a view of its values, with the wind at the wind points
    places: memoryview  # of its values: faster than an array for a few numbers
    wind_profile: int  # of its `Environment`
    wind_points: int  # number of wind inputs, 0 for none


class Inputs(TypedDict, total=False):
    """Inputs of a tether besides the motion of its ends, by their names.

    Attributes
    ----------
    reel_out_speed : float
        Rate of change of the unstretched length [m/s]; positive pays out.
    wind_velocity : (3,) or (segments + 1, 3) array
        Wind [m/s] at `wind_reference_height`; or at each node, whatever the wind profile says (tethers with nodes only).
    kite_load : (3,) array
        External force [N] on a free kite end: in its equilibrium (`kite_start`), and from the first step on.
    winch_force : float
        Force [N] with which the winch pulls, with `winch_control` = force, from the first step on; positive
        reels in.
    winch_length : float
        Set point of the unstretched length [m], with `winch_control` = length; 0: `initial_length`.
    release : bool
        True: the tether permanently lets go of the kite at the start of the step (dynamic tethers only).
    wind_at : (wind_points, 3) array
        Wind [m/s] at the wind points of a tether that has them, and no other wind.
    """

    reel_out_speed: float
    wind_velocity: ArrayLike
    kite_load: ArrayLike
    winch_force: float
    winch_length: float
    release: bool
    wind_at: ArrayLike


OF_ANY = tuple(each.name for each in (*INPUT_TABLE, WIND_AT))
OF_FREE_KITE = tuple(each.name for each in (*INPUT_TABLE, WIND_AT) if each.of != DRIVEN_KITE)


def starts(wind_points):
    """Default values of all inputs at a start, a dict by name."""
    given = {each.name: each.start if each.size > 1 else each.start[0] for each in INPUT_TABLE}
    return given | {WIND_AT.name: np.zeros((wind_points, 3))} if wind_points else given


LEADS = {  # inputs that control a winch, with their choice of `winch_control`
    "reel_out_speed": at.WINCH_BY_SPEED,
    "winch_force": at.WINCH_BY_FORCE,
    "winch_length": at.WINCH_BY_LENGTH,
}


def check_effect(name, value, parameters, at_start=False, label=""):
    """ValueError if a nonzero input has no effect with these parameters.

    value : a number or an array.  at_start : when a winch always uses `reel_out_speed`.  label : its name there.
    """
    if value is None:
        return
    control, why = parameters[at.WINCH_CONTROL], ""
    if LEADS.get(name, control) != control and not (at_start and name == "reel_out_speed"):
        why = f"winch_control is {control:.0f}; it must be {LEADS[name]}"
    elif name == "kite_load" and parameters[at.KITE_IS_FREE] == 0.0:
        why = "the kite end is driven; it must be free, as that of TetherDynamicFree"
    elif name in ("kite_velocity", "ground_velocity") and parameters[at.END_VELOCITIES] == at.DERIVED:
        at_kite = name == "kite_velocity" and parameters[at.KITE_IS_FREE] != 0.0
        why = "" if at_kite else "end_velocities is 2 (derived); it must be 1 (given)"
    if why and np.any(value) and np.all(np.isfinite(value)):  # the start or the step refuses values that are not finite
        shown = np.asarray(value).item() if np.size(value) == 1 else value
        raise ValueError(f"{label or name} is {shown!r} and has no effect: {why}")


def put(to, given, at_start=False):
    """Set the inputs that are not None; ValueError if a shape is wrong, TypeError for an unknown input.

    given : dict by name.  at_start : whether a free kite has position and velocity inputs.
    """
    check_names(to.name, given, OF_FREE_KITE if to.variant.kite_is_free and not at_start else OF_ANY)
    numbers = {name: value for name, value in given.items() if name not in ("wind_velocity", WIND_AT.name)}
    for start, end, values in arguments.numbers_at(numbers):
        to.places[start:end] = values
    for name, value in numbers.items():
        check_effect(name, value, to.instance.parameters, at_start)
    if numbers.get("release"):
        arguments.check_release(numbers["release"])
    if numbers.get("release") and not to.variant.has_waves:
        raise ValueError(f"release is {numbers['release']!r} and has no effect: a {to.name} cannot let go")
    if given.get("wind_velocity") is not None:
        _put_wind(to, given["wind_velocity"])
    if given.get(WIND_AT.name) is not None:
        to.inputs[at.INPUTS :] = wind_at_points(to, given[WIND_AT.name], ()).ravel()


def _put_wind(to, wind):
    """Set the wind [m/s], (3,), or at each node, (segments + 1, 3); ValueError if it has another shape."""
    shape, nodes = np.shape(wind), to.instance.segments + 1
    if to.wind_points and np.any(wind):
        raise ValueError(f"wind_velocity is given to a {to.name} with wind points; give wind_at")
    if shape == (nodes, 3) and to.variant.has_nodes:
        compiled_flight.put_node_winds(to.instance, arguments.numbers_in_shape("wind_velocity", wind, shape))
    elif shape == (3,):
        to.inputs[at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = wind
        to.instance.parameters[at.WIND_PROFILE] = at.AT_NODES if to.wind_points else to.wind_profile
    else:
        either = f", or ({nodes}, 3) for a wind at each node" if to.variant.has_nodes else ""
        raise ValueError(f"wind_velocity has the shape {shape}; it must be (3,){either}")


def wind_at_points(to, wind, before):
    """Wind at the wind points [m/s], array (*before, wind_points, 3); ValueError for another shape or without them."""
    if not to.wind_points:
        raise ValueError(f"this {to.name} has no wind points for wind_at: make it with wind_points=11")
    return arguments.numbers_in_shape("wind_at", wind, (*before, to.wind_points, 3))


def rows(to, inputs, wind_at):
    """Inputs of many steps with the wind at the wind points, in the form for `compiled_flight.fly`.

    inputs : (steps, INPUTS).  wind_at : [m/s], (steps, wind_points, 3); None for the present wind in all steps.  ValueError
    for another shape.
    """
    inputs = np.ascontiguousarray(inputs, dtype=float)
    if inputs.ndim != 2 or inputs.shape[1] != at.INPUTS:
        raise ValueError(f"inputs has the shape {inputs.shape}; it must be (steps, {at.INPUTS})")
    arguments.check_release(inputs[:, PLACES["release"]])
    if wind_at is not None:
        winds = wind_at_points(to, wind_at, (len(inputs),)).reshape(len(inputs), -1)
    elif to.wind_points:
        winds = np.tile(to.inputs[at.INPUTS :], (len(inputs), 1))
    else:
        return inputs
    return np.concatenate((inputs, winds), axis=1)


def node_winds(to, winds, steps):
    """Winds at the nodes in this number of steps [m/s], array, or None; ValueError for another shape."""
    if winds is None:
        return None
    if not to.variant.has_nodes or to.wind_points:
        instead = "has wind points: give wind_at" if to.wind_points else "has no nodes: give wind_velocity"
        raise ValueError(f"{to.name} {instead}")
    return arguments.numbers_in_shape("node_winds", winds, (steps, to.instance.segments + 1, 3))
