"""Rodas4P: a Rosenbrock method of order 4 with 6 stages, L-stable, without order reduction at driven ends.

    u_i = y0 + sum_j a_ij U_j
    (1/(h gamma) - J) U_i = f(t0 + alpha_i h, u_i) + sum_j c_ij/h U_j + gamma_i h df/dt
    y1 = u_6 + U_6,   error estimate U_6 (embedded method u_6 of order 3)

Source: G. Steinebach, Order-reduction of ROW-methods for DAEs and method of lines applications, TH Darmstadt preprint
1741 (1995), in the transformed form of Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.7.

For the chain y = (x, v), f = (v, F/m). The positions are eliminated, with d = h gamma, U = (d q, V) and q = V + r:

    x_i = x0 + h (alpha_i v0 + sum_j P_ij V_j),   v_i = v0 + sum_j a_ij V_j
    r_i = (gamma_i v0 + sum_j R_ij V_j)/gamma
    (M/d - B - d K) q_i = F(x_i, v_i) + M (sum_j c_ij V_j/h + r_i/d) - B r_i + gamma_i h dF/dt

one block tridiagonal system with 3x3 blocks per stage. P = alpha (a + 1) and R = Gamma (a + 1) are made of the coefficients
alpha = a Gamma and Gamma = (1/gamma - c)^-1 of the usual form; F at a stage is multiplied by the mass of the start over that
of the stage.

Taut and slack: all stages of a step give a segment the stiffness that it has at the start of the step, so that the step sees
smooth equations; a step that goes too far beyond the kink is rejected (`kink_error`). See docs/theory.md, "Rosenbrock step".
"""

from math import ceil, inf, sqrt

import numpy as np

from tetherfmu.kernels.algebra.block_tridiagonal import factorize, solve
from tetherfmu.kernels.algebra.pairs import load_pair, pair, store_pair
from tetherfmu.kernels.algebra.vectors import add, along, dot, get, get_two, norm, put, put_two, scale, sub
from tetherfmu.kernels.chain import nodes, segment
from tetherfmu.kernels.communication.drive import place_ends
from tetherfmu.kernels.communication.driven_end import acceleration_at, velocity_at
from tetherfmu.kernels.compilation import kernel
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

GAMMA = 0.25
A = np.array(
    (
        (0.0, 0.0, 0.0, 0.0, 0.0),
        (3.0, 0.0, 0.0, 0.0, 0.0),
        (1.831036793486759, 0.4955183967433795, 0.0, 0.0, 0.0),
        (2.304376582692669, -0.05249275245743001, -1.176798761832782, 0.0, 0.0),
        (-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401, 0.0),
        (-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401, 1.0),
    )
)
C = np.array(
    (
        (0.0, 0.0, 0.0, 0.0, 0.0),
        (-12.0, 0.0, 0.0, 0.0, 0.0),
        (-8.791795173947035, -2.207865586973518, 0.0, 0.0, 0.0),
        (10.81793056857153, 6.780270611428266, 19.5348594464241, 0.0, 0.0),
        (34.19095006749676, 15.49671153725963, 54.7476087596413, 14.16005392148534, 0.0),
        (34.62605830930532, 15.30084976114473, 56.99955578662667, 18.40807009793095, -5.714285714285717),
    )
)
P = (  # of the stages 1 to 4; the last one has x_5 = x_4 + U_x4, v_5 = v_4 + V_4
    (0.75,),
    (0.45775919837168977, 0.12387959918584487),
    (0.6840395424985646, 0.003483796012626717, -0.2941996904581955),
    (-1.150635276145604, -1.318155133423187, -5.061696550612639, -0.26550101102785023),
)
R_BY_GAMMA = (  # R_ij/gamma of the stages 1 to 5
    (0.0,),
    (-0.36691199999999974, -0.056448),
    (3.216965637533963, 1.3668989638916995, 3.706916099773243),
    (7.743495620908387, 3.1987837164992916, 10.499408840403428, 2.478009436259934),
    (0.0, 0.0, 0.0, 0.0, -0.42857142857142927),
)
ALPHA = np.array((0.0, 0.75, 0.21, 0.63, 1.0, 1.0))
GAMMA_I = np.array((0.25, -0.5, -0.023504, -0.0362, 0.0, 0.0))

# factors of V_j in v_i (stages 1 to 4) and in the momentum sum_j c_ij V_j + r_i/gamma (stages 1 to 5)
A_ROWS = tuple(tuple(A[i, :i]) for i in range(1, at.STAGES - 1))
MOMENTUM = tuple(tuple(c + r / GAMMA for c, r in zip(C[i], R_BY_GAMMA[i - 1], strict=False)) for i in range(1, at.STAGES))

SAFETY = 0.9
KINK = 0.05  # measured: 0.25 costs more rejections for the same error, 0.005 loses accuracy on the circle and in scene 06
DAMPER = 0.01  # part of the largest tension; see `damper_error`
TINY = 1e-200
LARGEST_GROWTH = 5.0
STRONGEST_CUT = 0.2
SMALLEST_STEP = 1e-10  # part of the communication step


@kernel
def prepare(n, drive, time, h, x, v, parameters, w):
    """Matrix of the step, factorized, and the explicit time derivative of M v' [N/s]; False if it is singular.

    Modifies w.mass, w.branches, w.records, w.force_rate and the block arrays.
    """
    length = drive.length + drive.reeling * time
    nodes.node_masses(n, length, parameters, w.mass)
    nodes.linearize(n, x, v, length, drive.reeling, drive.wind, parameters, w.records, w.force_rate)
    if drive.first == 1:
        nodes.add_end_motion(
            n, False, velocity_at(drive.ground, time), acceleration_at(drive.ground, time), w.records, w.force_rate
        )
    if drive.last == n - 1:
        nodes.add_end_motion(
            n, True, velocity_at(drive.kite, time), acceleration_at(drive.kite, time), w.records, w.force_rate
        )
    for s in range(n):
        stretched = norm(sub(get(x, s + 1), get(x, s))) > nodes.rest_length(s, length, parameters)
        w.branches[s] = segment.TAUT if stretched else segment.SLACK
    d = GAMMA * h
    nodes.assemble(n, 1.0 / d, 1.0, d, w.mass, w.records, w.diagonal, w.lower, w.upper)
    return factorize(drive.first, drive.last, w.diagonal, w.lower, w.upper)


@kernel
def stage_force(n, drive, time, parameters, w):
    """Forces at a stage [N] into w.b and the node masses then [kg] into w.stage_mass (both modified)."""
    length = drive.length + drive.reeling * time
    nodes.node_masses(n, length, parameters, w.stage_mass)
    nodes.node_forces(n, w.branches, w.x_stage, w.v_stage, length, drive.reeling, drive.wind, w.stage_mass, parameters, w.b)
    put(w.b, n, add(get(w.b, n), drive.load))


@kernel
def correct_rate_for_mass(n, drive, time, parameters, w):
    """Complete w.force_rate (modified): d(F/m)/dt = (dF/dt - F/m dm/dt)/m; w.b holds F at the start of the step."""
    length = drive.length + drive.reeling * time
    points = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n
    for i in range(n + 1):
        growth = (w.mass[i] - parameters[points + i]) / w.mass[i] * drive.reeling / length
        for j in range(3 * i, 3 * i + 3):
            w.force_rate[j] -= growth * w.b[j]


@kernel
def add_up(start, factors, velocities, k):
    """start + sum_j factors_j V_j at the places k and k + 1 of all V_j, as a pair."""
    size = len(velocities) // at.STAGES
    for j in range(len(factors)):
        start = start + factors[j] * load_pair(velocities, np.uint64(size * j + k))
    return start


@kernel
def place_argument(in_position, in_velocity, alpha, h, x, v, w):
    """x_i and v_i of a stage into w.x_stage, w.v_stage (modified), two numbers at once.

    Factors of V_j in both, alpha_i.  The last pair may overlap the one before.
    """
    for k in range(0, len(x), 2):
        k = np.uint64(min(k, len(x) - 2))
        start = load_pair(v, k)
        position = load_pair(x, k) + h * add_up(alpha * start, in_position, w.velocities, k)
        velocity = add_up(start, in_velocity, w.velocities, k)
        store_pair(w.x_stage, k, position)
        store_pair(w.v_stage, k, velocity)


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
    """Add up the stages before this one into w.x_stage, w.v_stage, w.r and w.momentum (modified).

    The last stage finds its argument in w.x_stage, w.v_stage, where `add_stage` has put U of the one before.
    """
    alpha = ALPHA[stage]
    gamma = GAMMA_I[stage] / GAMMA
    if stage == 0:
        for k in range(len(x)):
            w.x_stage[k] = x[k]
            w.v_stage[k] = v[k]
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
    """F m_0/m + gamma_i h dF/dt + m_0 momentum/h of all nodes [N] into w.b (modified), which holds F."""
    rate = GAMMA_I[stage] * h
    per_h = 1.0 / h
    for i in range(n // 2 + 1):  # a node in the middle is met twice
        j = n - i
        mass = pair(w.mass[i], w.mass[j])
        force = scale(mass / pair(w.stage_mass[i], w.stage_mass[j]), get_two(w.b, i, j))
        force = along(force, rate, get_two(w.force_rate, i, j))
        put_two(w.b, i, j, along(force, per_h * mass, get_two(w.momentum, i, j)))


@kernel
def solve_stage(n, drive, stage, h, w):
    """Solve for q into w.b and V into its place in w.velocities (modified); w.b holds F."""
    add_right_hand_side(n, stage, h, w)
    still = (0.0, 0.0, 0.0)
    if drive.first == 1:
        put(w.r, 0, still)
    if drive.last == n - 1:
        put(w.r, n, still)
    nodes.add_damping_product(n, -1.0, w.r, w.records, w.b)
    solve(drive.first, drive.last, w.diagonal, w.lower, w.upper, w.b)
    if drive.first == 1:
        put(w.b, 0, still)
    if drive.last == n - 1:
        put(w.b, n, still)
    size = len(w.b)
    velocities = w.velocities[size * stage : size * (stage + 1)]
    for k in range(size):
        velocities[k] = w.b[k] - w.r[k]


@kernel
def add_stage(stage, h, w):
    """Add U = (d q, V) of a stage to w.x_stage, w.v_stage (modified): the argument of the last stage, and its result."""
    size = len(w.b)
    velocities = w.velocities[size * stage : size * (stage + 1)]
    for k in range(size):
        w.x_stage[k] += GAMMA * h * w.b[k]
        w.v_stage[k] += velocities[k]


@kernel
def step(n, drive, time, h, x, v, parameters, w):
    """One step of h [s] from (x, v) at a time [s] of the communication step; False if the matrix is singular.

    The result stands in w.x_stage, w.v_stage, its error estimate U in w.b = U_x/d and in the last of w.velocities.
    """
    if not prepare(n, drive, time, h, x, v, parameters, w):
        return False
    for stage in range(at.STAGES):
        combine(stage, h, x, v, w)
        now = time + ALPHA[stage] * h
        place_ends(n, drive, now, w.x_stage, w.v_stage)
        stage_force(n, drive, now, parameters, w)
        if stage == 0 and drive.reeling != 0.0:
            correct_rate_for_mass(n, drive, time, parameters, w)
        solve_stage(n, drive, stage, h, w)
        if stage >= at.STAGES - 2:
            add_stage(stage, h, w)
    place_ends(n, drive, time + h, w.x_stage, w.v_stage)
    return True


@kernel
def error_norm(n, drive, h, position_scale, velocity_scale, w):
    """Root mean square of the error estimate of `step` over the allowed error of positions [m] and velocities [m/s]."""
    size = 3 * (n + 1)
    error = w.velocities[size * (at.STAGES - 1) :]
    squares = 0.0
    velocity_squares = 0.0
    for k in range(size):
        squares += w.b[k] * w.b[k]
        velocity_squares += error[k] * error[k]
    squares = squares * (GAMMA * h / position_scale) ** 2 + velocity_squares / velocity_scale**2
    return sqrt(squares / (6 * (drive.last - drive.first + 1)))


@kernel
def lighter_free_node(s, drive, w):
    """Smaller mass [kg] of the two nodes of a segment, of those that are free."""
    return min(w.mass[s] if s >= drive.first else inf, w.mass[s + 1] if s + 1 <= drive.last else inf)


@kernel
def kink_error(n, drive, length, h, parameters, w):
    """Estimate of the velocity error [m/s] of a step of h [s] in which segments went over the kink at l = l0.

    Overshoot |l - l0| times the wrong part of the stiffness, acting on the lighter free node for a part KINK of the step;
    `length` is the unstretched length of the tether [m] at its end.
    """
    worst = 0.0
    for s in range(n):
        rest = nodes.rest_length(s, length, parameters)
        r = sub(get(w.x_stage, s + 1), get(w.x_stage, s))
        if (dot(r, r) - rest * rest) * w.branches[s] < 0.0:
            taut, _ = segment.stiffness(segment.TAUT, rest, s, n, parameters)
            slack, _ = segment.stiffness(segment.SLACK, rest, s, n, parameters)
            over = abs(norm(r) - rest)
            worst = max(worst, KINK * h * (taut - slack) * over / lighter_free_node(s, drive, w))
    return worst


@kernel
def damper_error(n, drive, length, parameters, w):
    """Largest error estimate of a damper's tension in the last step as a velocity [m/s]: c |e.dv|/sqrt(k m).

    dv is the difference of the error estimates of the two nodes, sqrt(k m) the impedance of the taut segment with the mass
    of the lighter free node. A step in which it is more than the velocity error allowed is rejected if this tension is also
    more than DAMPER times the largest one (`relative_damper_error`). Without it the velocities of a stiff damper are allowed
    errors that, times c, are kilonewtons. `length` is the unstretched length of the tether [m] at the end of the step.
    """
    size = 3 * (n + 1)
    error = w.velocities[size * (at.STAGES - 1) :]
    worst = 0.0  # squared
    for s in range(n):
        r = sub(get(w.x_stage, s + 1), get(w.x_stage, s))
        rest = nodes.rest_length(s, length, parameters)
        k, _ = segment.stiffness(segment.TAUT, 1.0, s, n, parameters)  # times l0
        _, c = segment.stiffness(w.branches[s], 1.0, s, n, parameters)  # times l0
        wrong = c * dot(r, sub(get(error, s + 1), get(error, s)))  # times l0 l
        worst = max(worst, wrong * wrong / (k * rest * lighter_free_node(s, drive, w) * dot(r, r) + TINY))
    return sqrt(worst)


@kernel
def relative_damper_error(n, drive, length, parameters, w):
    """Largest error estimate of a damper's tension in the last step, see `damper_error`, over the largest tension [-]."""
    size = 3 * (n + 1)
    error = w.velocities[size * (at.STAGES - 1) :]
    worst = 0.0
    largest = TINY
    for s in range(n):
        stretched, e = segment.geometry(sub(get(w.x_stage, s + 1), get(w.x_stage, s)))
        rest = nodes.rest_length(s, length, parameters)
        k, c = segment.stiffness(w.branches[s], rest, s, n, parameters)
        rate = dot(e, sub(get(w.v_stage, s + 1), get(w.v_stage, s)))
        tension = segment.tension(stretched, rate, rest, drive.reeling / length, k, c, parameters)
        largest = max(largest, abs(tension))
        worst = max(worst, c * abs(dot(e, sub(get(error, s + 1), get(error, s)))))
    return worst / largest


@kernel
def allowed_errors(n, drive, v, parameters):
    """Error that one step may make in a position [m] and in a velocity [m/s] at the tolerance in the parameters.

    relative_tolerance times the mean segment length, and times the largest of: node speed, wind speed and the speed
    after falling freely over one segment.
    """
    tolerance = parameters[at.RELATIVE_TOLERANCE]
    segment_length = drive.length / n
    square = max(2.0 * parameters[at.GRAVITY] * segment_length, dot(drive.wind, drive.wind))
    for i in range(n + 1):
        square = max(square, dot(get(v, i), get(v, i)))
    return tolerance * segment_length, tolerance * sqrt(square) + 1e-12


@kernel
def growth(error, last_error):
    """Factor for the next step [-] from the error estimates of the last two accepted steps (PI rule).

    Source: Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.2.
    """
    factor = SAFETY * max(error, 1e-10) ** -0.175 * max(last_error, 1e-4) ** 0.1
    return min(LARGEST_GROWTH, max(STRONGEST_CUT, factor))


@kernel
def integrate(n, drive, duration, state, x, v, parameters, w):
    """Advance (x, v) (modified) over a communication step of `duration` [s] with steps chosen by the error estimate.

    Solver memory and counters in `state` are modified. Returns a status: OK, STEP_BUDGET_SPENT or STEP_TOO_SMALL.
    """
    time = 0.0
    h = state[at.SOLVER_STEP]
    last_error = state[at.SOLVER_ERROR]
    if h <= 0.0:
        h = duration
        last_error = 1.0
    budget = at.WORK_BUDGET // n
    tried = 0
    rejected_before = False
    while time < duration:
        if tried >= budget:
            return STEP_BUDGET_SPENT
        if h < SMALLEST_STEP * duration:
            return STEP_TOO_SMALL
        tried += 1
        rest = duration - time
        left = ceil(rest / h - 1e-6)
        h_now = rest / left if left > 1.0 else rest
        position_scale, velocity_scale = allowed_errors(n, drive, v, parameters)
        error = inf
        if step(n, drive, time, h_now, x, v, parameters, w):
            error = error_norm(n, drive, h_now, position_scale, velocity_scale, w)
            length = drive.length + drive.reeling * (time + h_now)
            damper = damper_error(n, drive, length, parameters, w) / velocity_scale
            if damper > 1.0:
                relative = relative_damper_error(n, drive, length, parameters, w)
                damper = min(damper, relative / DAMPER)
            error = max(error, damper)
            kink = kink_error(n, drive, length, h_now, parameters, w) / velocity_scale
            if kink > 1.0:
                error = max(error, kink * kink)  # it falls with h^2, the other estimate with h^4
        if error <= 1.0:
            time = time + h_now if left > 1.0 else duration
            for k in range(3 * (n + 1)):
                x[k] = w.x_stage[k]
                v[k] = w.v_stage[k]
            proposal = h_now * growth(error, last_error)
            if rejected_before:
                proposal = min(proposal, h_now)
            h = max(proposal, h) if h_now < h and not rejected_before else proposal
            last_error = error
            rejected_before = False
            state[at.STEPS] += 1.0
        else:
            rejected_before = True
            cut = 0.1 if not error < inf else max(STRONGEST_CUT, SAFETY * error**-0.25)
            h = h_now * min(cut, 0.9)
            state[at.REJECTIONS] += 1.0
    state[at.SOLVER_STEP] = h
    state[at.SOLVER_ERROR] = last_error
    return OK
