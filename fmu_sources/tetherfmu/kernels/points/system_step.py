"""One step of Rodas4P: all lines and free points at once.

Each stage solves the equations of `rosenbrock.py` for all nodes. Those of the inner nodes of a line know its own ends only:
a line is condensed to its free points (`linear_algebra.condensed`), and what is left of all lines is added up there,

    S y = b,   S, b: sums over the lines that meet there, the load on the point,

one system with a band (`linear_algebra.point_blocks`). Loops of lines are nothing special. Each line then has the solution
of its ends, and with it that of its inner nodes. A free point stands at the end of each of its lines: same numbers, same
arithmetic, same motion.

F at a stage counts times the mass of the start over that of the stage, at a point the mass of the whole point:
`share_forces` gives each line its part.
"""

from ..arrays import clear
from ..compilation import kernel, view
from ..equations import flow, winch
from ..equations.boundary import chain_moving
from ..equations.free_points import free_points, is_at_point, load_at, point_at, points_of, rows_of, size_of_blocks
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..equations.properties import point_mass
from ..equations.ropes import comes_from
from ..line import rosenbrock
from ..line.rodas4p import ALPHA, GAMMA_I, STAGES
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.point_blocks import factorize_blocks, solve_blocks
from ..linear_algebra.vectors import add_at, add_scaled, get, put, scale, sub
from . import rope_drums, sheave_border, sheave_slopes, sheave_stages, system_drums
from . import system_room as at_line
from .at_points import place_matrix, take_ends
from .coordinates import is_any_running
from .sheave_room import is_running, portion_gaining
from .system_drums import chain_at_start, chain_in_step
from .system_room import (
    has_drum,
    integrator_of,
    is_any_reeling,
    is_any_turning,
    is_any_turning_with_rope,
    length_of,
    moves,
    numbers_of,
    room_in_step,
    turns,
    turns_with_rope,
)

# --- the matrix of a step


@kernel
def prepare(system, time, h):
    """Matrices of a step of all lines, condensed, and that of the points; False if one is singular."""
    points = points_of(system)
    clear(points.matrix)
    clear(points.mass)
    clear(points.mass_rate)
    with_sheaves = is_any_running(system)
    if with_sheaves and not sheave_stages.go_to_stage(system, 0, time, h):
        return False
    for k in range(lines_of(system)):
        if moves(system, k):
            form_line(system, k, time, h)
    with_rope = is_any_turning_with_rope(system)
    if with_sheaves or with_rope:
        for k in range(lines_of(system)):
            if moves(system, k) and not start_stage(system, k, 0, time, h):
                return False
        stage_masses(system)
    if with_sheaves:
        begin_sheaves(system, time, h)
    if with_rope:
        begin_drums(system, time, h)
    for k in range(lines_of(system)):
        if moves(system, k):
            matrix = integrator_of(system, k).matrix
            if not condensed.condense(rows_of(system, k), matrix, room_in_step(system, k).columns):
                return False
            place_matrix(system, k, matrix)
    return True


@kernel
def begin_drums(system, time, h):
    """Accelerations of drums that feel their rope at stage 0, which has begun, also in the matrices of lines (modified)."""
    rope_drums.accelerate(system, 0, time)
    for k in range(lines_of(system)):
        if turns_with_rope(system, k):
            length, _ = length_of(system, k)
            gaining = chain_moving(conditions_of(system, k), length, 0.0, numbers_of(system, k)[at_line.STAGE_ACCELERATION])
            rosenbrock.add_acceleration(conditions_of(system, k), gaining, time, h, integrator_of(system, k))


@kernel
def begin_sheaves(system, time, h):
    """The same of rope over sheaves."""
    sheave_stages.accelerate(system, 0, time)
    for k in range(lines_of(system)):
        if is_running(system, k):
            w = integrator_of(system, k)
            sheave_slopes.form_slopes(system, k, time)
            rosenbrock.add_acceleration(conditions_of(system, k), portion_gaining(system, k, 0.0), time, h, w)
            if not comes_from(system, k):
                sheave_slopes.add_winch_rates(system, k, time, w)


@kernel
def factorize(system, time, h):
    """Factor the matrix of the points, with the drums that turn, once the forces of stage 0 are known; False: singular.

    Then the border of the sheaves over which rope runs.
    """
    points = points_of(system)
    if is_any_turning(system):
        place_loads(system, 0, False, time, 0.0, points)
        if not system_drums.place_drums(system, time, h):
            return False
    if not factorize_blocks(*size_of_blocks(system), points.matrix):
        return False
    return not is_any_running(system) or sheave_border.form_border(system, time, h)


@kernel
def form_line(system, k, time, h):
    """Matrix of a step of line k into its scratch space, see `rosenbrock.form`, and its end masses into those of its points.

    The masses [kg] and their rates [kg/s] are added to those of the free points (modified).
    """
    if has_drum(system, k):
        system_drums.begin_step(system, k)
    points, chain, w = points_of(system), chain_at_start(system, k, time), integrator_of(system, k)
    x, v = motion_of(system, k)
    turning = turns(system, k) or is_running(system, k)
    rosenbrock.form(conditions_of(system, k), chain, turning, time, h, x, v, w)
    for end in range(2):
        if is_at_point(system, k, end):
            point, node = point_at(system, k, end), chain.n * end
            points.mass[point] += w.mass[node]
            if not turning:
                points.mass_rate[point] += (w.mass[node] - point_mass(chain, node)) * chain.growth


# --- a stage


@view
def start_stage(system, k, stage, time, h):
    """Argument and forces of a stage of line k into its scratch space, up to what `rosenbrock.right_hand_side` needs.

    False if its drum has no length.
    """
    conditions, w, now = conditions_of(system, k), integrator_of(system, k), time + ALPHA[stage] * h
    rosenbrock.combine(stage, h, w)
    has_turning = turns(system, k)
    if has_turning and not system_drums.go_to_stage(system, k, stage, h):
        return False
    rosenbrock.prescribe_ends(conditions, now, w)
    chain = chain_in_step(system, k, now)
    changes = has_turning or winch.is_reeling(conditions.reeling) or is_running(system, k)
    rosenbrock.stage_masses(chain, stage, changes, w)
    rosenbrock.stage_force(conditions, chain, now, w)
    if stage == 0:
        rosenbrock.take_force_rate(conditions, time, w)
    return True


@view
def reduce_line(system, k, stage, time, h, points):
    """Right-hand side of a stage of line k, condensed, and what is left of it into that of the points (modified)."""
    n, w, has_turning = segments_of(system, k), integrator_of(system, k), turns(system, k)
    rosenbrock.right_hand_side(conditions_of(system, k), stage, h, w)
    if flow.flows(chain_at_start(system, k, time)):
        flow.subtract_damping(n, w.dampings, w.r, w.q)
    with_rope = turns_with_rope(system, k)
    if has_turning:
        system_drums.subtract_rest(system, k)
    if is_running(system, k):
        sheave_border.subtract_known(system, k, h)
    if with_rope:
        rope_drums.push_back(system, k, system_drums.inertia_of_stage(system, k, stage), h)
    condensed.solve_inner(rows_of(system, k), w.matrix, w.q)
    if with_rope:
        system_drums.solve_drum_with_rope(system, k, stage, h)
    elif has_turning:
        system_drums.solve_drum(system, k, stage, time, h)
    for end in range(2):
        if is_at_point(system, k, end):
            left = condensed.what_is_left(n, end, w.matrix, w.q)
            if has_turning:
                left = system_drums.add_left(system, k, end, left)
            add_at(points.right, point_at(system, k, end), left)


@kernel
def place_loads(system, stage, reels, time, h, points):
    """Loads on the free points [N] at a stage as right-hand side of the points (modified), over masses as all forces.

    With their rates as those of all forces; with h = 0 the loads at a time [s] alone.
    """
    for point in range(free_points(system)):
        part_of_load = 1.0
        if reels:
            mass = points.mass[point]
            part_of_load = mass / points.stage_mass[point] - GAMMA_I[stage] * h * points.mass_rate[point] / mass
        load = scale(part_of_load, load_at(system, point, time + ALPHA[stage] * h))
        put(points.right, point, add_scaled(load, GAMMA_I[stage] * h, get(points.load_rate, point)))


@view
def take_solution(system, k, w):
    """Solution of line k from that of the points, but for the part of a drum (modified)."""
    take_ends(system, k, w.q)
    condensed.expand(rows_of(system, k), room_in_step(system, k).columns, w.q)


@view
def end_stage(system, k, stage, h):
    """Solution of a stage of line k from that of the points, and its velocities, into its scratch space."""
    w = integrator_of(system, k)
    if not is_any_running(system):  # else it is there
        take_solution(system, k, w)
    if turns(system, k):
        system_drums.turn_drum(system, k, stage, h)
    rosenbrock.take_velocities(segments_of(system, k), stage, w)
    if stage >= STAGES - 2:
        rosenbrock.add_stage(segments_of(system, k), stage, h, w)


# --- all stages


@kernel
def solve_stages(system, time, h):
    """All stages; False if the matrix of the points is singular or a drum has no length.

    Where lines reel, the masses of the points at a stage are known once all lines have begun it, and so are the forces.
    """
    reels, with_rope, with_sheaves = is_any_reeling(system), is_any_turning_with_rope(system), is_any_running(system)
    for stage in range(STAGES):
        if with_sheaves and stage > 0 and not sheave_stages.go_to_stage(system, stage, time, h):
            return False
        if stage > 0 or not (with_rope or with_sheaves):  # else it has begun
            for k in range(lines_of(system)):
                if moves(system, k) and not start_stage(system, k, stage, time, h):
                    return False
            if reels:
                stage_masses(system)
            if with_rope:
                rope_drums.accelerate(system, stage, time + ALPHA[stage] * h)
            if with_sheaves:
                sheave_stages.accelerate(system, stage, time + ALPHA[stage] * h)
        if reels:
            for k in range(lines_of(system)):
                if moves(system, k):
                    share_forces(system, k, stage)
        if stage == 0 and not factorize(system, time, h):
            return False
        solve_stage(system, stage, reels, time, h)
    return True


@kernel
def share_forces(system, k, stage):
    """Let the forces at the free ends of line k count as parts of those on points whose masses change (modified).

    `rosenbrock.without_damping` multiplies F by m_0/m of the node; that of the point, M_0/M, is to be the factor. The rate
    of M v' has -F/M_0 dM/dt.
    """
    points, n, w = points_of(system), segments_of(system, k), integrator_of(system, k)
    for end in range(2):
        if is_at_point(system, k, end):
            point, node = point_at(system, k, end), n * end
            force = get_node(n, node, w.force)
            if stage == 0:
                rate = add_scaled(get(w.q, node), -points.mass_rate[point] / points.mass[point], force)
                add_to_node(n, node, sub(rate, get_node(n, node, w.force_rate)), w.force_rate)
            own = points.mass[point] / points.stage_mass[point] * (w.stage_mass[node] / w.mass[node])
            add_to_node(n, node, scale(own - 1.0, force), w.force)


@kernel
def stage_masses(system):
    """Masses of the free points at a stage [kg] in a system that reels (modified)."""
    points = points_of(system)
    clear(points.stage_mass)
    for k in range(lines_of(system)):
        n, stage_mass = segments_of(system, k), integrator_of(system, k).stage_mass
        for end in range(2):
            if is_at_point(system, k, end):
                points.stage_mass[point_at(system, k, end)] += stage_mass[n * end]


@kernel
def solve_stage(system, stage, reels, time, h):
    """Solve a stage of all lines whose forces are known; velocities go to their places. reels : whether any line does."""
    points = points_of(system)
    place_loads(system, stage, reels, time, h, points)
    for k in range(lines_of(system)):
        if moves(system, k):
            reduce_line(system, k, stage, time, h, points)
    solve_blocks(*size_of_blocks(system), points.matrix, points.right, points.solution)
    if is_any_running(system):
        for k in range(lines_of(system)):
            if moves(system, k):
                take_solution(system, k, integrator_of(system, k))
        sheave_border.solve_border(system, stage, h)
    for k in range(lines_of(system)):
        if moves(system, k):
            end_stage(system, k, stage, h)


@kernel
def step(system, time, h):
    """One step of h [s] of all lines from their states at a time [s] of the communication step; False if it is singular.

    The results stand in the scratch space of the lines: x and v, with their error estimates U_x/d in q and U_v in
    velocity_error, and those of drums.
    """
    if not prepare(system, time, h) or not solve_stages(system, time, h):
        return False
    if is_any_running(system) and not sheave_stages.take_lengths(system, time, time + h):
        return False
    for k in range(lines_of(system)):
        if moves(system, k):
            rosenbrock.take_result(conditions_of(system, k), time + h, integrator_of(system, k))
    return True


# --- after a step


@view
def whole_masses(system, k, w):
    """Let the free ends of line k have the masses of their points [kg] (modified), for what judges and corrects a step."""
    for end in range(2):
        if is_at_point(system, k, end):
            w.mass[segments_of(system, k) * end] = points_of(system).mass[point_at(system, k, end)]


@view
def collect_changes(system, k, before, w):
    """Add what changed the velocities of the free ends of line k since `before` [m/s] to `Points.change`, and undo it.

    before : of start and end.  Returns how many have changed.
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
    """Add `Points.change` [m/s] to the velocities of the free ends of line k in the result of the step (modified)."""
    for end in range(2):
        if is_at_point(system, k, end):
            change = get(points_of(system).change, point_at(system, k, end))
            add_at(integrator_of(system, k).v, segments_of(system, k) * end, change)
