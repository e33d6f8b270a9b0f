"""Ground contact in a Rosenbrock step: nodes in contact, their forces and derivatives, and the transition error.

All stages treat the nodes that touch the ground at the start of the step as in contact, and no others, so the step sees
smooth equations. A step in which a node goes too far beyond the transition is rejected (`transition_error`), as for a
segment that goes slack (`taut_slack.py`). The law: `equations/ground.py`.
"""

from ..compilation import kernel
from ..equations import ground as earth
from ..equations.properties import growing_mass
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.matrices import apply, get_matrix, put_matrix, scale_matrix
from ..linear_algebra.vectors import add_scaled, get, put, scale, sub
from .taut_slack import TRANSITION


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
            _, by_velocity = earth.derivatives(ground, get(x, i), get(v, i))
            put_matrix(w.grip, 9 * i, scale_matrix(w.mass[i], by_velocity))


@kernel
def add_rate(chain, x, v, w, force_rate):
    """Add the force rate from reeling [N/s], through the masses in ground contact, to `force_rate` (modified)."""
    ground = earth.ground_of(chain.parameters)
    for i in range(chain.n + 1):
        if w.touching[i] > 0.0:
            mass_rate = growing_mass(chain, i, w.mass[i]) * chain.growth
            put(force_rate, i, add_scaled(get(force_rate, i), mass_rate, earth.acceleration(ground, get(x, i), get(v, i))))


@kernel
def subtract_slopes(chain, d, x, v, w):
    """Subtract dF/dv + d dF/dx from the blocks of w.matrix (modified)."""
    ground = earth.ground_of(chain.parameters)
    for i in range(chain.n + 1):
        if w.touching[i] > 0.0:
            by_z, _ = earth.derivatives(ground, get(x, i), get(v, i))
            block = w.matrix.diagonal
            for j in range(3):
                for k in range(3):
                    block[9 * i + 3 * j + k] -= w.grip[9 * i + 3 * j + k]
            for j in range(3):
                block[9 * i + 3 * j + 2] -= d * w.mass[i] * by_z[j]


@kernel
def add_forces(chain, w):
    """Add the ground forces [N] at a stage to w.force (modified)."""
    n = chain.n
    ground = earth.ground_of(chain.parameters)
    for i in range(n + 1):
        if w.touching[i] > 0.0:
            a = earth.acceleration(ground, get_node(n, i, w.stage_x), get_node(n, i, w.stage_v))
            add_to_node(n, i, scale(w.stage_mass[i], a), w.force)


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
