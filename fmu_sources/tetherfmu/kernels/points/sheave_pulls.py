"""What a portion of a rope over sheaves pulls at its ends at a stage, and what is known of a sheave: `sheaves.py`."""

from math import atan2, exp, sqrt

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..equations import flow, segment
from ..equations import rope_at_sheave as rope
from ..equations.end_motion import acceleration_at
from ..equations.free_points import is_at_point, load_at, point_at, points_of
from ..equations.lines import conditions_of, lines_of, parameters_of, segments_of
from ..equations.properties import property_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import comes_from, goes_on, is_even, is_turned, sheaves_of
from ..linear_algebra.both_ends import get_interleaved, get_node, get_two, lower_and_upper, put_interleaved, put_two
from ..linear_algebra.pairs import first, number_at, pair, second
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, cross, dot, get, norm, put, scale, sub, vector_at
from . import sheave_room as at_sheave
from .coordinates import coordinate_at, count_of, is_drum, number_of, own_numbers, runs, weight_of
from .sheave_room import PULLED, gain_of, numbers_at, parts_of, portion_in_step, ratio_of, single_at
from .system_room import integrator_of


@kernel
def mass_of(system, k):
    """m of the sheave at the end of line k [kg]."""
    return parameters_of(system, k)[at.SHEAVE_MASS]


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
def has_losses(system, k):
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
    if not has_losses(system, k):
        return 1.0
    n, x_1, x_2 = segments_of(system, k), integrator_of(system, k).stage_x, integrator_of(system, k + 1).stage_x
    here = get_node(n, n, x_1)
    return loss_with(system, k, sub(get_node(n, n - 1, x_1), here), sub(get_node(segments_of(system, k + 1), 1, x_2), here))


@view
def take_segments(chain, are_interleaved, is_uniform, last_part, nodes, pulled, force):
    """R_a and R_b of a portion without accelerations [N], what is in minus their slopes by a', b' of rope alone: aa, ab, bb.

    And col of its nodes into `pulled` (modified). Two segments at a time, as in `assembly.node_forces`.
    are_interleaved : whether positions and velocities are, as a constant; then `force`, too, which gets the forces of rope
    that flows (modified).  last_part : w of the last node.  nodes : as of `sheave_slopes.take_row`.
    """
    n, (x, v, modes), nothing = chain.n, nodes, pair(0.0, 0.0)
    own, part, col = rope.rope_of(chain, (0, n - 1)), pair(1.0, last_part), pair(ZERO_VECTOR, ZERO_VECTOR)
    flows = are_interleaved and (chain.reeling != 0.0 or chain.leaving != 0.0)
    lowest, highest = (get_node(n, 0, x), get_node(n, n, x)) if are_interleaved else (get(x, 0), get(x, n))
    at_ends = rope.of_speed(own, pair(1.0, -1.0), pair(chain.reeling + chain.leaving, chain.leaving))
    pull_a, pull_b, own_aa, own_ab, own_bb, last = nothing, nothing, nothing, nothing, nothing, flow.no_forces()
    for s in range((n + 1) // 2):
        if are_interleaved:
            (x_p, x_q), (v_p, v_q) = lower_and_upper(n, s, x), lower_and_upper(n, s, v)
        else:
            x_p, x_q = get_two(x, s, n - 1 - s), get_two(x, s + 1, n - s)
            v_p, v_q = get_two(v, s, n - 1 - s), get_two(v, s + 1, n - s)
        if not is_uniform:
            own = rope.rope_of(chain, (s, n - 1 - s))
        inner = part + pair(-1.0, 1.0) * own.share
        below, above = pair(first(part), second(inner)), pair(first(inner), second(part))
        r, u, mode = sub(x_q, x_p), sub(v_q, v_p), number_at(modes, 0, (s, n - 1 - s))
        height = segment.mean_height(x_p, x_q)
        c = rope.flowing(chain, below, above)
        of_a, of_b = rope.pulls(own, chain, below, c, mode, r, u, height - lowest[2], height - highest[2])
        aa, ab, bb = rope.inertias(own, below, dot(r, r))
        once = pair(1.0, 0.0 if 2 * s + 1 == n else 1.0)  # a segment in the middle is met twice
        pull_a, pull_b = pull_a + once * of_a, pull_b + once * of_b
        own_aa, own_ab, own_bb = own_aa + once * aa, own_ab + once * ab, own_bb + once * bb
        of_nodes = scale(-1.0 * own.half, r)
        put_two(pulled, s, n - s, add(col, of_nodes))
        if flows:
            now = flow.forces_of(flow.slopes_with(own.half, own.rest, c, (nothing, nothing)), r, u)
            flow.add_to_two(s, last, now, force)
            last = now
        part, col = inner, of_nodes
    if n % 2 == 0:
        put(pulled, n // 2, add(first(col), second(col)))
        if flows:
            flow.add_to_middle(n, last, force)
    pulls = first(pull_a) + second(pull_a) + first(at_ends), first(pull_b) + second(pull_b) + second(at_ends)
    return pulls, (first(own_aa) + second(own_aa), first(own_ab) + second(own_ab), first(own_bb) + second(own_bb))


@kernel
def take_pulls(system, k, time):
    """PULL and YIELD of portion k at a stage, once its forces are known, and PULLED (all modified); rope's own inertia back.

    Without what its ends add where they are free points. The forces on its nodes get what rope that flows does, and a winch
    that gains speed.
    """
    conditions, numbers = conditions_of(system, k), numbers_at(system, k)
    w, pulled = integrator_of(system, k), single_at(system, k, PULLED)
    n, parts, gain = conditions.n, parts_of(system, k), 0.0
    given = is_even(system, k), parts[n], (w.stage_x, w.stage_v, w.modes)
    (pull_a, pull_b), own = take_segments(portion_in_step(system, k), True, *given, pulled, w.force)
    if not comes_from(system, k) and not is_turned(system, k):
        gain = numbers[at_sheave.INTO_GAIN]
        push(n, gain, 0.0, parts, pulled, w.force)
    pull_a, pull_b = pull_a - own[0] * gain, pull_b - own[1] * gain
    yield_aa, yield_ab, yield_bb = -own[0], -own[1], -own[2]
    for i in range(1, n):
        col, share, of_a = get(pulled, i), 1.0 / w.stage_mass[i], parts[i]
        along, square, of_b = share * dot(col, get_node(n, i, w.force)), share * dot(col, col), 1.0 - of_a
        pull_a += of_a * along
        pull_b += of_b * along
        yield_aa += of_a * of_a * square
        yield_ab += of_a * of_b * square
        yield_bb += of_b * of_b * square
    if conditions.first == 1:
        pull_a += dot(get(pulled, 0), acceleration_at(conditions.ground, time))
    if conditions.last == n - 1:
        pull_b += dot(get(pulled, n), acceleration_at(conditions.kite, time))
    numbers[at_sheave.PULL], numbers[at_sheave.PULL + 1] = pull_a, pull_b
    numbers[at_sheave.YIELD], numbers[at_sheave.YIELD + 1], numbers[at_sheave.YIELD + 2] = yield_aa, yield_ab, yield_bb
    return own


@kernel
def push(n, gain_a, gain_b, parts, pulled, force):
    """Add what a' and b' [m/s2] do to the nodes of a portion to the forces on them (modified, interleaved)."""
    for i in range(n // 2 + 1):
        gain = gain_b + (gain_a - gain_b) * number_at(parts, 0, (i, n - i))
        put_interleaved(force, i, add(get_interleaved(force, i), scale(gain, get_two(pulled, i, n - i))))


@kernel
def force_on_point(system, point, time):
    """Force on a free point [N] at a stage, of all lines and of the load, but for what coordinates that gain speed add."""
    total = load_at(system, point, time)
    for other in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, other, end) and point_at(system, other, end) == point:
                n = segments_of(system, other)
                total = add(total, get_node(n, n * end, integrator_of(system, other).force))
    return total


@kernel
def column_at_point(system, k):
    """What the sheave at the end of line k does to its point per u' [kg] at a stage."""
    return add(get(single_at(system, k, PULLED), segments_of(system, k)), get(single_at(system, k + 1, PULLED), 0))


@kernel
def column_of_drum(system, c, point):
    """The same of a drum and a free point; 0 where none of its lines begins there."""
    total = ZERO_VECTOR
    for k in range(lines_of(system)):
        weight = weight_of(system, c, k, IN)
        if weight != 0.0 and point_at(system, k, 0) == point:
            total = add_scaled(total, weight, get(single_at(system, k, PULLED), 0))
    return total


@kernel
def column_of(system, c, point):
    """What a coordinate does to a free point per u' [kg] at a stage."""
    if is_drum(system, c):
        return column_of_drum(system, c, point)
    return column_at_point(system, c) if point_at(system, c, 1) == point else ZERO_VECTOR


@kernel
def acceleration_at_sheave(system, k):
    """Acceleration of the free point at the end of line k [m/s2] at a stage, with what the coordinates there do."""
    return acceleration_with(system, point_at(system, k, 1), vector_at(numbers_at(system, k), at_sheave.FORCE))


@kernel
def acceleration_with(system, point, force):
    """The same of a free point, from `force_on_point` [N]."""
    total = force
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if runs(system, c):
            total = add_scaled(total, own_numbers(system, c)[at_sheave.GAIN], column_of(system, c, point))
    return scale(1.0 / points_of(system).stage_mass[point], total)


@kernel
def end_acceleration(system, k, end, time):
    """Acceleration [m/s2] of the start (end 0) or the end (1) of portion k at a stage, which is no sheave that is free."""
    conditions = conditions_of(system, k)
    curve = conditions.kite if end == 1 else conditions.ground
    if not is_at_point(system, k, end):
        return acceleration_at(curve, time)
    point = point_at(system, k, end)
    return acceleration_with(system, point, force_on_point(system, point, time))


# --- what accelerations do to pulls


@kernel
def pull_with(system, k, side):
    """R_a (side IN) or R_b (OUT) of portion k at a stage with u' of all coordinates [N]: but for what free points gain."""
    numbers, other = numbers_at(system, k), 1 - side
    pull = numbers[at_sheave.PULL + side] + numbers[at_sheave.YIELD + 2 * side] * gain_of(system, k, side)
    if goes_on(system, k) if other == OUT else (comes_from(system, k) or is_turned(system, k)):
        pull += numbers[at_sheave.YIELD + 1] * gain_of(system, k, other)
    return pull


@kernel
def couple(system, j, k, side, slope, matrix):
    """Add slopes by the rates of portion k to row j of a matrix (modified); slope : by R_a (side IN) or by R_b (OUT)."""
    count, numbers = count_of(system), numbers_at(system, k)
    if goes_on(system, k):
        matrix[count * j + number_of(system, k)] += slope * numbers[at_sheave.YIELD + side + OUT]
    into = slope * numbers[at_sheave.YIELD + side + IN]
    if comes_from(system, k):
        matrix[count * j + number_of(system, k - 1)] += into
    elif is_turned(system, k):
        add_for_drums(system, j, k, into, matrix)


@kernel
def add_for_drums(system, j, k, slope, matrix):
    """Add a slope by the rate of rope into line k to row j of a matrix (modified), as one by the speeds of its drums."""
    count, lines = count_of(system), lines_of(system)
    for i in range(sheaves_of(system), count):
        matrix[count * j + i] += slope * ratio_of(system, k, coordinate_at(system, i) - lines)


@kernel
def couple_at_point(system, j, point, slope, matrix):
    """The same of the acceleration of a free point; slope : by it [kg]."""
    count, slope = count_of(system), scale(1.0 / points_of(system).stage_mass[point], slope)
    for i in range(count):
        c = coordinate_at(system, i)
        if is_drum(system, c) or point_at(system, c, 1) == point:
            matrix[count * j + i] += dot(slope, column_of(system, c, point))


@kernel
def tension_in(stiffness, pull):
    """`rope_at_drum.tension_of` without a difference of numbers that are almost equal."""
    return pull if pull <= 0.0 else 2.0 * pull / (1.0 + sqrt(1.0 + 2.0 * pull / stiffness))
