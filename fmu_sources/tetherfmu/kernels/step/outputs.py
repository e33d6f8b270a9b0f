"""Outputs of a tether: of a chain of nodes, of tethers without nodes, and common ones."""

from math import atan2, inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK, OUTPUT_NOT_FINITE

from ..arrays import positions_and_velocities
from ..compilation import kernel
from ..equations import segment
from ..equations.assembly import end_force, node_masses
from ..equations.ground import ground_of, has_ground, part_under
from ..equations.properties import holds, part_of, point_mass, property_of, rest_length
from ..linear_algebra.vectors import add, add_scaled, dot, get, norm, put_at, sub, vector_at

SLACKEST = 1e-9  # lower limit of a tension in wave_time, over EA


@kernel
def wave_time(line_density, rest_length, length, tension, axial_stiffness):
    """Travel time [s] of a transverse wave over a piece of tether: sqrt(mu l0 l/T).

    Mass per unstretched length [kg/m], unstretched and present length [m], tension [N], EA [N]. To keep the time of a
    slack piece finite, its tension counts as at least 1e-9 EA.
    """
    return sqrt(line_density * rest_length * length / max(tension, SLACKEST * axial_stiffness))


@kernel
def write_direction(leaving, outputs):
    """Elevation and azimuth [rad] of the direction in which the tether leaves the ground, into the outputs (modified)."""
    outputs[at.GROUND_ELEVATION] = atan2(leaving[2], sqrt(leaving[0] ** 2 + leaving[1] ** 2))
    outputs[at.GROUND_AZIMUTH] = atan2(leaving[1], leaving[0])


@kernel
def place_along_chord(point, start, chord):
    """Position of a point [m] along the chord: 0 at its start [m], 1 at its end, also outside of this range."""
    square = dot(chord, chord)
    return dot(sub(point, start), chord) / square if square > 0.0 else 0.0


@kernel
def away_from_chord(point, start, chord):
    """Vector [m] to a point from the nearest point on the straight line through the ends of the chord."""
    part = min(1.0, max(0.0, place_along_chord(point, start, chord)))
    return add_scaled(sub(point, start), -part, chord)


@kernel
def last_of_rope(chain):
    """Number of the last node of the tether itself: the last but one after a release at its end."""
    has_let_go = chain.n > 1 and property_of(chain, chain.n - 1, at.LINE_DENSITY) == 0.0
    return chain.n - 1 if has_let_go else chain.n


@kernel
def write_segments(chain, x, v, outputs):
    """Outputs from all segments (modified): largest tension, slack segments, stiffness, wave time, sag."""
    largest = -inf
    slack = 0
    crossing = 0.0
    compliance = 0.0  # 1/k of all segments in series, taut [m/N]
    mobility = 0.0  # 1/c of all segments in series [m/(N s)], if all have a damper
    undamped = False
    sag = 0.0
    ground = get(x, 0)
    chord = sub(get(x, last_of_rope(chain)), ground)
    for s in range(chain.n):
        rest = rest_length(chain, s)
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rate = dot(e, sub(get(v, s + 1), get(v, s)))
        tension = segment.tension_of(chain, s, segment.BY_LENGTH, length, rate)
        sag = max(sag, norm(away_from_chord(get(x, s), ground, chord)))
        if not holds(chain, s):
            undamped, compliance = True, inf
            continue
        largest = max(largest, tension)
        if length < rest:
            slack += 1
        stiffness = property_of(chain, s, at.STIFFNESS)
        crossing += wave_time(property_of(chain, s, at.LINE_DENSITY), rest, length, tension, stiffness)
        compliance += rest / stiffness
        damping = property_of(chain, s, at.DAMPING)
        undamped = undamped or damping == 0.0
        mobility += rest / (damping if damping != 0.0 else 1.0)
    outputs[at.MAX_TENSION] = largest if largest > -inf else 0.0
    outputs[at.SLACK_SEGMENTS] = slack
    outputs[at.KITE_STIFFNESS] = 1.0 / compliance
    outputs[at.KITE_DAMPING] = 0.0 if undamped else 1.0 / mobility
    outputs[at.WAVE_TIME] = crossing
    outputs[at.SAG] = sag


@kernel
def write_shape(chain, x, shape_points, outputs):
    """Points [m] at equal unstretched length along the tether, ground first, into the outputs (modified)."""
    s = 0
    passed = 0.0
    for k in range(shape_points):
        part = k / max(1, shape_points - 1)
        while s < chain.n - 1 and part > passed + part_of(chain, s):
            passed += part_of(chain, s)
            s += 1
        within = (part - passed) / part_of(chain, s)
        if not holds(chain, s):
            within = 0.0 if within < 0.5 or s == last_of_rope(chain) else 1.0
        start = get(x, s)
        put_at(outputs, at.SHAPE + 3 * k, add_scaled(start, within, sub(get(x, s + 1), start)))


@kernel
def grounded_length(chain, x):
    """Unstretched length [m] of the chain in ground contact, with nodes at x [m]."""
    touching = 0.0
    if has_ground(chain.parameters):
        ground = ground_of(chain.parameters)
        for s in range(chain.n):
            if holds(chain, s):
                touching += part_under(ground, get(x, s), get(x, s + 1)) * rest_length(chain, s)
    return touching


@kernel
def missing_tension(chain, s, x, held):
    """Stored tension vector [N] of segment s minus its spring tension with nodes at x [m]: vector and size [N]."""
    length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
    pull = segment.spring_tension(chain, s, length)
    return add_scaled(held, -pull, e), norm(held) - pull


@kernel
def correct_end_forces(chain, state, x, outputs):
    """End forces and tensions and the largest tension in the outputs (modified), if positions do not determine them.

    Source: docs/models/numerics.md, "Stiff tethers".
    """
    held = vector_at(state, at.GROUND_TENSION_VECTOR)
    if dot(held, held) == 0.0:
        return
    pull, tension = missing_tension(chain, 0, x, held)
    put_at(outputs, at.GROUND_FORCE, add(vector_at(outputs, at.GROUND_FORCE), pull))
    outputs[at.GROUND_TENSION] += tension
    pull, tension = missing_tension(chain, chain.n - 1, x, vector_at(state, at.KITE_TENSION_VECTOR))
    put_at(outputs, at.KITE_FORCE, sub(vector_at(outputs, at.KITE_FORCE), pull))
    outputs[at.KITE_TENSION] += tension
    largest = outputs[at.MAX_TENSION] + state[at.MISSING_TENSION]
    outputs[at.MAX_TENSION] = max(largest, outputs[at.GROUND_TENSION], outputs[at.KITE_TENSION])


@kernel
def outputs_of_chain(chain, state, x, v, shape_points, outputs, mass):
    """Write all outputs (modified) of a chain in a state with positions x [m] and velocities v [m/s].

    `mass` (modified) holds n + 1 numbers.
    """
    node_masses(chain, mass)
    ground_force, ground_tension = end_force(chain, False, x, v, mass)
    kite_force, kite_tension = end_force(chain, True, x, v, mass)
    put_at(outputs, at.GROUND_FORCE, ground_force)
    put_at(outputs, at.KITE_FORCE, kite_force)
    outputs[at.GROUND_TENSION] = ground_tension
    outputs[at.KITE_TENSION] = kite_tension
    outputs[at.TETHER_LENGTH] = chain.length
    outputs[at.SOLVER_ITERATION_LIMIT] = 0.0  # for fixed steps see `fixed_steps.most_iterations`
    write_direction(sub(get(x, 1), get(x, 0)), outputs)
    outputs[at.KITE_END_MASS] = mass[chain.n] - point_mass(chain, chain.n)
    outputs[at.GROUNDED_LENGTH] = grounded_length(chain, x)
    write_segments(chain, x, v, outputs)
    correct_end_forces(chain, state, x, outputs)
    write_shape(chain, x, shape_points, outputs)


@kernel
def parting(state):
    """1 if the line has broken or was released, else 0; and the time of the first such event [s] since the start, or -1."""
    has_broken, has_let_go = state[at.TORN_SEGMENT] >= 1.0, state[at.LET_GO] >= 1.0
    if has_broken and has_let_go:
        return 1.0, min(state[at.TORN_AT], state[at.LET_GO_AT])
    if has_broken:
        return 1.0, state[at.TORN_AT]
    return (1.0, state[at.LET_GO_AT]) if has_let_go else (0.0, -1.0)


@kernel
def complete(n, state, outputs):
    """Write the outputs that all variants read from a state (modified); returns OK or OUTPUT_NOT_FINITE."""
    x, v = positions_and_velocities(n, state)
    put_at(outputs, at.OUTPUT_KITE_POSITION, get(x, n))
    put_at(outputs, at.OUTPUT_KITE_VELOCITY, get(v, n))
    outputs[at.BROKEN], outputs[at.BREAK_TIME] = parting(state)
    outputs[at.WINCH_SPEED] = state[at.REELING]
    outputs[at.PEAK_TENSION] = max(outputs[at.MAX_TENSION], state[at.PEAK_SO_FAR])
    outputs[at.SOLVER_STEPS] = min(state[at.STEPS], at.LARGEST_INTEGER)
    outputs[at.SOLVER_REJECTIONS] = min(state[at.REJECTIONS], at.LARGEST_INTEGER)
    outputs[at.FALLBACK_STEPS] = min(state[at.FALLBACKS], at.LARGEST_INTEGER)
    outputs[at.SOLVER_ITERATIONS] = min(state[at.ITERATIONS], at.LARGEST_INTEGER)
    for k in range(len(outputs)):
        if not abs(outputs[k]) < inf:
            return OUTPUT_NOT_FINITE
    return OK
