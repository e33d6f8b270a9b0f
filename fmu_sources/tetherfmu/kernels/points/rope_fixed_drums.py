"""Drums that feel the rope that flows (`equations/rope_at_drum.py`) in an iteration of `system_fixed_drums.py`.

    r = T + T^2/(2 EA) - R,   T = W + m (u - u0)/h,   R = R_0 + sum_i col_i . (v_i - v0_i)/h - I (u - u0)/h

at the end of the step: R feels all nodes, and so does the row of the drum.
"""

from tetherfmu.runtime import layout as at

from ..arrays import clear
from ..compilation import kernel
from ..equations import rope_at_drum as rope
from ..equations import segment
from ..equations.drum import force_at
from ..equations.end_motion import acceleration_at
from ..equations.lines import conditions_of, motion_of
from ..equations.properties import property_of
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, put, scale, sub
from . import system_room as at_line
from .rope_drums import is_free, mass_of, stiffness_of
from .system_room import attempt_of, drum_at, length_of, numbers_of, room_in_step, scratch_of

CLOSE = 1e-6  # of the tension: what an iteration may leave, whose square the next one does


@kernel
def acceleration_of_node(system, k, step, i):
    """Acceleration of node i of line k [m/s2] in the iteration, 0 of a driven kite end, which it does not matter for."""
    conditions, w, (_, v) = conditions_of(system, k), scratch_of(system, k), motion_of(system, k)
    if is_free(conditions, i):
        moved = sub(get(w.x, i), get(w.old, i))
        return scale(1.0 / step.h, sub(scale(1.0 / step.h, moved), get(v, i)))
    return acceleration_at(conditions.ground, step.time + step.h) if i == 0 else ZERO_VECTOR


@kernel
def form_column(system, k, step):
    """Add -dg/du of the rope that flows to the column of line k (modified)."""
    attempt, w, column, h = attempt_of(system, k, step), scratch_of(system, k), room_in_step(system, k).column, step.h
    chain, part = attempt.chain, 1.0
    for s in range(chain.n):
        r = sub(get(w.x, s + 1), get(w.x, s))
        u = scale(1.0 / h, sub(r, sub(get(w.old, s + 1), get(w.old, s))))
        by_length, of_p, of_q = rope.force_slopes(chain, s, part, r, u)
        col_p, col_q = rope.columns(chain, s, part, r)
        of_p = add_scaled(add_scaled(of_p, h, by_length), 1.0 / h, col_p)
        of_q = add_scaled(add_scaled(of_q, -h, by_length), 1.0 / h, col_q)
        put(column, s, add(get(column, s), of_p))
        put(column, s + 1, add(get(column, s + 1), of_q))
        part = rope.next_part(chain, s, part)


@kernel
def take_row(system, k, step, row):
    """dR/dx into `row` (modified, flat) [N/m]; R [N] of line k in the iteration, and -dR/du [N s/m]."""
    attempt, w, h, conditions = attempt_of(system, k, step), scratch_of(system, k), step.h, conditions_of(system, k)
    chain, part, lowest = attempt.chain, 1.0, get(w.x, 0)[2]
    pull, by_speed = rope.of_speed(chain), -2.0 * rope.half_density(chain, 0) * chain.reeling
    clear(row)
    a_p = acceleration_of_node(system, k, step, 0)
    for s in range(chain.n):
        x_p, x_q, a_q = get(w.x, s), get(w.x, s + 1), acceleration_of_node(system, k, step, s + 1)
        r, height = sub(x_q, x_p), segment.mean_height(x_p, x_q) - lowest
        u = scale(1.0 / h, sub(r, sub(get(w.old, s + 1), get(w.old, s))))
        mode = segment.BY_LENGTH
        col_p, col_q = rope.columns(chain, s, part, r)
        of_rope = rope.inertia(chain, s, part, r)
        pull += rope.pull(chain, s, part, mode, r, u, height) - of_rope * chain.acceleration
        pull += dot(col_p, a_p) + dot(col_q, a_q)
        by_r, by_u, of_length, of_speed = rope.by_motion(chain, s, part, mode, r, u, a_p, a_q)
        by_r = add_scaled(by_r, 1.0 / h, by_u)
        weight = (0.0, 0.0, -property_of(chain, s, at.SHARE) * rope.half_density(chain, s) * chain.gravity)
        put(row, s, add(get(row, s), add_scaled(sub(weight, by_r), 1.0 / (h * h), col_p)))
        put(row, s + 1, add(get(row, s + 1), add_scaled(add(weight, by_r), 1.0 / (h * h), col_q)))
        put(row, 0, add_scaled(get(row, 0), -2.0, weight))
        by_speed += of_rope / h - of_speed - h * of_length
        part, a_p = rope.next_part(chain, s, part), a_q
    for i in range(chain.n + 1):
        if not is_free(conditions, i):
            put(row, i, ZERO_VECTOR)
    return pull, by_speed


@kernel
def counter_force(system, k, step, direction):
    """T + T^2/(2 EA) [N] with T = W + m u' in the iteration, were friction in a direction; and its slope with T [-]."""
    drum, (_, before), speed = drum_at(system, k), length_of(system, k), numbers_of(system, k)[at_line.TRIAL]
    force = force_at(drum, step.time + step.h) + drum.damping * speed + drum.friction * direction
    return rope.with_strain(stiffness_of(system, k), force + mass_of(system, k) * (speed - before) / step.h)


@kernel
def friction(system, k, step, direction):
    """What friction in a direction (1 or -1) adds to that [N], positive in any."""
    with_it, _ = counter_force(system, k, step, direction)
    without, _ = counter_force(system, k, step, 0.0)
    return direction * (with_it - without)


@kernel
def inertia(system, k, step):
    """Slope of that with u [N s/m]."""
    _, slope = counter_force(system, k, step, 0.0)
    return slope * (mass_of(system, k) / step.h + drum_at(system, k).damping)


@kernel
def is_close(system, k, step):
    """Whether the last iteration left less than a part CLOSE of the tension, or its square of EA, of r.

    It left dT^2/(2 EA) and dT F/EA of friction, dT = (m/h + c) du.
    """
    stiffness, drum, numbers = stiffness_of(system, k), drum_at(system, k), numbers_of(system, k)
    speed, changed = numbers[at_line.TRIAL], (mass_of(system, k) / step.h + drum.damping) * numbers[at_line.CHANGE]
    force = abs(force_at(drum, step.time + step.h)) + drum.damping * abs(speed) + abs(changed)
    left = abs(changed) * (abs(changed) + 2.0 * drum.friction)
    return left <= 2.0 * stiffness * CLOSE * (force + CLOSE * stiffness)
