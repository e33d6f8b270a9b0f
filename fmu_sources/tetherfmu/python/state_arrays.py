"""States of the Python API: one flat array with everything to continue a tether, and to identify it.

The state of `layout.py`, then the inputs, the number of the variant, and the parameters. A state belongs to its
tether, or one with the same properties; environment and solver may differ.
"""

from array import array

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.naming import prefixed
from tetherfmu.runtime.refusals import STATE_IMPOSSIBLE
from tetherfmu.runtime.status import OK
from tetherfmu.runtime.variants import EVERY_VARIANT

_SCALARS = ("initial_length", "slack_stiffness_ratio", "slack_damping_ratio", "damping_law")
_SCALARS += ("ground_is_free", "kite_is_free")
_PROPERTIES = {  # of the segments, in words
    at.SHARE: "share of the length in a segment",
    at.OFFSET: "constant length of a segment [m]",
    at.STIFFNESS: "axial_stiffness [N]",
    at.DAMPING: "axial_damping [N s]",
    at.LINE_DENSITY: "mass per length [kg/m]",
    at.DRAG_WIDTH: "drag_coefficient times diameter [m]",
    at.STRENGTH: "breaking_force [N]",
}


def joined(variant, instance):
    """The whole state of an `Instance` of a variant, a flat array."""
    number = (EVERY_VARIANT.index(variant),)
    return np.concatenate([instance.state, instance.values[: instance.outputs_at], number, instance.parameters])


def take(variant, instance, state):
    """Set an `Instance` (modified) to a state of `joined`; ValueError, and nothing is changed, if that is not possible."""
    state, parameters = np.asarray(state, dtype=float), np.frombuffer(instance.parameters)
    shape = (len(instance.state) + instance.outputs_at + 1 + len(parameters),)
    if state.shape != shape:
        raise ValueError(f"state has the shape {state.shape}; it must be {shape}")
    places = np.cumsum((len(instance.state), instance.outputs_at, 1))
    own, inputs, number, its_parameters = np.split(state, places)
    if not (np.isfinite(state[places[0] :]).all() and number.item() in range(len(EVERY_VARIANT))):
        raise ValueError(f"state {STATE_IMPOSSIBLE}")
    its_variant = EVERY_VARIANT[int(number.item())]
    if its_variant != variant:
        raise ValueError(f"state belongs to another kind of tether: {its_variant}, not {variant}")
    for name, theirs, ours in properties(instance.segments, its_parameters, parameters):
        if theirs != ours:
            raise ValueError(f"state belongs to another tether: its {name} is {theirs:g}, that of this one {ours:g}")
    _take_own(instance, array("d", own))
    instance.values[: instance.outputs_at] = array("d", inputs)
    first = at.node_winds_at(instance.segments)
    winds = slice(first, first + 3 * (instance.segments + 1))
    parameters[winds], parameters[at.WIND_PROFILE] = its_parameters[winds], its_parameters[at.WIND_PROFILE]


def _take_own(instance, state):
    """Set an `Instance` (modified) to a state array; ValueError, and nothing is changed, if no tether is in such a state."""
    before = instance.state[:]
    with prefixed("state "):
        instance.take(state)
    if instance.take_outputs() != OK:
        instance.state[:] = before
        instance.take_outputs()
        raise ValueError(f"state {STATE_IMPOSSIBLE}")


def properties(segments, *parameters):
    """Properties that make two tethers equal: tuples of a name and its numbers in arrays of parameters."""
    for name in _SCALARS:
        yield name, *(each[getattr(at, name.upper())] for each in parameters)
    first = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * segments
    for node in range(segments + 1):  # before the lengths, which depend on them
        yield f"point mass [kg] at node {node}", *(each[first + node] for each in parameters)
    for place, name in _PROPERTIES.items():
        first = at.PARAMETER_SCALARS + place * segments
        for k in range(first, first + segments):
            yield name, *(each[k] for each in parameters)
