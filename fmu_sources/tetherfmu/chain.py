"""The chain of lumped masses: node forces, node masses, and the matrices of an implicit step.

Node 0 is at the ground, node n at the kite; segment s joins nodes s and s + 1. Half of the mass, of the weight and of
the drag of a segment sits on each of its nodes:

    m_i = sum over its segments of 1/2 mu l0  +  point mass of the node
    F_i = T_i e_i - T_(i-1) e_(i-1) + half drags - m_i g e_z

The rate of change of node forces with positions and velocities, dF = K dx + B dv, has 3x3 blocks next to its diagonal
only. `x`, `v`, `force` are flat arrays of 3 (n + 1) numbers, `mass` has n + 1. Theory: docs/theory.md, "The chain".
"""

from . import layout as at
from . import segment
from .compilation import kernel
from .pairs import first, number_at, pair, second
from .vectors import add, apply, dot, get, get_matrix, get_two, put, put_matrix, put_side_by_side, put_two, scale, sub


@kernel
def rest_length(s, length, parameters):
    """Unstretched length [m] of segment s (of two, as a pair) when that of the tether is `length` [m]."""
    return number_at(parameters, at.PARAMETER_SCALARS, s) * length


@kernel
def node_masses(n, length, parameters, mass):
    """Masses of all nodes [kg] into `mass` (modified) at the unstretched length of the tether [m]."""
    line = at.PARAMETER_SCALARS + at.LINE_DENSITY * n
    points = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n
    for i in range(n + 1):
        mass[i] = parameters[points + i]
    for s in range(n):
        half = 0.5 * parameters[line + s] * rest_length(s, length, parameters)
        mass[s] += half
        mass[s + 1] += half


@kernel
def node_forces(n, branches, x, v, length, reeling, wind, mass, parameters, force):
    """Forces of tension, drag and weight on all nodes [N] into `force` (modified), from both ends at once.

    Branch of the stiffness of every segment (`segment.BY_LENGTH`, ...), positions x [m], velocities v [m/s], unstretched
    length of the tether [m] and its rate [m/s], wind at the reference height [m/s] as a tuple, node masses [kg].
    """
    gravity = parameters[at.GRAVITY]
    growth = reeling / length
    from_outside = pair((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    x_p = get_two(x, 0, n)
    v_p = get_two(v, 0, n)
    for s in range((n + 1) // 2):  # p is the outer node, q the inner one; a segment in the middle is met twice
        mirror = n - 1 - s
        x_q = get_two(x, s + 1, mirror)
        v_q = get_two(v, s + 1, mirror)
        rest = rest_length((s, mirror), length, parameters)
        branch = pair(branches[s], branches[mirror])
        pull, drag, _, _ = segment.forces((s, mirror), n, branch, x_p, x_q, v_p, v_q, rest, growth, wind, parameters)
        total = add(add(from_outside, pull), drag)
        put_two(force, s, n - s, (total[0], total[1], total[2] - gravity * pair(mass[s], mass[n - s])))
        from_outside = sub(drag, pull)
        x_p = x_q
        v_p = v_q
    if n % 2 == 0:
        middle = n // 2
        total = add(first(from_outside), second(from_outside))
        put(force, middle, (total[0], total[1], total[2] - gravity * mass[middle]))


@kernel
def end_force(n, kite_end, x, v, length, reeling, wind, mass, parameters):
    """Force of the tether on what holds its ground end (or its kite end) [N], and the tension there [N].

    Force of the end segment plus half of its drag plus weight of its half there; without inertia, and without a point mass
    at the end, which is not of the tether.
    Source: docs/theory.md, "End forces".
    """
    s = n - 1 if kite_end else 0
    rest = rest_length(s, length, parameters)
    pull, drag, tension, _ = segment.forces(
        s, n, segment.BY_LENGTH, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1), rest, reeling / length, wind, parameters
    )
    if kite_end:
        pull = scale(-1.0, pull)
    total = add(pull, drag)
    i = n if kite_end else 0
    weight = (mass[i] - parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n + i]) * parameters[at.GRAVITY]
    return (total[0], total[1], total[2] - weight), tension


@kernel
def linearize(n, x, v, length, reeling, wind, parameters, records, force_rate):
    """Derivatives of all segment forces into `records` (modified); rate of the forces from reeling into `force_rate`.

    `force_rate` [N/s] (modified) is dF/dl0 dl0/dt of every node at constant positions and velocities.
    """
    size = at.SEGMENT_RECORD
    growth = reeling / length
    for s in range((n + 1) // 2):
        mirror = n - 1 - s
        x_p = get_two(x, s, mirror)
        x_q = get_two(x, s + 1, mirror + 1)
        v_p = get_two(v, s, mirror)
        v_q = get_two(v, s + 1, mirror + 1)
        both = (s, mirror)
        r = sub(x_q, x_p)
        rest = rest_length(both, length, parameters)
        axial, e, damper, slope = segment.linearize_tension(both, n, r, sub(v_q, v_p), rest, growth, parameters)
        height = 0.5 * (x_p[2] + x_q[2])
        velocity = scale(0.5, add(v_p, v_q))
        drag, drag_by_velocity, a = segment.linearize_drag(both, n, r, height, velocity, wind, parameters)
        p = size * s
        q = size * mirror
        put_side_by_side(records, p + segment.K, q + segment.K, axial)
        put_side_by_side(records, p + segment.G, q + segment.G, drag)
        put_side_by_side(records, p + segment.A, q + segment.A, drag_by_velocity)
        put_side_by_side(records, p + segment.HEIGHT, q + segment.HEIGHT, (*a, *e, damper, slope))
    rate_from_reeling(n, reeling, parameters, records, force_rate)


@kernel
def rate_from_reeling(n, reeling, parameters, records, force_rate):
    """Rate dF/dl0 dl0/dt of the node forces [N/s] into `force_rate` (modified), at constant positions and velocities."""
    size = at.SEGMENT_RECORD
    line = at.PARAMETER_SCALARS + at.LINE_DENSITY * n
    for k in range(3 * (n + 1)):
        force_rate[k] = 0.0
    if reeling == 0.0:
        return
    for s in range(n):
        record = records[size * s : size * (s + 1)]
        rest_rate = rest_length(s, reeling, parameters)
        half_weight = 0.5 * parameters[line + s] * rest_rate * parameters[at.GRAVITY]
        pull = record[segment.SLOPE] * rest_rate
        for i in range(3):
            along_e = pull * record[segment.DIRECTION + i]
            weight = half_weight if i == 2 else 0.0
            force_rate[3 * s + i] += along_e - weight
            force_rate[3 * s + 3 + i] = -along_e - weight


@kernel
def add_end_motion(n, kite_end, dx, dv, records, force):
    """Add to `force` (modified) the change of node forces [N] when one end moves by dx [m] and dv [m/s]."""
    size = at.SEGMENT_RECORD
    still = (0.0, 0.0, 0.0)
    s = n - 1 if kite_end else 0
    record = records[size * s : size * (s + 1)]
    if kite_end:
        axial, drag = segment.force_change(record, still, dx, still, dv)
    else:
        axial, drag = segment.force_change(record, dx, still, dv, still)
    put(force, s, add(get(force, s), add(axial, drag)))
    put(force, s + 1, add(get(force, s + 1), sub(drag, axial)))


@kernel
def assemble(n, mass_factor, damping_factor, stiffness_factor, mass, records, diagonal, lower, upper):
    """Blocks of the matrix mass_factor M - damping_factor B - stiffness_factor K (modified: the three block arrays).

    Block i of `lower` stands left of diagonal block i, block i of `upper` right of it; 9 numbers each, row by row.
    """
    size = at.SEGMENT_RECORD
    for i in range(n + 1):
        m = mass_factor * mass[i]
        put_matrix(diagonal, 9 * i, (m, 0.0, 0.0, 0.0, m, 0.0, 0.0, 0.0, m))
    for s in range(n):
        record = records[size * s : size * (s + 1)]
        block_p = diagonal[9 * s : 9 * s + 9]
        block_q = diagonal[9 * s + 9 : 9 * s + 18]
        right = upper[9 * s : 9 * s + 9]
        left = lower[9 * s + 9 : 9 * s + 18]
        damper = damping_factor * record[segment.DAMPER]
        for i in range(3):
            damper_i = damper * record[segment.DIRECTION + i]
            for j in range(3):
                k = 3 * i + j
                axial = stiffness_factor * record[segment.K + k] + damper_i * record[segment.DIRECTION + j]
                drag = stiffness_factor * record[segment.G + k]
                both = -0.5 * damping_factor * record[segment.A + k]
                if j == 2:
                    both += 0.5 * stiffness_factor * record[segment.HEIGHT + i]
                block_p[k] += axial + drag - both
                right[k] = -axial - drag - both
                left[k] = -axial + drag - both
                block_q[k] += axial - drag - both


@kernel
def add_damping_product(n, sign, u, records, result):
    """Add sign B u to `result` (modified); u and result are flat arrays of node vectors."""
    size = at.SEGMENT_RECORD
    u_p = get(u, 0)
    from_below = get(result, 0)
    for s in range(n):
        record = records[size * s : size * (s + 1)]
        u_q = get(u, s + 1)
        e = (record[segment.DIRECTION], record[segment.DIRECTION + 1], record[segment.DIRECTION + 2])
        axial = scale(sign * record[segment.DAMPER] * dot(e, sub(u_q, u_p)), e)
        drag = scale(-0.5 * sign, apply(get_matrix(record, segment.A), add(u_p, u_q)))
        put(result, s, add(from_below, add(drag, axial)))
        from_below = add(get(result, s + 1), sub(drag, axial))
        u_p = u_q
    put(result, n, from_below)
