"""Tension where a rope leaves its drum, and the acceleration of the drum, of a state of the lines; see `rope_drums.py`."""

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..equations import flow, motion, node_loads, segment
from ..equations import rope_at_drum as rope
from ..equations.boundary import chain_during, chain_moving, chain_with, load_during
from ..equations.drum import HELD
from ..equations.free_points import is_at_point, load_at, point_at
from ..equations.lines import conditions_of, lines_of, motion_of, state_of
from ..equations.properties import point_mass, property_of, rest_length
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, scale, sub
from .rope_drums import acceleration_of_start, acceleration_with, counter_force, is_free, mass_of, stiffness_of
from .system_room import has_drum, integrator_of, length_of, shares_of


@view
def nodes_of(system, k, is_after):
    """Positions [m] and velocities [m/s] of the nodes of line k: of a Rosenbrock step that is tried, or of its state."""
    w, (x, v) = integrator_of(system, k), motion_of(system, k)
    return (w.x, w.v) if is_after else (x, v)


@kernel
def force_of_end(chain, kite_end, x, v):
    """Force of a chain on the node at an end [N], its weight and the ground included, and its mass [kg]."""
    s = chain.n - 1 if kite_end else 0
    i = chain.n if kite_end else 0
    mass = rope.half_density(chain, s) * rest_length(chain, s) + point_mass(chain, i)
    x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
    pull, drag, _ = segment.forces(chain, s, x_p, x_q, v_p, v_q)
    total = add(scale(-1.0, pull), drag) if kite_end else add(pull, drag)
    total = add(total, node_loads.load(chain, mass, get(x, i), get(v, i), None))
    total = add_scaled(total, mass, motion.of_ground(chain, get(x, i), get(v, i)))
    if flow.flows(chain):
        of_p, of_q = flow.forces(chain, s, property_of(chain, s, at.SHARE) if kite_end else 1.0, x_p, x_q, v_p, v_q)
        total = add(total, of_q if kite_end else of_p)
    return total, mass


@view
def chain_now(system, k, other, time):
    """The `Chain` of line k at a time [s]; of a drum but that of the line `other` with its last acceleration."""
    conditions = conditions_of(system, k)
    if has_drum(system, k):
        acceleration = 0.0 if k == other else state_of(system, k)[at.ACCELERATION]
        return chain_moving(conditions, *length_of(system, k), acceleration)
    return chain_during(conditions, time)


@kernel
def acceleration_of_point(system, point, other, time, is_after):
    """Acceleration of a free point at a time [s], but for that of the drum of the line `other` [m/s2]; its mass [kg]."""
    total, mass = load_at(system, point, time), 0.0
    for k in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, k, end) and point_at(system, k, end) == point:
                x, v = nodes_of(system, k, is_after)
                force, own = force_of_end(chain_now(system, k, other, time), end == 1, x, v)
                total = add(total, force)
                mass += own
    return scale(1.0 / mass, total), mass


@kernel
def pull_and_inertia(system, k, now, is_after):
    """R but for u' [N], and the inertia of the rope [kg], of the drum of line k at an `Instant`, of whose nodes x and v are.

    Scratch space is modified.
    """
    conditions, w, a = conditions_of(system, k), integrator_of(system, k), shares_of(system, k).pulled
    chain, n, part = chain_with(conditions, now.length, now.speed), conditions.n, 1.0
    motion.accelerations(chain, now.x, now.v, load_during(conditions, now.time), w.stage_mass, a)
    force, inertia, from_below, lowest = rope.of_speed(chain), 0.0, ZERO_VECTOR, get(now.x, 0)[2]
    for i in range(n + 1):
        col = from_below
        if i < n:
            x_p, x_q = get(now.x, i), get(now.x, i + 1)
            r, height = sub(x_q, x_p), segment.mean_height(x_p, x_q) - lowest
            force += rope.pull(chain, i, part, segment.BY_LENGTH, r, sub(get(now.v, i + 1), get(now.v, i)), height)
            inertia += rope.inertia(chain, i, part, r)
            of_p, from_below = rope.columns(chain, i, part, r)
            col, part = add(col, of_p), rope.next_part(chain, i, part)
        if i == 0 and is_at_point(system, k, 0):
            gained, mass = acceleration_of_point(system, point_at(system, k, 0), k, now.time, is_after)
            force += dot(col, gained)
            inertia -= dot(col, col) / mass
        elif is_free(conditions, i):
            force += dot(col, get(a, i))
            inertia -= dot(col, col) / w.stage_mass[i]
        elif i == 0:
            force += dot(col, acceleration_of_start(conditions, now.time))
    return force, inertia


@kernel
def tension_at_rest(system, k, now, is_after):
    """Tension where the rope leaves the drum of line k [N] at an `Instant` without speed, were it held."""
    pull, _ = pull_and_inertia(system, k, now, is_after)
    return rope.tension_of(stiffness_of(system, k), pull)


@kernel
def tension_and_acceleration(system, k, now, direction):
    """The same of a drum that turns in a direction, or is held, and its acceleration [m/s2]."""
    pull, inertia = pull_and_inertia(system, k, now, False)
    if direction == HELD:
        return rope.tension_of(stiffness_of(system, k), pull), 0.0
    counter = counter_force(system, k, direction, now.speed, now.time)
    acceleration = acceleration_with(system, k, counter, pull, inertia)
    return counter + mass_of(system, k) * acceleration, acceleration
