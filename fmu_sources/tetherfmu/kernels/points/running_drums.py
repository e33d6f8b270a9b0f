"""Drums that turn beside sheaves, or that hold several lines with ratios: their equation at a stage of a Rosenbrock step.

A drum of the mass m (J/r2) that turns at the speed u pays out each line that it holds at r u, with the ratio r of the line:

    m u' = sum of r T - W - c u - F sign(u),   T + T^2/(2 EA) = R_a of the first portion of each line

(`equations/rope_at_sheave.py`), as the power of all lines is u sum of r T. Without mass the sum of r T is
W + c u + F sign(u) at every instant. With one line and r = 1 it is the drum of `rope_drums.py`. See `coordinates.py` for
what it has in common with a sheave.
Theory: docs/models/theory.md, "Several lines on a drum".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..equations.drum import drum_of, force_at
from ..equations.free_points import is_at_point, point_at
from ..equations.lines import conditions_of, lines_of, parameters_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import stiffness_of
from ..line.drum_events import OVERLOAD
from ..linear_algebra.vectors import dot, get, put_at, scale, vector_at
from . import sheave_room as at_sheave
from .coordinates import count_of, is_drum, line_of, number_of, own_numbers, runs, weight_of
from .sheave_pulls import acceleration_with, couple, couple_at_point, force_on_point, has_losses, pull_with, tension_in
from .sheave_room import BORDER, PULLED, numbers_at, single_at, through


@view
def drum_with_lines(system, c):
    """`Drum` of a coordinate."""
    conditions = conditions_of(system, line_of(system, c))
    return drum_of(conditions.parameters, conditions.force, conditions.force_rate)


@kernel
def mass_of_drum(system, c):
    """m of a drum [kg]."""
    return parameters_of(system, line_of(system, c))[at.WINCH_MASS]


@kernel
def friction_of_drum(system, c):
    """F of a drum [N]."""
    return parameters_of(system, line_of(system, c))[at.WINCH_FRICTION]


@kernel
def has_friction(system, c):
    """Whether friction may hold a coordinate."""
    return friction_of_drum(system, c) > 0.0 if is_drum(system, c) else has_losses(system, c)


@kernel
def urges(system, c, behind, ahead, loss):
    """Forces [N] with which tensions pull a coordinate forwards and backwards beyond what holds it; a margin of these.

    behind, ahead : T_1, T_2 [N].  loss : E of a sheave.
    """
    if is_drum(system, c):
        pull, friction = ahead - behind, friction_of_drum(system, c)
        return pull - friction, -pull - friction, OVERLOAD * own_numbers(system, c)[at_sheave.BEHIND]
    margin = OVERLOAD * (abs(behind) + abs(ahead))
    return ahead - behind - (loss - 1.0) * max(behind, 0.0), behind - ahead - (loss - 1.0) * max(ahead, 0.0), margin


@kernel
def take_forces_on_points(system, c, time):
    """Forces at a stage on the free points where lines of a drum begin, see `sheave_pulls.force_on_point` (modified)."""
    for k in range(lines_of(system)):
        if weight_of(system, c, k, IN) != 0.0 and is_at_point(system, k, 0):
            put_at(numbers_at(system, k), at_sheave.FORCE_IN, force_on_point(system, point_at(system, k, 0), time))


@kernel
def take_tensions(system, c, time, matrix, right):
    """Tensions where the lines leave a drum, and f with the present u', and its row of the matrix (all modified).

    As `sheaves.take_tensions`.
    """
    numbers, drum, j, total, size = own_numbers(system, c), drum_with_lines(system, c), number_of(system, c), 0.0, 0.0
    for k in range(lines_of(system)):
        weight = weight_of(system, c, k, IN)
        if weight != 0.0:
            pull, col, point = pull_with(system, k, IN), get(single_at(system, k, PULLED), 0), point_at(system, k, 0)
            if is_at_point(system, k, 0):
                pull += dot(col, acceleration_with(system, point, vector_at(numbers_at(system, k), at_sheave.FORCE_IN)))
            tension = tension_in(stiffness_of(system, k), pull)
            numbers_at(system, k)[at_sheave.TENSION_IN] = tension
            total += weight * tension
            size += abs(weight * tension)
            slope = weight / (1.0 + max(tension, 0.0) / stiffness_of(system, k))
            couple(system, j, k, IN, slope, matrix)
            if is_at_point(system, k, 0):
                couple_at_point(system, j, point, scale(slope, col), matrix)
    motor, mass = force_at(drum, time), mass_of_drum(system, c)
    counter = motor + drum.damping * numbers[at_sheave.STAGE_SPEED]
    numbers[at_sheave.TENSION_AHEAD], numbers[at_sheave.TENSION_BEHIND] = total, counter
    numbers[at_sheave.BEHIND] = size + abs(motor) + drum.friction
    gain = numbers[at_sheave.GAIN]
    right[j] = -(total - counter - drum.friction * numbers[at_sheave.SIGN] - mass * gain)
    matrix[count_of(system) * j + j] -= mass


@kernel
def take_slopes(system, c):
    """Slopes of the tensions of the lines of a drum by R_a at the start of the step (modified)."""
    for k in range(lines_of(system)):
        if runs(system, c) and weight_of(system, c, k, IN) != 0.0:
            numbers = numbers_at(system, k)
            numbers[at_sheave.OF_IN] = 1.0 / (1.0 + max(numbers[at_sheave.TENSION_IN], 0.0) / stiffness_of(system, k))


@kernel
def inertia_times(system, c, which):
    """Sum over the running coordinates of the inertia at a drum, as `sheave_stages.inertia_times`."""
    total = mass_of_drum(system, c) * own_numbers(system, c)[which]
    for k in range(lines_of(system)):
        weight = weight_of(system, c, k, IN)
        if weight != 0.0:
            numbers = numbers_at(system, k)
            both = numbers[at_sheave.INERTIA] * through(system, k, IN, which)
            both += numbers[at_sheave.INERTIA + 1] * through(system, k, OUT, which)
            total += weight * numbers[at_sheave.OF_IN] * both
    return total


@kernel
def take_right(system, c):
    """As `sheave_stages.take_right`, of a drum (modified)."""
    total = inertia_times(system, c, at_sheave.GAIN)
    for k in range(lines_of(system)):
        weight = weight_of(system, c, k, IN)
        if weight != 0.0 and is_at_point(system, k, 0):
            numbers = numbers_at(system, k)
            moved = acceleration_with(system, point_at(system, k, 0), vector_at(numbers, at_sheave.FORCE_IN))
            total -= weight * numbers[at_sheave.OF_IN] * dot(get(single_at(system, k, BORDER), 0), moved)
    own_numbers(system, c)[at_sheave.RIGHT] = total
