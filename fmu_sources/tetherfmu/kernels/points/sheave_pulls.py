"""What a portion of a rope over sheaves pulls at its ends at a stage, and what is known of a sheave: `sheaves.py`."""

from math import atan2, exp

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import rope_at_sheave as rope
from ..equations import segment
from ..equations.end_motion import acceleration_at
from ..equations.lines import (
    comes_from,
    conditions_of,
    goes_on,
    is_at_point,
    lines_of,
    load_at,
    parameters_of,
    point_at,
    points_of,
    segments_of,
)
from ..equations.properties import property_of
from ..equations.rope_at_sheave import IN, OUT
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, cross, dot, get, norm, put, put_at, scale, sub, vector_at
from . import sheave_room as at_sheave
from .sheave_room import (
    PULLED,
    array_at,
    numbers_at,
    portion_in_step,
    runs_over,
)
from .system_room import integrator_of


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


@kernel
def take_pulls(system, k, time):
    """PULL and YIELD of portion k at a stage, once its forces are known, and PULLED (all modified); rope's own inertia back.

    Without what its ends add where they are free points. The forces on its nodes get what a winch that gains speed does.
    """
    conditions, numbers, w = conditions_of(system, k), numbers_at(system, k), integrator_of(system, k)
    into, out = array_at(system, k, PULLED, IN), array_at(system, k, PULLED, OUT)
    chain, n, part = portion_in_step(system, k), conditions.n, 1.0
    own = rope.rope_of(chain)
    x_p, v_p = get_node(n, 0, w.stage_x), get_node(n, 0, w.stage_v)
    lowest, highest = x_p[2], get_node(n, n, w.stage_x)[2]
    pull_a = rope.of_speed(own, 1.0, numbers[at_sheave.INTO])
    pull_b = rope.of_speed(own, -1.0, chain.leaving)
    own_aa, own_ab, own_bb, below_a, below_b = 0.0, 0.0, 0.0, ZERO_VECTOR, ZERO_VECTOR
    for s in range(n):
        x_q, v_q = get_node(n, s + 1, w.stage_x), get_node(n, s + 1, w.stage_v)
        r, height, next_part = sub(x_q, x_p), segment.mean_height(x_p, x_q), part - own.share
        c = part * chain.reeling + chain.leaving, next_part * chain.reeling + chain.leaving
        of_a, of_b = rope.pulls(own, chain, part, c, w.modes[s], r, sub(v_q, v_p), height - lowest, height - highest)
        pull_a += of_a
        pull_b += of_b
        aa, ab, bb = rope.inertias(own, part, dot(r, r))
        own_aa += aa
        own_ab += ab
        own_bb += bb
        col = scale(-own.half, r)
        put(into, s, add_scaled(below_a, part, col))
        put(out, s, add_scaled(below_b, 1.0 - part, col))
        below_a, below_b = scale(next_part, col), scale(1.0 - next_part, col)
        part, x_p, v_p = next_part, x_q, v_q
    put(into, n, below_a)
    put(out, n, below_b)
    gain = numbers[at_sheave.INTO_GAIN]
    if not comes_from(system, k) and gain != 0.0:
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
def take_force_on_point(system, k, time):
    """Force on the free point at the end of line k at a stage, but for what sheaves that gain speed add (modified).

    Of all lines, and of the load.
    """
    point = point_at(system, k, 1)
    total = load_at(system, point, time)
    for other in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, other, end) and point_at(system, other, end) == point:
                n = segments_of(system, other)
                total = add(total, get_node(n, n * end, integrator_of(system, other).force))
    put_at(numbers_at(system, k), at_sheave.FORCE, total)


@kernel
def column_at_point(system, k):
    """What the sheave at the end of line k does to its point per u' [kg] at a stage."""
    return add(get(array_at(system, k, PULLED, OUT), segments_of(system, k)), get(array_at(system, k + 1, PULLED, IN), 0))


@kernel
def acceleration_at_sheave(system, k):
    """Acceleration of the free point at the end of line k [m/s2] at a stage, with what the sheaves there do."""
    point, total = point_at(system, k, 1), vector_at(numbers_at(system, k), at_sheave.FORCE)
    for other in range(lines_of(system)):
        if goes_on(system, other) and runs_over(system, other) and point_at(system, other, 1) == point:
            total = add_scaled(total, numbers_at(system, other)[at_sheave.GAIN], column_at_point(system, other))
    return scale(1.0 / points_of(system).stage_mass[point], total)


@kernel
def end_acceleration(system, k, end, time):
    """Acceleration [m/s2] of the start (end 0) or the end (1) of portion k at a stage, which is no sheave that is free."""
    conditions = conditions_of(system, k)
    curve = conditions.kite if end == 1 else conditions.ground
    if not is_at_point(system, k, end):
        return acceleration_at(curve, time)
    point = point_at(system, k, end)
    total = load_at(system, point, time)
    for other in range(lines_of(system)):
        for side in range(2):
            if is_at_point(system, other, side) and point_at(system, other, side) == point:
                n = segments_of(system, other)
                total = add(total, get_node(n, n * side, integrator_of(system, other).force))
        if goes_on(system, other) and runs_over(system, other) and point_at(system, other, 1) == point:
            total = add_scaled(total, numbers_at(system, other)[at_sheave.GAIN], column_at_point(system, other))
    return scale(1.0 / points_of(system).stage_mass[point], total)
