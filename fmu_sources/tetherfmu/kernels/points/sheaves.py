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

from ..compilation import kernel
from ..equations.lines import (
    comes_from,
    is_at_point,
    is_turned,
    lines_of,
    point_at,
    segments_of,
    sheaves_of,
    stiffness_of,
)
from ..equations.rope_at_sheave import IN, OUT
from ..linear_algebra import small_matrix
from ..linear_algebra.vectors import dot, get, put_at
from . import running_drums
from . import sheave_room as at_sheave
from .coordinates import (
    coordinate_at,
    count_of,
    first_portion,
    is_drum,
    last_portion,
    number_of,
    own_numbers,
    runs,
    weight_of,
)
from .sheave_pulls import (
    acceleration_at_sheave,
    couple,
    couple_at_point,
    density_of,
    force_on_point,
    loss_at_stage,
    mass_of,
    pull_with,
    tension_in,
)
from .sheave_room import PULLED, from_drums, numbers_at, shared_of, single_at, slopes_of

MOST_CORRECTIONS, BALANCED = 8, 1e-13  # of Newton's method for u'; what is left over the tensions when it has converged
TINY = 1e-200  # what keeps a quotient from 0/0


@kernel
def mass_at(system, c):
    """m [kg] of a sheave or a drum."""
    return running_drums.mass_of_drum(system, c) if is_drum(system, c) else mass_of(system, c)


@kernel
def inertia_of(system, c):
    """m [kg] of a sheave or a drum with that of the rope which it moves past nodes at rest."""
    inertia = 0.0
    for k in range(first_portion(system, c), last_portion(system, c) + 1):
        for side in (IN, OUT):
            weight = weight_of(system, c, k, side)
            if weight != 0.0:
                inertia += weight * weight * numbers_at(system, k)[at_sheave.INERTIA + 2 * side]
    return inertia + mass_at(system, c)


@kernel
def take_tensions(system, c, time, matrix, right):
    """Tensions and f of a coordinate with the present u', and its row of the matrix (all modified).

    The row: slopes of f by all u' [kg]; `right` gets -f [N].
    """
    if is_drum(system, c):
        running_drums.take_tensions(system, c, time, matrix, right)
    else:
        take_tensions_at_sheave(system, c, matrix, right)


@kernel
def take_pulls_at_sheave(system, k):
    """R_b of portion k and R_a of the next one with the present u', and their slopes by all u' (modified)."""
    numbers, count, (slopes_1, slopes_2, _) = numbers_at(system, k), count_of(system), slopes_of(system)
    j = number_of(system, k)
    pull_1, pull_2 = pull_with(system, k, OUT), pull_with(system, k + 1, IN)
    for i in range(count * j, count * (j + 1)):
        slopes_1[i] = slopes_2[i] = 0.0
    couple(system, j, k, OUT, 1.0, slopes_1)
    couple(system, j, k + 1, IN, 1.0, slopes_2)
    if is_at_point(system, k, 1):
        col_1, col_2 = get(single_at(system, k, PULLED), segments_of(system, k)), get(single_at(system, k + 1, PULLED), 0)
        moved, point = acceleration_at_sheave(system, k), point_at(system, k, 1)
        pull_1 += dot(col_1, moved)
        pull_2 += dot(col_2, moved)
        couple_at_point(system, j, point, col_1, slopes_1)
        couple_at_point(system, j, point, col_2, slopes_2)
    numbers[at_sheave.PULL_BEHIND], numbers[at_sheave.PULL_AHEAD] = pull_1, pull_2


@kernel
def change_pulls(system, changes):
    """Let R_b and R_a at all sheaves (modified) change with all u' [m/s2]."""
    count, (slopes_1, slopes_2, _) = count_of(system), slopes_of(system)
    for j in range(sheaves_of(system)):
        numbers = numbers_at(system, coordinate_at(system, j))
        for i in range(count):
            numbers[at_sheave.PULL_BEHIND] += slopes_1[count * j + i] * changes[i]
            numbers[at_sheave.PULL_AHEAD] += slopes_2[count * j + i] * changes[i]


@kernel
def take_tensions_at_sheave(system, k, matrix, right):
    """The same of the sheave at the end of line k: T_1 and T_2."""
    numbers, count, (slopes_1, slopes_2, _) = numbers_at(system, k), count_of(system), slopes_of(system)
    stiffness_1, stiffness_2, mass, j = (
        stiffness_of(system, k),
        stiffness_of(system, k + 1),
        mass_of(system, k),
        number_of(system, k),
    )
    tension_1 = tension_in(stiffness_1, -numbers[at_sheave.PULL_BEHIND])
    tension_2 = tension_in(stiffness_2, numbers[at_sheave.PULL_AHEAD])
    numbers[at_sheave.TENSION_AHEAD], numbers[at_sheave.TENSION_BEHIND] = tension_2, tension_1
    moving = density_of(system, k) * numbers[at_sheave.STAGE_SPEED] ** 2
    e_1 = numbers[at_sheave.BEHIND] if tension_1 > moving else 1.0
    e_2 = numbers[at_sheave.AHEAD] if tension_2 > moving else 1.0
    right[j] = -(e_2 * (tension_2 - moving) - e_1 * (tension_1 - moving) - mass * numbers[at_sheave.GAIN])
    by_2 = e_2 / (1.0 + max(tension_2, 0.0) / stiffness_2)
    by_1 = e_1 / (1.0 + max(tension_1, 0.0) / stiffness_1)
    for i in range(count * j, count * (j + 1)):
        matrix[i] = by_1 * slopes_1[i] + by_2 * slopes_2[i]
    matrix[count * j + j] -= mass


@kernel
def hold_row(system, c, matrix, right):
    """Let the equation of a coordinate say that it gains no speed (modified)."""
    count, j = count_of(system), number_of(system, c)
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
def size_at(system, c):
    """Size of the forces at a coordinate [N]."""
    numbers = own_numbers(system, c)
    if is_drum(system, c):
        return numbers[at_sheave.BEHIND] + TINY
    return abs(numbers[at_sheave.TENSION_BEHIND]) + abs(numbers[at_sheave.TENSION_AHEAD]) + TINY


@kernel
def begin_gains(system, time):
    """What of coordinates stays while their u' are sought (modified): signs of friction, forces on free points."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if is_drum(system, c):
            running_drums.take_forces_on_points(system, c, time)
        else:
            take_signs(system, c)
            if is_at_point(system, c, 1):
                put_at(numbers_at(system, c), at_sheave.FORCE, force_on_point(system, point_at(system, c, 1), time))
        if not runs(system, c):
            own_numbers(system, c)[at_sheave.GAIN] = 0.0


@kernel
def solve_gains(system, time):
    """u' of all coordinates that run, and the tensions at all of which pulls are known (modified)."""
    count, (matrix, _, right, _, _) = count_of(system), shared_of(system)
    begin_gains(system, time)
    pass_gains(system)
    for j in range(sheaves_of(system)):
        take_pulls_at_sheave(system, coordinate_at(system, j))
    for _ in range(MOST_CORRECTIONS):
        small_matrix.set_to_zero(count, matrix)
        left = 0.0
        for j in range(count):
            c = coordinate_at(system, j)
            take_tensions(system, c, time, matrix, right)
            if runs(system, c):
                left = max(left, abs(right[j]) / size_at(system, c))
            else:
                hold_row(system, c, matrix, right)
        if left <= BALANCED or not small_matrix.solve(count, matrix, right):
            break
        for j in range(count):
            own_numbers(system, coordinate_at(system, j))[at_sheave.GAIN] += right[j]
        change_pulls(system, right)
        pass_gains(system)


@kernel
def pass_gains(system):
    """Let portions behind sheaves and at drums have u' as the rate of their a (modified)."""
    for k in range(lines_of(system)):
        if comes_from(system, k):
            numbers_at(system, k)[at_sheave.INTO_GAIN] = numbers_at(system, k - 1)[at_sheave.GAIN]
        elif is_turned(system, k):
            numbers_at(system, k)[at_sheave.INTO_GAIN] = from_drums(system, k, at_sheave.GAIN)
