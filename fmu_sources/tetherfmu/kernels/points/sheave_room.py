"""Scratch space of lines that run over sheaves or off drums beside them, and what of them moves.

A line that runs `through` points is here several lines one behind the other, its portions, each of which knows whether it
goes on over a sheave at its end. What belongs to a sheave stands with the portion before it, what belongs to a drum with
the line that carries it. Each line of such a system has room in `work` for the numbers below, for those of a drum, for the
arrays of a portion, and for what a coordinate (`coordinates.py`) does to it in a step. A line that drums turn is a portion.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..arrays import places_of
from ..compilation import kernel, view
from ..equations import winch
from ..equations.boundary import portion_moving
from ..equations.lines import conditions_of, number_in, number_of_line, parameters_of, reeling_at, segments_of
from ..equations.properties import chain_with_flow, property_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import comes_from, coordinates_in, goes_on, has_coordinates, is_freed, is_rope, is_turned
from ..flat_arrays import part
from ..line.rodas4p import STAGES

(
    # of a sheave or a drum, of which rope that has passed is what it has paid out
    NUMBER,
    RUNS,  # 1: rope runs over it in this piece of time, 0: it is held
    SIGN,  # of the speed that friction knows; 0 without friction, and where either may be
    PAID,  # rope that has passed since the start of the communication step [m]
    SPEED,  # at the start of the step [m/s]
    PASSED,  # since the start of the step at a stage [m]; in the end of the step
    STAGE_SPEED,  # [m/s]
    REST,  # r_i of a stage [m/s]
    SOLUTION,  # p [m/s] and U_u [m/s] of a stage; in the end the error estimates of the payout over d and of the speed
    INCREMENT,
    ADDED_UP,  # of the stages, for its inertia [m/s]
    GAIN,  # u' [m/s2] of a stage
    RIGHT,  # right-hand side of a stage [N]
    RATE,  # explicit time derivative of its equation [N/s]
    FORCE,  # on its point, if that is free, at a stage but for what sheaves that gain speed add [N]
    BEHIND,  # e_1 and e_2 at a stage, see `sheaves.py`; of a drum the sum of the magnitudes of its forces [N]
    AHEAD,
    OF_BEHIND,  # slopes of its equation by -R_b of the portion before and by R_a of that behind it at the start of the step
    OF_AHEAD,
    TENSION_BEHIND,  # where the rope comes to it and leaves it in the direction of the line [N]
    TENSION_AHEAD,  # of a drum: what sets against the rope but for friction, and what all lines pull [N]
    PULL_BEHIND,  # R_b of the portion before it and R_a of the one behind it [N], with the present u'
    PULL_AHEAD,
    KEPT,  # PASSED and STAGE_SPEED of a step that is tried
    STARTED,  # how often rope began to run over it while it was sought over which it does
    BY_OWN,  # slope of its equation by its speed, without that of R_a and R_b [N s/m]
    # of a coordinate in fixed steps, see `fixed_sheaves.py`; PASSED, STAGE_SPEED and GAIN are those of the iteration
    REACHED,  # PASSED where the step, or its stage, starts [m]; SPEED is that there
    START_SPEED,  # at the start of a step of three stages [m/s]
    ONWARD_PASSED,  # the start of the third stage but for the result of the second one [m]
    ONWARD_SPEED,  # [m/s]
    BEFORE,  # speeds in the last stage but one, and in the one before it [m/s]
    LONG_BEFORE,
    KEEPS,  # sign of the speed that friction does not let turn round in the step, 0: it may
    LOWEST,  # limits of the speed in the iteration [m/s]
    HIGHEST,
    WAY,  # how u' is sought in the iteration
    SOUGHT,  # its value where that is given [m/s]
    CHANGE,  # by how much the last iteration changed it [m/s]
    IS_FOUND,  # 1 if u' was found as it was sought, and the tensions beside it are close; else 0
    LOSS,  # E
    MOVED_BEHIND,  # change of the tensions [N] and of the angle of wrap [rad] with the moves of nodes, without u' - u
    MOVED_AHEAD,
    MOVED_WRAP,
    # of a portion
    LENGTH_NOW,  # at the start of the step [m]
    LENGTH,  # at a stage [m]
    INTO,  # a at a stage [m/s] and its rate [m/s2]
    INTO_GAIN,
    HAS_RUN,  # 1 if a coordinate at it has run in this communication step
    PULL,  # R_a and R_b at a stage but for what accelerates with it [N]
    YIELD,  # their slopes by a', b' [kg]: aa, ab, bb
    INERTIA,  # the same of the rope alone at the start of the step
    BY_LENGTH,  # slopes of R_a and R_b by L [N/m]
    BY_RATE,  # by a and b [N s/m]: aa, ab, ba, bb
    COUNT,  # of the coordinates, in the first line
    KNOWN,  # there: 1 if the tensions are those of the states of all lines, and rope runs over no sheave
    # of a line that drums turn: tension where it leaves them [N], its slope by R_a and the rate of that [N/s], and the
    # force on the free point there as FORCE
    TENSION_IN,
    OF_IN,
    RATE_IN,
    FORCE_IN,
    WINCH,  # coefficients of the length that a winch pays out into the first portion, see `winch.py`
    BEGAN,  # time of the communication step at which a fixed step began, at which LENGTH_NOW is the length [s]
    _,
    NUMBERS,
) = places_of(*[1] * 14, 3, *[1] * 8, 2, *[1] * 2, *[1] * 17, *[1] * 5, 2, 3, 3, 2, 4, *[1] * 5, 3, 7, 1, 1)
DRUM_NUMBERS = LENGTH_NOW  # those of a drum are the first ones; its stages follow

BY_SPEED, BY_VELOCITY, ROW = range(3)  # arrays of 3 (n + 1) numbers, each of a and of b:
# slopes of the forces by the rate [N s/m], R_v [N s/m], row of the matrix
ARRAYS = 6
_ARRAYS_AT = NUMBERS + DRUM_NUMBERS + STAGES  # behind the numbers of a line
(
    BORDER,  # col at the start of the step and at a stage [kg]; that of a has the part w_i of node i in it, of b the rest
    PULLED,
    PARTS,  # w of each node, n + 1 numbers
    FORCE_BY_LENGTH,  # slopes of the forces by L [N/m]
    ACCELERATIONS,  # of the nodes at the start of the step [m/s2]
    VELOCITIES,  # of the nodes in the iteration of a fixed step [m/s]
    SOLUTIONS,  # of the column of each coordinate
) = range(ARRAYS, ARRAYS + 7)


@kernel
def portion_work_size(n, coordinates):
    """Length of what a line of n segments needs of `work` in a system with so many coordinates."""
    size = _ARRAYS_AT + (SOLUTIONS + coordinates) * 3 * (n + 1) if coordinates > 0 else 0
    return size + size % 2


@kernel
def shared_work_size(coordinates):
    """Length of what all coordinates together need of `work`: matrices and vectors."""
    size = 5 * coordinates * coordinates + 5 * coordinates
    return size + size % 2


@view
def numbers_at(system, k):
    """Numbers of line k in a system with coordinates, at the places above."""
    return part(system.work, number_of_line(system, k, places.PORTION_WORK), NUMBERS)


@view
def drum_numbers_at(system, k):
    """Numbers of the drum that line k carries, at the places above, and behind them what stages make of its speed."""
    return part(system.work, number_of_line(system, k, places.PORTION_WORK) + NUMBERS, DRUM_NUMBERS + STAGES)


@view
def array_at(system, k, which, side):
    """One of the arrays of portion k, of its coordinate IN or OUT."""
    size = 3 * (segments_of(system, k) + 1)
    first = number_of_line(system, k, places.PORTION_WORK) + _ARRAYS_AT
    return part(system.work, first + size * (2 * which + side), size)


@view
def single_at(system, k, which):
    """BORDER, ... of portion k, or SOLUTIONS + j: of the column of coordinate j in line k."""
    size = 3 * (segments_of(system, k) + 1)
    first = number_of_line(system, k, places.PORTION_WORK) + _ARRAYS_AT
    return part(system.work, first + size * which, size)


@kernel
def part_of(parts, side, i):
    """Part of col at node i that is of a (side IN), or of b; parts : PARTS of the portion."""
    return parts[i] if side == IN else 1.0 - parts[i]


@kernel
def take_parts(system, k):
    """PARTS of portion k (modified)."""
    conditions, parts, part_of_a = conditions_of(system, k), parts_of(system, k), 1.0
    for i in range(conditions.n):
        parts[i] = part_of_a
        part_of_a -= property_of(conditions, i, at.SHARE)
    parts[conditions.n] = part_of_a if is_freed(system, k) else 0.0  # beyond a gap it is below 0


@view
def parts_of(system, k):
    """PARTS of portion k."""
    return part(single_at(system, k, PARTS), 0, segments_of(system, k) + 1)


@view
def shared_of(system):
    """Matrix of accelerations, matrix of a step, and their right-hand side and solution, all of the coordinates.

    The last one: the coordinates in their order, see `coordinates.number_coordinates`.
    """
    count, first = coordinates_in(system), number_in(system.plan, places.SHEAVES_WORK)
    return shared_with(system, count, first)


@view
def shared_with(system, count, first):
    """Two matrices and three vectors of `work` from a place on."""
    square = count * count
    vectors = first + 2 * square
    return (
        part(system.work, first, square),
        part(system.work, first + square, square),
        part(system.work, vectors, count),
        part(system.work, vectors + count, count),
        part(system.work, vectors + 2 * count, count),
    )


@view
def shared_at_rest(system, count):
    """As many of so many of them, for `variants/rope_shares.py`; and room for one number more of each, and one."""
    first = number_in(system.plan, places.SHEAVES_WORK)
    behind_them, last = first + count * (2 * count + 3), first + count * (2 * count + 4)
    return shared_with(system, count, first), part(system.work, behind_them, count), part(system.work, last, 1)


@kernel
def held_ratio(system, k, carrier):
    """Ratio [-] with which the drum that the line `carrier` carries holds line k; 0 where it does not."""
    total, parameters = 0.0, parameters_of(system, k)
    for i in range(at.MOST_HOLDERS):
        if parameters[at.HELD_BY + i] == carrier + 1.0:
            total += parameters[at.HELD_RATIO + i]
    return total


@kernel
def ratio_of(system, k, carrier):
    """Rope of line k for each metre that the drum pays out which the line `carrier` carries [-]."""
    return held_ratio(system, k, carrier) if is_turned(system, k) else 0.0


@kernel
def from_drums(system, k, which):
    """What the drums that turn let into line k of one of their numbers: the sum with its ratios."""
    total, parameters = 0.0, parameters_of(system, k)
    for i in range(at.MOST_HOLDERS):
        holder = int(parameters[at.HELD_BY + i])
        if holder > 0:
            numbers = drum_numbers_at(system, holder - 1)
            if numbers[RUNS] != 0.0:
                total += parameters[at.HELD_RATIO + i] * numbers[which]
    return total


@kernel
def is_paid_out(system, k):
    """Whether a drum turns that pays out line k."""
    if not is_turned(system, k):
        return False
    count, parameters = 0, parameters_of(system, k)
    for i in range(at.MOST_HOLDERS):
        holder = int(parameters[at.HELD_BY + i])
        if holder > 0:
            count += drum_numbers_at(system, holder - 1)[RUNS] != 0.0
    return count > 0


@view
def slopes_of(system):
    """Slopes by the speeds of all coordinates, in fixed steps: of T_1, of T_2 [N s/m], of the angle of wrap [s/m].

    At a stage of a Rosenbrock step those of R_b and R_a by u' [kg]. Matrices with a row for each coordinate.
    """
    count, first = coordinates_in(system), number_in(system.plan, places.SHEAVES_WORK)
    square = count * count
    first += 2 * square + 5 * count
    return (
        part(system.work, first, square),
        part(system.work, first + square, square),
        part(system.work, first + 2 * square, square),
    )


@kernel
def has_run(system, k):
    """Whether line k is a portion that a coordinate has made longer or shorter in this communication step."""
    return is_rope(system, k) and numbers_at(system, k)[HAS_RUN] != 0.0


@kernel
def runs_over(system, k):
    """Whether rope runs over the sheave at the end of line k, which has one."""
    return numbers_at(system, k)[RUNS] != 0.0


@kernel
def is_running(system, k):
    """Whether the length of line k is an unknown, as rope runs into it or out of it."""
    if not has_coordinates(system):
        return False
    return is_coordinate(system, k, OUT) or is_coordinate(system, k, IN)


@kernel
def speed_out(system, k, which):
    """b of portion k [m/s], of a speed of coordinates among their numbers."""
    return numbers_at(system, k)[which] if goes_on(system, k) else 0.0


@kernel
def winch_of(system, k):
    """The length that the winch pays out into a rope whose first portion is k, see `winch.py`."""
    return reeling_at(numbers_at(system, k), WINCH)


@kernel
def speed_in(system, k, time, which):
    """a of portion k [m/s], of such a speed, or that of a winch at a time [s] of the communication step."""
    if comes_from(system, k):
        return numbers_at(system, k - 1)[which]
    if is_turned(system, k):
        return from_drums(system, k, which)
    return winch.rate_at(winch_of(system, k), time)


@view
def portion_at_start(system, k, time):
    """`Chain` of portion k at the start of the step, a time [s] of the communication step, without accelerations."""
    leaving = speed_out(system, k, SPEED)
    reeling = speed_in(system, k, time, SPEED) - leaving
    return portion_moving(conditions_of(system, k), numbers_at(system, k)[LENGTH_NOW], reeling, 0.0, (leaving, 0.0))


@view
def portion_in_step(system, k):
    """`Chain` of portion k at a stage, without accelerations.

    The forces of rope that flows are not among those of its nodes: `sheave_pulls.take_pulls` adds them.
    """
    numbers, conditions = numbers_at(system, k), conditions_of(system, k)
    leaving = speed_out(system, k, STAGE_SPEED)
    motion = numbers[LENGTH], numbers[INTO] - leaving, 0.0, (leaving, 0.0)
    return chain_with_flow(conditions.n, conditions.parameters, *motion, conditions.wind, False)


@kernel
def gain_of(system, k, side):
    """Rate of a or of b of portion k at a stage [m/s2]."""
    if side == IN:
        return numbers_at(system, k)[INTO_GAIN]
    return numbers_at(system, k)[GAIN] if goes_on(system, k) else 0.0


@view
def portion_gaining(system, k, moves):
    """`Chain` of portion k at a stage with its accelerations; moves : 1, or 0 without speeds."""
    numbers, leaving, gain = numbers_at(system, k), moves * speed_out(system, k, STAGE_SPEED), gain_of(system, k, OUT)
    reeling = moves * numbers[INTO] - leaving
    leave = leaving, gain
    return portion_moving(conditions_of(system, k), numbers[LENGTH], reeling, numbers[INTO_GAIN] - gain, leave)


@kernel
def is_coordinate(system, k, side):
    """Whether a or b of portion k is an unknown of the step: rope runs over the sheave there, or off a drum."""
    if side == OUT:
        return goes_on(system, k) and runs_over(system, k)
    return runs_over(system, k - 1) if comes_from(system, k) else is_paid_out(system, k)


@kernel
def through(system, k, side, which):
    """What the coordinates that run make of a number of theirs at an end of portion k: of a or of b."""
    if side == OUT:
        return numbers_at(system, k)[which] if is_coordinate(system, k, OUT) else 0.0
    if comes_from(system, k):
        return numbers_at(system, k - 1)[which] if runs_over(system, k - 1) else 0.0
    return from_drums(system, k, which) if is_turned(system, k) else 0.0


@kernel
def change_of_portion(system, k, which):
    """What the errors of coordinates, SOLUTION or INCREMENT, make of L' of portion k [m/s]."""
    return through(system, k, IN, which) - through(system, k, OUT, which)


@kernel
def shortest_of(system, k):
    """Unstretched length [m] below which portion k does not get."""
    return parameters_of(system, k)[at.SHORTEST_LENGTH]


@kernel
def longest_of(system, k):
    """Unstretched length [m] to which its drum pays out line k at most."""
    return parameters_of(system, k)[at.LONGEST_LENGTH]
