"""One step of the Rosenbrock method Rodas4P (`rodas4p.py`) for the chain, y = (x, v), f = (v, F/m).

The positions are eliminated, with d = h gamma, U = (d q, V) and q = V + r:

    x_i = x0 + h (alpha_i v0 + sum_j P_ij V_j),   v_i = v0 + sum_j a_ij V_j
    r_i = (gamma_i v0 + sum_j R_ij V_j)/gamma
    (M/d - B - d K) q_i = F(x_i, v_i) + M (sum_j c_ij V_j/h + r_i/d) - B r_i + gamma_i h dF/dt

one block tridiagonal system with 3x3 blocks per stage. F at a stage is multiplied by the mass of the start over that of the
stage.

Taut and slack: all stages of a step give a segment the stiffness that it has at the start of the step, so that the step sees
smooth equations; a step that goes too far beyond the kink is rejected (`step_control.kink_error`). See docs/numerics.md,
"Rosenbrock step".
"""

from collections import namedtuple

import numpy as np

from tetherfmu.runtime import layout as at

from ..algebra.block_tridiagonal import Matrix, factorize, solve
from ..algebra.both_ends import get_two, put_two
from ..algebra.pairs import load_pair, pair, store_pair
from ..algebra.vectors import add, along, get, norm, put, scale, sub
from ..arrays import node_arrays, shared_arrays
from ..chain import nodes, segment
from ..chain.properties import point_mass, rest_length
from ..communication.drive import chain_during, hold_ends, load_during, place_ends
from ..communication.driven_end import acceleration_at, velocity_at
from ..compilation import kernel, view
from .rodas4p import A_ROWS, ALPHA, GAMMA, GAMMA_I, MOMENTUM, R_BY_GAMMA, P

Stages = namedtuple(
    "Stages", "x v r momentum q force_rate velocities velocity_error matrix records mass stage_mass branches"
)
Stages.__doc__ = """Scratch arrays of a step; 3 (n + 1) numbers where nothing else is said.

x, v : argument of the stage [m], [m/s]; after the step its result.  r, momentum : what `combine` adds up [m/s].
q : force [N], right-hand side [N], then the solution q of a stage; after the step the error estimate of x over d [m/s].
force_rate : explicit time derivative of M v' [N/s].  velocities : V of all stages [m/s], `layout.STAGES` times 3 (n + 1).
velocity_error : the last V, the error estimate of v [m/s].  matrix, records, mass : see `arrays.shared_arrays`; at the start
of the step.  stage_mass : node masses at the stage [kg], n + 1.  branches : n, which stiffness each segment has, see
`segment.TAUT`.
"""


@view
def stages(n, work):
    """Cut the work array into the arrays of `Stages`."""
    blocks, records, mass, room = shared_arrays(n, work)
    x, v, r, momentum, q, force_rate, room = node_arrays(n, room)
    last = 3 * (n + 1) * at.STAGES
    velocities, error, room = room[:last], room[last - 3 * (n + 1) : last], room[last:]
    stage_mass, branches = room[: n + 1], room[n + 1 : 2 * n + 1]
    matrix = Matrix(*blocks)
    return Stages(x, v, r, momentum, q, force_rate, velocities, error, matrix, records, mass, stage_mass, branches)


@kernel
def prepare(drive, time, h, x, v, w):
    """Matrix of the step, factorized, and the explicit time derivative of M v' [N/s]; False if it is singular.

    Modifies w.mass, w.branches, w.records, w.force_rate and w.matrix.
    """
    n = drive.n
    chain = chain_during(drive, time)
    nodes.node_masses(chain, w.mass)
    nodes.linearize(chain, x, v, w.records, w.force_rate)
    nodes.add_rate_from_acceleration(chain, drive.acceleration, x, w.records, w.force_rate)
    put(w.force_rate, n, add(get(w.force_rate, n), drive.load_rate))
    if drive.first == 1:
        end, rate = velocity_at(drive.ground, time), acceleration_at(drive.ground, time)
        nodes.add_end_motion(n, False, end, rate, w.records, w.force_rate)
    if drive.last == n - 1:
        end, rate = velocity_at(drive.kite, time), acceleration_at(drive.kite, time)
        nodes.add_end_motion(n, True, end, rate, w.records, w.force_rate)
    for s in range(n):
        stretched = norm(sub(get(x, s + 1), get(x, s))) > rest_length(chain, s)
        w.branches[s] = segment.TAUT if stretched else segment.SLACK
    d = GAMMA * h
    nodes.assemble(n, 1.0 / d, 1.0, d, w.mass, w.records, w.matrix)
    return factorize(drive.first, drive.last, w.matrix)


@kernel
def stage_force(drive, time, w):
    """Forces at a stage [N] into w.q and the node masses then [kg] into w.stage_mass (both modified)."""
    chain = chain_during(drive, time)
    nodes.node_masses(chain, w.stage_mass)
    nodes.node_forces(chain, w.branches, w.x, w.v, w.stage_mass, w.q)
    put(w.q, drive.n, add(get(w.q, drive.n), load_during(drive, time)))


@kernel
def correct_rate_for_mass(chain, w):
    """Complete w.force_rate (modified): d(F/m)/dt = (dF/dt - F/m dm/dt)/m; w.q holds F at the start of the step."""
    for i in range(chain.n + 1):
        rate = (w.mass[i] - point_mass(chain, i)) / w.mass[i] * chain.reeling / chain.length
        for j in range(3 * i, 3 * i + 3):
            w.force_rate[j] -= rate * w.q[j]


@kernel
def add_up(start, factors, velocities, k):
    """start + sum_j factors_j V_j at the places k and k + 1 of all V_j, as a pair."""
    size = len(velocities) // at.STAGES
    for j in range(len(factors)):
        start = start + factors[j] * load_pair(velocities, np.uint64(size * j + k))
    return start


@kernel
def place_argument(in_position, in_velocity, alpha, h, x, v, w):
    """x_i and v_i of a stage into w.x, w.v (modified), two numbers at once.

    Factors of V_j in both, alpha_i.  The last pair may overlap the one before.
    """
    for k in range(0, len(x), 2):
        k = np.uint64(min(k, len(x) - 2))
        start = load_pair(v, k)
        position = load_pair(x, k) + h * add_up(alpha * start, in_position, w.velocities, k)
        velocity = add_up(start, in_velocity, w.velocities, k)
        store_pair(w.x, k, position)
        store_pair(w.v, k, velocity)


@kernel
def place_right(in_r, in_momentum, gamma, v, w):
    """r_i and momentum of a stage into w.r, w.momentum (modified): factors of V_j in both, gamma_i/gamma of the stage."""
    for k in range(0, len(v), 2):
        k = np.uint64(min(k, len(v) - 2))
        start = gamma * load_pair(v, k)
        r = add_up(start, in_r, w.velocities, k)
        momentum = add_up(1.0 / GAMMA * start, in_momentum, w.velocities, k)
        store_pair(w.r, k, r)
        store_pair(w.momentum, k, momentum)


@kernel
def combine(stage, h, x, v, w):
    """Add up the stages before this one into w.x, w.v, w.r and w.momentum (modified).

    The last stage finds its argument in w.x, w.v, where `add_stage` has put U of the one before.
    """
    alpha = ALPHA[stage]
    gamma = GAMMA_I[stage] / GAMMA
    if stage == 0:
        for k in range(len(x)):
            w.x[k] = x[k]
            w.v[k] = v[k]
            w.r[k] = v[k]
            w.momentum[k] = v[k] / GAMMA
    elif stage == 1:
        place_argument(P[0], A_ROWS[0], alpha, h, x, v, w)
        place_right(R_BY_GAMMA[0], MOMENTUM[0], gamma, v, w)
    elif stage == 2:
        place_argument(P[1], A_ROWS[1], alpha, h, x, v, w)
        place_right(R_BY_GAMMA[1], MOMENTUM[1], gamma, v, w)
    elif stage == 3:
        place_argument(P[2], A_ROWS[2], alpha, h, x, v, w)
        place_right(R_BY_GAMMA[2], MOMENTUM[2], gamma, v, w)
    elif stage == 4:
        place_argument(P[3], A_ROWS[3], alpha, h, x, v, w)
        place_right(R_BY_GAMMA[3], MOMENTUM[3], gamma, v, w)
    else:
        place_right(R_BY_GAMMA[4], MOMENTUM[4], gamma, v, w)


@kernel
def add_right_hand_side(n, stage, h, w):
    """F m_0/m + gamma_i h dF/dt + m_0 momentum/h of all nodes [N] into w.q (modified), which holds F."""
    rate = GAMMA_I[stage] * h
    per_h = 1.0 / h
    for i in range(n // 2 + 1):  # a node in the middle is met twice
        j = n - i
        mass = pair(w.mass[i], w.mass[j])
        force = scale(mass / pair(w.stage_mass[i], w.stage_mass[j]), get_two(w.q, i, j))
        force = along(force, rate, get_two(w.force_rate, i, j))
        put_two(w.q, i, j, along(force, per_h * mass, get_two(w.momentum, i, j)))


@kernel
def solve_stage(drive, stage, h, w):
    """Solve for q into w.q and V into its place in w.velocities (modified); w.q holds F."""
    add_right_hand_side(drive.n, stage, h, w)
    hold_ends(drive, w.r)
    nodes.add_damping_product(drive.n, -1.0, w.r, w.records, w.q)
    solve(drive.first, drive.last, w.matrix, w.q)
    hold_ends(drive, w.q)
    size = len(w.q)
    velocities = w.velocities[size * stage : size * (stage + 1)]
    for k in range(size):
        velocities[k] = w.q[k] - w.r[k]


@kernel
def add_stage(stage, h, w):
    """Add U = (d q, V) of a stage to w.x, w.v (modified): the argument of the last stage, and its result."""
    size = len(w.q)
    velocities = w.velocities[size * stage : size * (stage + 1)]
    for k in range(size):
        w.x[k] += GAMMA * h * w.q[k]
        w.v[k] += velocities[k]


@kernel
def step(drive, time, h, x, v, w):
    """One step of h [s] from (x, v) at a time [s] of the communication step; False if the matrix is singular.

    The result stands in w.x, w.v, its error estimate U in w.q = U_x/d and in w.velocity_error.
    """
    if not prepare(drive, time, h, x, v, w):
        return False
    for stage in range(at.STAGES):
        combine(stage, h, x, v, w)
        now = time + ALPHA[stage] * h
        place_ends(drive, now, w.x, w.v)
        stage_force(drive, now, w)
        if stage == 0 and (drive.reeling != 0.0 or drive.acceleration != 0.0):
            correct_rate_for_mass(chain_during(drive, time), w)
        solve_stage(drive, stage, h, w)
        if stage >= at.STAGES - 2:
            add_stage(stage, h, w)
    place_ends(drive, time + h, w.x, w.v)
    return True
