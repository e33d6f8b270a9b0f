"""Inputs of a tether of the Python API that are given by name: checked, and put into its arrays."""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.variants import Variant

from . import arguments, compiled_flight


class Receiver(NamedTuple):
    """The tether that they are given to."""

    name: str  # of its class, for messages
    variant: Variant
    instance: Instance  # whose values and parameters are modified
    inputs: np.ndarray  # a view of its values, with the wind at the wind points
    places: memoryview  # of its values: faster than an array for a few numbers
    wind_profile: int  # of its `Environment`
    wind_points: int  # at which the wind is given, 0 for none


def put(to, wind_velocity=None, wind_at=None, **given):
    """Set those inputs that are not None; ValueError if a shape is wrong.

    wind_velocity : [m/s], (3,), or at each node.  wind_at : at the wind points [m/s].  given : all others by name.
    """
    for start, end, numbers in arguments.numbers_at(given):
        to.places[start:end] = numbers
    if wind_velocity is not None:
        _put_wind(to, wind_velocity)
    if wind_at is not None:
        to.inputs[at.INPUTS :] = wind_at_points(to, wind_at, ()).ravel()


def _put_wind(to, wind):
    """Set the wind [m/s], (3,), or at each node, (segments + 1, 3); ValueError if it has another shape."""
    shape, nodes = np.shape(wind), to.instance.segments + 1
    if to.wind_points and np.any(wind):
        raise ValueError(f"wind_velocity is given to a {to.name} with wind points; give wind_at")
    if shape == (nodes, 3) and to.variant.has_nodes:
        compiled_flight.put_node_winds(to.instance, arguments.node_vectors("wind_velocity", wind, nodes - 1))
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
    """Inputs of many steps with the wind at the wind points, as `compiled_flight.fly` takes them.

    inputs : array (steps, INPUTS).  wind_at : [m/s], (steps, wind_points, 3); None for that of before in all steps.
    """
    if wind_at is not None:
        winds = wind_at_points(to, wind_at, (len(inputs),)).reshape(len(inputs), -1)
    elif to.wind_points:
        winds = np.tile(to.inputs[at.INPUTS :], (len(inputs), 1))
    else:
        return inputs
    return np.concatenate((inputs, winds), axis=1)


def node_winds(to, winds, steps):
    """Winds at the nodes in so many steps [m/s], array, or None; ValueError if they have another shape."""
    if winds is None:
        return None
    if not to.variant.has_nodes or to.wind_points:
        instead = "has wind points: give wind_at" if to.wind_points else "has no nodes: give wind_velocity"
        raise ValueError(f"{to.name} {instead}")
    return arguments.numbers_in_shape("node_winds", winds, (steps, to.instance.segments + 1, 3))
