"""A chain that moves as a rigid body about its ground end: its motion, and the forces on its nodes.

Every node turns with omega and recedes with the extension rate s; in static equilibrium both are zero:

    v_i = v_0 + S r_i,   S r = omega x r + s r,   a_i = omega x (omega x r_i),   r_i = x_i - x_0

There is no damping, as only the direction changes. Source: docs/models/theory.md, "Quasi-steady".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import flow, node_loads, segment
from ..equations.ground import SLIDING, carries, support, support_slope
from ..equations.properties import part_of, property_of, rest_length
from ..linear_algebra.matrices import ZERO_MATRIX, add_to_diagonal, scale_matrix, skew
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, cross, dot, get, put, scale, sub

GIVE = 0.01  # [m]: displacement at which piled-up rope overcomes friction
NO_PULL, SPRINGS, TENSIONS = 0, 1, 2  # tensions that act on the nodes

Body = namedtuple("Body", "chain spin extension_rate x v ground anchor is_piled")
Body.__doc__ = """A chain that moves as a body about its ground end.

chain : `Chain`.  spin : angular velocity omega [rad/s].  extension_rate : s [1/s].
x, v : positions [m] and velocities [m/s] of all nodes; given at the ends, modified at the inner nodes.
ground : `Ground` that carries the inner nodes; `without_ground` if there is none.
anchor, is_piled : friction anchors of the nodes of a piled-up chain [m], and whether it is piled up; otherwise nodes
slide with their velocities."""


@kernel
def straighten(chain, x):
    """Put the inner nodes of x (modified) on the straight line between its ends, at equal strain."""
    ground = get(x, 0)
    chord = sub(get(x, chain.n), ground)
    part = 0.0
    for i in range(1, chain.n):
        part += part_of(chain, i - 1)
        put(x, i, add_scaled(ground, part, chord))


@kernel
def rigid_motion(n, x, v):
    """Angular velocity [rad/s] and extension rate [1/s] of a body about the ground end that carries the kite.

    omega = r x u/|r|^2, s = r . u/|r|^2 with the vector r from the ground end to the kite and its rate u, from the ends in
    x [m] and v [m/s].
    """
    r = sub(get(x, n), get(x, 0))
    u = sub(get(v, n), get(v, 0))
    square = max(dot(r, r), segment.SHORTEST**2)
    return scale(1.0 / square, cross(r, u)), dot(r, u) / square


@kernel
def rigid_velocity(body):
    """Velocities [m/s] of the inner nodes of the body (modified): v_0 + omega x r + s r at their positions."""
    x, v = body.x, body.v
    ground = get(x, 0)
    for i in range(1, body.chain.n):
        r = sub(get(x, i), ground)
        put(v, i, add(get(v, 0), add_scaled(cross(body.spin, r), body.extension_rate, r)))


@kernel
def spring_tensions(chain, x, tension):
    """Tensions of the taut springs [N] into `tension` (modified, n numbers) at the positions x [m]."""
    for s in range(chain.n):
        length, _ = segment.geometry(sub(get(x, s + 1), get(x, s)))
        tension[s] = property_of(chain, s, at.STIFFNESS) * (length / rest_length(chain, s) - 1.0)


@kernel
def load_of(body, mass, x, v):
    """Load on a node of this mass [kg] at x [m] with velocity v [m/s], weight and inertia [N]."""
    acceleration = cross(body.spin, cross(body.spin, sub(x, get(body.x, 0))))
    return node_loads.load(body.chain, mass, x, v, acceleration)


@kernel
def motion_of(body):
    """Derivative of the velocity of a node of the body by its position [1/s], a matrix."""
    return add_to_diagonal(skew(body.spin), body.extension_rate)


@kernel
def sliding(body, i):
    """Sliding velocity [m/s] of the rope at node i on the ground."""
    if body.is_piled:
        return scale(SLIDING / GIVE, sub(get(body.x, i), get(body.anchor, i)))
    return add(get(body.v, i), flow.slide(body.chain, i, flow.passing_at(body.chain, i), body.x))


@kernel
def support_stiffness(body, mass, i):
    """Derivative of the ground force on node i, of this mass [kg], by its position [N/m], a matrix."""
    motion = motion_of(body)
    if body.is_piled:
        motion = add_to_diagonal(ZERO_MATRIX, SLIDING / GIVE)
    return scale_matrix(mass, support_slope(body.ground, get(body.x, i), sliding(body, i), motion))


@kernel
def loads(body, pulls, tension, mass, load):
    """Drag, weight, inertia and support f of all nodes [N] into `load` (modified).

    Updates the velocities of the inner nodes of the body.

    pulls : tensions to add, so that `load` becomes the residual: NO_PULL, SPRINGS, or the TENSIONS [N].
    """
    rigid_velocity(body)
    chain = body.chain
    x_p, v_p = get(body.x, 0), get(body.v, 0)
    from_below = ZERO_VECTOR
    for s in range(chain.n):
        x_q, v_q = get(body.x, s + 1), get(body.v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        drag = segment.half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q)
        pull = ZERO_VECTOR
        if pulls == SPRINGS:
            pull = scale(segment.spring_tension(chain, s, length), e)
        elif pulls == TENSIONS:
            pull = scale(tension[s], e)
        total = add(add(from_below, load_of(body, mass[s], x_p, v_p)), add(drag, pull))
        if s > 0 and carries(body.ground, x_p):
            total = add_scaled(total, mass[s], support(body.ground, x_p, sliding(body, s)))
        put(load, s, total)
        from_below = sub(drag, pull)
        x_p, v_p = x_q, v_q
    put(load, chain.n, add(from_below, load_of(body, mass[chain.n], x_p, v_p)))
