"""What a rope that flows pulls at its drum: the force R conjugate to the unstretched length L that the drum pays out.

Lagrange's equation of L, with the kinetic energy of `flow.py` and with rope that is on the drum already as fast as the drum
turns, so that it leaves it without a thrust:

    m u' = T - W,   T + T^2/(2 EA) = R = R_0 + sum_i col_i . v_i' - I u',   L' = u

    R_0 = sum over segments of  s (k (l^2 - l0^2)/(2 l0) + c (r . r' - l^2 l0'/l0)/l0 - mu g ((z_p + z_q)/2 - z_0)
                                   + mu |r'|^2/4) + mu/2 (w_p^2 + w_q^2) (s u^2 l^2/(2 l0^2) - 2 u r . r'/l0)
          + mu u^2/2                                            of the first segment
    col_p = -mu/2 w_p r,  col_q = -mu/2 w_q r,   I = sum mu/2 (w_p^2 + w_q^2) l^2/l0

with s the share of a segment in L, w_i = c_i/u the part that flows past a node, W all that the drum sets against the rope
(motor, damping, friction), m its mass. u' makes the force col_i u' on node i. T is the tension where the rope leaves the
drum, T^2/(2 EA) the energy of the strain that it has there: none where dampers press it, T < 0.
Theory: docs/models/theory.md, "Rope that flows".
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, norm, scale, sub, vector_at
from . import segment
from .boundary import spring_at_ground
from .properties import chain_at, half_density, property_of, rest_length, sees_reeling


@kernel
def next_part(chain, s, part):
    """w of node q of segment s from that of node p."""
    return part - property_of(chain, s, at.SHARE)


@kernel
def feels_rope(parameters):
    """Whether a drum feels the rope that flows, as chains of the strain_rate law; else the tension of the first segment."""
    return sees_reeling(parameters)


@kernel
def squares(chain, s, part):
    """mu/2 (w_p^2 + w_q^2)/l0 [kg/m2] of segment s."""
    other = next_part(chain, s, part)
    return half_density(chain, s) * (part * part + other * other) / rest_length(chain, s)


@kernel
def pull(chain, s, part, mode, r, u, height):
    """Part of segment s in R_0 [N] but mu u^2/2: its r [m] and r' [m/s], its mean height above the first node [m]."""
    share, rest, square = property_of(chain, s, at.SHARE), rest_length(chain, s), dot(r, r)
    mode = mode if mode != 0.0 else square - rest * rest
    k, c = segment.stiffness(chain, s, mode, rest)
    both, of_flow = dot(r, u), squares(chain, s, part)
    strained = 0.5 * k * (square - rest * rest) + c * (both - square * chain.growth)
    total = share * (strained / rest + half_density(chain, s) * (0.5 * dot(u, u) - 2.0 * chain.gravity * height))
    return total + of_flow * chain.reeling * (0.5 * chain.growth * square - 2.0 * both)


@kernel
def of_speed(chain):
    """mu u^2/2 [N] of the first segment."""
    return half_density(chain, 0) * chain.reeling * chain.reeling


@kernel
def inertia(chain, s, part, r):
    """Part of segment s in I [kg]."""
    return squares(chain, s, part) * dot(r, r)


@kernel
def columns(chain, s, part, r):
    """col_p and col_q [kg] of segment s."""
    half = half_density(chain, s)
    return scale(-half * part, r), scale(-half * next_part(chain, s, part), r)


@kernel
def by_motion(chain, s, part, mode, r, u, a_p, a_q):
    """Slopes of the part of segment s in R: by r [N/m], by r' [N s/m], by L [N/m], by u [N s/m].

    a_p, a_q : accelerations of its nodes [m/s2].  The chain has u'.
    """
    share, rest, half, speed = property_of(chain, s, at.SHARE), rest_length(chain, s), half_density(chain, s), chain.reeling
    square, both, of_flow = dot(r, r), dot(r, u), squares(chain, s, part)
    k, c = segment.stiffness(chain, s, mode if mode != 0.0 else square - rest * rest, rest)
    damper, gained = share * c / rest, add(scale(part, a_p), scale(next_part(chain, s, part), a_q))
    along = share * k / rest - 2.0 * damper * chain.growth + of_flow * (speed * chain.growth - 2.0 * chain.acceleration)
    by_r = add_scaled(scale(along, r), damper - 2.0 * of_flow * speed, u)
    by_r = add_scaled(by_r, -half, gained)
    by_u = add_scaled(scale(damper - 2.0 * of_flow * speed, r), half * share, u)
    of_spring = -share * k * square / rest - damper * (2.0 * both - 3.0 * square * chain.growth)
    of_inertia = of_flow * (speed * (2.0 * both - square * chain.growth) + square * chain.acceleration)
    by_speed = -damper * square / chain.length + of_flow * (square * chain.growth - 2.0 * both)
    return by_r, by_u, (of_spring + of_inertia) / chain.length, by_speed


@kernel
def force_slopes(chain, s, part, r, u):
    """Slopes of the forces of rope that flows: by L [N/m] of node p, which q has with the other sign; by u of p and of q.

    r [m], r' [m/s].
    """
    of_flow, half = squares(chain, s, part), half_density(chain, s)
    along = scale(of_flow * chain.reeling, r)
    both = scale(-half * (part + next_part(chain, s, part)), u)
    return scale(chain.growth, along), add_scaled(both, -2.0, along), add_scaled(both, 2.0, along)


@kernel
def with_strain(stiffness, force):
    """T + T^2/(2 EA) [N] of a tension T [N], and its slope [-]; EA [N] of the first segment. T alone below 0."""
    pulled = max(force, 0.0)
    return force + 0.5 * pulled * pulled / stiffness, 1.0 + pulled / stiffness


@kernel
def tension_of(stiffness, pull):
    """T [N] of R [N], the inverse of `with_strain`; EA [N]."""
    return pull if pull <= 0.0 else stiffness * (sqrt(1.0 + 2.0 * pull / stiffness) - 1.0)


@kernel
def tension_of_rope(chain, x, v, moves):
    """Tension where the rope leaves the winch [N], of R_0 with the nodes at x [m], v [m/s]: but for their accelerations.

    moves : 1, or 0 without the velocities.
    """
    total, part, lowest = of_speed(chain), 1.0, get(x, 0)[2]
    for s in range(chain.n):
        x_p, x_q = get(x, s), get(x, s + 1)
        u, height = scale(moves, sub(get(v, s + 1), get(v, s))), segment.mean_height(x_p, x_q) - lowest
        total += pull(chain, s, part, segment.BY_LENGTH, sub(x_q, x_p), u, height)
        part = next_part(chain, s, part)
    return tension_of(property_of(chain, 0, at.STIFFNESS), total)


@kernel
def spring_at_winch(n, parameters, state):
    """Tension where the rope leaves the winch [N] of a chain in equilibrium, from the spring of its first segment.

    That spring less the weight of the half segment below it.
    """
    spring, (x, _) = spring_at_ground(n, parameters, state), positions_and_velocities(n, state)
    chain = chain_at(n, parameters, state[at.LENGTH], 0.0, ZERO_VECTOR)
    _, along = segment.geometry(sub(get(x, 1), get(x, 0)))
    return spring - half_density(chain, 0) * rest_length(chain, 0) * chain.gravity * along[2]


@kernel
def tension_at_winch(n, parameters, state):
    """Tension where the rope leaves the winch [N], of a chain at rest in a state.

    Where positions do not hold the tensions, `spring_at_winch`; by the stretch_rate law the spring of the first segment.
    """
    held, (x, v) = vector_at(state, at.GROUND_TENSION_VECTOR), positions_and_velocities(n, state)
    if not feels_rope(parameters):
        return spring_at_ground(n, parameters, state)
    if norm(held) > 0.0:
        return spring_at_winch(n, parameters, state)
    chain = chain_at(n, parameters, state[at.LENGTH], 0.0, ZERO_VECTOR)
    return tension_of_rope(chain, x, v, 0.0)
