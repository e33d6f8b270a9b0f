"""Ground under the tether: a flat elastic half space with dry friction that carries the lumped masses.

All forces are proportional to the node mass, so they are written as accelerations:

    a_n = w2 d (1 - a v_z) >= 0,   d = ground_height - z > 0,   w2 = g/ground_sink,   a = 2/sqrt(g ground_sink)
    a_t = -mu a_n u/sqrt(|u|^2 + v_r^2),   u = v_t + c r/l0

At rest a node lies `ground_sink` deep; motion about this depth is critically damped. The damping grows with the depth, so
the force is continuous at touchdown, and a node that hits the ground at any speed leaves it with less than 1/a: it rises by
no more than ground_sink/8. Friction opposes the horizontal velocity u of the rope, which passes the node at c while the
winch reels (`flow.slide`). A lying node creeps with v_r T/sqrt(F^2 - T^2) under a pull T below its friction F. The ground
does not act on driven ends. In `acceleration` and its derivatives v is (u_x, u_y, v_z).

Source: Hunt and Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech. 42 (1975) 440;
docs/models/theory.md, "Ground".
"""

from collections import namedtuple
from math import sqrt

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..linear_algebra.matrices import multiply
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, sub

CREEP = 2e-4  # v_r [m/s]: under 98 % of its friction a lying tether creeps by less than 1 mm/s
SLIDING = 0.1  # v_r [m/s] in equilibrium, where friction has no memory: velocity noise is not sliding

Ground = namedtuple("Ground", "height hardness damping friction")
Ground.__doc__ = "Height [m], w2 [1/s2], a [s/m], friction coefficient mu [-]."


@kernel
def has_ground(parameters):
    """Whether ground contact is enabled."""
    return parameters[at.GROUND_CONTACT] == at.FLAT


@view
def ground_of(parameters):
    """The `Ground` of a tether; meaningful only if `has_ground`."""
    gravity, sink = parameters[at.GRAVITY], parameters[at.GROUND_SINK]
    return Ground(parameters[at.GROUND_HEIGHT], gravity / sink, 2.0 / sqrt(gravity * sink), parameters[at.GROUND_FRICTION])


@kernel
def pressure(ground, x, v):
    """a_n [m/s2] of a node at x [m] with velocity v [m/s], assuming contact."""
    return ground.hardness * (ground.height - x[2]) * (1.0 - ground.damping * v[2])


@kernel
def touches(ground, x, v):
    """Whether the ground presses on a node at x [m] with velocity v [m/s]."""
    return x[2] < ground.height and ground.damping * v[2] < 1.0


@view
def without_ground():
    """A `Ground` without any force."""
    return Ground(0.0, 0.0, 0.0, 0.0)


@view
def under(parameters):
    """The `Ground` under a tether with these parameters; `without_ground` if there is none."""
    return softer(ground_of(parameters), 1.0 if has_ground(parameters) else 0.0)


@view
def softer(ground, factor):
    """The `Ground` with `factor` times the stiffness."""
    return Ground(ground.height, factor * ground.hardness, ground.damping, ground.friction)


@view
def smooth(ground):
    """The `Ground` without friction."""
    return Ground(ground.height, ground.hardness, ground.damping, 0.0)


@kernel
def slip(v, creep):
    """Horizontal part of v/sqrt(|v_t|^2 + v_r^2) [-], and this root [m/s]; creep : v_r [m/s]."""
    size = sqrt(v[0] * v[0] + v[1] * v[1] + creep * creep)
    return (v[0] / size, v[1] / size, 0.0), size


@kernel
def slip_slope(factor, u):
    """Upper left 2x2 block of factor (1 - u u), row by row; u : from `slip`."""
    across = -factor * u[0] * u[1]
    return factor * (1.0 - u[0] * u[0]), across, across, factor * (1.0 - u[1] * u[1])


@kernel
def acceleration(ground, x, v):
    """Acceleration [m/s2] by the ground of a node in contact, at x [m] with velocity v [m/s]."""
    a = pressure(ground, x, v)
    u, _ = slip(v, CREEP)
    return -ground.friction * a * u[0], -ground.friction * a * u[1], a


@kernel
def derivatives(ground, x, v):
    """Derivatives of `acceleration` by z [1/s2] and by the velocity [1/s], a matrix."""
    a = pressure(ground, x, v)
    u, size = slip(v, CREEP)
    mu = ground.friction
    by_z = -ground.hardness * (1.0 - ground.damping * v[2])
    by_speed = -ground.hardness * (ground.height - x[2]) * ground.damping
    xx, xy, yx, yy = slip_slope(-mu * a / size, u)
    by_velocity = xx, xy, -mu * u[0] * by_speed, yx, yy, -mu * u[1] * by_speed, 0.0, 0.0, by_speed
    return (-mu * u[0] * by_z, -mu * u[1] * by_z, by_z), by_velocity


@kernel
def specific_energy(ground, x):
    """Elastic energy of the ground under a node at x [m], over its mass [J/kg]."""
    depth = max(ground.height - x[2], 0.0)
    return 0.5 * ground.hardness * depth * depth


@kernel
def specific_losses(ground, x, v):
    """Heat in the ground's damper and by friction, over the mass of a node at x [m] with velocity v [m/s]: [W/kg]."""
    depth = max(ground.height - x[2], 0.0)
    pressing = acceleration(ground, x, v) if touches(ground, x, v) else ZERO_VECTOR
    return (ground.hardness * depth - pressing[2]) * v[2], -pressing[0] * v[0] - pressing[1] * v[1]


# --- in equilibrium, where nodes slide but do not sink: a_n = w2 d


@kernel
def carries(ground, x):
    """Whether the ground carries a node at x [m] of a chain in equilibrium."""
    return ground.hardness > 0.0 and x[2] < ground.height


@kernel
def support(ground, x, v):
    """Acceleration [m/s2] by the ground of a node that it carries at x [m] and that slides with v [m/s]."""
    a = ground.hardness * (ground.height - x[2])
    u, _ = slip(v, SLIDING)
    return -ground.friction * a * u[0], -ground.friction * a * u[1], a


@kernel
def support_slope(ground, x, v, motion):
    """Derivative of `support` by the position [1/s2], a matrix; motion : velocity over position [1/s]."""
    u, size = slip(v, SLIDING)
    grip = ground.friction * ground.hardness
    xx, xy, yx, yy = slip_slope(-grip * (ground.height - x[2]) / size, u)
    m = multiply((xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, 0.0), motion)
    return m[0], m[1], m[2] + grip * u[0], m[3], m[4], m[5] + grip * u[1], m[6], m[7], m[8] - ground.hardness


# --- a step of backward Euler, from z_0 to z in h, in which both are functions of the position after it:
#     a_n = w2 d (1 + a (d - d_0)/h) where this is above 0, and friction with an a_n that each iteration freezes


@kernel
def least_depth(ground, before, h):
    """Depth [m] beyond which the ground presses on a node after a step of h [s] from a depth [m]."""
    return max(0.0, before - h / ground.damping)


@kernel
def depths(ground, old, new):
    """Depths [m] of a node before and after a step, from its positions [m]; below 0 above the ground."""
    return ground.height - old[2], ground.height - new[2]


@kernel
def slide_of_step(old, new, h, slide):
    """Horizontal displacement [m] of the rope at a node in a step of h [s] as `slip`, and its size [m].

    slide : velocity of the rope relative to the node [m/s].
    """
    u, speed = slip(add_scaled(slide, 1.0 / h, sub(new, old)), CREEP)
    return u, h * speed


@kernel
def normal_of_step(ground, old, new, h):
    """a_n [m/s2] of a node that moves from `old` to `new` [m] in h [s], and its derivative by z [1/s2]."""
    before, depth = depths(ground, old, new)
    if depth <= least_depth(ground, before, h):
        return 0.0, 0.0
    faster = ground.damping / h
    by_z = -ground.hardness * (1.0 + faster * (2.0 * depth - before))
    return ground.hardness * depth * (1.0 + faster * (depth - before)), by_z


@kernel
def potential_of_step(ground, old, new, h, held, slide):
    """Incremental potential of the ground over the mass of a node that moves from `old` to `new` [m] in h [s]: [J/kg].

    held, slide : a_n [m/s2] and velocity of the rope relative to the node [m/s], both frozen in the friction.
    """
    before, depth = depths(ground, old, new)
    least = least_depth(ground, before, h)
    _, way = slide_of_step(old, new, h, slide)
    total = ground.friction * held * way
    if depth > least:
        faster, deeper = ground.damping / h, depth - least
        linear = faster * least if least > 0.0 else 1.0 - faster * before
        total += ground.hardness * deeper * deeper * (0.5 * linear + faster * deeper / 3.0)
    return total


@kernel
def force_of_step(ground, old, new, h, held, slide):
    """Minus the derivative of `potential_of_step` by `new` [m/s2], and its own derivative, a matrix [1/s2]."""
    u, way = slide_of_step(old, new, h, slide)
    grip = ground.friction * held
    pressed, by_z = normal_of_step(ground, old, new, h)
    xx, xy, yx, yy = slip_slope(-grip / way, u)
    return (-grip * u[0], -grip * u[1], pressed), (xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, by_z)


@kernel
def part_under(ground, x_p, x_q):
    """Fraction [-] of a straight segment between two points [m] on or below the ground."""
    p, q = ground.height - x_p[2], ground.height - x_q[2]  # depths
    if p >= 0.0 and q >= 0.0:
        return 1.0 if p + q > 0.0 else 0.0
    if p <= 0.0 and q <= 0.0:
        return 0.0
    return max(p, q) / abs(p - q)
