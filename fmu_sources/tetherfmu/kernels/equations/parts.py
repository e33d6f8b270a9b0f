"""A portion of a rope over sheaves that broke or has a loose end: one line in two parts, each with the rope of its own end.

The first part has the unstretched length L_0 in the segments before node e, the second one L_1 in those from node b on. Rope
that enters over either end, at the rates a_0 and a_1, stays in the part there:

    l0 = L_0/e,         c_i = (1 - i/e) a_0                    i <= e
    l0 = L_1/(n - b),   c_i = -(i - b)/(n - b) a_1             i >= b

broke        the broken segment lies between both parts; half of its rope is lumped at each torn end, so that no node changes
             its mass
loose end    the end has come off its sheave: the segment there carries nothing, and what came in is lumped at the inner node
ran off      a part has left over its sheave: its segments carry nothing and have no mass

Segments that carry nothing have neither spring, damper, drag nor mass. In the parameters of a kernel the second part has
negative shares; a part that does not exist has the length 1 m, which `layout.REST_BETWEEN` compensates.
Theory: docs/models/theory.md, "Breaking and letting go".
"""

from tetherfmu.runtime import layout as at

from ..compilation import PARTS, kernel
from ..linear_algebra.vectors import add_at, get, scale, sub
from . import flow
from .properties import (
    half_density,
    point_mass,
    point_mass_in,
    property_in,
    property_of,
    put_point_mass,
    put_property,
    rest_length,
)
from .torn import NO_MASS

LEAST_SEGMENTS = 3  # of a portion that may break: a part at a sheave needs a segment
STOPPED = 1e-6  # of its shortest length: rope at its sheave
NO_PART = 1.0  # length of a part that does not exist [m]
EMPTY = at.SHORTEST_PART * at.MIN_SEGMENT_LENGTH  # length in the state of a portion without rope [m]
# of `layout.RUN_OFF`, added up: its start, its end has come off its sheave; its first, its second part has run off
LOOSE, GONE = 1, 4


@kernel
def has_flag(state, kind, end):
    """Whether an end of a portion is loose (kind LOOSE), or the part there has run off (GONE), in its state."""
    return (int(state[at.RUN_OFF]) // (kind * (1 + end))) % 2 == 1


@kernel
def add_flag(state, kind, end):
    """Note in the state of a portion (modified) what `has_flag` tells."""
    state[at.RUN_OFF] += kind * (1 + end)


@kernel
def is_parted(parameters):
    """Whether a portion is in two parts."""
    return PARTS and parameters[at.IS_PARTED] != 0.0


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
def bounds_of_parts(segments, state):
    """First segment and the one after the last of both parts of so many segments: a, b, c, d; empty if equal."""
    s, left = int(state[at.TORN_SEGMENT]) - 1, 1 if has_flag(state, LOOSE, 0) else 0
    right = segments - 1 if has_flag(state, LOOSE, 1) else segments
    a, b, c, d = left, right, segments, segments
    if s >= 0:
        a, b, c, d = left, s, s + 1, right
    elif left == 1 and right == segments:
        a, b, c, d = 0, 0, 1, segments
    if has_flag(state, GONE, 0):
        a = b = 0
    if has_flag(state, GONE, 1):
        c = d = segments
    return a, max(a, b), c, max(c, d)


@kernel
def divide(n, freed, state, parameters):
    """Divide a portion of n segments in its parameters (modified) as its state says; freed : 1 after its release, else 0."""
    segments = n - freed
    a, b, c, d = bounds_of_parts(segments, state)
    parameters[at.TORN_NOW] = state[at.TORN_SEGMENT]
    parameters[at.WHOLE_STIFFNESS] = property_in(parameters, n, 0, at.STIFFNESS)
    parameters[at.WHOLE_DAMPING] = property_in(parameters, n, 0, at.DAMPING)
    parameters[at.WHOLE_DRAG_WIDTH] = property_in(parameters, n, 0, at.DRAG_WIDTH)
    parameters[at.WHOLE_DENSITY] = property_in(parameters, n, 0, at.LINE_DENSITY)
    parameters[at.WHOLE_SHARE] = property_in(parameters, n, 0, at.SHARE)
    for i in range(n):
        if a <= i < b:
            put_property(n, at.SHARE, i, 1.0 / (b - a), parameters)
        elif c <= i < d:
            put_property(n, at.SHARE, i, -1.0 / (d - c), parameters)
        else:
            put_property(n, at.SHARE, i, 0.0, parameters)
            put_property(n, at.OFFSET, i, NO_PART, parameters)
            put_property(n, at.STIFFNESS, i, 0.0, parameters)
            put_property(n, at.DAMPING, i, 0.0, parameters)
            put_property(n, at.DRAG_WIDTH, i, 0.0, parameters)
            put_property(n, at.LINE_DENSITY, i, 0.0, parameters)
    put_lumps(n, segments, state, parameters)
    parameters[at.IS_PARTED] = 1.0
    parameters[at.FIRST_ENDS] = b if a == 0 else 0.0
    parameters[at.SECOND_BEGINS] = c if d == segments else n
    parameters[at.FIRST_PASSING] = 1.0 if b > a else 0.0
    rest = state[at.FIRST_LUMP] + state[at.SECOND_LUMP] + state[at.START_LUMP] + state[at.END_LUMP]
    rest -= (NO_PART if a == b else 0.0) + (NO_PART if c == d else 0.0)
    parameters[at.REST_BETWEEN] = rest
    parameters[at.LENGTH_BEYOND] = rest + state[at.SECOND_PART]


@kernel
def add_lump(n, i, lump, parameters):
    """Add the mass of rope of a length [m] to inner node i of a portion in its parameters (modified)."""
    if 0 < i < n and lump > 0.0:
        put_point_mass(n, i, point_mass_in(parameters, n, i) + parameters[at.WHOLE_DENSITY] * lump, parameters)


@kernel
def put_lumps(n, segments, state, parameters):
    """Masses of the nodes of `divide` in the parameters (modified): of the lumps, and NO_MASS where there is none."""
    torn = int(state[at.TORN_SEGMENT])
    add_lump(n, torn - 1, state[at.FIRST_LUMP], parameters)
    add_lump(n, torn, state[at.SECOND_LUMP], parameters)
    add_lump(n, 1, state[at.START_LUMP], parameters)
    add_lump(n, segments - 1, state[at.END_LUMP], parameters)
    for i in range(n + 1):
        of_rope = property_in(parameters, n, i - 1, at.LINE_DENSITY) if i > 0 else 0.0
        of_rope += property_in(parameters, n, i, at.LINE_DENSITY) if i < n else 0.0
        if of_rope == 0.0 and point_mass_in(parameters, n, i) == 0.0:
            put_point_mass(n, i, NO_MASS, parameters)


@kernel
def unite(n, freed, parameters):
    """Undo `divide`, if it was done."""
    if not is_parted(parameters):
        return
    for i in range(n):
        put_property(n, at.SHARE, i, parameters[at.WHOLE_SHARE], parameters)
        put_property(n, at.OFFSET, i, 0.0, parameters)
        if i < n - freed:
            put_property(n, at.STIFFNESS, i, parameters[at.WHOLE_STIFFNESS], parameters)
            put_property(n, at.DAMPING, i, parameters[at.WHOLE_DAMPING], parameters)
            put_property(n, at.DRAG_WIDTH, i, parameters[at.WHOLE_DRAG_WIDTH], parameters)
            put_property(n, at.LINE_DENSITY, i, parameters[at.WHOLE_DENSITY], parameters)
    for i in range(n + 1):
        if 0 < i < n or point_mass_in(parameters, n, i) == NO_MASS:
            put_point_mass(n, i, 0.0, parameters)
    for place in range(at.TORN_NOW, at.WHOLE_DRAG_WIDTH + 1):
        parameters[place] = 0.0
    for place in range(at.IS_PARTED, at.WHOLE_DENSITY + 1):
        parameters[place] = 0.0
    parameters[at.LENGTH_BEYOND] = 0.0


@kernel
def node_mass(chain, i):
    """Mass [kg] of inner node i."""
    of_rope = half_density(chain, i - 1) * rest_length(chain, i - 1) + half_density(chain, i) * rest_length(chain, i)
    return of_rope + point_mass(chain, i)


@kernel
def add_momentum(chain, x, v, sign):
    """Add the momentum of the rope that flows past the inner nodes, over their masses, to their velocities (modified).

    sign : -1 to subtract it.  x : positions [m], flat.
    """
    part = flow.first_passing(chain)
    for s in range(chain.n):
        share, half, r = property_of(chain, s, at.SHARE), half_density(chain, s), sub(get(x, s + 1), get(x, s))
        for i in range(2):
            c, _ = flow.passing(chain, share, part - i * share)
            if 0 < s + i < chain.n:
                add_at(v, s + i, scale(sign * half * c / node_mass(chain, s + i), r))
        part -= share
