"""Ground contact in a Rosenbrock step: nodes in contact, their forces and derivatives, and the transition error.

All stages treat the nodes that touch the ground at the start of the step as in contact, and no others, so the step sees
smooth equations. A step in which a node goes too far beyond the transition is rejected (`transition_error`), as for a
segment that goes slack (`taut_slack.py`). The law: `equations/ground.py`. Friction F acts on the rope, which passes a node
at c t, t = r/l0 (`flow.along_ground`): it also pulls on the rope coordinates of the ends, with W t . F (`pull_of_friction`).
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import flow
from ..equations import ground as earth
from ..equations.end_motion import velocity_at
from ..equations.properties import growing_mass, half_density, property_of
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.matrices import apply, get_matrix, put_matrix, scale_matrix, transposed_apply
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_at, add_scaled, dot, get, put, scale, sub
from .taut_slack import TRANSITION


@kernel
def direction(chain, i, x):
    """t [-] of inner node i from interleaved positions [m]."""
    return flow.along_ground(chain, i, get_node(chain.n, i - 1, x), get_node(chain.n, i + 1, x))


@kernel
def state_at(chain, i, x, v):
    """Position [m] of node i and the velocity (u_x, u_y, v_z) of its rope [m/s], from interleaved arrays."""
    u, c = get_node(chain.n, i, v), flow.passing_at(chain, i)
    if c != 0.0:
        u = add_scaled(u, c, direction(chain, i, x))
    return get_node(chain.n, i, x), u


@kernel
def find(conditions, chain, x, v, w):
    """Free nodes in ground contact at x [m] with velocities v [m/s] into w.touching, and m da/dv into w.grip.

    Both are modified.
    """
    ground = earth.ground_of(chain.parameters)
    for i in range(chain.n + 1):
        w.touching[i] = 0.0
        if conditions.first <= i <= conditions.last and earth.touches(ground, get(x, i), get(v, i)):
            w.touching[i] = 1.0
            _, by_velocity = earth.derivatives(ground, get(x, i), flow.velocity_of_rope(chain, i, x, v))
            put_matrix(w.grip, 9 * i, scale_matrix(w.mass[i], by_velocity))


@kernel
def add_rate(chain, acceleration, w, force_rate):
    """Add the force rate from reeling [N/s], through masses and c t of nodes in ground contact, to `force_rate` (modified).

    acceleration : L'' [m/s2].
    """
    if chain.reeling == 0.0 and acceleration == 0.0:
        return
    ground = earth.ground_of(chain.parameters)
    for i in range(chain.n + 1):
        if w.touching[i] > 0.0:
            here = state_at(chain, i, w.start_x, w.start_v)
            rate = scale(growing_mass(chain, i, w.mass[i]) * chain.growth, earth.acceleration(ground, *here))
            if 0 < i < chain.n:
                turned = turn(chain, i, property_of(chain, i - 1, at.SHARE), property_of(chain, i, at.SHARE))
                gained = flow.part_at(chain, i) * acceleration - flow.passing_at(chain, i) * chain.reeling * turned
                rate = add(rate, apply(get_matrix(w.grip, 9 * i), scale(gained, direction(chain, i, w.start_x))))
            put(force_rate, i, add(get(force_rate, i), rate))


@kernel
def add_end_motion(conditions, chain, time, w, force_rate):
    """Add to `force_rate` [N/s] (modified) how the motion of driven ends at a time [s] turns t of their neighbours."""
    for end in range(2):
        i, curve = (1, conditions.ground) if end == 0 else (chain.n - 1, conditions.kite)
        is_driven = conditions.first == 1 if end == 0 else conditions.last == chain.n - 1
        if is_driven and w.touching[i] > 0.0 and flow.passing_at(chain, i) != 0.0:
            turned = scale((2.0 * end - 1.0) * flow.passing_at(chain, i) * flow.per_node(chain, i), velocity_at(curve, time))
            turned = turned[0], turned[1], 0.0
            put(force_rate, i, add(get(force_rate, i), apply(get_matrix(w.grip, 9 * i), turned)))


@kernel
def subtract_slopes(chain, d, x, v, w):
    """Subtract dF/dv + d dF/dx from the blocks of w.matrix (modified)."""
    ground, (diagonal, lower, upper) = earth.ground_of(chain.parameters), w.matrix
    for i in range(chain.n + 1):
        if w.touching[i] > 0.0:
            by_z, _ = earth.derivatives(ground, get(x, i), flow.velocity_of_rope(chain, i, x, v))
            for row in range(9 * i, 9 * i + 9):
                diagonal[row] -= w.grip[row]
            subtract_column(diagonal, 9 * i + 2, scale(d * w.mass[i], by_z))
            if flow.passing_at(chain, i) != 0.0:
                factor = d * flow.passing_at(chain, i) * flow.per_node(chain, i)
                for row in range(9 * i, 9 * i + 9, 3):
                    for place in range(row, row + 2):
                        upper[place] -= factor * w.grip[place]
                        lower[place] += factor * w.grip[place]


@kernel
def subtract_column(blocks, place, a):
    """Subtract a vector from the column of a 3x3 block (modified) that starts at this place."""
    blocks[place] -= a[0]
    blocks[place + 3] -= a[1]
    blocks[place + 6] -= a[2]


@kernel
def force_at(chain, i, w):
    """Ground force [N] on node i in contact at a stage."""
    ground = earth.ground_of(chain.parameters)
    return scale(w.stage_mass[i], earth.acceleration(ground, *state_at(chain, i, w.stage_x, w.stage_v)))


@kernel
def add_forces(chain, w):
    """Add the ground forces [N] at a stage to w.force (modified)."""
    for i in range(chain.n + 1):
        if w.touching[i] > 0.0:
            add_to_node(chain.n, i, force_at(chain, i, w), w.force)


@kernel
def pull_of_friction(chain, weights, w):
    """Contribution of friction to R of a line end [N] at a stage; weights : W of its nodes."""
    total = 0.0
    for i in range(1, chain.n):
        if w.touching[i] > 0.0:
            total += weights[i] * dot(direction(chain, i, w.stage_x), force_at(chain, i, w))
    return total


@kernel
def turn(chain, i, before, after):
    """-1/t dt/dq [1/m] of inner node i, q : rope that enters over an end; before, after : g of both segments at the node."""
    return (before + after) * flow.per_node(chain, i)


@kernel
def mass_by_length(chain, i, growth):
    """dm/dq [kg/m] of node i."""
    before = half_density(chain, i - 1) * growth[i - 1] if i > 0 else 0.0
    return before + (half_density(chain, i) * growth[i] if i < chain.n else 0.0)


@kernel
def add_to_column(chain, d, weights, growth, w, own):
    """Add the slopes of ground forces by rope that enters over an end to its `Rope` (modified); weights, growth : W, g."""
    ground = earth.ground_of(chain.parameters)
    for i in range(chain.n + 1):
        if w.touching[i] > 0.0:
            a, by_rate = earth.acceleration(ground, *state_at(chain, i, w.start_x, w.start_v)), ZERO_VECTOR
            by_length = scale(mass_by_length(chain, i, growth), a)
            if 0 < i < chain.n:
                along = apply(get_matrix(w.grip, 9 * i), direction(chain, i, w.start_x))
                turned = turn(chain, i, growth[i - 1], growth[i])
                by_length = add_scaled(by_length, -flow.passing_at(chain, i) * turned, along)
                by_rate = scale(weights[i], along)
            add_at(own.by_rate, i, by_rate)
            add_at(own.solved, i, add_scaled(by_rate, d, by_length))


@kernel
def add_to_row(chain, d, weights, w, own):
    """Add the slopes of `pull_of_friction` by velocities and positions to the `Rope` of the end (modified)."""
    ground = earth.ground_of(chain.parameters)
    for i in range(1, chain.n):
        if w.touching[i] > 0.0:
            t, part = direction(chain, i, w.start_x), weights[i]
            here, u = state_at(chain, i, w.start_x, w.start_v)
            by_z, _ = earth.derivatives(ground, here, u)
            by_velocity = scale(part, transposed_apply(t, get_matrix(w.grip, 9 * i)))
            add_at(own.by_velocity, i, by_velocity)
            add_at(own.row, i, add(by_velocity, (0.0, 0.0, d * part * w.mass[i] * dot(t, by_z))))
            force = scale(part * w.mass[i], earth.acceleration(ground, here, u))
            turned = scale(d * flow.per_node(chain, i), add_scaled(force, flow.passing_at(chain, i), by_velocity))
            turned = turned[0], turned[1], 0.0
            add_at(own.row, i + 1, turned)
            add_at(own.row, i - 1, scale(-1.0, turned))


@kernel
def corner(chain, weights, others, growth, w):
    """Slopes of `pull_of_friction` by rope that enters over an end: by its length [N/m] and rate [N s/m].

    others, growth : W and g of that end.
    """
    ground, by_length, by_rate = earth.ground_of(chain.parameters), 0.0, 0.0
    for i in range(1, chain.n):
        if w.touching[i] > 0.0:
            t, turned = direction(chain, i, w.start_x), turn(chain, i, growth[i - 1], growth[i])
            a = earth.acceleration(ground, *state_at(chain, i, w.start_x, w.start_v))
            along = dot(t, apply(get_matrix(w.grip, 9 * i), t))
            of_force = mass_by_length(chain, i, growth) - turned * w.mass[i]
            by_length += weights[i] * (of_force * dot(t, a) - turned * flow.passing_at(chain, i) * along)
            by_rate += weights[i] * others[i] * along
    return by_length, by_rate


@kernel
def subtract_damping(n, w):
    """Subtract dF/dv r [N] from w.q (modified)."""
    for i in range(n + 1):
        if w.touching[i] > 0.0:
            put(w.q, i, sub(get(w.q, i), apply(get_matrix(w.grip, 9 * i), get_node(n, i, w.r))))


@kernel
def transition_error(conditions, chain, h, w):
    """Velocity error estimate [m/s] of a step of h [s] in which nodes touched down or lifted off; 0 if none did.

    The pressure that the step omitted, or exerted beyond the transition, over a part TRANSITION of the step.
    """
    ground = earth.ground_of(chain.parameters)
    worst = 0.0
    for i in range(conditions.first, conditions.last + 1):
        x, v = get(w.x, i), get(w.v, i)
        if earth.touches(ground, x, v) != (w.touching[i] > 0.0):
            worst = max(worst, TRANSITION * h * abs(earth.pressure(ground, x, v)))
    return worst
