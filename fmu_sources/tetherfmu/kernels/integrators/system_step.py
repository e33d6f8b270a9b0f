"""One step of Rodas4P for a system: all its lines and free points at once.

Each stage solves the equations of `rosenbrock.py` for all nodes. Those of the inner nodes of a line know its own ends only:
a line is condensed to its free ends (`linear_algebra.condensed`), and what is left of all lines is added up at the free
points,

    S y = b,   S, b: sums over the lines that meet there, the load on the point,

one system with a band (`linear_algebra.points`). Loops of lines are nothing special. Each line then has the solution of its
ends, and with it that of its inner nodes. A free point stands at the end of each of its lines: same numbers, same
arithmetic, same motion.

F at a stage counts times the mass of the start over that of the stage, as in a single tether, where the mass is that of the
whole point: `share_forces` gives each line its part.
"""

from tetherfmu.runtime import system_layout as places

from ..compilation import kernel
from ..equations.boundary import chain_during
from ..equations.lines import (
    add_at,
    band_of,
    clear,
    conditions_of,
    free_points,
    lines_of,
    load_at,
    motion_of,
    point_at,
    points_of,
    segments_of,
)
from ..equations.properties import point_mass
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.points import add_block, factorize_band, solve_band
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, put, scale, sub
from . import rosenbrock, system_drums
from .rodas4p import ALPHA, GAMMA_I, STAGES
from .system_drums import conditions_in_step
from .system_room import has_drum, integrator_of, is_any_reeling, is_any_turning, is_free, moves, turns

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
    return factorize_band(3 * free_points(system), band_of(system), points.matrix, points.pivots)


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
    """Condense line k to its free ends and add what is left to the matrix of the points (modified); False if singular."""
    n, room = segments_of(system, k), integrator_of(system, k)
    matrix, columns = room.w.matrix, room.columns
    if not condensed.condense(n, is_free(system, k, 0), is_free(system, k, 1), matrix, columns):
        return False
    for row_end in range(2):
        row = point_at(system, k, row_end)
        for column_end in range(2):
            column = point_at(system, k, column_end)
            if row != places.DRIVEN and column != places.DRIVEN:
                block = condensed.condensed_block(n, row_end, column_end, matrix, columns)
                add_block(band_of(system), row, column, block, points.matrix)
    return True


# --- a stage


@kernel
def start_stage(system, k, stage, time, h):
    """Argument and forces of a stage of line k into its scratch space, up to what `rosenbrock.right_hand_side` needs."""
    conditions, w = conditions_in_step(system, k), integrator_of(system, k).w
    now = time + ALPHA[stage] * h
    rosenbrock.combine(stage, h, w)
    ends, driven = rosenbrock.curves_of(conditions)
    rosenbrock.prescribe_ends(ends, driven, now, w)
    rosenbrock.stage_masses(conditions, stage, now, w)
    rosenbrock.stage_force(conditions, chain_during(conditions, now), now, w)
    if stage == 0:
        rosenbrock.take_force_rate(conditions, time, w)


@kernel
def start_stages(system, stage, time, h):
    """`start_stage` of all lines; False if a drum has no length."""
    for k in range(lines_of(system)):
        if turns(system, k):
            if not system_drums.start_stage_with_drum(system, k, stage, time, h):
                return False
        elif moves(system, k):
            start_stage(system, k, stage, time, h)
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
def reduce_line(system, k, stage, h, points):
    """Right-hand side of a stage of line k, condensed, and what is left of it into that of the points (modified)."""
    n, conditions, w = segments_of(system, k), conditions_of(system, k), integrator_of(system, k).w
    rosenbrock.right_hand_side(conditions, stage, h, w)
    condensed.reduce(n, w.matrix, w.q)
    for end in range(2):
        point = point_at(system, k, end)
        if point != places.DRIVEN:
            add_at(points.right, point, get(w.q, n * end))


@kernel
def expand_line(system, k, points):
    """Solution of a stage of line k from that of the points, into its scratch space."""
    n, room = segments_of(system, k), integrator_of(system, k)
    for end in range(2):
        point = point_at(system, k, end)
        put(room.w.q, n * end, ZERO_VECTOR if point == places.DRIVEN else get(points.right, point))
    condensed.expand(n, is_free(system, k, 0), is_free(system, k, 1), room.columns, room.w.q)


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
def solve_stage(system, stage, reels, time, h):
    """Solve a stage of all lines whose forces are known; the velocities go to their places."""
    points = points_of(system)
    place_loads(system, stage, reels, time, h, points)
    for k in range(lines_of(system)):
        if turns(system, k):
            system_drums.reduce_line_with_drum(system, k, stage, time, h, points)
        elif moves(system, k):
            reduce_line(system, k, stage, h, points)
    solve_band(3 * free_points(system), band_of(system), points.matrix, points.pivots, points.right)
    for k in range(lines_of(system)):
        if moves(system, k):
            expand_line(system, k, points)
            if turns(system, k):
                system_drums.turn_drum(system, k, stage, time, h)
            rosenbrock.take_velocities(segments_of(system, k), stage, integrator_of(system, k).w)
            if stage >= STAGES - 2:
                rosenbrock.add_stage(segments_of(system, k), stage, h, integrator_of(system, k).w)


@kernel
def step(system, time, h):
    """One step of h [s] of all lines from their states at a time [s] of the communication step; False if it is singular.

    The results stand in the scratch space of the lines, as after `rosenbrock.step`.
    """
    if not prepare(system, time, h):
        return False
    reels = is_any_reeling(system)
    for stage in range(STAGES):
        if not start_stages(system, stage, time, h):
            return False
        if reels:
            stage_masses(system, stage)
        if stage == 0 and not factorize(system, time, h):
            return False
        solve_stage(system, stage, reels, time, h)
    for k in range(lines_of(system)):
        if moves(system, k):
            rosenbrock.take_result(conditions_of(system, k), time + h, integrator_of(system, k).w)
            if has_drum(system, k):
                system_drums.take_drum(system, k, h)
    return True


# --- after a step


@kernel
def whole_masses(system, k):
    """Let the free ends of line k have the masses of their points [kg] (modified), for what judges and corrects a step."""
    points, n, w = points_of(system), segments_of(system, k), integrator_of(system, k).w
    for end in range(2):
        point = point_at(system, k, end)
        if point != places.DRIVEN:
            w.mass[n * end] = points.mass[point]


@kernel
def end_velocities(system, k):
    """Velocities [m/s] of start and end of line k in the result of the step."""
    w = integrator_of(system, k).w
    return get(w.v, 0), get(w.v, segments_of(system, k))


@kernel
def collect_changes(system, k, before):
    """Add what changed the velocities of the free ends of line k since `before` [m/s] to `Points.change`, and undo it."""
    points, n, w = points_of(system), segments_of(system, k), integrator_of(system, k).w
    for end in range(2):
        point, node = point_at(system, k, end), n * end
        if point != places.DRIVEN:
            velocity = before[1] if end == 1 else before[0]
            add_at(points.change, point, sub(get(w.v, node), velocity))
            put(w.v, node, velocity)


@kernel
def apply_changes(system, k):
    """Add `Points.change` [m/s] to the velocities of the free ends of line k in the result of the step (modified)."""
    points, n, w = points_of(system), segments_of(system, k), integrator_of(system, k).w
    for end in range(2):
        point, node = point_at(system, k, end), n * end
        if point != places.DRIVEN:
            put(w.v, node, add(get(w.v, node), get(points.change, point)))
