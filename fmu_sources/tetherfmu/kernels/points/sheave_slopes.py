"""Slopes of what sheaves and rope over them do, at the start of a Rosenbrock step: of forces, and the rows of the border."""

from tetherfmu.runtime import layout as at

from ..arrays import clear
from ..compilation import kernel
from ..equations import assembly, segment, winch
from ..equations import rope_at_sheave as rope
from ..equations.boundary import chain_with
from ..equations.end_motion import acceleration_at, jerk_at, velocity_at
from ..equations.ground import has_ground
from ..equations.lines import conditions_of, motion_of, parameters_of, segments_of
from ..equations.properties import point_mass
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import comes_from, is_even
from ..line import contact
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_at, add_scaled, dot, get, norm, put, scale, sub
from . import sheave_room as at_sheave
from .sheave_pulls import density_of, loss_with
from .sheave_room import (
    ACCELERATIONS,
    BORDER,
    BY_SPEED,
    BY_VELOCITY,
    FORCE_BY_LENGTH,
    ROW,
    array_at,
    numbers_at,
    part_of,
    parts_of,
    portion_at_start,
    portion_gaining,
    single_at,
    winch_of,
)
from .system_room import integrator_of

# --- slopes of forces


@kernel
def form_slopes(system, k, time):
    """F_L and F_u of portion k (modified) at the start of the step, with the masses of its nodes, which grow with L."""
    n, conditions, w = segments_of(system, k), conditions_of(system, k), integrator_of(system, k)
    (x, v), length, part = motion_of(system, k), numbers_at(system, k)[at_sheave.LENGTH_NOW], 1.0
    by_length = single_at(system, k, FORCE_BY_LENGTH)
    into, out = array_at(system, k, BY_SPEED, IN), array_at(system, k, BY_SPEED, OUT)
    chain, growing = portion_at_start(system, k, time), chain_with(conditions, length, 1.0)
    gained, own, is_uniform = single_at(system, k, ACCELERATIONS), rope.rope_of(chain, 0), is_even(system, k)
    assembly.rate_from_reeling(growing, w.start_x, w.start_v, w.records, by_length)
    if has_ground(conditions.parameters):
        contact.add_rate(growing, x, v, w, by_length)
    clear(into)
    assembly.add_rate_from_acceleration(growing, 1.0, x, w.records, into)
    for i in range(len(into)):
        out[i] = -into[i]
    for s in range(n):
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        if not is_uniform:
            own = rope.rope_of(chain, s)
        c = rope.flowing(chain, part, part - own.share)
        along = rope.force_by_length(own, c, r)
        add_at(by_length, s, along)
        put(by_length, s + 1, sub(get(by_length, s + 1), along))
        of_p, of_q = rope.force_by_rate(own, rope.passing(own, part, IN), c, r, u)
        add_at(into, s, of_p)
        add_at(into, s + 1, of_q)
        of_p, of_q = rope.force_by_rate(own, rope.passing(own, part, OUT), c, r, u)
        add_at(out, s, of_p)
        add_at(out, s + 1, of_q)
        part -= own.share
    for i in range(n + 1):
        share = (w.mass[i] - point_mass(growing, i)) / length
        put(by_length, i, add_scaled(get(by_length, i), -share, get(gained, i)))


@kernel
def add_winch_rates(system, k, time, w):
    """Add what a winch that pays out into portion k does to the forces per second to w.q and w.force_rate (modified)."""
    paid, by_length, into = winch_of(system, k), single_at(system, k, FORCE_BY_LENGTH), array_at(system, k, BY_SPEED, IN)
    border, parts = single_at(system, k, BORDER), parts_of(system, k)
    speed, gain, jerk = winch.rate_at(paid, time), winch.acceleration_at(paid, time), winch.jerk_at(paid, time)
    for i in range(len(into)):
        w.q[i] += speed * by_length[i] + gain * into[i] + jerk * parts[i // 3] * border[i]
    interleave(segments_of(system, k), w.q, w.force_rate)


@kernel
def take_row(system, k, side, weight, nodes):
    """Slopes of R_a or R_b of portion k by positions into ROW, by velocities into BY_VELOCITY, times a weight (modified).

    And by L and the rates into its numbers, without the weight.  nodes : positions [m] and velocities [m/s] of the nodes,
    and the modes of the segments.
    """
    n, numbers, (x, v, modes), part = segments_of(system, k), numbers_at(system, k), nodes, 1.0
    by_position, by_velocity = array_at(system, k, ROW, side), array_at(system, k, BY_VELOCITY, side)
    clear(by_position)
    clear(by_velocity)
    chain, holder = portion_gaining(system, k, 1.0), 0 if side == IN else n
    by_length, by_a, by_b = 0.0, 0.0, 0.0
    accelerations, own, is_uniform = single_at(system, k, ACCELERATIONS), rope.rope_of(chain, 0), is_even(system, k)
    a_p = get(accelerations, 0)
    for s in range(n):
        a_q = get(accelerations, s + 1)
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        if not is_uniform:
            own = rope.rope_of(chain, s)
        a, b, next_part = rope.passing(own, part, IN), rope.passing(own, part, OUT), part - own.share
        y, c, gained = a if side == IN else b, rope.flowing(chain, part, next_part), rope.gaining(chain, part, next_part)
        by_r, by_u, of_length = rope.by_motion(own, chain, y, c, gained, modes[s], r, u, a_p, a_q)
        below = -y.sign * own.share * own.half * chain.gravity
        add_at(by_position, s, scale(weight, sub((0.0, 0.0, below), by_r)))
        add_at(by_position, s + 1, scale(weight, add((0.0, 0.0, below), by_r)))
        add_at(by_position, holder, (0.0, 0.0, -2.0 * weight * below))
        add_at(by_velocity, s, scale(-weight, by_u))
        add_at(by_velocity, s + 1, scale(weight, by_u))
        by_length += of_length
        by_a += rope.by_rate(own, chain, y, a, c, modes[s], r, u)
        by_b += rope.by_rate(own, chain, y, b, c, modes[s], r, u)
        part, a_p = next_part, a_q
    if side == IN:
        by_a += 2.0 * rope.half_density(chain, 0) * numbers[at_sheave.INTO]
    else:
        by_b -= 2.0 * rope.half_density(chain, n - 1) * chain.leaving
    numbers[at_sheave.BY_LENGTH + side] = by_length
    numbers[at_sheave.BY_RATE + 2 * side], numbers[at_sheave.BY_RATE + 2 * side + 1] = by_a, by_b


@kernel
def turn_of(towards, other):
    """Slope of the angle of wrap by the vector away from a sheave along one portion [1/m]; other : along the other one."""
    length, d = segment.geometry(towards)
    _, e = segment.geometry(other)
    across = add_scaled(e, -dot(d, e), d)
    size = norm(across)
    return scale(1.0 / (length * size), across) if size > 1e-9 else ZERO_VECTOR


@kernel
def add_wrap(system, k):
    """Add what the angle of wrap at the end of line k does to its friction to ROW (modified)."""
    numbers, grip, sign = numbers_at(system, k), parameters_of(system, k)[at.SHEAVE_FRICTION], 0.0
    sign = numbers[at_sheave.SIGN]
    if grip == 0.0 or sign == 0.0:
        return
    n, (x_1, _), (x_2, _) = segments_of(system, k), motion_of(system, k), motion_of(system, k + 1)
    to_1, to_2 = sub(get(x_1, n - 1), get(x_1, n)), sub(get(x_2, 1), get(x_2, 0))
    moving = density_of(system, k) * numbers[at_sheave.SPEED] ** 2
    tension = numbers[at_sheave.TENSION_BEHIND] if sign > 0.0 else -numbers[at_sheave.TENSION_AHEAD]
    factor = -grip * loss_with(system, k, to_1, to_2) * (tension - sign * moving)
    if sign * tension <= moving:
        return
    by_1, by_2 = scale(factor, turn_of(to_1, to_2)), scale(factor, turn_of(to_2, to_1))
    add_at(array_at(system, k, ROW, OUT), n - 1, by_1)
    add_at(array_at(system, k, ROW, OUT), n, scale(-1.0, add(by_1, by_2)))
    add_at(array_at(system, k + 1, ROW, IN), 1, by_2)


@kernel
def finish_row(system, k, side, weight, time, d):
    """Row of R_a or R_b of portion k from ROW and BY_VELOCITY (modified); its explicit time derivative [N/s]."""
    conditions, numbers, border = conditions_of(system, k), numbers_at(system, k), single_at(system, k, BORDER)
    by_position, by_velocity = array_at(system, k, ROW, side), array_at(system, k, BY_VELOCITY, side)
    n, rate = conditions.n, 0.0
    for end in range(2):
        curve, node = conditions.kite if end == 1 else conditions.ground, n * end
        if not conditions.first <= node <= conditions.last:
            rate += dot(get(by_position, node), velocity_at(curve, time))
            rate += dot(get(by_velocity, node), acceleration_at(curve, time))
            if end == side:
                rate += weight * dot(get(border, node), jerk_at(curve, time))
    if not comes_from(system, k):
        paid, inertia = winch_of(system, k), numbers[at_sheave.INERTIA + side]
        of_winch = numbers[at_sheave.BY_LENGTH + side] * winch.rate_at(paid, time) - inertia * winch.jerk_at(paid, time)
        rate += weight * (of_winch + numbers[at_sheave.BY_RATE + 2 * side] * winch.acceleration_at(paid, time))
    close_row(system, k, side, weight, d)
    return rate


@kernel
def close_row(system, k, side, weight, d):
    """Row of R_a or R_b of portion k, but for its rate, from ROW and BY_VELOCITY, times a weight (modified)."""
    conditions, border, parts = conditions_of(system, k), single_at(system, k, BORDER), parts_of(system, k)
    by_position, by_velocity = array_at(system, k, ROW, side), array_at(system, k, BY_VELOCITY, side)
    for i in range(conditions.n + 1):
        inertia = weight / d * part_of(parts, side, i)
        along = add_scaled(add_scaled(get(by_velocity, i), d, get(by_position, i)), inertia, get(border, i))
        put(by_position, i, along if conditions.first <= i <= conditions.last else ZERO_VECTOR)
