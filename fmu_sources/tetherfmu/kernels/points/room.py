"""Scratch space of a step: for each line, and for the global unknowns (free points and rope coordinates).

The layout is fixed once a communication step has begun (`begin_coordinates`). Each line end has holders: the coordinates
that let rope in over it, each with a weight. The weight is +1 for the line's own drum, the ratio for a shared drum, and for
a sheave -1 at the end of the portion before it and +1 at the start of the next one. The length of a line without holders is
a polynomial of time (`equations/winch.py`); with holders, it is that polynomial plus the rope they let in.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..arrays import behind, clear, places_of
from ..compilation import PARTS, kernel, view
from ..equations import winch
from ..equations.boundary import chain_during, chain_with, portion_moving
from ..equations.drum import drum_of
from ..equations.free_points import free_points, is_at_point, point_at
from ..equations.lines import (
    CONDITIONS,
    conditions_of,
    hold_length,
    lines_of,
    motion_of,
    number_in,
    parameters_of,
    put_reeling,
    room_of,
    segments_of,
    state_of,
)
from ..equations.parts import is_parted
from ..equations.properties import chain_with_flow, property_of, section_of
from ..equations.rope import feels_rope
from ..equations.ropes import comes_from, goes_on, has_coordinates, has_sheaves, is_freed, is_portion, is_turned
from ..flat_arrays import part
from ..line import rosenbrock, second_order
from ..line.backward_euler import WHOLE
from ..line.incremental_potential import Attempt
from ..line.rodas4p import STAGES
from ..line.strand_room import (
    DRUM,
    FACTOR,
    FIRST_LENGTH,
    GAIN,
    HELD_GAIN,
    HOLDER,
    HOLDERS,
    INERTIA,
    LATE,
    LENGTH,
    NUMBERS,
    RATE,
    REST,
    RUNS,
    SECOND_PART,
    SHEAVE,
    WEIGHT,
    Strand,
    rope_in,
    ropes_size,
    weights_in,
)
from ..linear_algebra import condensed, profile
from ..linear_algebra.both_ends import interleaved_size
from ..linear_algebra.profile import Profile
from .coordinates import carries_drum, has_own_drum, part_of_shortest, shortest_of

# --- numbers of a coordinate

(
    LINE,  # line before the sheave, or line that carries the drum
    IS_DRUM,
    MASS,  # m [kg], c [N s/m], W [N] and its rate [N/s]
    DAMPING,
    LOAD,
    LOAD_RATE,
    FRICTION,  # F of a drum [N]; of a sheave 1 if it has losses, else 0
    PASSED,  # rope since `settle` [m], speed [m/s], acceleration [m/s2]: in the state
    SPEED,
    ACCELERATION,
    PASSED_NOW,  # these at a stage, finally after the step
    SPEED_NOW,
    GAIN_NOW,
    OF_REST,  # r_i of a stage [m/s]
    ADDED_UP,  # sum over the stages, for the inertia [m/s]
    SPEEDS,  # U of all stages [m/s]
    WRONG,  # error estimates: rope over d, and speed [m/s]
    WRONG_SPEED,
    BY_SPEED,  # slope of the opposing force by the speed, at the start of the step [N s/m]
    TOTAL,  # rope passed since the start of the communication step, before `settle` [m]
    IS_MASSLESS,  # 1: a massless drum, driven only by the tension of the first segment
    TURNED_BACK,  # 1: a massless drum has reversed under friction, which now holds it
    SIGN,  # sign of the speed in the friction law; 0 without friction or if undetermined
    IS_HELD,  # 1: at rest in this piece of time
    IS_BRAKED,  # 1: all its lines are broken
    LOSS,  # E of a sheave at a stage [-]
    PULLED,  # rope forces without friction, their magnitudes, opposing forces [N]
    AGAINST,
    MAGNITUDE,
    EVENT,  # event that happened in a step, and its margin (below 0)
    ROOM,
    STARTED,  # how often it was started while `events.turn` searched
    KEPT,  # PASSED_NOW, SPEED_NOW and GAIN_NOW of a trial step
    # fixed steps
    REACHED,  # PASSED and SPEED at the start of the step or stage
    REACHED_SPEED,
    START_SPEED,  # speed [m/s] and rope [m] at the start of a three-stage step
    START_PASSED,
    ONWARD_PASSED,  # start of the third stage without the result of the second
    ONWARD_SPEED,
    BEFORE,  # speeds in the last but one stage and in the one before [m/s]
    LONG_BEFORE,
    KEEPS,  # sign that friction keeps the speed from changing in the step; 0: free
    LOWEST,  # speed limits in the iteration [m/s]
    HIGHEST,
    WAY,  # assumed state in the iteration, and its speed if prescribed [m/s]
    SOUGHT,
    CHANGE,  # change in the last iteration [m/s]
    IS_FOUND,  # 1 if the assumed state was confirmed and tensions converged; else 0
    _,
    COORDINATE,
) = places_of(*[1] * 15, STAGES, *[1] * 16, 3, *[1] * 15, 1)

LEAST_LENGTH = 0.25  # lower bound of a line in an iteration or a trial step, see `part_of_shortest`
COUNT, IS_KNOWN, HEADER = 0, 1, 2  # global unknowns: number of coordinates; whether tensions match the states

Room = namedtuple("Room", "numbers columns weights ropes z stage_z own")
Room.__doc__ = """Scratch arrays of a line.

numbers, weights, ropes : see `line/strand_room.py`.  columns : of its ends, see `linear_algebra.condensed`.
z, stage_z : accelerations of the nodes at the start of the step and at a stage [m/s2], interleaved.
own : arrays of the methods, see `own_size`."""
Globals = namedtuple("Globals", "header right solution accelerations matrix")
Globals.__doc__ = """Scratch arrays of m = 3 (free points) + coordinates unknowns.

header : COUNT, ...  right, solution, accelerations : m numbers each.
matrix : `Profile`. The numbers of all coordinates follow the header, see `coordinate_at`."""

# --- sizes


@kernel
def own_size(n):
    """Length of the arrays of a line for both methods: Rosenbrock steps (with rows and columns of both) and fixed steps.

    Both start with `arrays.shared_arrays`.
    """
    return fixed_at(n) + second_order.workspace_size(n)


@kernel
def fixed_at(n):
    """Offset of the other arrays of a fixed step, an even number."""
    size = rosenbrock.workspace_size(n)
    return size + size % 2


@kernel
def line_work_size(n):
    """Length of a line of n segments in `work`: an even number, so that pairs do not cross cache lines."""
    size = CONDITIONS + condensed.columns_size(n) + NUMBERS + own_size(n) + 4 * (n + 1) + ropes_size(n)
    size += 2 * interleaved_size(n)
    return size + size % 2


@kernel
def globals_size(points, band, coordinates):
    """Length of the global arrays in `work`, for these numbers of free points and coordinates (maximum), and this band."""
    m = 3 * points + coordinates
    size = HEADER + 5 * m + 2 * profile_size(points, band, coordinates) + COORDINATE * coordinates
    return size + size % 2


@kernel
def profile_size(points, band, coordinates):
    """Maximum number of entries in one triangle of the global matrix."""
    return 9 * points * (band + 1) + coordinates * (3 * points + coordinates)


@kernel
def most_coordinates(system):
    """Maximum number of coordinates of a system."""
    return number_in(system.plan, places.SHEAVES) + lines_of(system)


# --- views


@view
def room_in_step(system, k):
    """`Room` of line k."""
    n, room = segments_of(system, k), behind(CONDITIONS, room_of(system, k))
    columns, two, ropes = condensed.columns_size(n), interleaved_size(n), ropes_size(n)
    numbers, ends, room = part(room, 0, NUMBERS), part(room, NUMBERS, columns), behind(NUMBERS + columns, room)
    own, room = part(room, 0, own_size(n)), behind(own_size(n), room)
    motion = part(room, 0, two), part(room, two, two)
    weights = part(room, 2 * two + ropes, 4 * (n + 1))
    return Room(numbers, ends, weights, part(room, 2 * two, ropes), *motion, own)


@view
def numbers_of(system, k):
    """Numbers of line k, indexed by the constants above."""
    return part(behind(CONDITIONS, room_of(system, k)), 0, NUMBERS)


@view
def columns_of(system, k):
    """Columns of the ends of line k."""
    return room_in_step(system, k).columns


@view
def weights_of(system, k):
    """`Weights` of line k."""
    return weights_in(segments_of(system, k), room_in_step(system, k).weights)


@view
def rope_at(system, k, end):
    """`Rope` of an end of line k."""
    return rope_in(segments_of(system, k), room_in_step(system, k).ropes, end)


@view
def strand_of(system, k):
    """`Strand` of line k in a Rosenbrock step."""
    n, room = segments_of(system, k), room_in_step(system, k)
    own = room.numbers, weights_in(n, room.weights), room.ropes, room.z, room.stage_z
    return Strand(n, conditions_of(system, k), *own, rosenbrock.workspace(n, room.own))


@view
def integrator_of(system, k):
    """`rosenbrock.Workspace` of line k."""
    return rosenbrock.workspace(segments_of(system, k), room_in_step(system, k).own)


@view
def stages_of(system, k):
    """`second_order.Workspace` of line k."""
    n, own = segments_of(system, k), room_in_step(system, k).own
    return second_order.workspace(n, own, behind(fixed_at(n), own))


@view
def scratch_of(system, k):
    """`backward_euler.Workspace` of line k."""
    return stages_of(system, k).chain


@view
def globals_of(system):
    """`Globals` of a system."""
    points, count = free_points(system), most_coordinates(system)
    m, size = 3 * points + count, profile_size(points, number_in(system.plan, places.BAND), count)
    room = behind(number_in(system.plan, places.SHEAVES_WORK), system.work)
    header, room = part(room, 0, HEADER), behind(HEADER + COORDINATE * count, room)
    vectors = part(room, 0, m), part(room, m, m), part(room, 2 * m, m)
    first, start, room = part(room, 3 * m, m), part(room, 4 * m, m), behind(5 * m, room)
    matrix = Profile(first, start, part(room, 0, size), part(room, size, size))
    return Globals(header, *vectors, matrix)


@view
def coordinate_at(system, j):
    """Numbers of coordinate j."""
    first = number_in(system.plan, places.SHEAVES_WORK) + HEADER
    return part(system.work, first + COORDINATE * j, COORDINATE)


@view
def speeds_of(own):
    """Stage increments U of the speed of a coordinate [m/s], from its numbers."""
    return part(own, SPEEDS, STAGES)


@kernel
def count_of(system):
    """Number of coordinates of a system, within a communication step."""
    return int(system.work[number_in(system.plan, places.SHEAVES_WORK) + COUNT])


@kernel
def unknowns_of(system):
    """Number of global unknowns: three per free point, then one per coordinate."""
    return 3 * free_points(system) + count_of(system)


@kernel
def line_of(system, j):
    """Line before a sheave, or line that carries a drum."""
    return int(coordinate_at(system, j)[LINE]) if lines_of(system) > 1 else 0


@kernel
def is_drum(system, j):
    """Whether a coordinate is a drum."""
    return not has_sheaves(system) or coordinate_at(system, j)[IS_DRUM] != 0.0


@kernel
def is_free(system, j):
    """Whether a coordinate may move in this piece of time."""
    return coordinate_at(system, j)[IS_HELD] == 0.0


@kernel
def count_free(system):
    """Number of coordinates that may move in this piece of time."""
    count = 0
    for j in range(count_of(system)):
        count += is_free(system, j)
    return count


@kernel
def is_held(system, k, end):
    """Whether a coordinate lets rope into line k over an end, in a piece of time in which such a coordinate moves."""
    return holders_of(system, k, end) > 0 and numbers_of(system, k)[RUNS] != 0.0


@kernel
def has_rope(system, k):
    """Whether a coordinate lets rope in over either end, in such a piece of time."""
    return numbers_of(system, k)[RUNS] != 0.0


@kernel
def is_rope(system, k):
    """Whether line k has holders, moving or not."""
    return holders_of(system, k, 0) + holders_of(system, k, 1) > 0


@kernel
def holders_of(system, k, end):
    """Number of holders of an end of line k."""
    if end == 1 and not has_sheaves(system):
        return 0
    return int(numbers_of(system, k)[HOLDERS + end])


@kernel
def holder(system, k, end, i):
    """Holder i of an end of line k: the number of its coordinate, and its weight."""
    if not has_coordinates(system):
        return int(numbers_of(system, k)[DRUM]), 1.0
    place = at.MOST_HOLDERS * end + i
    return int(numbers_of(system, k)[HOLDER + place]), numbers_of(system, k)[WEIGHT + place]


@kernel
def weight_of(system, j, k, end):
    """Weight [-] of coordinate j at an end of line k; 0 if it is not a holder."""
    total = 0.0
    for i in range(holders_of(system, k, end)):
        which, weight = holder(system, k, end, i)
        total += weight if which == j else 0.0
    return total


@kernel
def growth_of(system, j, k):
    """Lengthening of line k per metre that passes coordinate j [-]."""
    return weight_of(system, j, k, 0) + weight_of(system, j, k, 1)


@kernel
def let_in(system, k, end, which):
    """Sum over the holders of an end of line k of weight times the number `which`."""
    total = 0.0
    for i in range(holders_of(system, k, end)):
        j, weight = holder(system, k, end, i)
        total += weight * coordinate_at(system, j)[which]
    return total


@kernel
def let_in_over_both(system, k, which):
    """Sum of `let_in` over both ends: the effect on the length of line k."""
    return let_in(system, k, 0, which) + let_in(system, k, 1, which)


# --- start of a communication step


@kernel
def begin_coordinates(system):
    """Begin a communication step of all lines, points and coordinates (modified) from their states."""
    header, count = globals_of(system).header, 0
    header[COUNT] = header[IS_KNOWN] = 0.0
    for k in range(lines_of(system)):
        numbers = numbers_of(system, k)
        numbers[SHEAVE] = numbers[DRUM] = -1.0
        if goes_on(system, k):
            numbers[SHEAVE] = count
            begin_sheave(system, k, coordinate_at(system, count))
            count += 1
    for k in range(lines_of(system)):
        if carries_drum(system, k) or has_own_drum(system, k):
            numbers_of(system, k)[DRUM] = count
            begin_drum(system, k, coordinate_at(system, count))
            count += 1
    header[COUNT] = count
    for k in range(lines_of(system)):
        take_holders(system, k)
        if PARTS:
            numbers_of(system, k)[SECOND_PART], numbers_of(system, k)[LATE] = state_of(system, k)[at.SECOND_PART], 0.0
        numbers_of(system, k)[FIRST_LENGTH] = numbers_of(system, k)[LENGTH] = conditions_of(system, k).reeling[0]
        if is_rope(system, k):
            take_weights(system, k)
    find_profile(system)
    for j in range(count):
        take_brake(system, j)


@kernel
def begin_sheave(system, k, own):
    """Initialize the numbers of the sheave at the end of line k (modified)."""
    parameters, state = parameters_of(system, k), state_of(system, k)
    has_losses = parameters[at.SHEAVE_FRICTION] > 0.0 or parameters[at.SHEAVE_EFFICIENCY] != 1.0
    clear(own)
    own[LINE], own[MASS], own[FRICTION] = k, parameters[at.SHEAVE_MASS], 1.0 if has_losses else 0.0
    own[SPEED], own[ACCELERATION] = state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION]


@kernel
def begin_drum(system, k, own):
    """Initialize the numbers of the drum that line k carries (modified)."""
    conditions, state = conditions_of(system, k), state_of(system, k)
    drum = drum_of(conditions.parameters, conditions.force, conditions.force_rate)
    clear(own)
    own[LINE], own[IS_DRUM], own[MASS], own[DAMPING], own[FRICTION] = k, 1.0, drum.mass, drum.damping, drum.friction
    own[LOAD], own[LOAD_RATE] = drum.force, drum.force_rate
    if has_coordinates(system):
        own[SPEED], own[ACCELERATION] = state[at.DRUM_SPEED], state[at.DRUM_ACCELERATION]
    else:
        own[SPEED], own[ACCELERATION] = state[at.REELING], state[at.ACCELERATION]
        own[IS_MASSLESS] = 1.0 if drum.mass == 0.0 and not feels_rope(conditions.parameters) else 0.0


@kernel
def hold_by(system, k, end, j, weight):
    """Add coordinate j to the holders of an end of line k (modified)."""
    numbers, count = numbers_of(system, k), holders_of(system, k, end)
    place = at.MOST_HOLDERS * end + count
    numbers[HOLDERS + end], numbers[HOLDER + place], numbers[WEIGHT + place] = count + 1.0, j, weight


@kernel
def reaches(system, k, end):
    """Whether the rope of portion k reaches the sheave at an end."""
    parameters = parameters_of(system, k)
    if not is_parted(parameters):
        return True
    return parameters[at.FIRST_ENDS] > 0.0 if end == 0 else parameters[at.SECOND_BEGINS] < segments_of(system, k)


@kernel
def take_holders(system, k):
    """Holders of both ends of line k (modified); their payout is not a function of time."""
    numbers, parameters = numbers_of(system, k), parameters_of(system, k)
    numbers[HOLDERS] = numbers[HOLDERS + 1] = 0.0
    numbers[FACTOR] = numbers[FACTOR + 1] = 1.0
    if has_own_drum(system, k):
        hold_by(system, k, 0, numbers[DRUM], 1.0)
    elif comes_from(system, k):
        if reaches(system, k, 0):
            hold_by(system, k, 0, numbers_of(system, k - 1)[SHEAVE], 1.0)
    elif is_turned(system, k):
        for i in range(at.MOST_HOLDERS):
            carrier = int(parameters[at.HELD_BY + i])
            if carrier > 0:
                hold_by(system, k, 0, numbers_of(system, carrier - 1)[DRUM], parameters[at.HELD_RATIO + i])
    if goes_on(system, k) and reaches(system, k, 1):
        hold_by(system, k, 1, numbers[SHEAVE], -1.0)
    numbers[RUNS] = 1.0 if is_rope(system, k) else 0.0
    if holders_of(system, k, 0) > 0 or comes_from(system, k):
        hold_length(system, k, conditions_of(system, k).reeling[0])


@kernel
def take_weights(system, k):
    """`Weights` of line k (modified). Beyond the gap of a line that was released, the share of its start is negative."""
    n, conditions, own, of_start = segments_of(system, k), conditions_of(system, k), weights_of(system, k), 1.0
    if is_parted(conditions.parameters):
        take_weights_of_parts(n, conditions.parameters, own)
        return
    for i in range(n + 1):
        if i == n and not is_freed(system, k):
            of_start = 0.0
        own.first[i], own.last[i] = of_start, of_start - 1.0
        if i < n:
            share = property_of(conditions, i, at.SHARE)
            own.growth_first[i] = own.growth_last[i] = share
            of_start -= share
        if is_portion(system, k) and conditions.parameters[at.LENGTH_BEYOND] != 0.0:  # only the last segment grows there
            own.last[i], own.growth_last[min(i, n - 1)] = (-1.0, 1.0) if i == n else (0.0, 0.0)


@kernel
def take_weights_of_parts(n, parameters, own):
    """`Weights` (modified) of a portion of n segments in two parts."""
    ends, begins = int(parameters[at.FIRST_ENDS]), int(parameters[at.SECOND_BEGINS])
    for i in range(n + 1):
        own.first[i] = 1.0 - i / ends if i < ends else 0.0
        own.last[i] = (begins - i) / (n - begins) if i > begins else 0.0
        if i < n:
            own.growth_first[i] = 1.0 / ends if i < ends else 0.0
            own.growth_last[i] = 1.0 / (n - begins) if i >= begins else 0.0


@kernel
def find_profile(system):
    """Profile of the matrix of all global unknowns (modified): unknowns on the same line are coupled."""
    m, points, matrix = unknowns_of(system), 3 * free_points(system), globals_of(system).matrix
    for i in range(m):
        matrix.first[i] = i - i % 3 if i < points else i
    if m > 1:
        for k in range(lines_of(system)):
            for end in range(2):
                for other in range(2):
                    join_ends(system, k, end, other, matrix)
    profile.begin(matrix, m)


@kernel
def join_ends(system, k, end, other, matrix):
    """Extend the profile (modified) by the coupling between the unknowns of two ends of line k."""
    points = 3 * free_points(system)
    if is_at_point(system, k, end):
        for axis in range(3):
            row = 3 * point_at(system, k, end) + axis
            if is_at_point(system, k, other):
                profile.join(matrix, row, 3 * point_at(system, k, other))
                profile.join(matrix, 3 * point_at(system, k, end), 3 * point_at(system, k, other) + axis)
    for i in range(holders_of(system, k, end)):
        j, _ = holder(system, k, end, i)
        if is_at_point(system, k, other):
            profile.join(matrix, points + j, 3 * point_at(system, k, other))
        for place in range(holders_of(system, k, other)):
            o, _ = holder(system, k, other, place)
            profile.join(matrix, points + j, points + o)


@kernel
def take_brake(system, j):
    """Brake a drum (modified) if all its lines are broken."""
    own, held = coordinate_at(system, j), 0
    for k in range(lines_of(system)):
        for end in range(2):
            held += weight_of(system, j, k, end) != 0.0
    own[IS_BRAKED] = 1.0 if held == 0 else 0.0
    if held == 0:
        own[SPEED] = own[ACCELERATION] = own[SIGN] = 0.0
        own[IS_HELD] = 1.0


# --- pieces of time


@kernel
def take_running(system):
    """Treat lines (modified) whose holders are all at rest in a piece of time as chains without ropes."""
    for k in range(lines_of(system)):
        if is_rope(system, k):
            count = 0
            for end in range(2):
                for i in range(holders_of(system, k, end)):
                    j, _ = holder(system, k, end, i)
                    count += is_free(system, j)
            numbers_of(system, k)[RUNS] = 1.0 if count > 0 else 0.0


@kernel
def let_all_run(system):
    """Treat all lines with holders (modified) as lines with ropes."""
    for k in range(lines_of(system)):
        if is_rope(system, k):
            numbers_of(system, k)[RUNS] = 1.0


@kernel
def settle(system):
    """Add the passed rope to the lengths of the lines (modified), so that these are complete without coordinates."""
    for k in range(lines_of(system)):
        if is_rope(system, k):
            come_in, reeling = let_in_over_both(system, k, PASSED), conditions_of(system, k).reeling
            put_reeling(system, k, winch.from_length(reeling[0] + come_in, reeling))
            if is_parted(parameters_of(system, k)):
                numbers_of(system, k)[SECOND_PART] += let_in(system, k, 1, PASSED)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[TOTAL] += own[PASSED]
        own[PASSED] = 0.0


# --- chains


@kernel
def take_rates(system, k, time):
    """Length of line k; rates, gains, rests and inertias of both ends, from the coordinates at a time [s] (modified)."""
    numbers, reeling = numbers_of(system, k), conditions_of(system, k).reeling
    numbers[LENGTH] = winch.length_at(reeling, time)
    for end in range(2):
        length = rate = gain = rest = inertia = 0.0
        for i in range(holders_of(system, k, end)):
            j, weight = holder(system, k, end, i)
            own = coordinate_at(system, j)
            length += weight * own[PASSED_NOW]
            rate += weight * own[SPEED_NOW]
            gain += weight * own[GAIN_NOW]
            rest += weight * own[OF_REST]
            inertia += weight * own[ADDED_UP]
        numbers[LENGTH] += length
        numbers[HELD_GAIN + end], numbers[REST + end], numbers[INERTIA + end] = gain, rest, inertia
        if end == 0:
            rate += winch.rate_at(reeling, time)
            gain += winch.gain_at(reeling, time)
        numbers[RATE + end], numbers[GAIN + end] = rate, gain
    place_parts(system, k, numbers[LENGTH], PASSED_NOW)


@kernel
def place_parts(system, k, length, which):
    """Divide the length [m] of a portion in two parts in its parameters (modified), with rope let in (number `which`).

    No part is shorter than `LEAST_LENGTH` of its shortest length.
    """
    parameters = parameters_of(system, k)
    if is_parted(parameters):
        second, rest = numbers_of(system, k)[SECOND_PART] + let_in(system, k, 1, which), parameters[at.REST_BETWEEN]
        second = max(second, LEAST_LENGTH * shortest_of_part(system, k, 1))
        parameters[at.LENGTH_BEYOND] = min(rest + second, length - LEAST_LENGTH * shortest_of_part(system, k, 0))


@kernel
def section_now(system, k):
    """Length [m] of the section at the winch of line k at a stage."""
    parameters = parameters_of(system, k)
    first = section_of(parameters, numbers_of(system, k)[LENGTH])
    return min(first, second_part(parameters)) if is_parted(parameters) else first


@kernel
def second_part(parameters):
    """Unstretched length of the second part of a portion [m]."""
    return parameters[at.LENGTH_BEYOND] - parameters[at.REST_BETWEEN]


# --- limits of lengths: of a line, or of both parts of a portion; then of the whole rope that a drum pays out


@kernel
def limited_parts(system, k):
    """Number of lengths of line k that have limits, without the whole rope."""
    return 2 if is_parted(parameters_of(system, k)) else 1


@kernel
def limits_of(system, k):
    """Number of lengths that line k limits: the whole rope is the last one, if k is its first portion, at a drum."""
    parts = limited_parts(system, k)
    return parts + 1 if PARTS and goes_on(system, k) and is_turned(system, k) else parts


@kernel
def is_whole(system, k, which):
    """Whether a length with limits is that of the whole rope."""
    return PARTS and which == limited_parts(system, k)


@kernel
def growth_of_part(system, j, k, end):
    """`growth_of` a line, of the part at an end of a portion, or of the whole rope."""
    if is_whole(system, k, end):
        return weight_of(system, j, k, 0)
    return weight_of(system, j, k, end) if is_parted(parameters_of(system, k)) else growth_of(system, j, k)


@kernel
def length_of_rope(system, k):
    """Unstretched length [m] at a stage of the rope whose first portion is k."""
    length = numbers_of(system, k)[LENGTH]
    while goes_on(system, k):
        k += 1
        length += numbers_of(system, k)[LENGTH]
    return length


@kernel
def length_of_part(system, k, end):
    """Unstretched length [m] of line k, of the part at an end, or of the whole rope, at a stage."""
    parameters, length = parameters_of(system, k), numbers_of(system, k)[LENGTH]
    if is_whole(system, k, end):
        return length_of_rope(system, k)
    if not is_parted(parameters):
        return length
    return section_of(parameters, length) if end == 0 else second_part(parameters)


@kernel
def shortest_of_part(system, k, end):
    """Shortest unstretched length [m] of line k, of the part at an end, or of the whole rope."""
    parameters = parameters_of(system, k)
    if is_whole(system, k, end):
        return parameters[at.SHORTEST_LENGTH]
    if not is_parted(parameters):
        return shortest_of(system, k)
    count = parameters[at.FIRST_ENDS] if end == 0 else segments_of(system, k) - parameters[at.SECOND_BEGINS]
    return count * at.MIN_SEGMENT_LENGTH


@kernel
def least_length(system, k):
    """Lower bound of the unstretched length of line k [m] in an iteration."""
    parameters = parameters_of(system, k)
    if is_parted(parameters):
        shortest = shortest_of_part(system, k, 0) + shortest_of_part(system, k, 1)
        return parameters[at.REST_BETWEEN] + LEAST_LENGTH * shortest
    return part_of_shortest(system, k, LEAST_LENGTH)


@kernel
def least_of_part(system, k, end, part):
    """Length [m] at which the shortest segments have a part [-] of their shortest length, see `part_of_shortest`."""
    if is_parted(parameters_of(system, k)):
        return part * shortest_of_part(system, k, end)
    return part_of_shortest(system, k, part)


@view
def chain_at_stage(system, k):
    """`Chain` of line k with rope coordinates at a stage, without flow forces."""
    numbers, conditions = numbers_of(system, k), conditions_of(system, k)
    place_parts(system, k, numbers[LENGTH], PASSED_NOW)
    motion = numbers[LENGTH], numbers[RATE] + numbers[RATE + 1], 0.0, (-numbers[RATE + 1], -0.0)
    return chain_with_flow(conditions.n, conditions.parameters, *motion, conditions.wind, False)


@view
def chain_with_rope(system, k):
    """`Chain` of line k at a stage with flow forces, where dampers see the strain."""
    numbers, conditions = numbers_of(system, k), conditions_of(system, k)
    leaving = -numbers[RATE + 1], -numbers[GAIN + 1]
    place_parts(system, k, numbers[LENGTH], PASSED_NOW)
    motion = numbers[LENGTH], numbers[RATE] + numbers[RATE + 1], numbers[GAIN] + numbers[GAIN + 1]
    chain = portion_moving(conditions, *motion, leaving)
    flows = chain.flows and feels_rope(conditions.parameters)
    return chain_with_flow(conditions.n, conditions.parameters, *motion, leaving, conditions.wind, flows)


@view
def chain_now(system, k, time):
    """`Chain` of line k at a time [s] of the communication step, with coordinates at the stage."""
    if has_rope(system, k):
        return chain_with_rope(system, k)
    return chain_during(conditions_of(system, k), time)


@view
def chain_reached(system, k, time, which):
    """`Chain` of line k at a time [s], as if at rest, with the rope that its coordinates let in (number `which`)."""
    conditions = conditions_of(system, k)
    length = winch.length_at(conditions.reeling, time) + let_in_over_both(system, k, which)
    place_parts(system, k, length, which)
    return chain_with(conditions, length, 0.0)


@view
def chain_of_state(system, k, time):
    """`Chain` of line k in its state, at a time [s] of the communication step."""
    conditions = conditions_of(system, k)
    length = winch.length_at(conditions.reeling, time) + let_in_over_both(system, k, PASSED)
    rate = winch.rate_at(conditions.reeling, time) + let_in_over_both(system, k, SPEED)
    if is_parted(conditions.parameters):
        place_parts(system, k, length, PASSED)
        leaving = -let_in(system, k, 1, SPEED), 0.0
        return chain_with_flow(conditions.n, conditions.parameters, length, rate, 0.0, leaving, conditions.wind, False)
    return chain_with(conditions, length, rate)


# --- moving lines


@kernel
def has_free_nodes(system, k):
    """Whether line k has a free node."""
    conditions = conditions_of(system, k)
    return conditions.first <= conditions.last


@kernel
def is_on_drum(system, k):
    """Whether a force-controlled drum pays out line k."""
    return is_turned(system, k) or has_own_drum(system, k)


@kernel
def has_longest(system, k, end):
    """Whether a drum limits the length of line k; of a rope over sheaves it limits the whole."""
    return is_on_drum(system, k) and (not PARTS or is_whole(system, k, end) == is_portion(system, k))


@kernel
def moves(system, k):
    """Whether a step integrates line k: a node is free, or rope may run in or out."""
    return has_free_nodes(system, k) or is_rope(system, k)


def any_line(holds):
    """Return a kernel that tests whether any line meets a condition; holds : kernel that tests one line."""

    @kernel
    def of_system(system):
        count = 0
        for k in range(lines_of(system)):
            count += holds(system, k)
        return count > 0

    return of_system


does_any_move, is_any_rope = any_line(moves), any_line(has_rope)


# --- fixed steps

Step = namedtuple("Step", "time h kind turns")
Step.__doc__ = """A fixed step: its start [s] in the communication step, h [s], its kind (`backward_euler.start`).

turns : whether coordinate speeds are unknowns; else the rope speed of the last iteration is kept."""


@view
def attempt_of(system, k, step):
    """`incremental_potential.Attempt` of line k."""
    _, v = motion_of(system, k)
    chain = chain_now(system, k, step.time + step.h)
    return Attempt(conditions_of(system, k), chain, step.h, v, step.kind != WHOLE)
