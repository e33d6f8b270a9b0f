"""How rope gains speed over sheaves: their equation at a stage of a Rosenbrock step, and what it does to nodes.

Rope runs at the rate u from portion 1 to portion 2 over a sheave of the inertia m (J/r2):

    m u' = e_2 (T_2 - mu u^2) - e_1 (T_1 - mu u^2),   T_2 + T_2^2/(2 EA) = R_a of portion 2,  T_1 + ... = - R_b of portion 1
    e_1 = E, e_2 = 1 where it runs forwards, e_1 = 1, e_2 = E backwards,   E = exp(friction wrap)/efficiency
    E counts as 1 where T - mu u^2 is not above 0
    cos wrap = - d_1 . d_2,  d: directions of the two segments away from the sheave

(`equations/rope_at_sheave.py`). R_a and R_b depend on the accelerations of nodes, which are (F + sum over sheaves of
col u')/mass: a small system of equations for all u', solved by Newton's method as T is not quite linear in R. A free point
has all of its lines, and all sheaves there. See `sheave_border.py` for how this stands in the matrix of a step.
"""

from math import atan2, exp

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel
from ..equations import rope_at_sheave as rope
from ..equations import segment, winch
from ..equations.end_motion import acceleration_at
from ..equations.lines import (
    comes_from,
    conditions_of,
    goes_on,
    is_at_point,
    is_portion,
    lines_of,
    load_at,
    parameters_of,
    point_at,
    points_of,
    segments_of,
    sheaves_of,
)
from ..equations.properties import property_of
from ..equations.rope_at_drum import tension_of
from ..equations.rope_at_sheave import IN, OUT
from ..line.rodas4p import ALPHA, GAMMA, GAMMA_I, INERTIA, R_BY_GAMMA, STAGES, A, P
from ..linear_algebra import small_matrix
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, cross, dot, get, norm, put, scale, sub
from . import sheave_room as at_sheave
from .sheave_room import (
    BORDER,
    PULLED,
    array_at,
    gain_of,
    is_coordinate,
    is_running,
    numbers_at,
    portion_in_step,
    runs_over,
    shared_of,
    winch_of,
)
from .system_room import integrator_of, shares_of

MOST_CORRECTIONS, ENOUGH = 8, 1e-9  # of Newton's method for u', and a relative change after which it has converged


@kernel
def mass_of(system, k):
    """m of the sheave at the end of line k [kg]."""
    return parameters_of(system, k)[at.SHEAVE_MASS]


@kernel
def stiffness_of(system, k):
    """EA [N] of line k."""
    return property_of(conditions_of(system, k), 0, at.STIFFNESS)


@kernel
def density_of(system, k):
    """mu [kg/m] of line k."""
    return property_of(conditions_of(system, k), 0, at.LINE_DENSITY)


@kernel
def wrap_of(towards_1, towards_2):
    """Angle of wrap [rad] from the vectors away from a sheave along both portions."""
    _, d_1 = segment.geometry(towards_1)
    _, d_2 = segment.geometry(towards_2)
    return atan2(norm(cross(d_1, d_2)), -dot(d_1, d_2))


@kernel
def has_friction(system, k):
    """Whether the sheave at the end of line k has losses."""
    parameters = parameters_of(system, k)
    return parameters[at.SHEAVE_FRICTION] > 0.0 or parameters[at.SHEAVE_EFFICIENCY] != 1.0


@kernel
def loss_with(system, k, towards_1, towards_2):
    """E [-] of the sheave at the end of line k with these vectors."""
    parameters = parameters_of(system, k)
    grip = parameters[at.SHEAVE_FRICTION]
    grip = exp(grip * wrap_of(towards_1, towards_2)) if grip > 0.0 else 1.0
    return grip / parameters[at.SHEAVE_EFFICIENCY]


@kernel
def loss_at_stage(system, k):
    """The same at a stage."""
    if not has_friction(system, k):
        return 1.0
    n, x_1, x_2 = segments_of(system, k), integrator_of(system, k).stage_x, integrator_of(system, k + 1).stage_x
    here = get_node(n, n, x_1)
    return loss_with(system, k, sub(get_node(n, n - 1, x_1), here), sub(get_node(segments_of(system, k + 1), 1, x_2), here))


@kernel
def number_sheaves(system):
    """Number all sheaves (modified) in the order of their lines."""
    count = 0
    for k in range(lines_of(system)):
        numbers_at(system, k)[at_sheave.NUMBER] = count
        count += goes_on(system, k)


@kernel
def number_of(system, k):
    """Number of the sheave at the end of line k."""
    return int(numbers_at(system, k)[at_sheave.NUMBER])


# --- to a stage


@kernel
def added_up(start, factors, stage, speeds):
    """start + sum_j factors[stage, j] U_j."""
    for j in range(stage):
        start += factors[stage, j] * speeds[j]
    return start


@kernel
def go_to_stage(system, stage, time, h):
    """Rope that has passed, speeds, lengths of all running sheaves and portions (modified) at a stage; False: no length."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers, speeds = numbers_at(system, k), shares_of(system, k).speeds
            speed = numbers[at_sheave.SPEED]
            if not runs_over(system, k):
                numbers[at_sheave.PASSED] = numbers[at_sheave.STAGE_SPEED] = numbers[at_sheave.GAIN] = 0.0
                numbers[at_sheave.REST] = numbers[at_sheave.ADDED_UP] = 0.0
                continue
            numbers[at_sheave.REST] = added_up(GAMMA_I[stage] / GAMMA * speed, R_BY_GAMMA, stage, speeds)
            numbers[at_sheave.ADDED_UP] = added_up(GAMMA_I[stage] / GAMMA * speed / GAMMA, INERTIA, stage, speeds)
            if stage < STAGES - 1:
                numbers[at_sheave.PASSED] = h * added_up(ALPHA[stage] * speed, P, stage, speeds)
                numbers[at_sheave.STAGE_SPEED] = added_up(speed, A, stage, speeds)
    return take_lengths(system, time, time + ALPHA[stage] * h)


@kernel
def take_lengths(system, start, time):
    """Lengths and a of the portions (modified) at a time [s], from a step that began at `start` [s]; False: no length."""
    lost = 0
    for k in range(lines_of(system)):
        if is_portion(system, k):
            numbers = numbers_at(system, k)
            length = numbers[at_sheave.LENGTH_NOW]
            if comes_from(system, k):
                before = numbers_at(system, k - 1)
                length += before[at_sheave.PASSED]
                numbers[at_sheave.INTO] = before[at_sheave.STAGE_SPEED]
            else:
                paid = winch_of(system, k)
                length += winch.length_at(paid, time) - winch.length_at(paid, start)
                numbers[at_sheave.INTO] = winch.rate_at(paid, time)
                numbers[at_sheave.INTO_GAIN] = winch.gain_at(paid, time)
            if goes_on(system, k):
                length -= numbers[at_sheave.PASSED]
            numbers[at_sheave.LENGTH] = length
            lost += not length > 0.0
    return lost == 0


# --- forces and inertias of a portion


@kernel
def take_pulls(system, k, time):
    """PULL and YIELD of portion k at a stage, once its forces are known, and PULLED (all modified); rope's own inertia back.

    Without what its ends add where they are free points. The forces on its nodes get what a winch that gains speed does.
    """
    conditions, numbers, w = conditions_of(system, k), numbers_at(system, k), integrator_of(system, k)
    into, out = array_at(system, k, PULLED, IN), array_at(system, k, PULLED, OUT)
    chain, n, part = portion_in_step(system, k), conditions.n, 1.0
    lowest, highest = get_node(n, 0, w.stage_x)[2], get_node(n, n, w.stage_x)[2]
    pull_a = rope.of_speed(chain, 0, rope.passing(chain, 0, part, IN), numbers[at_sheave.INTO])
    pull_b = rope.of_speed(chain, n - 1, rope.passing(chain, n - 1, part, OUT), chain.leaving)
    own_aa, own_ab, own_bb, below_a, below_b = 0.0, 0.0, 0.0, ZERO_VECTOR, ZERO_VECTOR
    for s in range(n):
        x_p, x_q = get_node(n, s, w.stage_x), get_node(n, s + 1, w.stage_x)
        r, u = sub(x_q, x_p), sub(get_node(n, s + 1, w.stage_v), get_node(n, s, w.stage_v))
        a, b, c = rope.passing(chain, s, part, IN), rope.passing(chain, s, part, OUT), rope.flowing(chain, s, part)
        height = segment.mean_height(x_p, x_q)
        pull_a += rope.pull(chain, s, a, c, w.modes[s], r, u, height - lowest)
        pull_b += rope.pull(chain, s, b, c, w.modes[s], r, u, height - highest)
        square = dot(r, r)
        own_aa += rope.inertia(chain, s, a, a, square)
        own_ab += rope.inertia(chain, s, a, b, square)
        own_bb += rope.inertia(chain, s, b, b, square)
        of_p, of_q = rope.columns(chain, s, a, r)
        put(into, s, add(below_a, of_p))
        below_a = of_q
        of_p, of_q = rope.columns(chain, s, b, r)
        put(out, s, add(below_b, of_p))
        below_b = of_q
        part -= property_of(chain, s, at.SHARE)
    put(into, n, below_a)
    put(out, n, below_b)
    if not comes_from(system, k) and numbers[at_sheave.INTO_GAIN] != 0.0:
        gain = numbers[at_sheave.INTO_GAIN]
        for i in range(n + 1):
            add_to_node(n, i, scale(gain, get(into, i)), w.force)
        pull_a -= own_aa * gain
        pull_b -= own_ab * gain
    yield_aa, yield_ab, yield_bb = -own_aa, -own_ab, -own_bb
    for i in range(1, n):
        share, force, col_a, col_b = 1.0 / w.stage_mass[i], get_node(n, i, w.force), get(into, i), get(out, i)
        pull_a += share * dot(col_a, force)
        pull_b += share * dot(col_b, force)
        yield_aa += share * dot(col_a, col_a)
        yield_ab += share * dot(col_a, col_b)
        yield_bb += share * dot(col_b, col_b)
    if conditions.first == 1:
        pull_a += dot(get(into, 0), acceleration_at(conditions.ground, time))
    if conditions.last == n - 1:
        pull_b += dot(get(out, n), acceleration_at(conditions.kite, time))
    numbers[at_sheave.PULL], numbers[at_sheave.PULL + 1] = pull_a, pull_b
    numbers[at_sheave.YIELD], numbers[at_sheave.YIELD + 1], numbers[at_sheave.YIELD + 2] = yield_aa, yield_ab, yield_bb
    return own_aa, own_ab, own_bb


@kernel
def force_on_point(system, point, time):
    """Force on a free point [N] at a stage but for what sheaves that gain speed add: of all lines, and of the load."""
    total = load_at(system, point, time)
    for k in range(lines_of(system)):
        n, w = segments_of(system, k), integrator_of(system, k)
        for end in range(2):
            if is_at_point(system, k, end) and point_at(system, k, end) == point:
                total = add(total, get_node(n, n * end, w.force))
    return total


@kernel
def column_at_point(system, k):
    """What the sheave at the end of line k does to its point per u' [kg] at a stage."""
    return add(get(array_at(system, k, PULLED, OUT), segments_of(system, k)), get(array_at(system, k + 1, PULLED, IN), 0))


@kernel
def acceleration_of_point(system, point, time):
    """Acceleration of a free point [m/s2] at a stage, with what the sheaves there do."""
    total = force_on_point(system, point, time)
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k) and point_at(system, k, 1) == point:
            total = add_scaled(total, numbers_at(system, k)[at_sheave.GAIN], column_at_point(system, k))
    return scale(1.0 / points_of(system).stage_mass[point], total)


# --- the equations of all sheaves


@kernel
def take_tensions(system, k, time, matrix, right):
    """T_1, T_2 and f of the sheave at the end of line k with the present u', and its row of the matrix (all modified).

    The row: slopes of f by all u' [kg]; `right` gets -f [N].
    """
    numbers, behind, count, j = numbers_at(system, k), numbers_at(system, k + 1), sheaves_of(system), number_of(system, k)
    pull_2, pull_1 = behind[at_sheave.PULL], numbers[at_sheave.PULL + 1]
    own_2, own_1, at_end = behind[at_sheave.YIELD], numbers[at_sheave.YIELD + 2], is_at_point(system, k, 1)
    col_2, col_1 = get(array_at(system, k + 1, PULLED, IN), 0), get(array_at(system, k, PULLED, OUT), segments_of(system, k))
    gain = numbers[at_sheave.GAIN]
    pull_2 += own_2 * gain
    pull_1 += own_1 * gain
    if comes_from(system, k):
        pull_1 += numbers[at_sheave.YIELD + 1] * numbers[at_sheave.INTO_GAIN]
    if goes_on(system, k + 1):
        pull_2 += behind[at_sheave.YIELD + 1] * behind[at_sheave.GAIN]
    point = point_at(system, k, 1)
    if at_end:
        moved = acceleration_of_point(system, point, time)
        pull_2 += dot(col_2, moved)
        pull_1 += dot(col_1, moved)
    stiffness_1, stiffness_2 = stiffness_of(system, k), stiffness_of(system, k + 1)
    tension_2, tension_1 = tension_of(stiffness_2, pull_2), tension_of(stiffness_1, -pull_1)
    numbers[at_sheave.TENSION_AHEAD], numbers[at_sheave.TENSION_BEHIND] = tension_2, tension_1
    moving = density_of(system, k) * numbers[at_sheave.STAGE_SPEED] ** 2
    e_1 = numbers[at_sheave.BEHIND] if tension_1 > moving else 1.0
    e_2 = numbers[at_sheave.AHEAD] if tension_2 > moving else 1.0
    right[j] = -(e_2 * (tension_2 - moving) - e_1 * (tension_1 - moving) - mass_of(system, k) * gain)
    by_2 = e_2 / (1.0 + max(tension_2, 0.0) / stiffness_2)
    by_1 = e_1 / (1.0 + max(tension_1, 0.0) / stiffness_1)
    matrix[count * j + j] += by_2 * own_2 + by_1 * own_1 - mass_of(system, k)
    if comes_from(system, k):
        matrix[count * j + j - 1] += by_1 * numbers[at_sheave.YIELD + 1]
    if goes_on(system, k + 1):
        matrix[count * j + j + 1] += by_2 * behind[at_sheave.YIELD + 1]
    if at_end:
        share = 1.0 / points_of(system).stage_mass[point]
        both = scale(share, add(scale(by_2, col_2), scale(by_1, col_1)))
        for other in range(lines_of(system)):
            if goes_on(system, other) and point_at(system, other, 1) == point:
                matrix[count * j + number_of(system, other)] += dot(both, column_at_point(system, other))


@kernel
def hold_row(system, k, matrix, right):
    """Let the equation of the sheave at the end of line k say that it gains no speed (modified)."""
    count, j = sheaves_of(system), number_of(system, k)
    for i in range(count):
        matrix[count * j + i] = 0.0
    matrix[count * j + j] = 1.0
    right[j] = 0.0


@kernel
def take_signs(system, k):
    """e_1 and e_2 of the sheave at the end of line k at a stage (modified)."""
    numbers, loss = numbers_at(system, k), loss_at_stage(system, k)
    sign = numbers[at_sheave.SIGN]
    numbers[at_sheave.BEHIND] = loss if sign > 0.0 else 1.0
    numbers[at_sheave.AHEAD] = loss if sign < 0.0 else 1.0


@kernel
def solve_gains(system, time):
    """u' of all sheaves over which rope runs, and the tensions at all sheaves of which pulls are known (modified)."""
    count, (matrix, _, right, _, _) = sheaves_of(system), shared_of(system)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            take_signs(system, k)
            if not runs_over(system, k):
                numbers_at(system, k)[at_sheave.GAIN] = 0.0
    for _ in range(MOST_CORRECTIONS):
        small_matrix.set_to_zero(count, matrix)
        pass_gains(system)
        for k in range(lines_of(system)):
            if goes_on(system, k):
                take_tensions(system, k, time, matrix, right)
                if not runs_over(system, k):
                    hold_row(system, k, matrix, right)
        if not small_matrix.solve(count, matrix, right):
            break
        largest, change = 0.0, 0.0
        for k in range(lines_of(system)):
            if goes_on(system, k):
                numbers, more = numbers_at(system, k), right[number_of(system, k)]
                numbers[at_sheave.GAIN] += more
                largest, change = max(largest, abs(numbers[at_sheave.GAIN])), max(change, abs(more))
        if change <= ENOUGH * largest:
            break
    pass_gains(system)


@kernel
def pass_gains(system):
    """Let portions behind sheaves have u' as the rate of their a (modified)."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers_at(system, k + 1)[at_sheave.INTO_GAIN] = numbers_at(system, k)[at_sheave.GAIN]


# --- a stage


@kernel
def accelerate(system, stage, time):
    """u' of all sheaves at a stage at a time [s], and the right-hand sides with it (modified)."""
    for k in range(lines_of(system)):
        if is_running(system, k):
            own = take_pulls(system, k, time)
            if stage == 0:
                numbers = numbers_at(system, k)
                numbers[at_sheave.INERTIA], numbers[at_sheave.INERTIA + 1], numbers[at_sheave.INERTIA + 2] = own
                for side in (IN, OUT):
                    copy(array_at(system, k, PULLED, side), array_at(system, k, BORDER, side))
    solve_gains(system, time)
    if stage == 0:
        take_slopes(system)
    for k in range(lines_of(system)):
        if is_running(system, k):
            cross_nodes(system, k)
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            take_right(system, k, time)
    if stage > 0:
        for k in range(lines_of(system)):
            if is_running(system, k):
                push_nodes(system, k)


@kernel
def take_slopes(system):
    """Slopes of the equations of all running sheaves by R_a and - R_b at the start of the step, and e there (modified)."""
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            numbers = numbers_at(system, k)
            moving = density_of(system, k) * numbers[at_sheave.SPEED] ** 2
            if numbers[at_sheave.TENSION_BEHIND] <= moving:
                numbers[at_sheave.BEHIND] = 1.0
            if numbers[at_sheave.TENSION_AHEAD] <= moving:
                numbers[at_sheave.AHEAD] = 1.0
            of_1 = max(numbers[at_sheave.TENSION_BEHIND], 0.0) / stiffness_of(system, k)
            of_2 = max(numbers[at_sheave.TENSION_AHEAD], 0.0) / stiffness_of(system, k + 1)
            numbers[at_sheave.OF_BEHIND] = numbers[at_sheave.BEHIND] / (1.0 + of_1)
            numbers[at_sheave.OF_AHEAD] = numbers[at_sheave.AHEAD] / (1.0 + of_2)


@kernel
def gained_force(system, k, i, which):
    """Force on node i of portion k [N] with what rope that gains speed over running sheaves adds; which : BORDER, PULLED."""
    total = get_node(segments_of(system, k), i, integrator_of(system, k).force)
    for side in (IN, OUT):
        if is_coordinate(system, k, side):
            total = add_scaled(total, gain_of(system, k, side), get(array_at(system, k, which, side), i))
    return total


@kernel
def cross_nodes(system, k):
    """CROSSED of portion k at a stage (modified)."""
    numbers, w = numbers_at(system, k), integrator_of(system, k)
    a, b = array_at(system, k, BORDER, IN), array_at(system, k, BORDER, OUT)
    of_a, of_b = 0.0, 0.0
    for i in range(1, segments_of(system, k)):
        gained = scale(1.0 / w.stage_mass[i], gained_force(system, k, i, PULLED))
        of_a += dot(get(a, i), gained)
        of_b += dot(get(b, i), gained)
    numbers[at_sheave.CROSSED], numbers[at_sheave.CROSSED + 1] = of_a, of_b


@kernel
def inertia_times(system, k, which):
    """Sum over the running sheaves of the inertia of the sheave at the end of line k at the start of the step [N], [kg m/s].

    which : what of a sheave it is multiplied by, GAIN or ADDED_UP.
    """
    numbers, behind = numbers_at(system, k), numbers_at(system, k + 1)
    of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
    own = of_2 * behind[at_sheave.INERTIA] + of_1 * numbers[at_sheave.INERTIA + 2] + mass_of(system, k)
    total = own * numbers[which]
    if is_coordinate(system, k, IN):
        total += of_1 * numbers[at_sheave.INERTIA + 1] * numbers_at(system, k - 1)[which]
    if is_coordinate(system, k + 1, OUT):
        total += of_2 * behind[at_sheave.INERTIA + 1] * behind[which]
    return total


@kernel
def take_right(system, k, time):
    """Right-hand side of a stage of the sheave at the end of line k from all accelerations (modified)."""
    numbers, behind, n = numbers_at(system, k), numbers_at(system, k + 1), segments_of(system, k)
    of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
    total = inertia_times(system, k, at_sheave.GAIN)
    total -= of_2 * behind[at_sheave.CROSSED] + of_1 * numbers[at_sheave.CROSSED + 1]
    if is_at_point(system, k, 1):
        col = add(
            scale(of_1, get(array_at(system, k, BORDER, OUT), n)), scale(of_2, get(array_at(system, k + 1, BORDER, IN), 0))
        )
        total -= dot(col, acceleration_of_point(system, point_at(system, k, 1), time))
    numbers[at_sheave.RIGHT] = total


@kernel
def push_nodes(system, k):
    """Let the forces of portion k (modified) have what u' of its sheaves does: col u', and - col_0 u' of M_0, by masses."""
    conditions, w, points = conditions_of(system, k), integrator_of(system, k), points_of(system)
    n = conditions.n
    for side in (IN, OUT):
        if is_coordinate(system, k, side):
            gain, pulled, border = (
                gain_of(system, k, side),
                array_at(system, k, PULLED, side),
                array_at(system, k, BORDER, side),
            )
            for i in range(conditions.first, conditions.last + 1):
                ratio, end = w.stage_mass[i] / w.mass[i], 0 if i == 0 else 1
                if (i == 0 or i == n) and is_at_point(system, k, end):
                    point = point_at(system, k, end)
                    ratio = points.stage_mass[point] / points.mass[point]
                add_to_node(n, i, add_scaled(scale(gain, get(pulled, i)), -gain * ratio, get(border, i)), w.force)
