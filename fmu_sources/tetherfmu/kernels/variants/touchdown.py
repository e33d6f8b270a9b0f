"""A catenary on the ground: whether it touches down, and the outputs of its three parts: two hanging, one lying.

The hanging parts start at the ends, with the end forces of the tether as tension vectors.

Source: docs/models/theory.md, "Catenary on the ground".
"""

from collections import namedtuple
from math import sqrt

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations.properties import property_of
from ..linear_algebra.vectors import add_scaled, get, norm, put_at, sub, vector_at
from ..rest.elastic_catenary import SAMPLES, crossing_and_sag, point_in_space
from ..rest.grounded_catenary import hang_on_ground, lying_span, parts_with, scene_of
from ..step.outputs import away_from_chord, wave_time, write_direction

CLEAR = 0.02  # see `part_in_air`

Lying = namedtuple(
    "Lying", "ground kite plane load stiffness ground_force kite_force near far length ground_is_high start end pull fall"
)
Lying.__doc__ = """A tether with a part on the ground.

ground, kite : ends [m].  plane : height of the lying part [m].  load : per unstretched length [N/m].  stiffness : EA [N].
ground_force, kite_force : of the tether on its ends [N].  near, far : unstretched lengths that hang from the ground end and
from the kite [m].  length : of the lying part [m].  ground_is_high : whether the ground end is the higher one.
start, end : touchdown points at the side of the high end and of the low one [m].
pull, fall : tension at that start [N], its decrease per length [N/m]."""


@kernel
def plane_of(parameters, ground, kite):
    """Height [m] of the ground under a tether, lowered to an end below the ground."""
    return min(parameters[at.GROUND_HEIGHT], ground[2], kite[2])


@kernel
def lowest(ground, tension, load, length, stiffness):
    """Lowest point [m] of a catenary that hangs below both ends, else its ground end [m]; tension vector there [N]."""
    arc = tension[2] / load[2] if load[2] < 0.0 else 0.0
    if not 0.0 < arc < length:
        return ground, tension
    return point_in_space(ground, tension, load, arc, stiffness), add_scaled(tension, -arc, load)


@kernel
def part_in_air(line, load, state):
    """Relative clearance of a catenary without ground contact [-]: 0 at touchdown, 1 from CLEAR of its length on.

    From the height of its lowest point above the ground, or if this is an end, from the missing length until the
    tether is level there.
    """
    x, _ = positions_and_velocities(1, state)
    ground, kite = get(x, 0), get(x, 1)
    if not load[2] < 0.0:
        return 1.0
    tension = vector_at(state, at.GROUND_TENSION_VECTOR)
    arc, stiffness = tension[2] / load[2], property_of(line, 0, at.STIFFNESS)
    point = point_in_space(ground, tension, load, min(line.length, max(0.0, arc)), stiffness)
    missing = max(0.0, -arc, arc - line.length)
    clear = (point[2] - plane_of(line.parameters, ground, kite) + missing) / (CLEAR * line.length)
    part = min(1.0, max(0.0, clear))
    return part * part * (3.0 - 2.0 * part)


@kernel
def rest_on_ground(line, load, state):
    """Lay a catenary that hangs below the ground onto it, in the state (modified); load per unstretched length [N/m]."""
    x, _ = positions_and_velocities(1, state)
    ground, kite = get(x, 0), get(x, 1)
    stiffness, friction = property_of(line, 0, at.STIFFNESS), line.parameters[at.GROUND_FRICTION]
    plane = plane_of(line.parameters, ground, kite)
    point, tension = lowest(ground, vector_at(state, at.GROUND_TENSION_VECTOR), load, line.length, stiffness)
    if point[2] >= plane:
        return
    ground_force, kite_force, lying, tried = hang_on_ground(
        ground, kite, load, line.length, stiffness, friction, plane, tension
    )
    state[at.ITERATIONS] += max(tried, 0)
    if tried >= 0 and lying > 0.0:
        put_at(state, at.GROUND_TENSION_VECTOR, ground_force)
        put_at(state, at.KITE_TENSION_VECTOR, kite_force)
        state[at.LYING_LENGTH] = lying


@view
def lying_of(line, load, state):
    """`Lying` of a state in which a part of the catenary lies on the ground; load per unstretched length [N/m]."""
    x, _ = positions_and_velocities(1, state)
    ground, kite = get(x, 0), get(x, 1)
    stiffness, friction = property_of(line, 0, at.STIFFNESS), line.parameters[at.GROUND_FRICTION]
    plane, length = plane_of(line.parameters, ground, kite), state[at.LYING_LENGTH]
    ground_force, kite_force = vector_at(state, at.GROUND_TENSION_VECTOR), vector_at(state, at.KITE_TENSION_VECTOR)
    near, far = ground_force[2] / load[2], kite_force[2] / load[2]
    scene, size, kite_is_low = scene_of(ground, kite, load, line.length, stiffness, friction, plane)
    end = point_in_space(ground, ground_force, load, near, stiffness)
    start = point_in_space(kite, kite_force, load, far, stiffness)
    tension = add_scaled(kite_force, -far, load)
    if kite_is_low:
        start, end = end, start
        tension = add_scaled(ground_force, -near, load)
    unit = size * line.length
    pull = sqrt(tension[0] ** 2 + tension[1] ** 2)
    fall = 0.0
    if pull > 0.0:
        parts = parts_with(pull / unit, -tension[0] / pull, -tension[1] / pull, scene)
        fall = size * parts.friction
    return Lying(
        *(ground, kite, plane, load, stiffness, ground_force, kite_force, near, far, length),
        *(kite_is_low, start, end, pull, fall),
    )


@kernel
def point_lying(lying, arc):
    """Point [m] of the part on the ground at an unstretched length `arc` [m] from its high side."""
    part = lying_span(lying.pull, lying.fall, arc, 1.0 / lying.stiffness)
    part /= lying_span(lying.pull, lying.fall, lying.length, 1.0 / lying.stiffness)
    x, y, _ = add_scaled(lying.start, part, sub(lying.end, lying.start))
    return x, y, lying.plane


@kernel
def point_at(lying, arc, length):
    """Point [m] at an unstretched length `arc` [m] from the ground end of a tether of this length [m]."""
    if arc <= lying.near:
        x, y, z = point_in_space(lying.ground, lying.ground_force, lying.load, arc, lying.stiffness)
    elif length - arc <= lying.far:
        x, y, z = point_in_space(lying.kite, lying.kite_force, lying.load, length - arc, lying.stiffness)
    else:
        from_ground = arc - lying.near
        x, y, z = point_lying(lying, from_ground if lying.ground_is_high else lying.length - from_ground)
    return x, y, max(z, lying.plane)


@kernel
def write_shape(lying, length, shape_points, outputs):
    """Points [m] at equal unstretched length along a tether of this length [m], into the outputs (modified)."""
    for k in range(shape_points):
        put_at(outputs, at.SHAPE + 3 * k, point_at(lying, length * k / max(1, shape_points - 1), length))


@kernel
def write_parts(line, lying, chord, outputs):
    """Wave time and sag of the three parts into the outputs (modified); chord [m]."""
    density = property_of(line, 0, at.LINE_DENSITY)
    crossing, sag = 0.0, 0.0
    for touch in (lying.start, lying.end):
        sag = max(sag, norm(away_from_chord(touch, lying.ground, chord)))
    ends = (lying.ground, lying.ground_force, lying.near), (lying.kite, lying.kite_force, lying.far)
    for end, force, hanging in ends:
        if hanging > 0.0:
            time, away = crossing_and_sag(line, end, hanging, lying.ground, chord, force, lying.load)
            crossing += time
            sag = max(sag, away)
    piece = lying.length / SAMPLES
    for k in range(SAMPLES):
        pull = max(0.0, lying.pull - (k + 0.5) * piece * lying.fall)
        crossing += wave_time(density, piece, piece * (1.0 + pull / lying.stiffness), pull, lying.stiffness)
    outputs[at.WAVE_TIME] = crossing
    outputs[at.SAG] = sag


@kernel
def write_lying(line, chord, load, state, shape_points, outputs):
    """Write the additional outputs of a tether on the ground (modified); chord [m], load [N/m]."""
    lying = lying_of(line, load, state)
    outputs[at.GROUNDED_LENGTH] = lying.length
    leaving = lying.ground_force
    if norm(leaving) == 0.0:  # slack: direction of the lying part
        first, second = (lying.start, lying.end) if lying.ground_is_high else (lying.end, lying.start)
        leaving = second[0] - first[0], second[1] - first[1], 0.0
    write_direction(leaving, outputs)
    write_parts(line, lying, chord, outputs)
    write_shape(lying, line.length, shape_points, outputs)
