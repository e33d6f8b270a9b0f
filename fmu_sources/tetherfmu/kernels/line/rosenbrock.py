"""One step of the Rosenbrock method Rodas4P (`rodas4p.py`) for the chain, y = (x, v), f = (v, F/m).

The positions are eliminated, with d = h gamma, U = (d q, V) and q = V + r:

    x_i = x0 + h (alpha_i v0 + sum_j P_ij V_j),   v_i = v0 + sum_j a_ij V_j
    r_i = (gamma_i v0 + sum_j R_ij V_j)/gamma
    (M/d - B - d K) q_i = F(x_i, v_i) + M (sum_j c_ij V_j/h + r_i/d) - B r_i + gamma_i h dF/dt

one block tridiagonal system with 3x3 blocks per stage. F at a stage is multiplied by m_0/m, the masses at the start and
at the stage.

Taut and slack: all stages use the stiffness of a segment at the start of the step, so the step sees smooth equations; a step
that goes too far beyond the transition is rejected (`taut_slack.transition_error`). See docs/models/numerics.md,
"Rosenbrock step".
"""

from collections import namedtuple

from ..arrays import behind, copy, shared_arrays, shared_size, split
from ..compilation import kernel, view
from ..equations import assembly, flow, winch
from ..equations.boundary import chain_during, load_during, place_ends
from ..equations.end_motion import acceleration_at, position_at, velocity_at
from ..equations.ground import has_ground
from ..equations.properties import growing_mass
from ..flat_arrays import part
from ..linear_algebra.block_tridiagonal import Matrix
from ..linear_algebra.both_ends import (
    deinterleave,
    get_interleaved,
    get_two,
    interleave,
    interleaved_size,
    next_interleaved,
    put_interleaved,
    put_two,
)
from ..linear_algebra.pairs import first, number_at, pair, second, select
from ..linear_algebra.vectors import NEUTRAL_VECTOR, ZERO_VECTOR, add, add_scaled, get, put, scale, sub
from . import contact
from .rodas4p import ALPHA, GAMMA, GAMMA_I, INERTIA, R_BY_GAMMA, STAGES, A, P

Workspace = namedtuple(
    "Workspace",
    "x v q velocity_error start_x start_v stage_x stage_v r inertia_velocity force force_rate "
    "velocities matrix segments records mass stage_mass modes dampings touching grip",
)
Workspace.__doc__ = """Scratch arrays of a step.

Flat arrays of 3 (n + 1) numbers:
x, v : result of the step [m], [m/s].  q : the solution q of a stage; after the step the error estimate of x over d [m/s].
velocity_error : the error estimate of v [m/s].

Interleaved arrays (`linear_algebra.both_ends`):
start_x, start_v : at the start of the step [m], [m/s].  stage_x, stage_v : argument of a stage.  r, inertia_velocity : sums
of `combine` [m/s].  force : F [N].  force_rate : explicit time derivative of M v' [N/s].
velocities : V of all stages [m/s], two nodes side by side: number STAGES k + stage.

matrix, records, mass : see `arrays.shared_arrays`; at the start of the step.  segments : see `assembly.find_segments`.
stage_mass : node masses at the stage [kg], n + 1.  modes : n, stiffness mode of each segment, see `segment.TAUT`.
dampings : b of `flow.slopes` at the start of the step [N s/m], n, where rope flows.
touching, grip : nodes in ground contact, n + 1, and their dF/dv [N s/m], 9 (n + 1); see `contact.py`."""


@kernel
def workspace_size(n):
    """Length of the work array that `workspace` needs."""
    vectors = (8 + STAGES) * interleaved_size(n) + 4 * 3 * (n + 1)
    return shared_size(n) + vectors + assembly.segments_size(n) + 13 * n + 11


@view
def workspace(n, work):
    """Cut the work array into the arrays of `Workspace`."""
    blocks, records, mass, room = shared_arrays(n, work)
    flat, interleaved, segments = 3 * (n + 1), interleaved_size(n), assembly.segments_size(n)
    start_x, start_v, stage_x, room = split(interleaved, room)
    stage_v, r, inertia_velocity, room = split(interleaved, room)
    force, force_rate, room = part(room, 0, interleaved), part(room, interleaved, interleaved), behind(2 * interleaved, room)
    velocities, room = part(room, 0, STAGES * interleaved), behind(STAGES * interleaved, room)
    segments, room = part(room, 0, segments), behind(segments, room)
    x, v, q, room = split(flat, room)
    error, stage_mass, modes = part(room, 0, flat), part(room, flat, n + 1), part(room, flat + n + 1, n)
    dampings, room = part(room, flat + 2 * n + 1, n), behind(flat + 3 * n + 1, room)
    on_ground = part(room, 0, n + 1), part(room, n + 1, 9 * (n + 1))
    vectors = x, v, q, error, start_x, start_v, stage_x, stage_v, r, inertia_velocity, force, force_rate, velocities
    return Workspace(*vectors, Matrix(*blocks), segments, records, mass, stage_mass, modes, dampings, *on_ground)


@kernel
def add_explicit_rates(conditions, chain, time, w):
    """Add to w.q (modified) the rates of the forces [N/s] from the load and from the motion of the driven ends."""
    n = conditions.n
    put(w.q, n, add(get(w.q, n), conditions.load_rate))
    if conditions.first == 1:
        end, rate = velocity_at(conditions.ground, time), acceleration_at(conditions.ground, time)
        assembly.add_end_motion(n, False, end, rate, w.records, w.q)
        if flow.flows(chain):
            flow.add_end_motion(chain, False, end, rate, w.q)
    if conditions.last == n - 1:
        end, rate = velocity_at(conditions.kite, time), acceleration_at(conditions.kite, time)
        assembly.add_end_motion(n, True, end, rate, w.records, w.q)
        if flow.flows(chain):
            flow.add_end_motion(chain, True, end, rate, w.q)


@kernel
def form(conditions, chain, time, h, x, v, w):
    """Matrix of the step from the `Chain` at its start, and the explicit time derivative of forces [N/s] into w.q.

    Modifies w.start_x, w.start_v, w.mass, w.modes, w.records, w.q and w.matrix.
    """
    n = conditions.n
    interleave(n, x, w.start_x)
    interleave(n, v, w.start_v)
    assembly.node_masses(chain, w.mass)
    assembly.linearize(chain, w.start_x, w.start_v, w.modes, w.segments, w.records, w.q)
    acceleration = winch.acceleration_at(conditions.reeling, time)
    assembly.add_rate_from_acceleration(chain, acceleration, x, w.records, w.q)
    if flow.flows(chain):
        flow.add_rates(chain, acceleration, winch.jerk_at(conditions.reeling, time), x, v, w.q)
    add_explicit_rates(conditions, chain, time, w)
    assemble(conditions, chain, GAMMA * h, x, v, w)
    if has_ground(chain.parameters):
        contact.add_rate(chain, acceleration, w, w.q)
        contact.add_end_motion(conditions, chain, time, w, w.q)


@kernel
def assemble(conditions, chain, d, x, v, w):
    """Matrix M/d - B - d K of a step from (x, v) into w.matrix, and which nodes touch the ground into w (both modified)."""
    assembly.assemble(chain.n, 1.0 / d, 1.0, d, w.mass, w.records, w.matrix)
    if flow.flows(chain):
        flow.subtract_slopes(chain, 1.0, d, w.matrix)
        flow.put_dampings(chain, w.dampings)
    if has_ground(chain.parameters):
        contact.find(conditions, chain, x, v, w)
        contact.subtract_slopes(chain, d, x, v, w)


@kernel
def stage_masses(chain, stage, changes, w):
    """Node masses at a stage [kg] into w.stage_mass (modified); changes : whether they differ from the start."""
    if stage == 0:
        copy(w.mass, w.stage_mass)
    elif changes:
        assembly.node_masses(chain, w.stage_mass)


@kernel
def stage_force(conditions, chain, time, w):
    """Forces at a stage [N] into w.force (modified), for the `Chain` at its time [s]."""
    assembly.node_forces(chain, w.modes, w.stage_x, w.stage_v, w.stage_mass, w.segments, w.force)
    if has_ground(chain.parameters):
        contact.add_forces(chain, w)
    put_interleaved(w.force, 0, add(get_interleaved(w.force, 0), pair(NEUTRAL_VECTOR, load_during(conditions, time))))


@kernel
def take_force_rate(conditions, time, w):
    """Explicit time derivative of M v' [N/s] into w.force_rate (modified): from the force rates, in w.q, and the mass rates.

    d(F/m)/dt = (dF/dt - F/m dm/dt)/m; w.force holds F at the start of the step.
    """
    n = conditions.n
    interleave(n, w.q, w.force_rate)
    if not winch.is_reeling(conditions.reeling):
        return
    chain = chain_during(conditions, time)
    for k in range(n // 2 + 1):
        mass = number_at(w.mass, 0, (k, n - k))
        of_tether = pair(growing_mass(chain, k, w.mass[k]), growing_mass(chain, n - k, w.mass[n - k]))
        rate = of_tether / mass * chain.reeling / chain.section
        put_interleaved(w.force_rate, k, sub(get_interleaved(w.force_rate, k), scale(rate, get_interleaved(w.force, k))))


@view
def add_up(start, factors, stage, k, w):
    """start + sum_j factors[stage, j] V_j of the nodes k and n - k, as pairs."""
    for j in range(stage):
        start = add_scaled(start, factors[stage, j], get_interleaved(w.velocities, STAGES * k + j))
    return start


@kernel
def combine(stage, h, w):
    """Sums over the earlier stages into w.stage_x, w.stage_v, w.r and w.inertia_velocity (modified).

    The argument of the last stage is already in w.stage_x, w.stage_v, where `add_stage` added U of the stage before.
    """
    alpha, gamma = ALPHA[stage], GAMMA_I[stage] / GAMMA
    for k in range(len(w.r) // 6):
        start = get_interleaved(w.start_v, k)
        if stage < STAGES - 1:
            move = add_up(scale(alpha, start), P, stage, k, w)
            put_interleaved(w.stage_x, k, add_scaled(get_interleaved(w.start_x, k), h, move))
            put_interleaved(w.stage_v, k, add_up(start, A, stage, k, w))
        put_interleaved(w.r, k, add_up(scale(gamma, start), R_BY_GAMMA, stage, k, w))
        put_interleaved(w.inertia_velocity, k, add_up(scale(gamma / GAMMA, start), INERTIA, stage, k, w))


@kernel
def select_end(sign, a, b):
    """Vector of pairs: a where `sign` > 0, b elsewhere."""
    return select(sign, a[0], b[0]), select(sign, a[1], b[1]), select(sign, a[2], b[2])


@kernel
def prescribe_ends(conditions, time, w):
    """Driven ends at a time [s] of the communication step into w.stage_x, w.stage_v; their r is 0 (all modified)."""
    ground, kite, is_driven = conditions.ground, conditions.kite, conditions.last == conditions.n - 1
    if conditions.first == 1 or is_driven:
        positions = pair(position_at(ground, time), position_at(kite, time))
        velocities = pair(velocity_at(ground, time), velocity_at(kite, time))
        driven = pair(1.0 if conditions.first == 1 else 0.0, 1.0 if is_driven else 0.0)
        put_interleaved(w.stage_x, 0, select_end(driven, positions, get_interleaved(w.stage_x, 0)))
        put_interleaved(w.stage_v, 0, select_end(driven, velocities, get_interleaved(w.stage_v, 0)))
        put_interleaved(w.r, 0, select_end(driven, pair(ZERO_VECTOR, ZERO_VECTOR), get_interleaved(w.r, 0)))


@kernel
def without_damping(n, stage, h, k, w):
    """F m_0/m + gamma_i h dF/dt + m_0 inertia_velocity/h of the nodes k and n - k [N], as pairs; w.force holds F."""
    mass = number_at(w.mass, 0, (k, n - k))
    force = scale(mass / number_at(w.stage_mass, 0, (k, n - k)), get_interleaved(w.force, k))
    force = add_scaled(force, GAMMA_I[stage] * h, get_interleaved(w.force_rate, k))
    return add_scaled(force, 1.0 / h * mass, get_interleaved(w.inertia_velocity, k))


@kernel
def right_hand_side(conditions, stage, h, w):
    """`without_damping` - B r of all nodes [N] into w.q (modified), from both ends at once; without flowing rope."""
    n = conditions.n
    from_outside = pair(ZERO_VECTOR, ZERO_VECTOR)
    r_p = get_interleaved(w.r, 0)
    for s in range((n + 1) // 2):  # the loop visits a middle segment twice
        r_q = next_interleaved(n, s, w.r)
        axial, drag = assembly.damping_product(s, -1.0, r_p, r_q, w.records)
        change = add(from_outside, add(drag, axial))
        put_two(w.q, s, n - s, add(without_damping(n, stage, h, s, w), change))
        from_outside = sub(drag, axial)
        r_p = r_q
    if n % 2 == 0:
        rest = first(without_damping(n, stage, h, n // 2, w))
        put(w.q, n // 2, add(rest, add(first(from_outside), second(from_outside))))
    if has_ground(conditions.parameters):
        contact.subtract_damping(n, w)


@kernel
def take_velocities(n, stage, w):
    """V of a stage into w.velocities (modified), from q in w.q."""
    for k in range(n // 2 + 1):
        put_interleaved(w.velocities, STAGES * k + stage, sub(get_two(w.q, k, n - k), get_interleaved(w.r, k)))


@kernel
def add_stage(n, stage, h, w):
    """Add U = (d q, V) of a stage to w.stage_x, w.stage_v (modified): argument and result of the last stage."""
    for k in range(n // 2 + 1):
        put_interleaved(w.stage_x, k, add_scaled(get_interleaved(w.stage_x, k), GAMMA * h, get_two(w.q, k, n - k)))
        put_interleaved(w.stage_v, k, add(get_interleaved(w.stage_v, k), get_interleaved(w.velocities, STAGES * k + stage)))


@kernel
def take_result(conditions, time, w):
    """Result of the step that ends at a time [s] of the communication step into w.x, w.v, w.velocity_error (modified)."""
    n = conditions.n
    deinterleave(n, w.stage_x, w.x)
    deinterleave(n, w.stage_v, w.v)
    place_ends(conditions, time, w.x, w.v)
    for k in range(n // 2 + 1):
        put_two(w.velocity_error, k, n - k, get_interleaved(w.velocities, STAGES * (k + 1) - 1))
