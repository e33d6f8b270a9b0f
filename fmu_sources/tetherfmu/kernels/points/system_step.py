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

from tetherfmu.runtime import plan_layout as places

from ..compilation import kernel, view
from ..equations.boundary import chain_during, hold_ends
from ..equations.lines import (
    add_at,
    clear,
    conditions_of,
    free_points,
    is_at_point,
    lines_of,
    load_at,
    motion_of,
    point_at,
    points_of,
    rows_of,
    segments_of,
    size_of_blocks,
)
from ..equations.properties import point_mass
from ..line import rosenbrock
from ..line.rodas4p import ALPHA, GAMMA_I, STAGES
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.pairs import first, second
from ..linear_algebra.point_blocks import add_to_block, factorize_blocks, solve_blocks
from ..linear_algebra.vectors import add, add_scaled, get, put, scale, sub
from . import system_drums
from .system_drums import conditions_in_step
from .system_room import has_drum, integrator_of, is_any_reeling, is_any_turning, moves, turns

# --- the matrix of a step


@kernel
def prepare(system, time, h):
    """Matrices of a step of all lines, condensed, and that of the points; False if one is singular."""
    points = points_of(system)
    clear(points.matrix)
    clear(points.mass)
    clear(points.mass_rate)
    for k in range(lines_of(system)):
        if moves(system, k):
            form_line(system, k, time, h)
            if not condense_line(system, k, points):
                return False
    return True


@kernel
def factorize(system, time, h):
    """Factor the matrix of the points, with the drums that turn, once the forces of stage 0 are known; False: singular."""
    points = points_of(system)
    if is_any_turning(system):
        place_loads(system, 0, False, time, 0.0, points)
        if not system_drums.place_drums(system, time, h):
            return False
    return factorize_blocks(*size_of_blocks(system), points.matrix)


@kernel
def form_line(system, k, time, h):
    """Matrix of a step of line k into its scratch space, see `rosenbrock.form`."""
    x, v = motion_of(system, k)
    if turns(system, k):
        system_drums.form_with_drum(system, k, time, h)
    else:
        rosenbrock.form(conditions_in_step(system, k), time, h, x, v, integrator_of(system, k).w)
    add_masses(system, k, time)


@kernel
def add_masses(system, k, time):
    """Add the end masses of line k [kg] and their rates [kg/s] to those of its free points (modified)."""
    points, n, mass = points_of(system), segments_of(system, k), integrator_of(system, k).w.mass
    chain = chain_during(conditions_of(system, k), time)
    for end in range(2):
        point, node = point_at(system, k, end), n * end
        if point != places.DRIVEN:
            points.mass[point] += mass[node]
            points.mass_rate[point] += (mass[node] - point_mass(chain, node)) * chain.growth


@kernel
def condense_line(system, k, points):
    """Condense line k to its free points and add what is left to the matrix of the points (modified); False if singular."""
    n, room = segments_of(system, k), integrator_of(system, k)
    matrix, columns, size = room.w.matrix, room.columns, size_of_blocks(system)
    start, end, rows = point_at(system, k, 0), point_at(system, k, 1), rows_of(system, k)
    if not condensed.condense(rows, matrix, columns):
        return False
    if rows.start_is_shared and rows.end_is_shared:
        own, across = condensed.condensed_blocks(n, matrix, columns)
        add_to_block(*size, start, start, first(own), points.matrix)
        add_to_block(*size, end, end, second(own), points.matrix)
        add_to_block(*size, start, end, first(across), points.matrix)
        add_to_block(*size, end, start, second(across), points.matrix)
    elif rows.start_is_shared:
        add_to_block(*size, start, start, condensed.condensed_block(n, 0, 0, matrix, columns), points.matrix)
    elif rows.end_is_shared:
        add_to_block(*size, end, end, condensed.condensed_block(n, 1, 1, matrix, columns), points.matrix)
    return True


# --- a stage


@view
def start_stage(conditions, w, stage, time, h):
    """Argument and forces of a stage of a line into its scratch space, up to what `rosenbrock.right_hand_side` needs."""
    now = time + ALPHA[stage] * h
    rosenbrock.combine(stage, h, w)
    if conditions.first == 1 or conditions.last == conditions.n - 1:
        ends, driven = rosenbrock.curves_of(conditions)
        rosenbrock.prescribe_ends(ends, driven, now, w)
    rosenbrock.stage_masses(conditions, stage, now, w)
    rosenbrock.stage_force(conditions, chain_during(conditions, now), now, w)
    if stage == 0:
        rosenbrock.take_force_rate(conditions, time, w)


@view
def reduce_line(system, k, conditions, w, stage, h, points):
    """Right-hand side of a stage of line k, condensed, and what is left of it into that of the points (modified)."""
    rosenbrock.right_hand_side(conditions, stage, h, w)
    condensed.solve_inner(rows_of(system, k), w.matrix, w.q)
    for end in range(2):
        point = point_at(system, k, end)
        if point != places.DRIVEN:
            add_at(points.right, point, condensed.what_is_left(conditions.n, end, w.matrix, w.q))


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


@kernel
def solve_points(system, points):
    """Solution of a stage at the free points (modified) from their right-hand side."""
    solve_blocks(*size_of_blocks(system), points.matrix, points.right, points.solution)


@view
def expand_line(system, k, n, room, points):
    """Solution of a stage of line k from that of the points, into its scratch space."""
    hold_ends(conditions_of(system, k), room.w.q)
    for end in range(2):
        if is_at_point(system, k, end):
            put(room.w.q, n * end, get(points.solution, point_at(system, k, end)))
    condensed.expand(rows_of(system, k), room.columns, room.w.q)


@view
def end_stage(n, w, stage, h):
    """Velocities of a stage of a line, whose solution is in its scratch space, to their places there."""
    rosenbrock.take_velocities(n, stage, w)
    if stage >= STAGES - 2:
        rosenbrock.add_stage(n, stage, h, w)


# --- all stages


@kernel
def solve_stages(system, time, h):
    """All stages; False if the matrix of the points is singular or a drum has no length.

    Where lines reel, the masses of the points at a stage are known once all lines have begun it, and so are the forces.
    """
    reels = is_any_reeling(system)
    for stage in range(STAGES):
        if not start_stages(system, stage, time, h):
            return False
        if reels:
            stage_masses(system, stage)
        if stage == 0 and not factorize(system, time, h):
            return False
        solve_stage(system, stage, reels, time, h)
    return True


@kernel
def start_stages(system, stage, time, h):
    """`start_stage` of all lines; False if a drum has no length."""
    for k in range(lines_of(system)):
        if turns(system, k):
            if not system_drums.start_stage_with_drum(system, k, stage, time, h):
                return False
        elif moves(system, k):
            start_stage(conditions_in_step(system, k), integrator_of(system, k).w, stage, time, h)
    return True


@kernel
def add_stage_masses(system, k):
    """Add the end masses of line k at a stage [kg] to those of its free points (modified)."""
    points, n, stage_mass = points_of(system), segments_of(system, k), integrator_of(system, k).w.stage_mass
    for end in range(2):
        point = point_at(system, k, end)
        if point != places.DRIVEN:
            points.stage_mass[point] += stage_mass[n * end]


@kernel
def share_forces(system, k, stage):
    """Let the forces at the free ends of line k count as parts of those on points whose masses change (modified).

    `rosenbrock.without_damping` multiplies F by m_0/m of the node; that of the point, M_0/M, is to be the factor. The rate
    of M v' has -F/M_0 dM/dt.
    """
    points, n, w = points_of(system), segments_of(system, k), integrator_of(system, k).w
    for end in range(2):
        point, node = point_at(system, k, end), n * end
        if point != places.DRIVEN:
            force = get_node(n, node, w.force)
            if stage == 0:
                rate = add_scaled(get(w.q, node), -points.mass_rate[point] / points.mass[point], force)
                add_to_node(n, node, sub(rate, get_node(n, node, w.force_rate)), w.force_rate)
            own = points.mass[point] / points.stage_mass[point] * (w.stage_mass[node] / w.mass[node])
            add_to_node(n, node, scale(own - 1.0, force), w.force)


@kernel
def stage_masses(system, stage):
    """Masses of the free points at a stage, and the forces that follow from them, in a system that reels (modified)."""
    clear(points_of(system).stage_mass)
    for k in range(lines_of(system)):
        if moves(system, k):
            add_stage_masses(system, k)
    for k in range(lines_of(system)):
        if moves(system, k):
            share_forces(system, k, stage)


@kernel
def solve_stage(system, stage, reels, time, h):
    """Solve a stage of all lines whose forces are known; velocities go to their places. reels : whether any line does."""
    points = points_of(system)
    place_loads(system, stage, reels, time, h, points)
    for k in range(lines_of(system)):
        if turns(system, k):
            system_drums.reduce_line_with_drum(system, k, stage, time, h, points)
        elif moves(system, k):
            reduce_line(system, k, conditions_of(system, k), integrator_of(system, k).w, stage, h, points)
    solve_points(system, points)
    for k in range(lines_of(system)):
        if moves(system, k):
            n, room = segments_of(system, k), integrator_of(system, k)
            expand_line(system, k, n, room, points)
            if turns(system, k):
                system_drums.turn_drum(system, k, stage, h)
            end_stage(n, room.w, stage, h)


@kernel
def step(system, time, h):
    """One step of h [s] of all lines from their states at a time [s] of the communication step; False if it is singular.

    The results stand in the scratch space of the lines: x and v, with their error estimates U_x/d in q and U_v in
    velocity_error.
    """
    if not prepare(system, time, h) or not solve_stages(system, time, h):
        return False
    for k in range(lines_of(system)):
        if moves(system, k):
            rosenbrock.take_result(conditions_of(system, k), time + h, integrator_of(system, k).w)
            if has_drum(system, k):
                system_drums.take_drum(system, k, h)
    return True


# --- after a step


@view
def whole_masses(system, k, w):
    """Let the free ends of line k have the masses of their points [kg] (modified), for what judges and corrects a step."""
    points, n = points_of(system), segments_of(system, k)
    for end in range(2):
        point = point_at(system, k, end)
        if point != places.DRIVEN:
            w.mass[n * end] = points.mass[point]


@view
def collect_changes(system, k, before, w):
    """Add what changed the velocities of the free ends of line k since `before` [m/s] to `Points.change`, and undo it.

    before : of start and end.  Returns how many have changed.
    """
    points, n = points_of(system), segments_of(system, k)
    changed = 0
    for end in range(2):
        point, node = point_at(system, k, end), n * end
        velocity = before[1] if end == 1 else before[0]
        change = sub(get(w.v, node), velocity)
        if point != places.DRIVEN and not (change[0] == 0.0 and change[1] == 0.0 and change[2] == 0.0):
            add_at(points.change, point, change)
            put(w.v, node, velocity)
            changed += 1
    return changed


@kernel
def apply_changes(system, k):
    """Add `Points.change` [m/s] to the velocities of the free ends of line k in the result of the step (modified)."""
    points, n, w = points_of(system), segments_of(system, k), integrator_of(system, k).w
    for end in range(2):
        point, node = point_at(system, k, end), n * end
        if point != places.DRIVEN:
            put(w.v, node, add(get(w.v, node), get(points.change, point)))
