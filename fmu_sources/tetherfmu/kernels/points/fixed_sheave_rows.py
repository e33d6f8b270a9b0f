"""Ropes over sheaves in an iteration of a fixed step: what they pull at its end, and how that changes with all that moves.

    T_2 + T_2^2/(2 EA) = R_a of the portion ahead,   T_1 + T_1^2/(2 EA) = - R_b of the one behind,
    v = (x - x0)/h,   v' = (v - v0)/h,   u' = (u - u0)/h

(`equations/rope_at_sheave.py`). Lines and points are solved for minus the gradient g of Phi, and for minus its change with
the speed u_s of each sheave,

    A p = -g,   A Z_s = -dg/du_s,   move = p + sum_s (u_s' - u_s) Z_s

so that T_1, T_2 and the angle of wrap change by what p does, kept in the numbers of the sheave, and by a row of slopes by
the speeds of all sheaves (`sheave_room.slopes_of`). `fixed_sheaves.py` has the equations of the sheaves.
"""

from ..arrays import clear
from ..compilation import kernel
from ..equations import rope_at_sheave as rope
from ..equations.boundary import hold_ends
from ..equations.drum import force_at
from ..equations.end_motion import acceleration_at
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import comes_from, goes_on, is_even, is_rope, is_turned, stiffness_of
from ..linear_algebra.vectors import add, add_at, dot, get, put, scale, sub
from . import sheave_room as at_sheave
from .coordinates import coordinate_at, count_of, is_drum, number_of, own_numbers, portions_of, weight_of
from .running_drums import drum_with_lines
from .sheave_border import pivot_of, row_times, solve_column
from .sheave_pulls import loss_with, take_segments, tension_in
from .sheave_room import (
    ACCELERATIONS,
    BORDER,
    SOLUTIONS,
    VELOCITIES,
    numbers_at,
    part_of,
    parts_of,
    portion_gaining,
    single_at,
    slopes_of,
)
from .sheave_slopes import close_row, take_row, turn_of
from .system_fixed_drums import put_reeling_column
from .system_room import scratch_of

# --- rows


@kernel
def take_motion(system, k, step):
    """VELOCITIES and ACCELERATIONS of the nodes of portion k in the iteration (modified)."""
    conditions, w, (_, v), end = conditions_of(system, k), scratch_of(system, k), motion_of(system, k), step.time + step.h
    velocities, accelerations = single_at(system, k, VELOCITIES), single_at(system, k, ACCELERATIONS)
    for i in range(conditions.n + 1):
        velocity = scale(1.0 / step.h, sub(get(w.x, i), get(w.old, i)))
        put(velocities, i, velocity)
        if conditions.first <= i <= conditions.last:
            put(accelerations, i, scale(1.0 / step.h, sub(velocity, get(v, i))))
        else:
            put(accelerations, i, acceleration_at(conditions.kite if i > 0 else conditions.ground, end))


@kernel
def take_pulls(system, k):
    """PULL, INERTIA and BORDER of portion k in the iteration (modified)."""
    numbers, w, border = numbers_at(system, k), scratch_of(system, k), single_at(system, k, BORDER)
    parts, accelerations = parts_of(system, k), single_at(system, k, ACCELERATIONS)
    chain, nodes = portion_gaining(system, k, 1.0), (w.x, single_at(system, k, VELOCITIES), w.held)
    given = is_even(system, k), parts[chain.n], nodes
    (pull_a, pull_b), (own_aa, own_ab, own_bb) = take_segments(chain, False, *given, border, border)
    for i in range(chain.n + 1):
        along = dot(get(border, i), get(accelerations, i))
        pull_a += parts[i] * along
        pull_b += (1.0 - parts[i]) * along
    into, leaving = numbers[at_sheave.INTO_GAIN], chain.leaving_gain
    numbers[at_sheave.PULL] = pull_a - own_aa * into - own_ab * leaving
    numbers[at_sheave.PULL + 1] = pull_b - own_ab * into - own_bb * leaving
    numbers[at_sheave.INERTIA], numbers[at_sheave.INERTIA + 1], numbers[at_sheave.INERTIA + 2] = own_aa, own_ab, own_bb


@kernel
def is_sought(system, k, side):
    """Whether a or b of portion k is that of coordinates."""
    return goes_on(system, k) if side == OUT else (comes_from(system, k) or is_turned(system, k))


@kernel
def take_portion(system, k, step):
    """Pulls and rows of portion k in the iteration (modified)."""
    w = scratch_of(system, k)
    take_motion(system, k, step)
    take_pulls(system, k)
    nodes = w.x, single_at(system, k, VELOCITIES), w.held
    if is_sought(system, k, IN):
        take_row(system, k, IN, 1.0, nodes)
        close_row(system, k, IN, 1.0, step.h)
    if goes_on(system, k):
        take_row(system, k, OUT, 1.0, nodes)
        close_row(system, k, OUT, 1.0, step.h)


# --- columns


@kernel
def put_column(system, k, side, step, column):
    """-dg/du for the speed u of rope at an end of portion k into an array (modified)."""
    w, chain, part = scratch_of(system, k), portion_gaining(system, k, 1.0), 1.0
    velocities, border = single_at(system, k, VELOCITIES), single_at(system, k, BORDER)
    sign, parts = 1.0 if side == IN else -1.0, parts_of(system, k)
    put_reeling_column(system, k, step, column)
    for i in range(len(column)):
        column[i] = sign * column[i] + part_of(parts, side, i // 3) * border[i] / step.h
    own, is_uniform = rope.rope_of(chain, 0), is_even(system, k)
    for s in range(chain.n):
        r, u = sub(get(w.x, s + 1), get(w.x, s)), sub(get(velocities, s + 1), get(velocities, s))
        if not is_uniform:
            own = rope.rope_of(chain, s)
        c = rope.flowing(chain, part, part - own.share)
        of_p, of_q = rope.force_by_rate(own, rope.passing(own, part, side), c, r, u)
        along = scale(sign * step.h, rope.force_by_length(own, c, r))
        add_at(column, s, add(of_p, along))
        add_at(column, s + 1, sub(of_q, along))
        part -= own.share
    hold_ends(conditions_of(system, k), column)


@kernel
def solve_columns(system, step):
    """Z of all coordinates (modified); the matrices of lines and points are factorized."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        for k in range(lines_of(system)):
            column = single_at(system, k, SOLUTIONS + j)
            clear(column)
            for side in (IN, OUT):
                weight = weight_of(system, c, k, side)
                if weight != 0.0:
                    put_column(system, k, side, step, column)
                    for i in range(len(column)):
                        column[i] *= weight
        solve_column(system, j, True)


@kernel
def add_columns(system, k):
    """Add what the changes of all speeds do to the move of line k (modified)."""
    move = scratch_of(system, k).move
    for j in range(count_of(system)):
        change = own_numbers(system, coordinate_at(system, j))[at_sheave.CHANGE]
        if change != 0.0:
            column = single_at(system, k, SOLUTIONS + j)
            for i in range(len(move)):
                move[i] += change * column[i]


# --- tensions and wrap


@kernel
def wrap_times(turns, n, behind, ahead):
    """Change of an angle of wrap with moves of the nodes of both portions; turns : its slopes by those beside the sheave."""
    by_1, by_2 = turns
    return dot(by_1, sub(get(behind, n - 1), get(behind, n))) + dot(by_2, sub(get(ahead, 1), get(ahead, 0)))


@kernel
def add_rates_of_pull(system, k, side, slope, slopes, row):
    """Add slopes by the rates of portion k to a row of slopes by all speeds (modified); slope : by R_a or R_b there."""
    numbers, h = numbers_at(system, k), slope[1]
    for other in (IN, OUT):
        if is_sought(system, k, other):
            by_rate = -slope[0] * pivot_of(numbers, side, other, h)
            for j in range(count_of(system)):
                weight = weight_of(system, coordinate_at(system, j), k, other)
                if weight != 0.0:
                    slopes[row + j] += weight * by_rate


@kernel
def tension_at(system, k, side):
    """Tension at an end of portion k in the iteration [N], and its slope by R_a or R_b there [-]."""
    stiffness, sign = stiffness_of(system, k), 1.0 if side == IN else -1.0
    tension = tension_in(stiffness, sign * numbers_at(system, k)[at_sheave.PULL + side])
    return tension, sign / (1.0 + max(tension, 0.0) / stiffness)


@kernel
def away_from_sheave(system, k):
    """Vectors away from the sheave at the end of line k along both portions in the iteration [m]."""
    n, x_1, x_2 = segments_of(system, k), scratch_of(system, k).x, scratch_of(system, k + 1).x
    return sub(get(x_1, n - 1), get(x_1, n)), sub(get(x_2, 1), get(x_2, 0))


@kernel
def take_tensions(system, c, step):
    """T_1, T_2, E of a coordinate, and how the moves p change them, into its numbers (modified).

    T_2 of a drum is the sum of the tensions of its lines times their ratios, T_1 is W + c u.
    """
    numbers, h, size = own_numbers(system, c), step.h, 0.0
    for i in range(2):
        numbers[at_sheave.TENSION_BEHIND + i] = numbers[at_sheave.MOVED_BEHIND + i] = 0.0
    for k in range(*portions_of(system, c)):
        for side in (IN, OUT):
            weight = weight_of(system, c, k, side)
            if weight != 0.0:
                (tension, slope), ahead = tension_at(system, k, side), 1 - side
                moved = weight * slope / h * row_times(system, k, side, scratch_of(system, k).move)
                numbers[at_sheave.TENSION_BEHIND + ahead] += weight * tension
                numbers[at_sheave.MOVED_BEHIND + ahead] += moved
                size += abs(weight * tension)
                if is_drum(system, c):
                    numbers_at(system, k)[at_sheave.TENSION_IN] = tension
    if is_drum(system, c):
        drum = drum_with_lines(system, c)
        motor = force_at(drum, step.time + h)
        numbers[at_sheave.TENSION_BEHIND] = motor + drum.damping * numbers[at_sheave.STAGE_SPEED]
        numbers[at_sheave.BEHIND] = size + abs(motor) + drum.friction
        numbers[at_sheave.MOVED_WRAP] = 0.0
    else:
        to_1, to_2 = away_from_sheave(system, c)
        turns = turn_of(to_1, to_2), turn_of(to_2, to_1)
        moves = scratch_of(system, c).move, scratch_of(system, c + 1).move
        numbers[at_sheave.LOSS] = loss_with(system, c, to_1, to_2)
        numbers[at_sheave.MOVED_WRAP] = wrap_times(turns, segments_of(system, c), *moves)


@kernel
def take_slopes(system, c, step):
    """How tensions and wrap at a coordinate change with the speeds of all coordinates (modified)."""
    count, h, (slopes_1, slopes_2, slopes_wrap) = count_of(system), step.h, slopes_of(system)
    row = count * number_of(system, c)
    for j in range(row, row + count):
        slopes_1[j] = slopes_2[j] = slopes_wrap[j] = 0.0
    for k in range(*portions_of(system, c)):
        for side in (IN, OUT):
            weight = weight_of(system, c, k, side)
            if weight != 0.0:
                _, slope = tension_at(system, k, side)
                slope, slopes = weight * slope, slopes_2 if side == IN else slopes_1
                for j in range(count):
                    slopes[row + j] += slope / h * row_times(system, k, side, single_at(system, k, SOLUTIONS + j))
                add_rates_of_pull(system, k, side, (slope, h), slopes, row)
    if is_drum(system, c):
        slopes_1[row + number_of(system, c)] = drum_with_lines(system, c).damping
    else:
        to_1, to_2 = away_from_sheave(system, c)
        turns = turn_of(to_1, to_2), turn_of(to_2, to_1)
        for j in range(count):
            columns = single_at(system, c, SOLUTIONS + j), single_at(system, c + 1, SOLUTIONS + j)
            slopes_wrap[row + j] = wrap_times(turns, segments_of(system, c), *columns)


@kernel
def change_in(system, k, h):
    """Change of the tension where line k leaves drums [N] with the whole move and the changes of all speeds."""
    total = row_times(system, k, IN, scratch_of(system, k).move) / h
    for other in (IN, OUT):
        if is_sought(system, k, other):
            by_rate = pivot_of(numbers_at(system, k), IN, other, h)
            for j in range(count_of(system)):
                c = coordinate_at(system, j)
                total -= by_rate * weight_of(system, c, k, other) * own_numbers(system, c)[at_sheave.CHANGE]
    _, slope = tension_at(system, k, IN)
    return slope * total


@kernel
def take_sheaves(system, step):
    """Tensions and angles of wrap at all coordinates in the iteration, and how the moves p change them (modified)."""
    for k in range(lines_of(system)):
        if is_rope(system, k):
            take_portion(system, k, step)
    for j in range(count_of(system)):
        take_tensions(system, coordinate_at(system, j), step)


@kernel
def take_all_slopes(system, step):
    """Z of all coordinates, and how tensions and wrap at all of them change with the speeds (modified)."""
    solve_columns(system, step)
    for j in range(count_of(system)):
        take_slopes(system, coordinate_at(system, j), step)
