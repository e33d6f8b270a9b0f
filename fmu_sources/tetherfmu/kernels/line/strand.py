"""A line with rope coordinates at its ends: residual of a stage, derivatives, right-hand sides.

The equations are 0 = r(q, v, z, t) with q' = v and v' = z: M(q) z = F(q, v, z, t) for the nodes, where F contains the
inertia of accelerating rope, and a tension T(R) at each end. Condensed to its ends (`linear_algebra.condensed`), the line is
a substructure in `points/net.py`. Under the stretch_rate law rope carries no momentum; T belongs to the first segment.
"""

from ..arrays import clear, copy
from ..compilation import kernel, view
from ..equations import assembly, node_loads, rope, segment, winch
from ..equations.boundary import load_during
from ..equations.end_motion import acceleration_at, jerk_at, velocity_at
from ..equations.ground import has_ground
from ..equations.properties import half_density, rest_length
from ..equations.rope import Side, feels_rope
from ..linear_algebra.both_ends import (
    get_interleaved,
    get_node,
    get_vector_of_pairs,
    interleave,
    next_interleaved,
    put_interleaved,
    put_two,
)
from ..linear_algebra.matrices import get_matrix, transposed_apply
from ..linear_algebra.pairs import first, load_pair, number_at, pair, second, select, store_pair, swapped
from ..linear_algebra.vectors import NEUTRAL_VECTOR, ZERO_VECTOR, add, add_at, add_scaled, dot, get, put, scale, sub
from . import contact, rosenbrock
from .rodas4p import GAMMA_I, OF_SPEEDS, OF_START, STAGES
from .strand_room import (
    BY_GAIN,
    BY_LENGTH,
    BY_RATE,
    CORNER,
    GAIN,
    HELD_GAIN,
    HOLDERS,
    INERTIA,
    LEFT,
    OF_TIME,
    PULL,
    RATE,
    REST,
    rope_in,
)

# --- weights


@view
def sides_at(n, s, weights):
    """`Side`s of segments s and n - 1 - s, as pairs: first for the line end in the same half, then for the other end."""
    both, p, q, mirrored_p, mirrored_q = (s, n - 1 - s), s, s + 1, n - s, n - s - 1
    w, v = weights.first, weights.last
    own = Side(
        pair(weights.growth_first[s], weights.growth_last[both[1]]), pair(w[p], -v[mirrored_p]), pair(w[q], -v[mirrored_q])
    )
    shares = pair(weights.growth_last[s], weights.growth_first[both[1]])
    return own, Side(shares, pair(v[p], -w[mirrored_p]), pair(v[q], -w[mirrored_q]))


@kernel
def is_held(strand, end):
    """Whether rope coordinates act at an end."""
    return strand.numbers[HOLDERS + end] > 0.0


@view
def curve_of(conditions, end):
    """Curve of a driven end."""
    return conditions.kite if end == 1 else conditions.ground


@kernel
def is_driven(conditions, end):
    """Whether an end is driven."""
    return conditions.last == conditions.n - 1 if end == 1 else conditions.first == 1


# --- residual: node forces, and R of both ends


@kernel
def residual(strand, chain, time):
    """Forces at a stage at a time [s] into w.force, R of both ends into the numbers (all modified); stage_z is known."""
    w = strand.w
    take_pulls(strand, chain)
    if feels_rope(chain.parameters):
        if has_ground(chain.parameters):
            contact.add_forces(chain, w)
            add_friction(strand, chain)
        load = pair(NEUTRAL_VECTOR, load_during(strand.conditions, time))
        put_interleaved(w.force, 0, add(get_interleaved(w.force, 0), load))
    else:
        rosenbrock.stage_force(strand.conditions, chain, time, w)


@kernel
def add_friction(strand, chain):
    """Add the pull of friction on the ground to R of both ends at a stage (modified)."""
    strand.numbers[PULL] += contact.pull_of_friction(chain, strand.weights.first, strand.w)
    strand.numbers[PULL + 1] += contact.pull_of_friction(chain, strand.weights.last, strand.w)


@kernel
def take_pulls(strand, chain):
    """R of both ends (modified); under the strain_rate law also forces without ground and load into w.force (modified)."""
    w = strand.w
    if feels_rope(chain.parameters):
        assembly.find_segments(chain.n, w.stage_x, False, w.segments)
        sum_forces(strand, chain)
    else:
        strand.numbers[PULL] = first_tension(chain, w.modes[0], w.stage_x, w.stage_v)


@kernel
def first_tension(chain, mode, x, v):
    """Tension of the first segment [N] from interleaved positions [m] and velocities [m/s]."""
    n = chain.n
    length, e = segment.geometry(sub(get_node(n, 1, x), get_node(n, 0, x)))
    return segment.tension_of(chain, 0, mode, length, dot(e, sub(get_node(n, 1, v), get_node(n, 0, v))))


@kernel
def sum_forces(strand, chain):
    """Loop of `take_pulls` from both ends inwards; in each half p is the outer node of a segment and `own` the line end."""
    n, w, numbers, weights = chain.n, strand.w, strand.numbers, strand.weights
    from_outside = pair(ZERO_VECTOR, ZERO_VECTOR)
    x_p, v_p, z_p = get_interleaved(w.stage_x, 0), get_interleaved(w.stage_v, 0), get_interleaved(strand.stage_z, 0)
    rate, gain, own_height = load_pair(numbers, RATE), load_pair(numbers, GAIN), x_p[2]
    rates, gains, other_height = (rate, swapped(rate)), (gain, swapped(gain)), swapped(own_height)
    of_own = of_other = resisted = at_own = at_other = pair(0.0, 0.0)
    outside = pair(1.0, 1.0)
    for s in range((n + 1) // 2):
        x_q, v_q = next_interleaved(n, s, w.stage_x), next_interleaved(n, s, w.stage_v)
        z_q, both = next_interleaved(n, s, strand.stage_z), (s, n - 1 - s)
        length, e = assembly.found_segment(w.segments, s)
        r, u, mode = sub(x_q, x_p), sub(v_q, v_p), number_at(w.modes, 0, both)
        piece = rope.piece_of(chain, both, select(mode * mode, mode, length - rest_length(chain, both)))
        tension = segment.tension(chain, both, length, dot(e, u), piece.rest, piece.k, piece.c)
        drag, pull = segment.half_drag_between(chain, both, length, e, x_p, x_q, v_p, v_q), scale(tension, e)
        own, other = sides_at(n, s, weights)
        flow = rope.flow_past(own, other, rates, gains)
        of_p, of_q = rope.forces(piece, flow, r, u)
        height = segment.mean_height(x_p, x_q)
        a, b = rope.pulls(piece, flow, own, other, r, u, (height - own_height, height - other_height), z_p, z_q)
        inside = rope.straightness(piece, dot(r, r))
        resisted = rope.resistance(piece, flow.c_p, outside, inside) * flow.c_p
        of_own, of_other, outside = of_own - own.at_p * resisted, of_other - other.at_p * resisted, inside
        resisted = rope.resistance(piece, flow.c_q, inside, swapped(inside)) * flow.c_q
        at_own, at_other = own.at_q * resisted, other.at_q * resisted
        count = 0.5 if 2 * s + 1 == n else 1.0  # the loop visits a middle segment twice
        of_own, of_other = of_own + count * a, of_other + count * b
        load = node_loads.load(chain, number_at(w.stage_mass, 0, (s, n - s)), x_p, v_p, None)
        put_interleaved(w.force, s, add(add(from_outside, load), add(add(drag, pull), of_p)))
        from_outside = add(sub(drag, pull), of_q)
        x_p, v_p, z_p = x_q, v_q, z_q
    if n % 2 == 0:
        of_own, of_other = of_own - pair(first(at_own), 0.0), of_other - pair(first(at_other), 0.0)
        load = node_loads.load(chain, w.stage_mass[n // 2], first(x_p), first(v_p), None)
        total = add(add(first(from_outside), second(from_outside)), load)
        put_interleaved(w.force, n // 2, pair(total, total))
    half = half_density(chain, (0, n - 1))
    store_pair(numbers, PULL, of_own + swapped(of_other) + half * rate * rate)


# --- start of a step


@kernel
def begin(strand, chain, time, x, v):
    """Argument and forces of stage 0 at a time [s], records, masses, modes, and slopes by gains (modified)."""
    conditions, w, n = strand.conditions, strand.w, strand.n
    interleave(n, x, w.start_x)
    interleave(n, v, w.start_v)
    rosenbrock.combine(0, 1.0, w)
    rosenbrock.prescribe_ends(conditions, time, w)
    assembly.node_masses(chain, w.mass)
    copy(w.mass, w.stage_mass)
    assembly.find_slopes(chain, w.start_x, w.start_v, w.modes, w.segments, w.records)
    if has_ground(chain.parameters):
        contact.find(strand.conditions, chain, x, v, w)
    begin_residual(strand, chain, time)


@kernel
def evaluate(strand, chain, time, x, v):
    """Forces, pulls and slopes by gains at x [m], v [m/s] and a time [s], outside a step (modified)."""
    w, n = strand.w, strand.n
    interleave(n, x, w.stage_x)
    interleave(n, v, w.stage_v)
    assembly.node_masses(chain, w.stage_mass)
    clear(w.modes)
    if has_ground(chain.parameters):
        copy(w.stage_mass, w.mass)
        contact.find(strand.conditions, chain, x, v, w)
    begin_residual(strand, chain, time)


@kernel
def begin_residual(strand, chain, time):
    """Residual with zero acceleration of free nodes and coordinates, and slopes by gains (modified)."""
    clear(strand.stage_z)
    put_end_accelerations(strand.conditions, time, strand.stage_z)
    residual(strand, chain, time)
    take_gain_columns(strand, chain)


@kernel
def put_end_accelerations(conditions, time, z):
    """Write the accelerations of driven ends [m/s2] into an interleaved array (modified)."""
    for end in range(2):
        if is_driven(conditions, end):
            z[end], z[2 + end], z[4 + end] = acceleration_at(curve_of(conditions, end), time)


@kernel
def take_gain_columns(strand, chain):
    """`Rope.by_gain` of both ends and BY_GAIN at the stage (modified)."""
    n, w, numbers, nothing = chain.n, strand.w, strand.numbers, pair(0.0, 0.0)
    a, b = rope_in(n, strand.ropes, 0).by_gain, rope_in(n, strand.ropes, 1).by_gain
    if not feels_rope(chain.parameters):
        clear(a)
        clear(b)
        for i in range(4):
            numbers[BY_GAIN + i] = 0.0
        return
    below_own = below_other = pair(ZERO_VECTOR, ZERO_VECTOR)
    of_own, crossed, of_other = nothing, nothing, nothing
    for s in range((n + 1) // 2):
        r = sub(next_interleaved(n, s, w.stage_x), get_interleaved(w.stage_x, s))
        half, (own, other) = -1.0 * half_density(chain, (s, n - 1 - s)), sides_at(n, s, strand.weights)
        put_of_ends(n, s, add(below_own, scale(half * own.at_p, r)), add(below_other, scale(half * other.at_p, r)), a, b)
        below_own, below_other = scale(half * own.at_q, r), scale(half * other.at_q, r)
        square = (0.5 if 2 * s + 1 == n else 1.0) * (half / rest_length(chain, (s, n - 1 - s)) * dot(r, r))
        of_own = of_own + square * (own.at_p * own.at_p + own.at_q * own.at_q)
        crossed = crossed + square * (own.at_p * other.at_p + own.at_q * other.at_q)
        of_other = of_other + square * (other.at_p * other.at_p + other.at_q * other.at_q)
    if n % 2 == 0:
        put(a, n // 2, add(first(below_own), second(below_other)))
        put(b, n // 2, add(first(below_other), second(below_own)))
    own, between = of_own + swapped(of_other), first(crossed) + second(crossed)
    numbers[BY_GAIN], numbers[BY_GAIN + 1], numbers[BY_GAIN + 2], numbers[BY_GAIN + 3] = (
        first(own),
        between,
        between,
        second(own),
    )


@view
def put_of_ends(n, s, own, other, a, b):
    """Write vectors of nodes s and n - s, for the near and the far end, into the arrays of both ends (modified)."""
    put_two(a, s, n - s, pair(first(own), second(other)))
    put_two(b, s, n - s, pair(first(other), second(own)))


# --- derivatives


@kernel
def form(strand, chain, time, d, x, v):
    """Matrix M/d - B - d K of a step, columns, rows and slopes of R, time derivatives into w.force_rate (all modified)."""
    conditions, w, n, numbers = strand.conditions, strand.w, strand.n, strand.numbers
    assembly.assemble(n, 1.0 / d, 1.0, d, w.mass, w.records, w.matrix)
    if has_ground(chain.parameters):
        contact.subtract_slopes(chain, d, x, v, w)
    clear(w.q)
    clear(w.dampings)
    if feels_rope(chain.parameters):
        flow_into_matrix(strand, chain, d)
    for end in range(2):
        if is_held(strand, end) or (end == 0 and winch.is_reeling(conditions.reeling)):
            linearize_end(strand, chain, end, time, d)
    if winch.is_reeling(conditions.reeling):
        add_rates_of_winch(strand, time, d)
    add_explicit_rates(strand, chain, time)
    interleave(n, w.q, w.force_rate)
    for end in range(2):
        for other in range(2):
            i = 2 * end + other
            numbers[CORNER + i] = d * numbers[BY_LENGTH + i] + numbers[BY_RATE + i] + numbers[BY_GAIN + i] / d


@kernel
def flow_into_matrix(strand, chain, d):
    """Subtract df/dv + d df/dx of flowing rope from w.matrix; df/dv also into w.dampings (both modified)."""
    n, w = chain.n, strand.w
    for s in range(n):
        of_p, of_q, w.dampings[s] = slopes_of_flow(strand, chain, s)
        for j in range(0, 9, 4):
            w.matrix.diagonal[9 * s + j] += w.dampings[s] + d * of_p
            w.matrix.upper[9 * s + j] -= w.dampings[s] + d * of_p
            w.matrix.lower[9 * s + 9 + j] += w.dampings[s] + d * of_q
            w.matrix.diagonal[9 * s + 9 + j] -= w.dampings[s] + d * of_q


@kernel
def slopes_of_flow(strand, chain, s):
    """Slopes of the flow forces in segment s: by r for p and for q [N/m], by u [N s/m]."""
    first, last, numbers = strand.weights.first, strand.weights.last, strand.numbers
    own, other = Side(0.0, first[s], first[s + 1]), Side(0.0, last[s], last[s + 1])
    rates, gains = (numbers[RATE], numbers[RATE + 1]), (numbers[GAIN], numbers[GAIN + 1])
    flow, half = rope.flow_past(own, other, rates, gains), half_density(chain, s)
    along = (flow.c_p * flow.c_p + flow.c_q * flow.c_q) / rest_length(chain, s)
    return -half * (flow.gain_p + along), -half * (flow.gain_q - along), -half * (flow.c_p + flow.c_q)


@view
def two_segments(strand, chain, s):
    """Segments s and n - 1 - s, counted inwards from both ends, at the start of the step, as pairs.

    `Piece`, `Flow`, both `Side`s, dT/dl0, e, r, u, and accelerations of p and q.
    """
    n, w, both, outward = chain.n, strand.w, (s, chain.n - 1 - s), pair(1.0, -1.0)
    rate, gain, record = load_pair(strand.numbers, RATE), load_pair(strand.numbers, GAIN), 2 * segment.RECORD * s
    r = sub(next_interleaved(n, s, w.start_x), get_interleaved(w.start_x, s))
    u = sub(next_interleaved(n, s, w.start_v), get_interleaved(w.start_v, s))
    own, other = sides_at(n, s, strand.weights)
    flow = rope.flow_past(own, other, (rate, swapped(rate)), (gain, swapped(gain)))
    piece = rope.piece_of(chain, both, number_at(w.modes, 0, both))
    e = scale(outward, get_vector_of_pairs(w.records, record + 2 * segment.DIRECTION))
    slope = load_pair(w.records, record + 2 * segment.SLOPE)
    gained = get_interleaved(strand.stage_z, s), next_interleaved(n, s, strand.stage_z)
    return piece, flow, (own, other), slope, e, r, u, gained


@view
def of_end(end, own, other):
    """`Side` of an end in both halves, from the `Side`s of the near and the far end."""
    a, b = (own, other) if end == 0 else (other, own)
    return Side(
        pair(first(a.share), second(b.share)), pair(first(a.at_p), second(b.at_p)), pair(first(a.at_q), second(b.at_q))
    )


@kernel
def loaded(chain, z):
    """Acceleration minus gravity [m/s2], as pairs."""
    return z[0], z[1], z[2] + chain.gravity


@kernel
def linearize_end(strand, chain, end, time, d):
    """Column, row and slopes of R of an end, and its rate from the motion of driven ends, OF_TIME (all modified)."""
    conditions, numbers, own = strand.conditions, strand.numbers, rope_in(strand.n, strand.ropes, end)
    if feels_rope(chain.parameters):
        loop_of_end(strand, chain, end, d, own)
    else:
        loop_of_spring(strand, chain, d, own)
    if has_ground(chain.parameters):
        slopes_of_ground(strand, chain, end, d, own)
    numbers[OF_TIME + end] = 0.0
    for i in range(2):
        if is_driven(conditions, i):
            numbers[OF_TIME + end] += let_go(curve_of(conditions, i), strand.n * i, time, d, own)
    interleave(strand.n, own.by_gain, own.gain_row)
    interleave(strand.n, own.by_velocity, own.velocity_row)
    if strand.n % 2 == 0:
        for j in range(3 * strand.n + 1, 3 * strand.n + 7, 2):  # count the middle node once
            own.gain_row[j] = own.velocity_row[j] = 0.0


@kernel
def slopes_of_ground(strand, chain, end, d, own):
    """Add the slopes of ground forces to column, row and slopes of R of an end (modified)."""
    w, by_end, growths = strand.w, strand.weights, (strand.weights.growth_first, strand.weights.growth_last)
    weights = by_end.last if end == 1 else by_end.first
    contact.add_to_column(chain, d, weights, growths[1] if end == 1 else growths[0], w, own)
    if feels_rope(chain.parameters):
        contact.add_to_row(chain, d, weights, w, own)
        for f in range(2):
            others = by_end.last if f == 1 else by_end.first
            by_length, by_rate = contact.corner(chain, weights, others, growths[1] if f == 1 else growths[0], w)
            strand.numbers[BY_LENGTH + 2 * end + f] += by_length
            strand.numbers[BY_RATE + 2 * end + f] += by_rate


@kernel
def loop_of_end(strand, chain, end, d, own):
    """Loop of `linearize_end` over pairs of segments: row, column and slopes of R by lengths and rates (all modified)."""
    n, numbers, other_end, nothing = chain.n, strand.numbers, 1 - end, pair(0.0, 0.0)
    by_own, by_other, of_own, of_other, heights = nothing, nothing, nothing, nothing, nothing
    length_p = rate_p = x_row = v_row = pair(ZERO_VECTOR, ZERO_VECTOR)
    outside, at_own, at_other = pair(1.0, 1.0), nothing, nothing
    for s in range((n + 1) // 2):
        piece, flow, (near, far), slope, e, r, u, (z_p, z_q) = two_segments(strand, chain, s)
        side, other = of_end(end, near, far), of_end(other_end, near, far)
        loads = loaded(chain, z_p), loaded(chain, z_q)
        (p_l, q_l), (p_r, q_r), _ = rope.column(piece, flow, slope, e, r, u, side, loads)
        by_r, by_u, of_rest = rope.row(piece, flow, side, r, u, z_p, z_q)
        count = 0.5 if 2 * s + 1 == n else 1.0
        below = -1.0 * (side.share * piece.half * piece.gravity)
        weight, heights = (nothing, nothing, below), heights - 2.0 * count * below
        x_row, v_row, rate_p, length_p = (
            add(sub(x_row, by_r), weight),
            sub(v_row, by_u),
            add(rate_p, p_r),
            add(length_p, p_l),
        )
        put_two(own.by_rate, s, n - s, rate_p)
        put_two(own.solved, s, n - s, add_scaled(rate_p, d, length_p))
        put_two(own.row, s, n - s, add_scaled(v_row, d, x_row))
        put_two(own.by_velocity, s, n - s, v_row)
        length_p, rate_p, x_row, v_row = q_l, q_r, add(by_r, weight), by_u
        by_own, by_other = by_own + count * (of_rest * side.share), by_other + count * (of_rest * other.share)
        of_own = of_own + count * rope.corner(piece, flow, side, side, r, u)
        of_other = of_other + count * rope.corner(piece, flow, side, other, r, u)
        inside = rope.straightness(piece, dot(r, r))
        resisted = 2.0 * side.at_p * rope.resistance(piece, flow.c_p, outside, inside)
        of_own, of_other, outside = of_own - side.at_p * resisted, of_other - other.at_p * resisted, inside
        resisted = 2.0 * side.at_q * rope.resistance(piece, flow.c_q, inside, swapped(inside))
        at_own, at_other = side.at_q * resisted, other.at_q * resisted
    if n % 2 == 0:
        of_own, of_other = of_own - pair(first(at_own), 0.0), of_other - pair(first(at_other), 0.0)
        m = n // 2
        rate, velocity = add(first(rate_p), second(rate_p)), add(first(v_row), second(v_row))
        put(own.by_rate, m, rate)
        put(own.solved, m, add_scaled(rate, d, add(first(length_p), second(length_p))))
        put(own.row, m, add_scaled(velocity, d, add(first(x_row), second(x_row))))
        put(own.by_velocity, m, velocity)
    own.row[3 * n * end + 2] += d * (first(heights) + second(heights))
    for i in range(len(own.row)):
        own.row[i] += own.by_gain[i] / d
        own.solved[i] += own.by_gain[i] / d
    density = 2.0 * half_density(chain, (n - 1) * end)
    numbers[BY_LENGTH + 3 * end], numbers[BY_LENGTH + 1 + end] = (
        first(by_own) + second(by_own),
        first(by_other) + second(by_other),
    )
    numbers[BY_RATE + 3 * end] = first(of_own) + second(of_own) + density * numbers[RATE + end]
    numbers[BY_RATE + 1 + end] = first(of_other) + second(of_other)


@kernel
def loop_of_spring(strand, chain, d, own):
    """Like `loop_of_end` under the stretch_rate law: only the first segment pulls, and dampers ignore reeling."""
    n, w, numbers = chain.n, strand.w, strand.numbers
    clear(own.by_rate)
    clear(own.solved)
    clear(own.row)
    clear(own.by_velocity)
    for s in range(n):
        record, share = assembly.record_of(s, n, w.records), strand.weights.growth_first[s]
        pull, mass = scale(record[segment.SLOPE] * share, segment.direction_in(record)), -half_density(chain, s) * share
        for i in range(2):
            load = loaded(chain, get_node(n, s + i, strand.stage_z))
            add_at(own.solved, s + i, scale(d, add_scaled(scale(1.0 - 2.0 * i, pull), mass, load)))
    record = assembly.record_of(0, n, w.records)
    e = segment.direction_in(record)
    by_velocity = scale(record[segment.DAMPER], e)
    along = add_scaled(by_velocity, d, transposed_apply(e, get_matrix(record, segment.K)))
    put(own.by_velocity, 0, scale(-1.0, by_velocity))
    put(own.by_velocity, 1, by_velocity)
    put(own.row, 0, scale(-1.0, along))
    put(own.row, 1, along)
    for i in range(4):
        numbers[BY_LENGTH + i] = numbers[BY_RATE + i] = 0.0
    numbers[BY_LENGTH] = record[segment.SLOPE] * strand.weights.growth_first[0]


@kernel
def let_go(curve, i, time, d, own):
    """Remove a driven node from column and row (modified) and return the rate of R from its motion [N/s]."""
    velocity, by_gain = get(own.by_velocity, i), get(own.by_gain, i)
    by_position = scale(1.0 / d, sub(sub(get(own.row, i), velocity), scale(1.0 / d, by_gain)))
    rate = dot(by_position, velocity_at(curve, time)) + dot(velocity, acceleration_at(curve, time))
    rate += dot(by_gain, jerk_at(curve, time))
    put(own.solved, i, ZERO_VECTOR)
    put(own.row, i, ZERO_VECTOR)
    put(own.by_velocity, i, ZERO_VECTOR)
    put(own.by_gain, i, ZERO_VECTOR)
    return rate


@kernel
def add_rates_of_winch(strand, time, d):
    """Add the rates of forces and of R [N/s] from time-dependent reeling to w.q and OF_TIME (modified)."""
    reeling, n, w, numbers = strand.conditions.reeling, strand.n, strand.w, strand.numbers
    speed, gain, jerk = winch.rate_at(reeling, time), winch.acceleration_at(reeling, time), winch.jerk_at(reeling, time)
    own = rope_in(n, strand.ropes, 0)
    for i in range(len(w.q)):
        by_length = (own.solved[i] - own.by_rate[i] - own.by_gain[i] / d) / d
        w.q[i] += speed * by_length + gain * own.by_rate[i] + jerk * own.by_gain[i]
    for end in range(2):
        by_winch = numbers[BY_LENGTH + 2 * end] * speed + numbers[BY_RATE + 2 * end] * gain
        numbers[OF_TIME + end] += by_winch + numbers[BY_GAIN + 2 * end] * jerk


@kernel
def add_explicit_rates(strand, chain, time):
    """Add the rates of the forces [N/s] from the load and the motion of driven ends to w.q (modified)."""
    conditions, n, w = strand.conditions, strand.n, strand.w
    put(w.q, n, add(get(w.q, n), conditions.load_rate))
    for end in range(2):
        if is_driven(conditions, end):
            dx, dv = velocity_at(curve_of(conditions, end), time), acceleration_at(curve_of(conditions, end), time)
            assembly.add_end_motion(n, end == 1, dx, dv, w.records, w.q)
            if feels_rope(chain.parameters):
                s, sign = (n - 1) * end, 2.0 * end - 1.0
                of_p, of_q, damping = slopes_of_flow(strand, chain, s)
                both = scale(sign * damping, dv)
                add_at(w.q, s, add_scaled(both, sign * of_p, dx))
                add_at(w.q, s + 1, add_scaled(both, sign * of_q, dx))


# --- stages


@kernel
def go_to_stage(strand, chain, stage, time, h):
    """Argument of a stage at a time [s], with accelerations and masses (modified)."""
    w = strand.w
    rosenbrock.combine(stage, h, w)
    rosenbrock.prescribe_ends(strand.conditions, time, w)
    add_up_accelerations(strand, stage, h, len(w.r) // 6)
    put_end_accelerations(strand.conditions, time, strand.stage_z)
    assembly.node_masses(chain, w.stage_mass)


@kernel
def add_up_accelerations(strand, stage, h, count):
    """z_i = OF_START z_0 + sum OF_SPEEDS V_j/h into stage_z (modified), for `count` nodes from each end inwards."""
    w, of_start = strand.w, OF_START[stage]
    for i in range(count):
        z = scale(of_start, get_interleaved(strand.z, i))
        for j in range(stage):
            z = add_scaled(z, OF_SPEEDS[stage, j] / h, get_interleaved(w.velocities, STAGES * i + j))
        put_interleaved(strand.stage_z, i, z)


@view
def known_of(strand, stage, h, i):
    """F + (m_0 - m) z + m_0 inertia/h + gamma_i h dF/dt of nodes i and n - i [N]."""
    w, both = strand.w, (i, strand.n - i)
    mass = number_at(w.mass, 0, both)
    total = add_scaled(
        get_interleaved(w.force, i), mass - number_at(w.stage_mass, 0, both), get_interleaved(strand.stage_z, i)
    )
    total = add_scaled(total, GAMMA_I[stage] * h, get_interleaved(w.force_rate, i))
    return add_scaled(total, 1.0 / h * mass, get_interleaved(w.inertia_velocity, i))


@kernel
def right_hand_side(strand, stage, h):
    """-r + r_z (z + inertia/h) + r_v rest - gamma_i h r_t, for nodes into w.q and for ends into LEFT (modified)."""
    n, w = strand.n, strand.w
    from_outside, outward = pair(ZERO_VECTOR, ZERO_VECTOR), pair(1.0, -1.0)
    r_p = get_interleaved(w.r, 0)
    for s in range((n + 1) // 2):
        r_q = next_interleaved(n, s, w.r)
        axial, drag = assembly.damping_product(s, -1.0, r_p, r_q, w.records)
        drag = add_scaled(drag, -1.0 * (outward * number_at(w.dampings, 0, (s, n - 1 - s))), sub(r_q, r_p))
        put_two(w.q, s, n - s, add(known_of(strand, stage, h, s), add(from_outside, add(drag, axial))))
        from_outside = sub(drag, axial)
        r_p = r_q
    if n % 2 == 0:
        rest = first(known_of(strand, stage, h, n // 2))
        put(w.q, n // 2, add(rest, add(first(from_outside), second(from_outside))))
    if has_ground(strand.conditions.parameters):
        contact.subtract_damping(n, w)
    for end in range(2):
        if is_held(strand, end):
            subtract_known(strand, end, h)
            right_of_end(strand, end, stage, h)


@kernel
def subtract_known(strand, end, h):
    """Subtract the known part of M and B for rope that enters over an end from w.q (modified)."""
    own, numbers, q = rope_in(strand.n, strand.ropes, end), strand.numbers, strand.w.q
    gained, rest = numbers[HELD_GAIN + end] + numbers[INERTIA + end] / h, numbers[REST + end]
    for i in range(0, len(q) - 1, 2):
        known = gained * load_pair(own.by_gain, i) + rest * load_pair(own.by_rate, i)
        store_pair(q, i, load_pair(q, i) - known)
    if len(q) % 2 == 1:
        q[len(q) - 1] -= gained * own.by_gain[len(q) - 1] + rest * own.by_rate[len(q) - 1]


@kernel
def right_of_end(strand, end, stage, h):
    """LEFT of an end with coordinates: the known part of R + dR over dT/dR (modified)."""
    own, numbers, w = rope_in(strand.n, strand.ropes, end), strand.numbers, strand.w
    total, other = pair(0.0, 0.0), pair(0.0, 0.0)
    for i in range(0, len(w.r), 2):
        known = load_pair(strand.stage_z, i) + 1.0 / h * load_pair(w.inertia_velocity, i)
        total = total + load_pair(own.gain_row, i) * known
        other = other + load_pair(own.velocity_row, i) * load_pair(w.r, i)
    total = total + other
    left = GAMMA_I[stage] * h * numbers[OF_TIME + end] - first(total) - second(total)
    for f in range(2):
        gained = numbers[HELD_GAIN + f] + numbers[INERTIA + f] / h
        left -= numbers[BY_GAIN + 2 * end + f] * gained + numbers[BY_RATE + 2 * end + f] * numbers[REST + f]
    numbers[LEFT + end] = left
