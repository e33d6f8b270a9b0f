"""Ropes over sheaves within a communication step of the adaptive solver: over which rope runs, and what ends a piece.

A sheave without losses runs always. One with friction is held while the tensions on both sides are within the cone
1/E <= T_1/T_2 <= E, and begins to run where they leave it; it comes to rest where its speed gets 0. A portion that is as
short as its segments may be stops the sheaves at its ends (two-blocking): nodes take the momentum as at a drum that stops
(`stopped_drums.py`), and a sheave begins to run again where the rope pulls it the other way. Each of these ends a piece of
the step, see `pieces.py`.
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits

from ..compilation import kernel, view
from ..equations import assembly, winch
from ..equations.boundary import chain_during
from ..equations.ground import has_ground
from ..equations.lines import (
    add_at,
    comes_from,
    conditions_of,
    goes_on,
    is_at_point,
    is_portion,
    lines_of,
    motion_of,
    point_at,
    points_of,
    put_reeling,
    segments_of,
    sheaves_of,
    state_of,
)
from ..equations.notes import note
from ..equations.rope_at_drum import tension_of
from ..equations.rope_at_sheave import IN, OUT
from ..line import contact, rosenbrock
from ..line.drum_events import OVERLOAD, SLOW, part_of_piece
from ..line.rodas4p import GAMMA
from ..line.step_control import allowed_errors
from ..linear_algebra import small_matrix
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import NEUTRAL, dot, get, put_at, scale
from ..points import sheave_room as at_sheave
from ..points.sheave_room import (
    PULLED,
    array_at,
    is_any_running,
    is_running,
    numbers_at,
    portion_in_step,
    runs_over,
    shared_of,
    shortest_of,
    winch_of,
)
from ..points.sheaves import (
    acceleration_of_point,
    column_at_point,
    has_friction,
    hold_row,
    loss_at_stage,
    number_of,
    number_sheaves,
    solve_gains,
    stiffness_of,
    take_lengths,
    take_pulls,
    take_tensions,
)
from ..points.system_room import integrator_of
from ..points.system_step import stage_masses

AT_STOP = 1e-9  # of the shortest length: a portion that is longer by less is as short as it may be
LOCATED = 1e-10  # of it: how far a piece may end beyond
SHORT_BEHIND, SHORT_AHEAD, RESTS, FORWARDS, BACKWARDS, NO_EVENT = range(6)  # events that end a piece
ROUNDS = 4  # in which it is sought over which sheaves rope runs, and two for each of them


@kernel
def begin_ropes(system):
    """Let all sheaves and portions (modified) begin a communication step with their states."""
    number_sheaves(system)
    for k in range(lines_of(system)):
        if is_portion(system, k):
            numbers, state, reeling = numbers_at(system, k), state_of(system, k), conditions_of(system, k).reeling
            numbers[at_sheave.LENGTH_NOW] = reeling[0]
            for i in range(5):
                numbers[at_sheave.WINCH + i] = reeling[i]
            numbers[at_sheave.SPEED] = state[at.SHEAVE_SPEED] if goes_on(system, k) else 0.0
            numbers[at_sheave.PAID] = numbers[at_sheave.HAS_RUN] = numbers[at_sheave.RUNS] = 0.0
            numbers[at_sheave.GAIN] = state[at.SHEAVE_ACCELERATION]
            numbers[at_sheave.SIGN] = 0.0


# --- the forces at a state


@view
def nodes_of(system, k, is_after):
    """Positions [m] and velocities [m/s] of the nodes of line k: of a step that is tried, or of its state."""
    w, (x, v) = integrator_of(system, k), motion_of(system, k)
    return (w.x, w.v) if is_after else (x, v)


@view
def chain_now(system, k, time):
    """The `Chain` of line k in `evaluate`."""
    if is_portion(system, k):
        return portion_in_step(system, k)
    return chain_during(conditions_of(system, k), time)


@kernel
def evaluate(system, start, time, is_after):
    """Tensions at all sheaves, and u' of those over which rope runs (modified), at a time [s]; scratch space is modified.

    is_after : of a step that is tried and began at `start` [s]; else of the states, and start is that time.
    """
    if not is_after or not is_any_running(system):
        for k in range(lines_of(system)):
            if goes_on(system, k):
                numbers = numbers_at(system, k)
                numbers[at_sheave.PASSED], numbers[at_sheave.STAGE_SPEED] = 0.0, numbers[at_sheave.SPEED]
        take_lengths(system, start, time)
    for k in range(lines_of(system)):
        n, conditions, w, (x, v) = (
            segments_of(system, k),
            conditions_of(system, k),
            integrator_of(system, k),
            nodes_of(system, k, is_after),
        )
        chain = chain_now(system, k, time)
        interleave(n, x, w.stage_x)
        interleave(n, v, w.stage_v)
        assembly.node_masses(chain, w.stage_mass)
        for s in range(n):
            w.modes[s] = 0.0
        if has_ground(conditions.parameters):
            contact.find(conditions, chain, x, v, w)
        rosenbrock.stage_force(conditions, chain, time, w)
    stage_masses(system)
    for k in range(lines_of(system)):
        if is_portion(system, k):
            take_pulls(system, k, time)
    solve_gains(system, time)


# --- over which sheaves rope runs


@kernel
def is_short(system, k):
    """Whether portion k is as short as it may be at the start of a piece."""
    return numbers_at(system, k)[at_sheave.LENGTH_NOW] <= (1.0 + AT_STOP) * shortest_of(system, k)


@kernel
def may_run(system, k, sign):
    """Whether rope may run forwards (sign 1) or backwards (-1) over the sheave at the end of line k."""
    return not is_short(system, k if sign > 0.0 else k + 1)


@kernel
def has_to_stop(system, k):
    """Whether rope runs over the sheave at the end of line k from a portion that is as short as it may be."""
    speed = numbers_at(system, k)[at_sheave.SPEED]
    return speed != 0.0 and not may_run(system, k, 1.0 if speed > 0.0 else -1.0)


@kernel
def urge(system, k, sign):
    """Force [N] with which the sheave at the end of line k, which is held, is pulled forwards (1) or backwards (-1)."""
    numbers, loss = numbers_at(system, k), loss_at_stage(system, k)
    behind, ahead = numbers[at_sheave.TENSION_BEHIND], numbers[at_sheave.TENSION_AHEAD]
    if sign > 0.0:
        return ahead - behind - (loss - 1.0) * max(behind, 0.0)
    return behind - ahead - (loss - 1.0) * max(ahead, 0.0)


@kernel
def overload(system, k):
    """Force [N] beyond its friction with which the sheave at the end of line k begins to run."""
    numbers = numbers_at(system, k)
    return OVERLOAD * (abs(numbers[at_sheave.TENSION_BEHIND]) + abs(numbers[at_sheave.TENSION_AHEAD]))


@kernel
def set_running(system, k, sign):
    """Let rope run over the sheave at the end of line k (modified) in a direction, 0 for any."""
    numbers = numbers_at(system, k)
    numbers[at_sheave.RUNS], numbers[at_sheave.SIGN] = 1.0, sign


@kernel
def hold(system, k):
    """Hold the sheave at the end of line k (modified)."""
    numbers = numbers_at(system, k)
    numbers[at_sheave.RUNS] = numbers[at_sheave.SIGN] = numbers[at_sheave.GAIN] = 0.0


@kernel
def begin_directions(system):
    """Over which sheaves rope runs as far as their speeds say (modified); how many more it may begin to run over."""
    undecided = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            speed = numbers_at(system, k)[at_sheave.SPEED]
            is_open = may_run(system, k, 1.0) and may_run(system, k, -1.0)
            if not has_friction(system, k) and (is_open or speed != 0.0):
                set_running(system, k, 0.0)
            elif speed != 0.0:
                set_running(system, k, 1.0 if speed > 0.0 else -1.0)
            else:
                hold(system, k)
                undecided += 1
    return undecided


@kernel
def change_directions(system, is_last):
    """Let sheaves that are pulled beyond their friction run, and hold those that would turn round; how many have changed."""
    changed = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            if not runs_over(system, k):
                margin = overload(system, k)
                for sign in (1.0, -1.0):
                    if may_run(system, k, sign) and urge(system, k, sign) > margin and not runs_over(system, k):
                        if not is_last:
                            set_running(system, k, sign)
                        changed += 1
            elif numbers[at_sheave.SPEED] == 0.0 and numbers[at_sheave.SIGN] * numbers[at_sheave.GAIN] < 0.0:
                hold(system, k)
                changed += 1
    return changed


@kernel
def stop_ropes(system, time):
    """Stop all sheaves that have to (modified), with the jumps of velocities of nodes and points (modified) that this is."""
    stops = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            stops += has_to_stop(system, k)
    if stops == 0:
        return
    evaluate(system, time, time, False)
    count, (matrix, _, right, _, _) = sheaves_of(system), shared_of(system)
    small_matrix.set_to_zero(count, matrix)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            take_tensions(system, k, time, matrix, right)
            right[number_of(system, k)] = 0.0
            if not runs_over(system, k) or has_to_stop(system, k):
                hold_row(system, k, matrix, right)
                right[number_of(system, k)] = -numbers_at(system, k)[at_sheave.SPEED]
    if not small_matrix.solve(count, matrix, right):
        return
    for k in range(lines_of(system)):
        if is_portion(system, k):
            jump_inner(system, k, right)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers, change = numbers_at(system, k), right[number_of(system, k)]
            if is_at_point(system, k, 1):
                jump_point(system, k, change)
            if has_to_stop(system, k):
                hold(system, k)
                numbers[at_sheave.SPEED] = 0.0
            else:
                numbers[at_sheave.SPEED] += change


@kernel
def jump_inner(system, k, changes):
    """Let the inner nodes of portion k (modified) take the changes of the speeds of its sheaves [m/s]."""
    w, (_, v) = integrator_of(system, k), motion_of(system, k)
    for side in (IN, OUT):
        if comes_from(system, k) if side == IN else goes_on(system, k):
            change, col = changes[number_of(system, k - 1 if side == IN else k)], array_at(system, k, PULLED, side)
            for i in range(1, segments_of(system, k)):
                add_at(v, i, scale(change / w.stage_mass[i], get(col, i)))


@kernel
def jump_point(system, k, change):
    """Let the free point at the end of line k (modified, in all its lines) take a change of the speed of that sheave."""
    point = point_at(system, k, 1)
    jump = scale(change / points_of(system).stage_mass[point], column_at_point(system, k))
    for other in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, other, end) and point_at(system, other, end) == point:
                _, v = motion_of(system, other)
                add_at(v, segments_of(system, other) * end, jump)


@kernel
def take_reeling(system, k, time):
    """Let the length of portion k (modified) change by itself as far as no sheave beside it runs, from a time [s] on."""
    numbers, length = numbers_at(system, k), numbers_at(system, k)[at_sheave.LENGTH_NOW]
    if is_running(system, k):
        numbers[at_sheave.HAS_RUN] = 1.0
        put_reeling(system, k, (length, 0.0, 0.0, NEUTRAL, NEUTRAL))
    elif numbers[at_sheave.HAS_RUN] != 0.0:
        paid = winch_of(system, k)
        start = length - (winch.length_at(paid, time) - paid[0])
        put_reeling(system, k, (start, paid[1], paid[2], paid[3], paid[4]))


@kernel
def turn_ropes(system, time):
    """Find over which sheaves (modified) rope runs from a time [s] on."""
    begin_directions(system)
    stop_ropes(system, time)
    if begin_directions(system) > 0:
        rounds = ROUNDS + 2 * sheaves_of(system)
        for i in range(rounds):
            evaluate(system, time, time, False)
            if change_directions(system, i == rounds - 1) == 0:
                break
    for k in range(lines_of(system)):
        if is_portion(system, k):
            take_reeling(system, k, time)


# --- a piece


@kernel
def error_of_rope(system, k, h):
    """Error of the sheave at the end of line k in a step of h [s] over what is allowed [-], as of a node that moves so."""
    numbers, worst = numbers_at(system, k), 0.0
    for j in (k, k + 1):
        _, v = motion_of(system, j)
        position_scale, velocity_scale = allowed_errors(conditions_of(system, j), v)
        fastest = max(abs(numbers[at_sheave.SPEED]), abs(numbers[at_sheave.STAGE_SPEED]))
        velocity_scale = max(velocity_scale, conditions_of(system, j).parameters[at.RELATIVE_TOLERANCE] * fastest)
        worst = max(worst, abs(GAMMA * h * numbers[at_sheave.SOLUTION]) / position_scale)
        worst = max(worst, abs(numbers[at_sheave.INCREMENT]) / velocity_scale)
    return worst


@kernel
def room_of_sheave(system, k, event, is_after):
    """Room until an event of the sheave at the end of line k, over how far below 0 is as good as 0 [-]; inf: there is none.

    is_after : at a state that is evaluated after the step.
    """
    numbers = numbers_at(system, k)
    sign = 1.0 if event in (SHORT_BEHIND, FORWARDS) else -1.0
    speed = numbers[at_sheave.STAGE_SPEED if is_after else at_sheave.SPEED]
    if event in (SHORT_BEHIND, SHORT_AHEAD):
        j = k if event == SHORT_BEHIND else k + 1
        if not runs_over(system, k) or (is_after and speed * sign <= 0.0):
            return inf
        length = numbers_at(system, j)[at_sheave.LENGTH if is_after else at_sheave.LENGTH_NOW]
        return (length - shortest_of(system, j)) / (LOCATED * shortest_of(system, j))
    if event == RESTS:
        if not runs_over(system, k) or numbers[at_sheave.SIGN] == 0.0:
            return inf
        return speed * numbers[at_sheave.SIGN] / (SLOW * numbers[at_sheave.LENGTH_NOW])
    margin = overload(system, k)
    if runs_over(system, k) or not may_run(system, k, sign) or margin == 0.0:
        return inf
    return -urge(system, k, sign) / margin


@kernel
def any_held(system):
    """Whether any sheave is held."""
    count = 0
    for k in range(lines_of(system)):
        count += goes_on(system, k) and not runs_over(system, k)
    return count > 0


@kernel
def find_event(system, k):
    """The event of the sheave at the end of line k that has happened by most after a step, into RIGHT (modified).

    And its room, into RATE; whether there is one.
    """
    numbers, least, found = numbers_at(system, k), -1.0, NO_EVENT
    for event in range(NO_EVENT):
        room = room_of_sheave(system, k, event, True)
        if room < least:
            least, found = room, event
    numbers[at_sheave.RIGHT], numbers[at_sheave.RATE] = float(found), least
    return found != NO_EVENT


@kernel
def part_to_rope_event(system, time, h, weight):
    """As `pieces.part_to_event`, of sheaves."""
    least, happened, held = inf, 0, any_held(system)
    if held:
        evaluate(system, time, time + h, True)
    for k in range(lines_of(system)):
        happened += goes_on(system, k) and find_event(system, k)
    if happened == 0:
        return inf
    if held:
        keep_results(system, True)
        evaluate(system, time, time, False)
        keep_results(system, False)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            event, over = int(numbers_at(system, k)[at_sheave.RIGHT]), numbers_at(system, k)[at_sheave.RATE]
            if event != NO_EVENT:
                least = min(least, part_of_piece(weight * room_of_sheave(system, k, event, False), over))
    return least


@kernel
def keep_results(system, is_kept):
    """Keep what sheaves have after a step that is tried, or put it back where `evaluate` has written (modified)."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            if is_kept:
                numbers[at_sheave.KEPT], numbers[at_sheave.KEPT + 1] = (
                    numbers[at_sheave.PASSED],
                    numbers[at_sheave.STAGE_SPEED],
                )
            else:
                numbers[at_sheave.PASSED], numbers[at_sheave.STAGE_SPEED] = (
                    numbers[at_sheave.KEPT],
                    numbers[at_sheave.KEPT + 1],
                )


@kernel
def accept_ropes(system, time, h):
    """Let all sheaves and portions (modified) have the results of the step of h [s] from a time [s] on."""
    for k in range(lines_of(system)):
        if is_portion(system, k):
            numbers = numbers_at(system, k)
            length = numbers[at_sheave.LENGTH_NOW]
            if comes_from(system, k):
                length += passed(system, k - 1)
            else:
                paid = winch_of(system, k)
                length += winch.length_at(paid, time + h) - winch.length_at(paid, time)
            if goes_on(system, k):
                length -= passed(system, k)
            numbers[at_sheave.LENGTH_NOW] = length
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            numbers = numbers_at(system, k)
            numbers[at_sheave.PAID] += numbers[at_sheave.PASSED]
            speed = numbers[at_sheave.STAGE_SPEED]
            turns_round = numbers[at_sheave.SIGN] * speed < 0.0
            numbers[at_sheave.SPEED] = 0.0 if turns_round else speed


@kernel
def passed(system, k):
    """Rope that has passed the sheave at the end of line k in the step [m]."""
    return numbers_at(system, k)[at_sheave.PASSED] if runs_over(system, k) else 0.0


# --- the end of a communication step


@kernel
def end_tension(system, k, end, time):
    """Tension [N] at an end of portion k where no sheave is, after `evaluate`."""
    numbers, n = numbers_at(system, k), segments_of(system, k)
    total, col = numbers[at_sheave.PULL + end], get(array_at(system, k, PULLED, end), n * end)
    if end == IN and goes_on(system, k):
        total += numbers[at_sheave.YIELD + 1] * numbers[at_sheave.GAIN]
    if end == OUT and comes_from(system, k):
        total += numbers[at_sheave.YIELD + 1] * numbers[at_sheave.INTO_GAIN]
    if is_at_point(system, k, end):
        total += dot(col, acceleration_of_point(system, point_at(system, k, end), time))
    return tension_of(stiffness_of(system, k), total if end == IN else -total)


@kernel
def write_tensions(system, time):
    """Tensions at both ends of all portions into their states (modified), after `evaluate`; none at a sheave is noted."""
    for k in range(lines_of(system)):
        if is_portion(system, k):
            state = state_of(system, k)
            if not comes_from(system, k):
                state[at.TENSION_FROM] = end_tension(system, k, IN, time)
            else:
                state[at.TENSION_FROM] = numbers_at(system, k - 1)[at_sheave.TENSION_AHEAD]
            if not goes_on(system, k):
                state[at.TENSION_TO] = end_tension(system, k, OUT, time)
            else:
                numbers = numbers_at(system, k)
                state[at.TENSION_TO] = numbers[at_sheave.TENSION_BEHIND]
                least = min(numbers[at_sheave.TENSION_BEHIND], numbers[at_sheave.TENSION_AHEAD])
                if least < 0.0:
                    note(state, limits.SLACK_AT_SHEAVE, least * least, 0.0)
                if is_at_point(system, k, 1):
                    gained = acceleration_of_point(system, point_at(system, k, 1), time)
                    put_at(state, at.END_ACCELERATION, gained)
                    put_at(state_of(system, k + 1), at.START_ACCELERATION, gained)


@kernel
def end_ropes(system, time):
    """Let the states (modified) have what sheaves and portions have at the end of a communication step, a time [s]."""
    begin_end(system)
    evaluate(system, time, time, False)
    write_tensions(system, time)
    for k in range(lines_of(system)):
        if is_portion(system, k):
            numbers, state = numbers_at(system, k), state_of(system, k)
            leaving = gain = 0.0
            if goes_on(system, k):
                leaving, gain = numbers[at_sheave.SPEED], numbers[at_sheave.GAIN]
                state[at.PAYOUT] += numbers[at_sheave.PAID]
                state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION] = leaving, gain
            if numbers[at_sheave.HAS_RUN] != 0.0:
                state[at.LENGTH] = numbers[at_sheave.LENGTH_NOW]
                state[at.REELING] = numbers[at_sheave.INTO] - leaving
                state[at.ACCELERATION] = numbers[at_sheave.INTO_GAIN] - gain


@kernel
def begin_end(system):
    """Let sheaves that rest (modified) be held, so that they gain no speed, but for those without friction."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            if numbers[at_sheave.SPEED] == 0.0 and has_friction(system, k):
                hold(system, k)
