"""One Rodas4P step of all lines, free points and rope coordinates together: 0 = r(q, v, z, t), q' = v, v' = z.

    (r_z/d + r_v + d r_q) y = -r + r_z (z + inertia/h) + r_v rest - gamma_i h r_t,   d = h gamma

A stage changes q by d y and v by V = y - rest; nodes and coordinates use the same sums (`line/rosenbrock.py`), and

    z_i = OF_START_i z_0 + sum_j OF_SPEEDS_ij V_j/h

are the accelerations at a stage, so stages need no mass matrix. z_0 is computed once per step, and only if it has an effect
(`net.find_accelerations`). A line without ropes needs no accelerations: its node rows are multiplied by m_0/m (masses at the
start and at the stage), which eliminates z. Only its ends at free points, which it shares with other lines, have them.

Each line has its own copy of its free points: same numbers, same arithmetic, same motion.
"""

from ..compilation import kernel, view
from ..equations import flow, winch
from ..equations.boundary import chain_during
from ..equations.free_points import free_points, is_at_point, point_at, points_of, rows_of
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..equations.properties import growing_mass
from ..line import rosenbrock, strand
from ..line.rodas4p import ALPHA, GAMMA, GAMMA_I, INERTIA, OF_SPEEDS, OF_START, R_BY_GAMMA, STAGES, A, P, added_up
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.vectors import add_at, add_scaled, get, put, scale, sub
from . import net, room
from .room import (
    chain_at_stage,
    coordinate_at,
    count_of,
    globals_of,
    has_rope,
    integrator_of,
    is_any_rope,
    is_drum,
    moves,
    section_now,
    strand_of,
    take_rates,
    unknowns_of,
)

# --- coordinates


@kernel
def coordinates_to_stage(system, stage, h):
    """Passed rope, speeds and accelerations of all coordinates at a stage (modified)."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        speed, speeds = own[room.SPEED], room.speeds_of(own)
        own[room.OF_REST] = added_up(GAMMA_I[stage] / GAMMA * speed, R_BY_GAMMA, stage, speeds)
        own[room.ADDED_UP] = added_up(GAMMA_I[stage] / GAMMA / GAMMA * speed, INERTIA, stage, speeds)
        if stage < STAGES - 1:
            own[room.PASSED_NOW] = own[room.PASSED] + h * added_up(ALPHA[stage] * speed, P, stage, speeds)
            own[room.SPEED_NOW] = added_up(speed, A, stage, speeds)
        if stage == 0:
            own[room.GAIN_NOW] = 0.0
        else:
            own[room.GAIN_NOW] = OF_START[stage] * own[room.ACCELERATION] + added_up(0.0, OF_SPEEDS, stage, speeds) / h


@kernel
def end_stage_of_coordinates(system, stage, h):
    """Apply the solution of a stage to all coordinates (modified)."""
    solution, points = globals_of(system).solution, 3 * free_points(system)
    for j in range(count_of(system)):
        own, p = coordinate_at(system, j), solution[points + j]
        increment = p - own[room.OF_REST]
        own[room.SPEEDS + stage] = increment
        own[room.WRONG], own[room.WRONG_SPEED] = p, increment
        if stage >= STAGES - 2:
            own[room.PASSED_NOW] += GAMMA * h * p
            own[room.SPEED_NOW] += increment


# --- matrix of a step


@kernel
def begin_line(system, k, time, h):
    """Begin a step of line k (modified): argument, forces and derivatives of stage 0; False if the line has no length."""
    x, v = motion_of(system, k)
    if has_rope(system, k):
        take_rates(system, k, time)
        if not section_now(system, k) > 0.0:
            return False
        strand.begin(strand_of(system, k), chain_at_stage(system, k), time, x, v)
        return True
    conditions, w, chain = conditions_of(system, k), integrator_of(system, k), chain_during(conditions_of(system, k), time)
    rosenbrock.form(conditions, chain, time, h, x, v, w)
    rosenbrock.combine(0, h, w)
    rosenbrock.prescribe_ends(conditions, time, w)
    rosenbrock.stage_masses(chain, 0, False, w)
    rosenbrock.stage_force(conditions, chain, time, w)
    rosenbrock.take_force_rate(conditions, time, w)
    return True


@kernel
def is_any_reeling(system):
    """Whether the unstretched length of any line is a function of time."""
    count = 0
    for k in range(lines_of(system)):
        count += winch.is_reeling(conditions_of(system, k).reeling)
    return count > 0


@kernel
def prepare(system, time, h):
    """Begin stage 0 and form the matrix of a step; False if it is singular or a line has no length."""
    room.take_running(system)
    is_rope = is_any_rope(system)
    coordinates_to_stage(system, 0, h)
    for k in range(lines_of(system)):
        if moves(system, k) and not begin_line(system, k, time, h):
            return False
    net.sum_masses(system, False)
    if is_rope or (free_points(system) > 0 and is_any_reeling(system)):
        net.find_accelerations(system, time, is_rope)
        for j in range(count_of(system)):
            own = coordinate_at(system, j)
            own[room.ACCELERATION] = own[room.GAIN_NOW]
            net.take_damping(system, j)
        for k in range(lines_of(system)):
            if moves(system, k) and not has_rope(system, k):
                begin_ends(system, k, time)
    return form_matrix(system, time, GAMMA * h)


@kernel
def form_matrix(system, time, d):
    """Matrix from the lines that `begin_line` has prepared (modified); False if it is singular."""
    for k in range(lines_of(system)):
        if has_rope(system, k):
            x, v = motion_of(system, k)
            strand.form(strand_of(system, k), chain_at_stage(system, k), time, d, x, v)
    for j in range(count_of(system)):
        if not is_drum(system, j):
            net.add_wrap(system, j, time, d)
    m = unknowns_of(system)
    if m > 0:
        net.begin_matrix(system, d)
    for k in range(lines_of(system)):
        if moves(system, k):
            w, rows, columns = integrator_of(system, k), rows_of(system, k), room.columns_of(system, k)
            if not condensed.condense(rows, w.matrix, columns):
                return False
            for end in range(2):
                if room.is_held(system, k, end):
                    condensed.solve_inner(rows, w.matrix, room.rope_at(system, k, end).solved)
            if m > 0:
                net.place_blocks(system, k, w.matrix)
                net.place_ropes(system, k, w.matrix, 1.0)
    if m == 0:
        return True
    net.hold(system)
    return net.factorize(system)


# --- ends of reeling lines at free points


@kernel
def begin_ends(system, k, time):
    """Add the acceleration terms of a reeling line's ends at free points at the start of the step (modified)."""
    conditions, own = conditions_of(system, k), strand_of(system, k)
    net.put_accelerations_of_points(system, k)
    if winch.is_reeling(conditions.reeling):
        chain = chain_during(conditions, time)
        for end in range(2):
            if is_at_point(system, k, end):
                node = own.n * end
                mass_rate = growing_mass(chain, node, own.w.mass[node]) * chain.growth
                instead = scale(1.0 / own.w.mass[node], get_node(own.n, node, own.w.force))
                instead = sub(instead, net.acceleration_of_point(system, point_at(system, k, end)))
                add_to_node(own.n, node, scale(mass_rate, instead), own.w.force_rate)


@kernel
def share_forces(system, k, stage, h):
    """Like `begin_ends`, at a stage: `rosenbrock.without_damping` multiplies the force by m_0/m, hence F m/m_0 + ..."""
    own = strand_of(system, k)
    strand.add_up_accelerations(own, stage, h, 1)
    for end in range(2):
        if is_at_point(system, k, end):
            node = own.n * end
            before, now, force = own.w.mass[node], own.w.stage_mass[node], get_node(own.n, node, own.w.force)
            whole = add_scaled(force, before - now, get_node(own.n, node, own.stage_z))
            add_to_node(own.n, node, sub(scale(now / before, whole), force), own.w.force)


# --- stages


@kernel
def start_stage(system, k, stage, time, h):
    """Argument and forces of line k at a stage after the first, at a time [s] (modified); False if it has no length."""
    if has_rope(system, k):
        take_rates(system, k, time)
        if not section_now(system, k) > 0.0:
            return False
        strand.go_to_stage(strand_of(system, k), chain_at_stage(system, k), stage, time, h)
        strand.residual(strand_of(system, k), chain_at_stage(system, k), time)
        return True
    conditions, w = conditions_of(system, k), integrator_of(system, k)
    chain, changes = chain_during(conditions, time), winch.is_reeling(conditions.reeling)
    rosenbrock.combine(stage, h, w)
    rosenbrock.prescribe_ends(conditions, time, w)
    rosenbrock.stage_masses(chain, stage, changes, w)
    rosenbrock.stage_force(conditions, chain, time, w)
    if changes and free_points(system) > 0:
        share_forces(system, k, stage, h)
    return True


@kernel
def reduce_line(system, k, stage, time, h):
    """Condense the right-hand side of line k at a stage and add it to the global right-hand side (modified)."""
    n, w = segments_of(system, k), integrator_of(system, k)
    if has_rope(system, k):
        strand.right_hand_side(strand_of(system, k), stage, h)
    else:
        conditions = conditions_of(system, k)
        rosenbrock.right_hand_side(conditions, stage, h, w)
        if flow.flows(chain_during(conditions, time)):
            flow.subtract_damping(n, w.dampings, w.r, w.q)
    condensed.solve_inner(rows_of(system, k), w.matrix, w.q)
    net.place_right(system, k, w.matrix, w.q, 1.0)


@kernel
def solve_stage(system, stage, start, time, h):
    """Solve a stage of all lines at a time [s], with known forces; start : of the step [s]."""
    net.begin_right(system, stage, time, h)
    for k in range(lines_of(system)):
        if moves(system, k):
            reduce_line(system, k, stage, start, h)
    net.solve(system)
    end_stage_of_coordinates(system, stage, h)
    for k in range(lines_of(system)):
        if moves(system, k):
            n, w = segments_of(system, k), integrator_of(system, k)
            net.take_solution(system, k, w.q)
            rosenbrock.take_velocities(n, stage, w)
            if stage >= STAGES - 2:
                rosenbrock.add_stage(n, stage, h, w)


@kernel
def step(system, time, h):
    """One step of h [s] of all lines from their states at a time [s] of the communication step; False if it is singular.

    Results are left in the scratch space of the lines (x and v, error estimates U_x/d in q and U_v in velocity_error) and
    in the numbers of the coordinates.
    """
    if not prepare(system, time, h):
        return False
    is_rope = is_any_rope(system)
    for stage in range(STAGES):
        now = time + ALPHA[stage] * h
        if stage > 0:
            coordinates_to_stage(system, stage, h)
            for k in range(lines_of(system)):
                if moves(system, k) and not start_stage(system, k, stage, now, h):
                    return False
            if is_rope:
                net.count_tensions(system)
        solve_stage(system, stage, time, now, h)
    return take_results(system, time + h)


@kernel
def take_results(system, end):
    """Results of all lines for the step that ends at a time [s] (modified); False if a line has no length."""
    for k in range(lines_of(system)):
        if moves(system, k):
            rosenbrock.take_result(conditions_of(system, k), end, integrator_of(system, k))
            if has_rope(system, k):
                take_rates(system, k, end)
                if not section_now(system, k) > 0.0:
                    return False
    return True


# --- after a step


@view
def whole_masses(system, k, w):
    """Set the masses of line k's free ends to the point masses [kg] (modified), for error control and corrections."""
    for end in range(2):
        if is_at_point(system, k, end):
            w.mass[segments_of(system, k) * end] = points_of(system).mass[point_at(system, k, end)]


@view
def collect_changes(system, k, before, w):
    """Move velocity changes of line k's free ends since `before` [m/s] into `Points.change`, and count them.

    before : velocities of start and end.  The ends get their earlier velocities back.
    """
    changed = 0
    for end in range(2):
        node = segments_of(system, k) * end
        velocity = before[1] if end == 1 else before[0]
        change = sub(get(w.v, node), velocity)
        if is_at_point(system, k, end) and not (change[0] == 0.0 and change[1] == 0.0 and change[2] == 0.0):
            add_at(points_of(system).change, point_at(system, k, end), change)
            put(w.v, node, velocity)
            changed += 1
    return changed


@kernel
def apply_changes(system, k):
    """Add `Points.change` [m/s] to the velocities of the free ends of line k in the step result (modified)."""
    for end in range(2):
        if is_at_point(system, k, end):
            change = get(points_of(system).change, point_at(system, k, end))
            add_at(integrator_of(system, k).v, segments_of(system, k) * end, change)
