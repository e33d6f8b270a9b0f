"""A line of a system at rest between its two points, some of which are sought: its forces on them, and their slopes.

The line is in equilibrium (`dynamic_chain.initialize`), and never a compressed chain. The slopes of its forces by
the positions of its ends come from the matrix of Newton's method, condensed to them (`linear_algebra.condensed`). The
ground carries a point with its half segments like a node.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import OK

from ..compilation import kernel, view
from ..equations import assembly, segment
from ..equations.free_points import point_at
from ..equations.ground import carries, support, support_slope, under
from ..equations.lines import inputs_of, lines_of, motion_of, number_of_line, parameters_of, room_of, segments_of, state_of
from ..equations.properties import chain_of, property_of
from ..equations.ropes import is_turned, outputs_of_line
from ..flat_arrays import part
from ..linear_algebra import condensed
from ..linear_algebra.matrices import ZERO_MATRIX, scale_matrix, subtract
from ..linear_algebra.profile import add_block
from ..linear_algebra.vectors import ZERO_VECTOR, add_at, add_scaled, get, norm, put, scale, vector_at
from ..points.coordinates import LENGTH_AT_REST, is_shared_out, numbers_at_rest, start_speed
from ..points.room import globals_of
from ..step import transaction
from . import dynamic_chain, end_tensions, newton
from .rigid_body import Body


@kernel
def line_work_size(n):
    """Length of a line of n segments in `work`: for its equilibrium, then for the columns of its ends."""
    size = newton.workspace_size(n) + condensed.columns_size(n)
    return size + size % 2


@kernel
def is_sought(system, k, end):
    """Whether the point at the start (end 0) or at the end (1) of line k is a free point with a sought position."""
    return number_of_line(system, k, places.START_IS_SOUGHT + end) != 0


@kernel
def is_any_sought(system, k):
    """Whether the point at either end of line k is sought."""
    return is_sought(system, k, 0) or is_sought(system, k, 1)


@kernel
def any_sought(system):
    """Number of a free point with a sought position, or DRIVEN if there is none."""
    for k in range(lines_of(system)):
        for end in range(2):
            if is_sought(system, k, end):
                return point_at(system, k, end)
    return places.DRIVEN


@kernel
def is_point_sought(system, point):
    """Whether the position of a free point is sought."""
    count = 0
    for k in range(lines_of(system)):
        for end in range(2):
            count += is_sought(system, k, end) and point_at(system, k, end) == point
    return count > 0


@kernel
def given_position(system, k, end):
    """Input position [m] of an end of line k."""
    return vector_at(inputs_of(system, k), at.KITE_POSITION if end == 1 else at.GROUND_POSITION)


@kernel
def position(system, k, end, x):
    """Position [m] of an end of line k: from the free points x, if it is sought."""
    if is_sought(system, k, end):
        return get(x, point_at(system, k, end))
    return given_position(system, k, end)


@kernel
def start_state(system, k):
    """`transaction.start` of line k (modified), with the speed of its drums and its share of the rope length; a status."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    status = transaction.start(n, parameters, inputs_of(system, k), state)
    if is_turned(system, k):
        state[at.REELING] = start_speed(system, k)
    if status == OK and is_shared_out(system, k):
        state[at.LENGTH] = numbers_at_rest(system, k)[LENGTH_AT_REST]
        status = transaction.check_length(n, parameters, state[at.LENGTH])
    return status


@kernel
def shape_line(system, k, shape, x):
    """Put line k (modified) into a shape between its points, with the sought ones at x [m]; a status."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    status = start_state(system, k)
    if status != OK:
        return status
    nodes, v = motion_of(system, k)
    if shape == at.STATIC_EQUILIBRIUM:
        state[at.REELING] = 0.0  # its damper force would violate equilibrium
    for end in range(2):
        put(nodes, n * end, position(system, k, end, x))
        if shape == at.STATIC_EQUILIBRIUM:
            put(v, n * end, ZERO_VECTOR)
    return dynamic_chain.initialize(n, parameters, shape, state, room_of(system, k))


@kernel
def rest_line(system, k, x):
    """Bring line k to rest between its points, with the sought ones at x [m]; a status.

    Its state, its scratch space and its outputs in the scratch space are modified.
    """
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    status = shape_line(system, k, float(at.STATIC_EQUILIBRIUM), x)
    if status == OK:
        points = number_of_line(system, k, places.SHAPE_POINTS)
        dynamic_chain.outputs_of(n, parameters, state, points, room_outputs(system, k), room_of(system, k))
    return status


@view
def room_outputs(system, k):
    """Outputs of line k in the scratch space."""
    found = part(system.work, int(system.plan[places.OUTPUTS_WORK]), int(system.plan[places.OUTPUTS_SIZE]))
    return outputs_of_line(system, k, found)


@kernel
def force_at(system, k, end):
    """Force [N] of line k on the point at one of its ends, after `rest_line`."""
    return vector_at(room_outputs(system, k), at.KITE_FORCE if end == 1 else at.GROUND_FORCE)


@kernel
def rounding_at(system, k, end):
    """Tension rounding error [N] of line k at one of its ends."""
    n = segments_of(system, k)
    nodes, _ = motion_of(system, k)
    chain = chain_of(n, parameters_of(system, k), state_of(system, k))
    reach = max(norm(get(nodes, 0)), norm(get(nodes, n)))
    return end_tensions.rounding(chain, (n - 1) * end, reach)


@kernel
def take_tensions(body, w):
    """Spring tensions of a body [N] into w.tension (modified), if its positions determine them."""
    chain, x = body.chain, body.x
    reach = max(norm(get(x, 0)), norm(get(x, chain.n)))
    for s in range(chain.n):
        length, _ = segment.geometry(add_scaled(get(x, s + 1), -1.0, get(x, s)))
        pull = segment.spring_tension(chain, s, length)
        if chain.n == 1 or end_tensions.HELD * abs(pull) >= end_tensions.rounding(chain, s, reach):
            w.tension[s] = pull


@kernel
def add_slopes(system, k, search):
    """Subtract the slopes of the forces of line k at its sought points from S [N/m] (modified); False if singular.

    After `rest_line`.
    """
    n, parameters, state, room = segments_of(system, k), parameters_of(system, k), state_of(system, k), room_of(system, k)
    nodes, v = motion_of(system, k)
    w, columns = newton.workspace(n, room), part(room, newton.workspace_size(n), condensed.columns_size(n))
    body = Body(chain_of(n, parameters, state), ZERO_VECTOR, 0.0, nodes, v, under(parameters), nodes, False)
    take_tensions(body, w)
    newton.linearize(body, w)
    if n == 1:
        assembly.assemble(n, 0.0, 1.0, 1.0, w.mass, w.records, w.matrix)
    else:
        # piled nodes have no stiffness: use the stiffness of their weight, if there is no friction
        give = body.chain.gravity * property_of(body.chain, 0, at.LINE_DENSITY) if search.slides[0] != 0.0 else 0.0
        if not newton.factorize(body, give, w):
            return False
        rows = condensed.Rows(n, 1, n - 1, is_sought(system, k, 0), is_sought(system, k, 1))
        condensed.find_all_columns(rows, w.matrix, columns)
    for row_end in range(2):
        for column_end in range(2):
            if is_sought(system, k, row_end) and is_sought(system, k, column_end):
                block = condensed.condensed_block(n, row_end, column_end, w.matrix, columns)
                if row_end == column_end and carries(body.ground, get(nodes, n * row_end)):
                    slope = support_slope(body.ground, get(nodes, n * row_end), ZERO_VECTOR, ZERO_MATRIX)
                    block = subtract(block, scale_matrix(w.mass[n * row_end], slope))
                row, column = point_at(system, k, row_end), point_at(system, k, column_end)
                add_block(globals_of(system).matrix, 3 * row, 3 * column, block)
    return True


@kernel
def add_support(system, k, end, search):
    """Add the ground force on an end of line k, with its share of the point mass [N], after `rest_line`."""
    n, parameters = segments_of(system, k), parameters_of(system, k)
    nodes, _ = motion_of(system, k)
    x, ground, point = get(nodes, n * end), under(parameters), point_at(system, k, end)
    if carries(ground, x):
        mass = newton.workspace(n, room_of(system, k)).mass[n * end]
        force = scale(mass, support(ground, x, ZERO_VECTOR))
        add_at(search.residual, point, force)
        search.grip[point] += ground.friction * force[2]
