"""Momentum of the rope that flows past the nodes while the winch reels.

Nodes keep their shares of the section at the winch, so they are not material points there: rope flows past node i at the
rate c_i = L' (1 - sum of the shares before it), L' at the winch and 0 from the end of the section on, where rope does not
change: at the last node of a uniform line. Each half segment of mass
mu l0/2, with the vector r between its nodes, moves with V = v_i + c_i r/l0. New rope enters from the winch with the velocity
of the first node. Lagrange's equations of sum 1/2 (mu l0/2) |V|^2 add these forces to the lumped-mass equations,

    f_p = -1/2 mu (c_p' r + (c_p + c_q) u + (c_p^2 + c_q^2) r/l0)
    f_q = -1/2 mu (c_q' r + (c_p + c_q) u - (c_p^2 + c_q^2) r/l0)

for each segment, on its nodes p (nearer to the winch) and q, with u = r'. They vanish without reeling and under the
stretch_rate law, which has the momentum of Tethers.jl. They are linear in r and u: f = a r + b u.

If a line runs over a sheave at its last node, rope leaves it there at the rate b, and c_i = L' (1 - shares) + b: rope enters
at the first node faster than L'. Theory: docs/models/theory.md, "Rope that flows".
"""

from tetherfmu.runtime import layout as at

from ..compilation import PARTS, kernel
from ..linear_algebra.both_ends import add_to_node, get_interleaved, get_two, lower_and_upper, put_interleaved, put_two
from ..linear_algebra.pairs import broadcast, first, number_at, pair, second, select
from ..linear_algebra.vectors import NEUTRAL_VECTOR, ZERO_VECTOR, add, add_scaled, dot, get, norm, put, scale, sub
from .properties import growth_at, property_of, rest_length


@kernel
def flows(chain):
    """Whether rope flows past the nodes, or begins to."""
    return chain.flows


@kernel
def part_at(chain, i):
    """c_i/L' [-] of node i with rope from the winch: all segments of its section grow alike, none beyond it."""
    return max(1.0 - i * property_of(chain, 0, at.SHARE), 0.0)


@kernel
def passing_at(chain, i):
    """c_i [m/s] of an inner node, 0 at the ends, where rope leaves the ground."""
    if not 0 < i < chain.n or (chain.reeling == 0.0 and chain.leaving == 0.0):
        return 0.0
    if PARTS and chain.is_parted:
        ends, begins = chain.parameters[at.FIRST_ENDS], chain.parameters[at.SECOND_BEGINS]
        if i < ends:
            return (1.0 - i / ends) * (chain.reeling + chain.leaving)
        return (i - begins) / (chain.n - begins) * chain.leaving if i > begins else 0.0
    return part_at(chain, i) * chain.reeling + chain.leaving


@kernel
def per_node(chain, i):
    """1/(l0 of the segment before inner node i + l0 of the one after it) [1/m]."""
    return 1.0 / (rest_length(chain, i - 1) + rest_length(chain, i))


@kernel
def along_ground(chain, i, below, above):
    """Horizontal part of r/l0 [-] around inner node i, from the nodes before and after it [m]."""
    per = per_node(chain, i)
    return per * (above[0] - below[0]), per * (above[1] - below[1]), 0.0


@kernel
def slide(chain, i, c, x):
    """Horizontal velocity [m/s] of the rope relative to node i, which it passes at c [m/s]; x : flat positions [m]."""
    return scale(c, along_ground(chain, i, get(x, i - 1), get(x, i + 1))) if c != 0.0 else ZERO_VECTOR


@kernel
def velocity_of_rope(chain, i, x, v):
    """Velocity (u_x, u_y, v_z) [m/s] with which the rope at node i meets the ground; x, v : flat positions, velocities."""
    return add(get(v, i), slide(chain, i, passing_at(chain, i), x))


@kernel
def first_passing(chain):
    """c/L' of the first node [-] without rope that leaves: 0 if a portion that broke has no first part."""
    return chain.parameters[at.FIRST_PASSING] if PARTS and chain.is_parted else 1.0


@kernel
def passing(chain, share, part):
    """c [m/s] of a node and its rate [m/s2]; share : of the segment beside it.

    part : c/L' [-] without rope that leaves; in a portion that broke, of the rate at the end of the same part.
    """
    if PARTS and chain.is_parted:
        into, leaving = broadcast((chain.reeling + chain.leaving, chain.leaving), share)
        gain, leaving_gain = broadcast((chain.acceleration + chain.leaving_gain, chain.leaving_gain), share)
        return part * select(share, into, leaving), part * select(share, gain, leaving_gain)
    return part * chain.reeling + chain.leaving, part * chain.acceleration + chain.leaving_gain


@kernel
def slopes(chain, s, part):
    """a of node p, a of node q [N/m] and b [N s/m] of segment s; part : see `passing`."""
    half, share = 0.5 * property_of(chain, s, at.LINE_DENSITY), property_of(chain, s, at.SHARE)
    (c_p, gain_p), (c_q, gain_q) = passing(chain, share, part), passing(chain, share, part - share)
    return slopes_with(half, rest_length(chain, s), (c_p, c_q), (gain_p, gain_q))


@kernel
def slopes_with(half, rest, c, gained):
    """`slopes` of a segment with mu/2 [kg/m], l0 [m], c_p and c_q [m/s], and their rates [m/s2]."""
    along = (c[0] * c[0] + c[1] * c[1]) / rest
    return -half * (gained[0] + along), -half * (gained[1] - along), -half * (c[0] + c[1])


@kernel
def slope_rates(chain, s, part, acceleration, jerk):
    """Rates of `slopes` per second; acceleration, jerk : L'' [m/s2], L''' [m/s3]."""
    half, share = 0.5 * property_of(chain, s, at.LINE_DENSITY), property_of(chain, s, at.SHARE)
    next_part, rest = part - share, rest_length(chain, s)
    square = part * part + next_part * next_part
    rate = 2.0 * chain.reeling * acceleration - chain.reeling * chain.reeling * chain.growth
    return (
        -half * (part * jerk + square * rate / rest),
        -half * (next_part * jerk - square * rate / rest),
        -half * (part + next_part) * acceleration,
    )


@kernel
def forces(chain, s, part, x_p, x_q, v_p, v_q):
    """f_p and f_q [N] of segment s between these nodes [m, m/s]; part : c_p/L' [-]."""
    return forces_of(slopes(chain, s, part), sub(x_q, x_p), sub(v_q, v_p))


@kernel
def forces_of(found, r, u):
    """f_p and f_q [N] from `slopes`, with r [m] and u [m/s]."""
    of_p, of_q, by_rate = found
    along = scale(by_rate, u)
    return add_scaled(along, of_p, r), add_scaled(along, of_q, r)


@kernel
def last_passing(chain):
    """`passing` of the last node but one."""
    share = property_of(chain, chain.n - 1, at.SHARE)
    return 1.0 + share if PARTS and share < 0.0 else share


@kernel
def end_force(chain, kite_end, x_p, x_q, v_p, v_q):
    """Contribution of flowing rope to the force on the support of an end [N], from the nodes of its segment [m, m/s].

    At the winch -1/2 mu (c_0' r + (c_0 + c_1) (u - r l0'/l0)): the total is then the force of the rope where it leaves the
    winch, after it has gained its speed. At the kite f_n.
    """
    if not kite_end:
        _, _, by_rate = slopes(chain, 0, first_passing(chain))
        half = 0.5 * property_of(chain, 0, at.LINE_DENSITY)
        r = sub(x_q, x_p)
        gain = chain.acceleration + chain.leaving_gain
        return add_scaled(scale(-half * gain - by_rate * chain.growth, r), by_rate, sub(v_q, v_p))
    s = chain.n - 1
    _, of_kite = forces(chain, s, last_passing(chain), x_p, x_q, v_p, v_q)
    return of_kite


@kernel
def energy(chain, s, part, x_p, x_q, v_p, v_q):
    """Kinetic energy [J] of segment s beyond 1/2 (mu l0/2) |v|^2 of its nodes: mu/2 (c v . r + c^2 l^2/(2 l0)) of both."""
    share = property_of(chain, s, at.SHARE)
    (c_p, _), (c_q, _) = passing(chain, share, part), passing(chain, share, part - share)
    r, rest = sub(x_q, x_p), rest_length(chain, s)
    along = c_p * dot(v_p, r) + c_q * dot(v_q, r) + 0.5 * (c_p * c_p + c_q * c_q) / rest * dot(r, r)
    return 0.5 * property_of(chain, s, at.LINE_DENSITY) * along


@kernel
def add_forces(chain, x, v, parts, force):
    """Add the forces on all nodes [N] to `force` (modified); x, v : positions [m], velocities [m/s]; all interleaved.

    Two segments at a time, as in `assembly.node_forces`.  parts (modified) : n + 1 numbers, c_i/L'.
    """
    n, last = chain.n, no_forces()
    parts[0] = first_passing(chain)
    for s in range(n):
        parts[s + 1] = parts[s] - property_of(chain, s, at.SHARE)
    for s in range((n + 1) // 2):
        both = (s, n - 1 - s)
        (x_p, x_q), (v_p, v_q) = lower_and_upper(n, s, x), lower_and_upper(n, s, v)
        now = forces(chain, both, number_at(parts, 0, both), x_p, x_q, v_p, v_q)
        add_to_two(s, last, now, force)
        last = now
    if n % 2 == 0:
        add_to_middle(n, last, force)


@kernel
def no_forces():
    """`forces` of two nonexistent segments beyond the ends."""
    nothing = pair(NEUTRAL_VECTOR, NEUTRAL_VECTOR)
    return nothing, nothing


@kernel
def add_to_two(s, last, now, force):
    """Add `forces` of the adjacent outer and inner segments to node s and its mirror image (interleaved, modified)."""
    below, above = pair(first(last[1]), second(now[1])), pair(first(now[0]), second(last[0]))
    put_interleaved(force, s, add(add(get_interleaved(force, s), below), above))


@kernel
def add_to_middle(n, last, force):
    """`add_to_two` for the middle node of an even n."""
    add_to_node(n, n // 2, first(last[1]), force)
    add_to_node(n, n // 2, second(last[0]), force)


@kernel
def most_power(chain, x, v):
    """Upper bound of the power [W] of these forces, with the nodes at x [m], v [m/s]."""
    power, part = 0.0, first_passing(chain)
    for s in range(chain.n):
        of_p, of_q = forces(chain, s, part, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1))
        power += norm(of_p) * norm(get(v, s)) + norm(of_q) * norm(get(v, s + 1))
        part -= property_of(chain, s, at.SHARE)
    return power


@kernel
def power(chain, x, v, a, are_free, counted):
    """Power [W] that accelerates flowing rope: power of these forces, and the rate of `energy_of_flow`.

    x, v, a : positions [m], velocities [m/s] and accelerations [m/s2] of the nodes.  are_free : for each end, 1 or 0.
    counted : as for `energy_of_flow`.
    """
    start, end = are_free
    total, part = 0.0, first_passing(chain)
    for s in range(chain.n):
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        free_p, free_q = start if s == 0 else 1.0, end if s == chain.n - 1 else 1.0
        of_p, of_q = forces(chain, s, part, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1))
        total += free_p * dot(of_p, get(v, s)) + free_q * dot(of_q, get(v, s + 1))
        share, rest, square, growth = property_of(chain, s, at.SHARE), rest_length(chain, s), dot(r, r), growth_at(chain, s)
        next_part = part - share
        for is_q in range(2):
            here, node = (next_part, s + 1) if is_q == 1 else (part, s)
            with_velocity = 1.0
            if node == 0 or node == chain.n:
                with_velocity = counted[0] if node == 0 else counted[1]
            c, gain = passing(chain, share, here)
            crossed = gain * dot(get(v, node), r) + c * (dot(get(a, node), r) + dot(get(v, node), u))
            of_square = c * gain * square + 0.5 * c * c * (2.0 * dot(r, u) - square * growth)
            total += 0.5 * property_of(chain, s, at.LINE_DENSITY) * (with_velocity * crossed + of_square / rest)
        part = next_part
    return total


@kernel
def energy_of_flow(chain, x, v, counted):
    """Sum of `energy` over all segments [J]; counted : for each end, 1 or 0: whether its velocity counts."""
    total, part = 0.0, first_passing(chain)
    for s in range(chain.n):
        v_p = scale(counted[0] if s == 0 else 1.0, get(v, s))
        v_q = scale(counted[1] if s == chain.n - 1 else 1.0, get(v, s + 1))
        total += energy(chain, s, part, get(x, s), get(x, s + 1), v_p, v_q)
        part -= property_of(chain, s, at.SHARE)
    return total


@kernel
def add_rates(chain, acceleration, jerk, x, v, force_rate):
    """Add df/dt [N/s] at constant x [m], v [m/s] to `force_rate` (modified), all flat; others as for `slope_rates`."""
    part = first_passing(chain)
    for s in range(chain.n):
        of_p, of_q, by_rate = slope_rates(chain, s, part, acceleration, jerk)
        r, along = sub(get(x, s + 1), get(x, s)), scale(by_rate, sub(get(v, s + 1), get(v, s)))
        put(force_rate, s, add(get(force_rate, s), add_scaled(along, of_p, r)))
        put(force_rate, s + 1, add(get(force_rate, s + 1), add_scaled(along, of_q, r)))
        part -= property_of(chain, s, at.SHARE)


@kernel
def add_change(chain, s, part, dr, du, force):
    """Add to `force` (flat, modified) the change of the forces [N] due to changes of r [m] and u [m/s] of segment s."""
    of_p, of_q, by_rate = slopes(chain, s, part)
    along = scale(by_rate, du)
    put(force, s, add(get(force, s), add_scaled(along, of_p, dr)))
    put(force, s + 1, add(get(force, s + 1), add_scaled(along, of_q, dr)))


@kernel
def add_end_motion(chain, kite_end, dx, dv, force):
    """Add to `force` (modified, flat) the change of the forces [N] when one end moves by dx [m] and dv [m/s]."""
    if kite_end:
        s = chain.n - 1
        add_change(chain, s, last_passing(chain), dx, dv, force)
    else:
        add_change(chain, 0, first_passing(chain), scale(-1.0, dx), scale(-1.0, dv), force)


@kernel
def put_dampings(chain, dampings):
    """b [N s/m] of all segments into an array (modified)."""
    part = first_passing(chain)
    for s in range(chain.n):
        _, _, dampings[s] = slopes(chain, s, part)
        part -= property_of(chain, s, at.SHARE)


@kernel
def subtract_damping(n, dampings, velocity, force):
    """Subtract df/dv velocity [N] from `force` (modified, flat); velocity : interleaved [m/s].  dampings : of segments."""
    change = pair(NEUTRAL_VECTOR, NEUTRAL_VECTOR)
    for s in range((n + 1) // 2):
        at_p, at_q = lower_and_upper(n, s, velocity)
        last, change = change, scale(-1.0 * number_at(dampings, 0, (s, n - 1 - s)), sub(at_q, at_p))
        below, above = pair(first(last), second(change)), pair(first(change), second(last))
        put_two(force, s, n - s, add(add(get_two(force, s, n - s), below), above))
    if n % 2 == 0:
        put(force, n // 2, add(add(get(force, n // 2), first(change)), second(change)))


@kernel
def subtract_slopes(chain, damping_factor, stiffness_factor, matrix):
    """Subtract damping_factor df/dv + stiffness_factor df/dx from a `block_tridiagonal.Matrix` (modified)."""
    diagonal, lower, upper = matrix
    part = first_passing(chain)
    for s in range(chain.n):
        of_p, of_q, by_rate = slopes(chain, s, part)
        of_p = damping_factor * by_rate + stiffness_factor * of_p
        of_q = damping_factor * by_rate + stiffness_factor * of_q
        for j in range(3):
            diagonal[9 * s + 4 * j] += of_p
            upper[9 * s + 4 * j] -= of_p
            lower[9 * s + 9 + 4 * j] += of_q
            diagonal[9 * s + 9 + 4 * j] -= of_q
        part -= property_of(chain, s, at.SHARE)
