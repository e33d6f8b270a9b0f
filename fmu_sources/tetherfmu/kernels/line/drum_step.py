"""The drum of a winch in a Rosenbrock step: in the same system as its chain.

Length L and speed u of the drum (`equations/drum.py`) are unknowns beside x and v, with the same coefficients: p = U_L/d and
U_u stand for L and u as q and V for x and v. Each segment has its share of L, so the matrix of a stage has a border:

    (M/d - B - d K) q - (F_u + d F_L) p = ...
    -(T_v + d T_x) q + (m/d - f_u - d f_L) p = f + m (sum_j c_ij U_uj/h + r/d) - T_v r_v - f_u r + gamma_i h df/dt

with f = T - W - c u - F sign(u). The border costs one solution more for each matrix and one vector for each stage. See
docs/models/numerics.md, "A drum in the same system".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel, view
from ..equations import assembly, segment
from ..equations.boundary import BoundaryConditions
from ..equations.drum import balance
from ..equations.end_motion import acceleration_at, velocity_at
from ..equations.ground import has_ground
from ..equations.properties import chain_at, point_mass, property_of, sees_reeling
from ..flat_arrays import part
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.matrices import get_matrix, transposed_apply
from ..linear_algebra.pairs import first
from ..linear_algebra.vectors import add, add_scaled, dot, get, put, scale, sub
from . import contact, rosenbrock
from .rodas4p import ALPHA, GAMMA, GAMMA_I, INERTIA, R_BY_GAMMA, STAGES, A, P

Workspace = namedtuple("Workspace", "chain column by_length by_speed speeds")
Workspace.__doc__ = """Scratch arrays of a step.

chain : `rosenbrock.Workspace`.  column : the solution y of (M/d - B - d K) y = F_u + d F_L.  by_length, by_speed : F_L [N/m]
and F_u [N s/m].  These three are flat arrays of 3 (n + 1) numbers.  speeds : U_u of all stages [m/s].
"""
Border = namedtuple("Border", "by_speed by_length by_position damper direction rate")
Border.__doc__ = """Derivatives of f = T - W - c u - F sign(u) at the start of a step.

by_speed, by_length : f_u [N s/m], f_L [N/m].  by_position : dT/dr of the first segment [N/m].  damper : dT/d(dl/dt) [N s/m].
direction : of the first segment.  rate : explicit time derivative [N/s].
"""
Motion = namedtuple("Motion", "length speed length_error speed_error")
Motion.__doc__ = "Length [m] and speed [m/s] of the drum after a step, and their error estimates."


@kernel
def drum_size(n):
    """Length of the room that `beside` needs."""
    return 9 * (n + 1) + STAGES


@view
def beside(n, w, room):
    """`Workspace` of a chain with its own, `rosenbrock.Workspace`, and a room for the arrays of the drum."""
    flat = 3 * (n + 1)
    vectors = part(room, 0, flat), part(room, flat, flat), part(room, 2 * flat, flat)
    return Workspace(w, *vectors, part(room, 3 * flat, STAGES))


@view
def with_reeling(conditions, reeling):
    """`BoundaryConditions` with these coefficients of the unstretched length, see `winch.py`."""
    c = conditions
    ends = c.ground, c.kite, c.first, c.last
    return BoundaryConditions(c.n, c.parameters, *ends, reeling, c.force, c.force_rate, c.wind, c.load, c.load_rate)


@view
def chain_with(conditions, length, speed):
    """The `Chain` with this unstretched length [m] and its rate [m/s]."""
    return chain_at(conditions.n, conditions.parameters, length, speed, conditions.wind)


@kernel
def first_tension(chain, x, v):
    """Tension of the first segment [N] with the nodes at x [m] and velocities v [m/s]."""
    length, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    return segment.tension_of(chain, 0, segment.BY_LENGTH, length, dot(e, sub(get(v, 1), get(v, 0))))


# --- one step


@kernel
def put_rates(conditions, chain, x, v, b):
    """F_L and F_u of all nodes into b.by_length, b.by_speed (both modified), at constant masses."""
    n, w = conditions.n, b.chain
    growing = chain_with(conditions, chain.length, 1.0)
    assembly.rate_from_reeling(growing, w.start_x, w.start_v, w.records, b.by_length)
    if has_ground(chain.parameters):
        contact.add_rate(growing, x, v, w, b.by_length)
    for k in range(3 * (n + 1)):
        b.by_speed[k] = 0.0
    assembly.add_rate_from_acceleration(chain, 1.0, x, w.records, b.by_speed)


@kernel
def put_in_column(chain, i, d, mass, force, b):
    """F_u + d F_L of node i into b.column, and what its mass adds to F_L into b.by_length (both modified).

    The mass [kg], of which w.mass is the part of this chain, grows with the length, and F/m falls; force : F at the start of
    the step [N].
    """
    share = (b.chain.mass[i] - point_mass(chain, i)) / (mass * chain.length)
    put(b.by_length, i, add(get(b.by_length, i), scale(-share, force)))
    put(b.column, i, add_scaled(get(b.by_speed, i), d, get(b.by_length, i)))


@kernel
def border_of(conditions, drum, chain, time, x, w):
    """`Border` at a time [s] of the communication step; the records of the segments are those of the start of the step."""
    record = assembly.record_of(0, chain.n, w.records)
    e = segment.direction_in(record)
    damper = record[segment.DAMPER]
    by_position = transposed_apply(e, get_matrix(record, segment.K))
    by_speed = -drum.damping
    if sees_reeling(chain.parameters):
        length, _ = segment.geometry(sub(get(x, 1), get(x, 0)))
        by_speed -= damper * length / chain.length
    by_length = record[segment.SLOPE] * property_of(chain, 0, at.SHARE)
    rate = -drum.force_rate
    if conditions.first == 1:
        moving, gaining = velocity_at(conditions.ground, time), acceleration_at(conditions.ground, time)
        rate -= dot(by_position, moving) + damper * dot(e, gaining)
    if chain.n == 1 and conditions.last == 0:
        moving, gaining = velocity_at(conditions.kite, time), acceleration_at(conditions.kite, time)
        rate += dot(by_position, moving) + damper * dot(e, gaining)
    return Border(by_speed, by_length, by_position, damper, e, rate)


@kernel
def form(conditions, chain, time, h, x, v, w):
    """`rosenbrock.form` of a chain whose length is an unknown."""
    interleave(conditions.n, x, w.start_x)
    interleave(conditions.n, v, w.start_v)
    assembly.node_masses(chain, w.mass)
    assembly.linearize(chain, w.start_x, w.start_v, w.modes, w.segments, w.records, w.q)
    for k in range(3 * (conditions.n + 1)):
        w.q[k] = 0.0
    rosenbrock.add_explicit_rates(conditions, time, w)
    interleave(conditions.n, w.q, w.force_rate)
    rosenbrock.assemble(conditions, chain, GAMMA * h, x, v, w)


@kernel
def added_up(start, factors, stage, b):
    """start + sum_j factors[stage, j] U_uj."""
    for j in range(stage):
        start += factors[stage, j] * b.speeds[j]
    return start


@kernel
def stage_tension(n, chain, x, v, w):
    """Tension of the first segment [N] at a stage, x [m] and v [m/s] interleaved, with its stiffness of the start."""
    x_p, x_q = assembly.lower_and_upper(n, 0, x)
    v_p, v_q = assembly.lower_and_upper(n, 0, v)
    length, e = segment.geometry(sub(first(x_q), first(x_p)))
    return segment.tension_of(chain, 0, w.modes[0], length, dot(e, sub(first(v_q), first(v_p))))


@kernel
def pull_of(border, d, change):
    """What f gains [N] by the difference of q [m/s] of the nodes of the first segment: (T_v + d T_x) q."""
    return border.damper * dot(border.direction, change) + d * dot(border.by_position, change)


@kernel
def pivot_of(drum, border, d, response):
    """m/d - f_u - d f_L - (T_v + d T_x) y of the drum with the difference of y at the first segment, `response`."""
    return drum.mass / d - border.by_speed - d * border.by_length - pull_of(border, d, response)


@kernel
def motion_at_stage(stage, h, length, speed, last, b):
    """L_i [m] and u_i [m/s] of a stage.

    length, speed : at the start of the step.  last : L_i, u_i, p and U_u of the stage before.
    """
    length_i, speed_i, p, increment = last
    if stage < STAGES - 1:
        length_i = length + h * added_up(ALPHA[stage] * speed, P, stage, b)
        return length_i, added_up(speed, A, stage, b)
    return length_i + GAMMA * h * p, speed_i + increment


@kernel
def stage_rest(stage, speed, b):
    """r_i of the drum at a stage [m/s]."""
    return added_up(GAMMA_I[stage] / GAMMA * speed, R_BY_GAMMA, stage, b)


@kernel
def place_stage(conditions, chain, stage, now, w):
    """Masses and forces of a chain with a drum at a stage, at a time [s] of the communication step, into w (modified)."""
    ends, driven = rosenbrock.curves_of(conditions)
    rosenbrock.prescribe_ends(ends, driven, now, w)
    if stage == 0:
        copy(w.mass, w.stage_mass)
    else:
        assembly.node_masses(chain, w.stage_mass)
    rosenbrock.stage_force(conditions, chain, now, w)


@kernel
def reduced_side(conditions, stage, h, r, b):
    """Right-hand side of a stage of the chain into w.q (modified), with what r [m/s] of the drum takes from it."""
    w = b.chain
    rosenbrock.right_hand_side(conditions, stage, h, w)
    for k in range(3 * (conditions.n + 1)):
        w.q[k] -= r * b.by_speed[k]


@kernel
def drum_side(chain, drum, direction, border, stage, now, h, speed, b):
    """Right-hand side of a stage of the drum [N] but for what q of the nodes adds; speed : at the start of the step [m/s].

    chain : with L_i and u_i.
    """
    w, gamma, r = b.chain, GAMMA_I[stage] / GAMMA, stage_rest(stage, speed, b)
    inertia = added_up(gamma * speed / GAMMA, INERTIA, stage, b)
    r_p, r_q = assembly.lower_and_upper(chain.n, 0, w.r)
    still = dot(border.direction, sub(first(r_q), first(r_p)))
    tension = stage_tension(chain.n, chain, w.stage_x, w.stage_v, w)
    right = balance(drum, direction, tension, chain.reeling, now)
    right += drum.mass * inertia / h - border.damper * still - border.by_speed * r + GAMMA_I[stage] * h * border.rate
    return right
