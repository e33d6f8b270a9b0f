"""Assembly of the lumped-mass chain: node masses, node forces, and the matrices of an implicit step.

Node 0 is at the ground, node n at the kite; segment s joins nodes s and s + 1. Each node of a segment carries half of its
mass, weight and drag:

    m_i = sum over its segments of 1/2 mu l0  +  point mass of the node
    F_i = T_i e_i - T_(i-1) e_(i-1) + half drags + f_i,   f_i: loads of the node (`node_loads.py`)

The change of node forces with positions and velocities, dF = K dx + B dv, is block tridiagonal with 3x3 blocks. Flat
arrays of node vectors have 3 (n + 1) numbers, interleaved arrays see `linear_algebra.both_ends`; `mass` has n + 1.
Theory: docs/models/theory.md, "The chain".
"""

from tetherfmu.runtime import layout as at

from ..arrays import clear
from ..compilation import kernel, view
from ..flat_arrays import every_second
from ..linear_algebra.both_ends import (
    get_interleaved,
    get_matrix_of_pairs,
    get_node,
    get_vector_of_pairs,
    lower_and_upper,
    next_interleaved,
    put_interleaved,
    put_pairs,
    put_side_by_side,
)
from ..linear_algebra.matrices import (
    ZERO_MATRIX,
    add_matrices,
    add_to_diagonal,
    apply,
    put_matrix,
    scale_matrix,
    subtract,
    symmetric,
)
from ..linear_algebra.pairs import broadcast, first, load_pair, number_at, pair, second
from ..linear_algebra.vectors import ZERO_VECTOR, add, dot, get, norm, put, scale, sub
from . import flow, node_loads, segment
from .properties import has_drag, in_section, point_mass, property_of, rest_length, sees_reeling

DIRECTION_AND_LENGTH = 8  # numbers of a segment and of its mirror image in the array of `find_segments`


@kernel
def node_masses(chain, mass):
    """Masses of all nodes [kg] into `mass` (modified)."""
    below = 0.0
    for s in range(chain.n):
        half = 0.5 * property_of(chain, s, at.LINE_DENSITY) * rest_length(chain, s)
        mass[s] = point_mass(chain, s) + below + half
        below = half
    mass[chain.n] = point_mass(chain, chain.n) + below


@kernel
def segments_size(n):
    """Length of the array that `find_segments` fills."""
    return DIRECTION_AND_LENGTH * ((n + 1) // 2)


@kernel
def find_segments(n, x, upwards, segments):
    """Directions and lengths [m] of all segments into `segments` (modified); x : interleaved positions [m].

    Directions go from the ground to the kite if `upwards`, else from the outer node to the inner one.
    This is a loop of its own because the processor looks some 300 instructions ahead: it then works on the square roots and
    quotients of several segments at once.
    """
    for s in range((n + 1) // 2):
        if upwards:
            x_p, x_q = lower_and_upper(n, s, x)
        else:
            x_p, x_q = get_interleaved(x, s), next_interleaved(n, s, x)
        length, e = segment.geometry(sub(x_q, x_p))
        put_pairs(segments, DIRECTION_AND_LENGTH * s, (*e, length))


@kernel
def found_segment(segments, s):
    """Length [m] and direction of segment s and of its mirror image, from `find_segments`."""
    return load_pair(segments, DIRECTION_AND_LENGTH * s + 6), get_vector_of_pairs(segments, DIRECTION_AND_LENGTH * s)


@kernel
def node_forces(chain, modes, x, v, mass, segments, force):
    """Tension, drag and load forces on all nodes [N] into `force` (modified).

        F_i = T_i e_i - T_(i-1) e_(i-1) + half drags + f_i, plus the forces of flowing rope (`flow.py`)

    `motion.accelerations` computes this sum in a plain loop. This loop runs from both ends inwards. It processes segment
    s and its mirror image n - 1 - s, node s and node n - s, as pairs of numbers, because the processor computes both
    numbers of a pair at once (`linear_algebra.pairs`). In both halves p is the outer node, q the inner one, and e
    points from p to q. A segment looks the same from both sides: p feels T e + F, q feels -T e + F.

    Mode of the stiffness of every segment (`segment.BY_LENGTH`, ...), positions x [m], velocities v [m/s], node masses
    [kg]. x, v and force are interleaved; `segments` is modified, see `find_segments`.
    """
    find_segments(chain.n, x, False, segments)
    if has_drag(chain):
        sum_forces(chain, True, modes, x, v, mass, segments, force)
    else:
        sum_forces(chain, False, modes, x, v, mass, segments, force)
    if flow.flows(chain):
        flow.add_forces(chain, x, v, segments, force)


@view
def sum_forces(chain, in_air, modes, x, v, mass, segments, force):
    """Loop of `node_forces`, given `segments`.

    in_air : `has_drag`, as a constant: compiled for both values, which saves a tenth of the time without drag.
    """
    n = chain.n
    from_outside = pair(ZERO_VECTOR, ZERO_VECTOR)  # force of the outer segment on p: none at the ends
    x_p, v_p = get_interleaved(x, 0), get_interleaved(v, 0)
    for s in range((n + 1) // 2):  # for odd n the middle segment is its own mirror image
        x_q, v_q = next_interleaved(n, s, x), next_interleaved(n, s, v)
        both = (s, n - 1 - s)
        length, e = found_segment(segments, s)
        mode, length_rate = number_at(modes, 0, both), dot(e, sub(v_q, v_p))
        pull = scale(segment.tension_of(chain, both, mode, length, length_rate), e)
        drag = broadcast(ZERO_VECTOR, length)
        if in_air:
            drag = segment.half_drag_between(chain, both, length, e, x_p, x_q, v_p, v_q)
        load = node_loads.load(chain, number_at(mass, 0, (s, n - s)), x_p, v_p, None)
        put_interleaved(force, s, add(add(add(from_outside, pull), drag), load))
        from_outside = sub(drag, pull)
        x_p, v_p = x_q, v_q
    if n % 2 == 0:  # the middle node is its own mirror image, and has two outer segments
        middle = n // 2
        load = node_loads.load(chain, mass[middle], first(x_p), first(v_p), None)
        total = add(add(first(from_outside), second(from_outside)), load)
        put_interleaved(force, middle, pair(total, total))


@kernel
def end_force(chain, kite_end, x, v, mass):
    """Force of the tether on the support of its ground end (or kite end) [N], and the tension there [N].

    Force of the end segment plus half of its drag plus the weight of its half there, without inertia and without a point
    mass at the end, which is not part of the tether.
    Source: docs/models/theory.md, "End forces".
    """
    s = chain.n - 1 if kite_end else 0
    i = chain.n if kite_end else 0
    pull, drag, tension = segment.forces(chain, s, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1))
    total = add(scale(-1.0, pull), drag) if kite_end else add(pull, drag)
    load = node_loads.load(chain, mass[i] - point_mass(chain, i), get(x, i), get(v, i), None)
    total = add(total, load)
    if flow.flows(chain):
        total = add(total, flow.end_force(chain, kite_end, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)))
    return total, tension


@view
def record_of(s, n, records):
    """Derivatives of the forces of segment s: a view of `records`, which stores mirror segments as pairs."""
    outer = min(s, n - 1 - s)
    return every_second(records, 2 * segment.RECORD * outer + (1 if s > outer else 0), segment.RECORD)


@kernel
def linearize(chain, x, v, modes, segments, records, force_rate):
    """Derivatives of all segment forces into `records`, rate of the forces from reeling into `force_rate` (both modified).

    x, v : interleaved positions [m] and velocities [m/s].  modes (modified) : stiffness mode of each segment.
    segments (modified) : see `find_segments`.  force_rate : dF/dl0 dl0/dt of every node [N/s] at constant positions and
    velocities, a flat array.
    """
    find_slopes(chain, x, v, modes, segments, records)
    rate_from_reeling(chain, x, v, records, force_rate)


@kernel
def find_slopes(chain, x, v, modes, segments, records):
    """`linearize` without `force_rate`."""
    find_segments(chain.n, x, True, segments)
    if has_drag(chain):
        linearize_segments(chain, True, x, v, modes, segments, records)
    else:
        linearize_segments(chain, False, x, v, modes, segments, records)


@view
def linearize_segments(chain, in_air, x, v, modes, segments, records):
    """Records and modes of `linearize`, given `segments`; in_air : see `sum_forces`."""
    n = chain.n
    for s in range((n + 1) // 2):
        both = (s, n - 1 - s)
        x_p, x_q = lower_and_upper(n, s, x)
        v_p, v_q = lower_and_upper(n, s, v)
        length, e = found_segment(segments, s)
        axial, damper, slope, mode = segment.linearize_tension(chain, both, length, e, sub(v_q, v_p))
        drag = drag_by_velocity = broadcast(ZERO_MATRIX, length)
        a = broadcast(ZERO_VECTOR, length)
        if in_air:
            _, drag, drag_by_velocity, a = segment.linearize_drag_between(chain, both, length, e, x_p, x_q, v_p, v_q)
        put_records(s, axial, drag, drag_by_velocity, (*a, *e, damper, slope), records)
        modes[s] = first(mode)
        modes[n - 1 - s] = second(mode)


@kernel
def put_records(s, axial, drag, drag_by_velocity, others, records):
    """Write the derivatives of segment s and of its mirror image, as pairs, to `records` (modified)."""
    start = 2 * segment.RECORD * s
    put_pairs(records, start + 2 * segment.K, axial)
    put_pairs(records, start + 2 * segment.G, drag)
    put_pairs(records, start + 2 * segment.A, drag_by_velocity)
    put_pairs(records, start + 2 * segment.HEIGHT, others)


@kernel
def rate_from_reeling(chain, x, v, records, force_rate):
    """Rate dF/dl0 dl0/dt of the node forces [N/s] into `force_rate` (modified), at constant positions and velocities.

    x, v : interleaved positions [m] and velocities [m/s].
    """
    clear(force_rate)
    if chain.reeling == 0.0:
        return
    for s in range(chain.n):
        record = record_of(s, chain.n, records)
        rest_rate = property_of(chain, s, at.SHARE) * chain.reeling
        half = 0.5 * property_of(chain, s, at.LINE_DENSITY) * rest_rate
        pull = scale(record[segment.SLOPE] * rest_rate, segment.direction_in(record))
        below = node_loads.load_rate(chain, half, get_node(chain.n, s, x), get_node(chain.n, s, v))
        above = node_loads.load_rate(chain, half, get_node(chain.n, s + 1, x), get_node(chain.n, s + 1, v))
        put(force_rate, s, add(get(force_rate, s), add(below, pull)))
        put(force_rate, s + 1, sub(above, pull))


@kernel
def add_rate_from_acceleration(chain, acceleration, x, records, force_rate):
    """Add dF/d(dl0/dt) d2l0/dt2 of the node forces [N/s] to `force_rate` (modified): dampers feel the rate of reeling.

    acceleration : second derivative of the unstretched length of the tether [m/s2].  x : node positions [m].
    """
    if acceleration == 0.0 or not sees_reeling(chain.parameters):
        return
    for s in range(chain.n):
        record = record_of(s, chain.n, records)
        by_reeling = in_section(chain, s, -record[segment.DAMPER] * acceleration / chain.section)
        pull = scale(by_reeling, sub(get(x, s + 1), get(x, s)))
        put(force_rate, s, add(get(force_rate, s), pull))
        put(force_rate, s + 1, sub(get(force_rate, s + 1), pull))


@kernel
def add_end_motion(n, kite_end, dx, dv, records, force):
    """Add to `force` (modified) the change of node forces [N] when one end moves by dx [m] and dv [m/s]."""
    s = n - 1 if kite_end else 0
    record = record_of(s, n, records)
    if kite_end:
        axial, drag = segment.force_change(record, ZERO_VECTOR, dx, ZERO_VECTOR, dv)
    else:
        axial, drag = segment.force_change(record, dx, ZERO_VECTOR, dv, ZERO_VECTOR)
    put(force, s, add(get(force, s), add(axial, drag)))
    put(force, s + 1, add(get(force, s + 1), sub(drag, axial)))


@kernel
def longest_part(chain, move):
    """Fraction [-] of a displacement [m] of all nodes in which no segment changes by more than its unstretched length."""
    part = 1.0
    for s in range(chain.n):
        rest = rest_length(chain, s)
        part = min(part, rest / max(norm(sub(get(move, s + 1), get(move, s))), rest))
    return part


@kernel
def assemble(n, mass_factor, damping_factor, stiffness_factor, mass, records, matrix):
    """Blocks of the `block_tridiagonal.Matrix` mass_factor M - damping_factor B - stiffness_factor K (modified)."""
    diagonal, lower, upper = matrix
    outward = pair(1.0, -1.0)
    from_outside = pair(ZERO_MATRIX, ZERO_MATRIX)
    for s in range((n + 1) // 2):  # the loop visits a middle segment twice
        i = n - s
        axial, drag, both = step_blocks(2 * segment.RECORD * s, damping_factor, stiffness_factor, records)
        drag = scale_matrix(outward, drag)
        total = add_matrices(axial, drag)
        outer = add_to_diagonal(subtract(total, both), mass_factor * pair(mass[s], mass[i]))
        put_side_by_side(diagonal, 9 * s, diagonal, 9 * i, add_matrices(from_outside, outer))
        put_side_by_side(upper, 9 * s, lower, 9 * i, scale_matrix(-1.0, add_matrices(total, both)))
        put_side_by_side(lower, 9 * s + 9, upper, 9 * i - 9, subtract(subtract(drag, axial), both))
        from_outside = subtract(subtract(axial, drag), both)
    if n % 2 == 0:
        middle = n // 2
        block = add_matrices(first(from_outside), second(from_outside))
        put_matrix(diagonal, 9 * middle, add_to_diagonal(block, mass_factor * mass[middle]))


@kernel
def step_blocks(start, damping_factor, stiffness_factor, records):
    """Parts of the blocks of two segments, with records at this place, as pairs.

    stiffness_factor K + damping_factor c e e, stiffness_factor G, and (stiffness_factor a e_z - damping_factor A)/2.
    """
    damper = damping_factor * load_pair(records, start + 2 * segment.DAMPER)
    along_e = symmetric(damper, get_vector_of_pairs(records, start + 2 * segment.DIRECTION))
    axial = add_matrices(scale_matrix(stiffness_factor, get_matrix_of_pairs(records, start + 2 * segment.K)), along_e)
    drag = scale_matrix(stiffness_factor, get_matrix_of_pairs(records, start + 2 * segment.G))
    both = scale_matrix(-0.5 * damping_factor, get_matrix_of_pairs(records, start + 2 * segment.A))
    x, y, z = scale(0.5 * stiffness_factor, get_vector_of_pairs(records, start + 2 * segment.HEIGHT))
    return axial, drag, (both[0], both[1], both[2] + x, both[3], both[4], both[5] + y, both[6], both[7], both[8] + z)


@kernel
def damping_product(s, sign, u_p, u_q, records):
    """Changes of the axial force and of the half drag of segment s and its mirror image by sign u, as pairs.

    sign u : velocities [m/s] of the outer and inner nodes, times sign.
    """
    record = 2 * segment.RECORD * s
    e = get_vector_of_pairs(records, record + 2 * segment.DIRECTION)
    damper = sign * load_pair(records, record + 2 * segment.DAMPER)
    axial = scale(damper * dot(e, sub(u_q, u_p)), e)
    drag_by_velocity = get_matrix_of_pairs(records, record + 2 * segment.A)
    return axial, scale(-0.5 * sign, apply(drag_by_velocity, add(u_p, u_q)))
