"""A portion of a rope over sheaves that broke: one line in two parts, each with the rope of its own end.

Segments before node e are the first part, with the unstretched length L_0; those from node b on are the second part, with
L_1. Rope that enters over either end, at the rates a_0 and a_1, stays in the part there:

    l0 = L_0/e,         c_i = (1 - i/e) a_0                    i <= e
    l0 = L_1/(n - b),   c_i = -(i - b)/(n - b) a_1             i >= b

The broken segment between them has no spring, damper or drag. Its rope is lumped at the torn ends, half at each: the nodes
there keep their masses. In the parameters its second part has negative shares.
Theory: docs/models/theory.md, "Breaking and letting go".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from .properties import property_in, put_point_mass, put_property

LEAST_SEGMENTS = 3  # of a portion that may break: a part at a sheave needs a segment


@kernel
def is_parted(parameters):
    """Whether a portion is in two parts."""
    return parameters[at.IS_PARTED] != 0.0


@kernel
def torn_between(n, s):
    """Segment of n to tear if segment s breaks: both parts keep a segment."""
    return min(max(s, 1), n - 2)


@kernel
def brake(parameters):
    """Brake the winch of a line in its parameters (modified)."""
    if parameters[at.WINCH_IS_BRAKED] == 0.0:
        parameters[at.WINCH_IS_BRAKED] = 1.0
        parameters[at.WHOLE_CONTROL] = parameters[at.WINCH_CONTROL]
        parameters[at.WINCH_CONTROL] = float(at.WINCH_BY_SPEED)


@kernel
def release_brake(parameters):
    """Undo `brake`, if it was done."""
    if parameters[at.WINCH_IS_BRAKED] != 0.0:
        parameters[at.WINCH_CONTROL] = parameters[at.WHOLE_CONTROL]
        parameters[at.WINCH_IS_BRAKED] = parameters[at.WHOLE_CONTROL] = 0.0


@kernel
def divide(n, freed, state, parameters):
    """Divide a portion of n segments in its parameters (modified) as its state says; freed : 1 after its release, else 0."""
    s = int(state[at.TORN_SEGMENT]) - 1
    ends, begins, segments = s, s + 1, n - freed
    parameters[at.TORN_NOW] = s + 1.0
    parameters[at.WHOLE_STIFFNESS] = property_in(parameters, n, s, at.STIFFNESS)
    parameters[at.WHOLE_DAMPING] = property_in(parameters, n, s, at.DAMPING)
    parameters[at.WHOLE_DRAG_WIDTH] = property_in(parameters, n, s, at.DRAG_WIDTH)
    parameters[at.WHOLE_DENSITY] = property_in(parameters, n, s, at.LINE_DENSITY)
    parameters[at.WHOLE_SHARE] = property_in(parameters, n, s, at.SHARE)
    for i in range(n):
        put_property(n, at.SHARE, i, 1.0 / ends if i < ends else -1.0 / (segments - begins), parameters)
    put_property(n, at.SHARE, s, 0.0, parameters)
    put_property(n, at.OFFSET, s, state[at.FIRST_LUMP] + state[at.SECOND_LUMP], parameters)
    for which in (at.STIFFNESS, at.DAMPING, at.DRAG_WIDTH, at.LINE_DENSITY):
        put_property(n, which, s, 0.0, parameters)
    put_point_mass(n, ends, parameters[at.WHOLE_DENSITY] * state[at.FIRST_LUMP], parameters)
    put_point_mass(n, begins, parameters[at.WHOLE_DENSITY] * state[at.SECOND_LUMP], parameters)
    parameters[at.IS_PARTED], parameters[at.FIRST_ENDS], parameters[at.SECOND_BEGINS] = 1.0, ends, begins
    parameters[at.REST_BETWEEN] = state[at.FIRST_LUMP] + state[at.SECOND_LUMP]
    parameters[at.LENGTH_BEYOND] = state[at.LENGTH] - state[at.FIRST_PART]


@kernel
def unite(n, parameters):
    """Undo `divide`, if it was done."""
    s = int(parameters[at.TORN_NOW]) - 1
    if not is_parted(parameters):
        return
    for i in range(n):
        put_property(n, at.SHARE, i, parameters[at.WHOLE_SHARE], parameters)
    put_property(n, at.OFFSET, s, 0.0, parameters)
    put_property(n, at.STIFFNESS, s, parameters[at.WHOLE_STIFFNESS], parameters)
    put_property(n, at.DAMPING, s, parameters[at.WHOLE_DAMPING], parameters)
    put_property(n, at.DRAG_WIDTH, s, parameters[at.WHOLE_DRAG_WIDTH], parameters)
    put_property(n, at.LINE_DENSITY, s, parameters[at.WHOLE_DENSITY], parameters)
    put_point_mass(n, int(parameters[at.FIRST_ENDS]), 0.0, parameters)
    put_point_mass(n, int(parameters[at.SECOND_BEGINS]), 0.0, parameters)
    for place in (at.TORN_NOW, at.WHOLE_STIFFNESS, at.WHOLE_DAMPING, at.WHOLE_DRAG_WIDTH, at.LENGTH_BEYOND):
        parameters[place] = 0.0
    for place in range(at.IS_PARTED, at.WHOLE_DENSITY + 1):
        parameters[place] = 0.0
