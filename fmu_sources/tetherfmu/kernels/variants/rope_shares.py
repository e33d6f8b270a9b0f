"""Lines over sheaves at rest: the portion lengths for which each sheave has equal tension on both sides.

For given lengths of all portions the free points are solved as usual (`resting_points.py`), and then each portion is in
equilibrium. Rope that passes a sheave by q reduces the tension ahead and raises the tension behind it; both are slopes of
one potential, so Newton's method on q, with finite differences for the slopes, descends on it. A drum with a sought start
(`winch_start`) is one more unknown, also one of several lines without sheaves: its payout, with its
imbalance (`sought_drums.py`) as the difference.
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import INPUT_NOT_FINITE, NO_SHARES, OK, REELED_TOO_SHORT, WINCH_TOO_SHORT

from ..arrays import clear, positions_and_velocities
from ..compilation import kernel
from ..equations.lines import lines_of, motion_of, parameters_of, room_of, segments_of, state_of
from ..equations.properties import chain_without_flow, half_density, property_in, put_property, rest_length
from ..equations.rope import tension_at_winch, tensions_of_rope
from ..equations.ropes import first_of, goes_on, is_portion
from ..linear_algebra import small_matrix
from ..linear_algebra.vectors import norm, vector_at
from ..points.coordinates import (
    LENGTH_AT_REST,
    has_sought_drum,
    is_shared_out,
    is_sought_by_drums,
    numbers_at_rest,
    shared_at_rest,
    shortest_of,
)
from ..rest import dynamic_chain, resting_points
from ..rest.resting_line import start_state
from .first_shares import fits, share_ropes
from .sought_drums import WAITING, about_drums, holds_several, imbalance_of_drum, part_of_drum, put_start

ITERATIONS, TRIALS = 60, 12
BALANCED, ROUNDED = 1e-10, 1e-7  # tension difference over its size: goal, acceptable if it stagnates
DIFFERENCE = 1e-7  # of the rope, for slopes
SOFTEST, STIFFER = 2.0**-15, 8.0  # relative stiffness of rope that fits anywhere; factor from step to step
LONGEST_STEP = 0.25  # of the adjacent portion
LONGEST = 1e5  # [m] of a line, as `initial_length` may be
MOST_SEARCHES = 3.0  # of free points, in units of the limit for one search


@kernel
def is_balanced(system, k):
    """Whether line k continues over a sheave that needs equal tensions: not if all portions are given."""
    j, count = first_of(system, k), 0
    count += is_sought_by_drums(system, j)
    while goes_on(system, j):
        count += parameters_of(system, j)[at.GIVEN_PORTION] == 0.0
        j += 1
    count += parameters_of(system, j)[at.GIVEN_PORTION] == 0.0
    return goes_on(system, k) and count > 0


@kernel
def count_unknowns(system):
    """Number of these sheaves, and of sought drums."""
    sheaves, drums = 0, 0
    for k in range(lines_of(system)):
        sheaves += is_balanced(system, k)
        drums += has_sought_drum(system, k)
    return sheaves, drums


@kernel
def end_tensions_at_rest(n, parameters, state):
    """Tension at both ends of a portion in equilibrium in its state [N]."""
    chain, held = chain_without_flow(n, parameters, state), vector_at(state, at.GROUND_TENSION_VECTOR)
    if norm(held) > 0.0:
        half = half_density(chain, 0) * rest_length(chain, 0) * chain.gravity
        at_end = vector_at(state, at.KITE_TENSION_VECTOR)
        return norm(held) - half * held[2] / norm(held), norm(at_end) + half * at_end[2] / norm(at_end)
    x, v = positions_and_velocities(n, state)
    return tensions_of_rope(chain, x, v, 0.0)


@kernel
def take_tensions_at_rest(system, k):
    """Store the end tensions of portion k at rest, or the drum tension of a whole line, in its state (modified)."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    if is_portion(system, k):
        state[at.TENSION_FROM], state[at.TENSION_TO] = end_tensions_at_rest(n, parameters, state)
    else:
        state[at.TENSION_FROM] = tension_at_winch(n, parameters, state)


@kernel
def settle_line(system, k):
    """Bring portion k (modified) to rest between its points, a whole line into its `initial_shape`; a status."""
    n, parameters, state = segments_of(system, k), parameters_of(system, k), state_of(system, k)
    status, shape = start_state(system, k), parameters[at.INITIAL_SHAPE]
    if status == OK and is_portion(system, k):
        shape = float(at.STATIC_EQUILIBRIUM)
        state[at.REELING] = 0.0
        _, v = motion_of(system, k)
        clear(v)
    if status == OK:
        status = dynamic_chain.initialize(n, parameters, shape, state, room_of(system, k))
    if status == OK:
        take_tensions_at_rest(system, k)
    return status


@kernel
def find_differences(system, as_given, differences, spent):
    """T ahead - T behind of sheaves, then imbalances of drums [N], at rest (modified); a status, and the largest tension.

    spent : Newton iterations of all searches for free points so far (modified); beyond the limit the status is NO_SHARES.
    """
    if spent[0] > MOST_SEARCHES * resting_points.BUDGET * lines_of(system):
        return NO_SHARES, 0.0
    status = resting_points.find(system, as_given)
    spent[0] += resting_points.spent_in(system)
    largest = 0.0
    for k in range(lines_of(system)):
        if status == OK and is_shared_out(system, k):
            system.plan[places.STATUS_LINE] = k
            status = settle_line(system, k)
            state = state_of(system, k)
            largest = max(largest, abs(state[at.TENSION_FROM]), abs(state[at.TENSION_TO]))
    j = 0
    for k in range(lines_of(system)):
        if is_balanced(system, k):
            differences[j] = state_of(system, k + 1)[at.TENSION_FROM] - state_of(system, k)[at.TENSION_TO]
            j += 1
    for k in range(lines_of(system)):
        if has_sought_drum(system, k):
            differences[j] = imbalance_of_drum(system, k)
            j += 1
    return status, largest


@kernel
def move_rope(system, factor, moves):
    """Move rope over sheaves and drums by a factor times `moves` [m], in the portion lengths (modified)."""
    j = 0
    for k in range(lines_of(system)):
        if is_balanced(system, k):
            numbers_at_rest(system, k)[LENGTH_AT_REST] -= factor * moves[j]
            numbers_at_rest(system, k + 1)[LENGTH_AT_REST] += factor * moves[j]
            j += 1
    for c in range(lines_of(system)):
        if has_sought_drum(system, c):
            for k in range(lines_of(system)):
                numbers_at_rest(system, k)[LENGTH_AT_REST] += factor * part_of_drum(system, k, c) * moves[j]
            j += 1


@kernel
def change_of(system, k, moves):
    """Change [m] of the length of line k by `moves` [m]."""
    change, j = 0.0, 0
    for c in range(lines_of(system)):
        if is_balanced(system, c):
            change += moves[j] if c + 1 == k else 0.0
            change -= moves[j] if c == k else 0.0
            j += 1
    for c in range(lines_of(system)):
        if has_sought_drum(system, c):
            change += part_of_drum(system, k, c) * moves[j]
            j += 1
    return change


@kernel
def part_within(system, moves):
    """Fraction of `moves` [m] at which no portion changes too much, or becomes too short."""
    part = 1.0
    for k in range(lines_of(system)):
        if is_shared_out(system, k):
            change, length = change_of(system, k, moves), numbers_at_rest(system, k)[LENGTH_AT_REST]
            room = min(LONGEST_STEP * length, 0.5 * (length - shortest_of(system, k)))
            if change < 0.0 and -change * part > room:
                part = room / -change
            elif change * part > min(LONGEST_STEP * length, LONGEST - length):
                part = min(LONGEST_STEP * length, LONGEST - length) / change
    return part


@kernel
def size_of(numbers):
    """Largest magnitude."""
    most = 0.0
    for j in range(len(numbers)):
        most = max(most, abs(numbers[j]))
    return most


@kernel
def work_of(moves, differences):
    """Sum of moves times differences [N m]."""
    total = 0.0
    for j in range(len(moves)):
        total += moves[j] * differences[j]
    return total


@kernel
def find_moves(system, differences, shared, length, spent):
    """A step of Newton's method [m] into shared[3] (modified) from differences [N]; a status.

    If ropes hang slack without weight, and nothing changes, a long step along the differences.
    length : of the ropes [m].  spent : as for `find_differences`.
    """
    (matrix, _, unit, moves, other), count = shared, len(differences)
    h, status = DIFFERENCE * length, OK
    for j in range(count):
        for i in range(count):
            unit[i] = 1.0 if i == j else 0.0
        if status == OK:
            move_rope(system, h, unit)
            status, _ = find_differences(system, True, other, spent)
            move_rope(system, -h, unit)
            for i in range(count):
                matrix[count * i + j] = (differences[i] - other[i]) / h
    for i in range(count):
        moves[i] = differences[i]
    if status == OK and not small_matrix.solve(count, matrix, moves):
        for i in range(count):
            moves[i] = differences[i] / size_of(differences) * length
    if work_of(moves, differences) < 0.0:
        for i in range(count):
            moves[i] = -moves[i]
    return status


@kernel
def balance_ropes(system, as_given, shared, differences, spent):
    """Search for the portion lengths (modified) from their present values; a status.

    as_given : whether the search for free points begins at the inputs.  spent : see `find_differences`.
    """
    length, moves = 0.0, shared[3]
    for k in range(lines_of(system)):
        if is_shared_out(system, k):
            length = max(length, numbers_at_rest(system, k)[LENGTH_AT_REST])
    status, largest = find_differences(system, as_given, differences, spent)
    last = inf
    for _ in range(ITERATIONS):
        size = size_of(differences)
        if status != OK or size <= BALANCED * largest or (size >= 0.5 * last and size <= ROUNDED * largest):
            return status
        last = size
        status = find_moves(system, differences, shared, length, spent)
        if status != OK:
            return status
        start, taken = work_of(moves, differences), part_within(system, moves)
        if taken == 0.0:  # drums pay out endlessly
            return NO_SHARES
        move_rope(system, taken, moves)
        for trial in range(TRIALS):
            status, largest = find_differences(system, True, differences, spent)
            left = work_of(moves, differences) if status == OK else -inf
            if left > -0.5 * start or trial == TRIALS - 1:
                break
            less = taken * min(max(start / (start - left), 0.05), 0.9)
            move_rope(system, less - taken, moves)
            taken = less
    return NO_SHARES


@kernel
def put_stiffness(system, factor):
    """Multiply the axial stiffness of all portions by a factor, a power of 2 (in the parameters, modified)."""
    for k in range(lines_of(system)):
        n, parameters = segments_of(system, k), parameters_of(system, k)
        for s in range(n):
            if is_portion(system, k):
                put_property(n, at.STIFFNESS, s, factor * property_in(parameters, n, s, at.STIFFNESS), parameters)


@kernel
def search_for_shares(system, sheaves, drums):
    """Search of `find_shares` for the portion lengths at so many sheaves, and of so many drums; a status."""
    shared, differences, spent = shared_at_rest(system, sheaves + drums)
    spent[0] = 0.0
    status = balance_ropes(system, False, shared, differences, spent)
    if status != OK and drums > 0:
        share_ropes(system, True)
        return balance_ropes(system, False, shared, differences, spent)
    if status == OK:
        return OK
    share_ropes(system, False)
    factor, found = SOFTEST, OK
    put_stiffness(system, SOFTEST)
    while factor <= 1.0 and found == OK:
        found = balance_ropes(system, factor > SOFTEST, shared, differences, spent)
        put_stiffness(system, STIFFER if factor < 1.0 else 1.0)
        factor *= STIFFER
    if factor <= 1.0:
        put_stiffness(system, 1.0 / factor)
    return found if found == OK else status


@kernel
def search_from_given(system, sheaves, drums):
    """`search_for_shares` from the solution with all drums as given; a status."""
    put_start(system, float(at.WINCH_IN_BALANCE), WAITING)
    sought, (others, _) = share_ropes(system, False), count_unknowns(system)
    status = search_for_shares(system, others, 0) if sought > 0 else resting_points.find(system, False)
    put_start(system, WAITING, float(at.WINCH_IN_BALANCE))
    if status != OK:
        return status
    shared, differences, spent = shared_at_rest(system, sheaves + drums)
    spent[0] = 0.0
    return OK if balance_ropes(system, True, shared, differences, spent) == OK else about_drums(system)


@kernel
def find_shares(system):
    """Solve all sought points and portion lengths for equilibrium (modified); a status.

    If drums are sought, start from straight ropes if `initial_length` fails, and for drums of several lines from the
    solution without them. If stiff portions do not fit together during the search, start with softer rope.
    Portions that become too short during the search are NO_SHARES.
    """
    sought, (sheaves, drums) = share_ropes(system, False), count_unknowns(system)
    if sought == 0:
        return resting_points.find(system, False)
    status = search_for_shares(system, sheaves, drums)
    if status != OK and status & 0xFF != INPUT_NOT_FINITE and holds_several(system):
        share_ropes(system, False)  # of whole lines
        status = search_from_given(system, sheaves, drums)
    is_short = status in (REELED_TOO_SHORT, WINCH_TOO_SHORT)
    return NO_SHARES if is_short and fits(system) else status
