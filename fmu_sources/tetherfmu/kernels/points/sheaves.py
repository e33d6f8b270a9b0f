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

from math import sqrt

from ..compilation import kernel
from ..equations.lines import (
    comes_from,
    goes_on,
    is_at_point,
    lines_of,
    point_at,
    points_of,
    segments_of,
    sheaves_of,
)
from ..equations.rope_at_sheave import IN, OUT
from ..linear_algebra import small_matrix
from ..linear_algebra.vectors import add, dot, get, scale
from . import sheave_room as at_sheave
from .sheave_pulls import (
    acceleration_at_sheave,
    column_at_point,
    density_of,
    loss_at_stage,
    mass_of,
    number_of,
    stiffness_of,
    take_force_on_point,
)
from .sheave_room import (
    PULLED,
    array_at,
    numbers_at,
    runs_over,
    shared_of,
)

MOST_CORRECTIONS, BALANCED = 8, 1e-12  # of Newton's method for u'; what is left over the tensions when it has converged
TINY = 1e-200  # what keeps a quotient from 0/0


@kernel
def take_tensions(system, k, matrix, right):
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
        moved = acceleration_at_sheave(system, k)
        pull_2 += dot(col_2, moved)
        pull_1 += dot(col_1, moved)
    stiffness_1, stiffness_2 = stiffness_of(system, k), stiffness_of(system, k + 1)
    tension_2, tension_1 = tension_in(stiffness_2, pull_2), tension_in(stiffness_1, -pull_1)
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
def tension_in(stiffness, pull):
    """`rope_at_drum.tension_of` without a difference of numbers that are almost equal."""
    return pull if pull <= 0.0 else 2.0 * pull / (1.0 + sqrt(1.0 + 2.0 * pull / stiffness))


@kernel
def size_at(system, k):
    """Size of the forces at the sheave at the end of line k [N]."""
    numbers = numbers_at(system, k)
    return abs(numbers[at_sheave.TENSION_BEHIND]) + abs(numbers[at_sheave.TENSION_AHEAD]) + TINY


@kernel
def solve_gains(system, time):
    """u' of all sheaves over which rope runs, and the tensions at all sheaves of which pulls are known (modified)."""
    count, (matrix, _, right, _, _) = sheaves_of(system), shared_of(system)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            take_signs(system, k)
            if is_at_point(system, k, 1):
                take_force_on_point(system, k, time)
            if not runs_over(system, k):
                numbers_at(system, k)[at_sheave.GAIN] = 0.0
    for _ in range(MOST_CORRECTIONS):
        small_matrix.set_to_zero(count, matrix)
        pass_gains(system)
        left = 0.0
        for k in range(lines_of(system)):
            if goes_on(system, k):
                take_tensions(system, k, matrix, right)
                if runs_over(system, k):
                    left = max(left, abs(right[number_of(system, k)]) / size_at(system, k))
                else:
                    hold_row(system, k, matrix, right)
        if left <= BALANCED or not small_matrix.solve(count, matrix, right):
            break
        for k in range(lines_of(system)):
            if goes_on(system, k):
                numbers_at(system, k)[at_sheave.GAIN] += right[number_of(system, k)]
    pass_gains(system)


@kernel
def pass_gains(system):
    """Let portions behind sheaves have u' as the rate of their a (modified)."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers_at(system, k + 1)[at_sheave.INTO_GAIN] = numbers_at(system, k)[at_sheave.GAIN]
