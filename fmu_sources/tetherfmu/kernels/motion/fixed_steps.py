"""Fixed steps: three stages of all lines (`second_order.py`), or backward Euler (`backward_euler.py`).

If one line falls back to backward Euler, the whole system does: when a drum comes to rest, a segment is too stiff, a stage
does not converge, or the energy grows without input, see `fallback.py`.
"""

from math import inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.limits import FINEST, LAST_ITERATIONS, MOST_ITERATIONS, STAGES, most_of_a_step
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, OK, STATE_NOT_FINITE

from ..arrays import copy
from ..compilation import kernel
from ..equations import segment
from ..equations.boundary import chain_during
from ..equations.lines import conditions_of, lines_of, motion_of, state_of
from ..line import backward_euler, second_order
from ..line.backward_euler import EXPECTED, STAGE, WHOLE
from ..line.second_order import ENDS, GAMMA, TO_NEXT
from ..line.strand_room import UNCONVERGED
from ..notes import note, note_peak
from ..points import fixed
from ..points.descent import (
    EARLY,
    HELD,
    LATE,
    STUCK,
    descend,
    holds,
    is_unconverged,
    rests_on_ground,
    unconverged_lines,
)
from ..points.guess import begin_as_expected, guess, start
from ..points.room import (
    Step,
    attempt_of,
    chain_of_state,
    count_of,
    has_rope,
    moves,
    numbers_of,
    scratch_of,
    stages_of,
)
from . import events, turning
from .adaptive_steps import work_of
from .breaks import begin_breaks, break_lines, can_any_break, check_ends, place_all_ends
from .fallback import (
    ASKED,
    AT_STOP,
    HARD,
    ON_GROUND,
    RESOLVED,
    WELL_RESOLVED,
    bounces,
    count_fallback,
    crosses,
    give_back,
    hard_at,
    save_start,
    stiff_swing,
    unexplained,
)

HELD_FROM = LAST_ITERATIONS - MOST_ITERATIONS  # of the iterations of the finest parts: lets them converge

# --- backward Euler


@kernel
def note_unconverged(system, all_of_them, taken):
    """Count a step that ended unconverged in the numbers (modified) of the unconverged lines, or of all lines.

    taken : fraction of the last displacement.
    """
    for k in range(lines_of(system)):
        if moves(system, k) and (all_of_them or is_unconverged(system, k, taken)):
            numbers_of(system, k)[UNCONVERGED] += 1.0


@kernel
def take_all(system, step):
    """Accept the result of the iteration in all lines (modified)."""
    for k in range(lines_of(system)):
        if moves(system, k):
            x, v = motion_of(system, k)
            backward_euler.take(attempt_of(system, k, step), step.time, step.kind, x, v, scratch_of(system, k))


@kernel
def count_unconverged(system, step, taken):
    """Number of lines and coordinates that have not converged; taken : fraction of the last displacement."""
    return unconverged_lines(system, taken) + fixed.unconverged(system, step)


@kernel
def take_step(system, step, most, in_any_case):
    """A backward Euler step of all lines (modified): whether it was accepted, and its iterations, negative if singular.

    most : maximum number of iterations.  in_any_case : whether to accept an unconverged result.  Coordinates are not
    updated.
    """
    start(system, step)
    iterations, taken, unconverged, phi = 0, inf, 1, 0.0
    if step.kind == EXPECTED:
        phi, taken = begin_as_expected(system, step)
        iterations = 1
        unconverged = count_unconverged(system, step, taken) if taken < inf else 1
    else:
        phi = guess(system, step)
    phase = EARLY
    while iterations < most and not (step.turns and taken == STUCK):
        if unconverged == 0 and (phase == HELD or rests_on_ground(system, step)) and holds(system, step):
            break
        phase = (EARLY if iterations < MOST_ITERATIONS else LATE) if iterations < HELD_FROM else HELD
        phi, taken = descend(system, step, phi, phase)
        iterations += 1
        if taken == inf:
            return False, -1
        unconverged = count_unconverged(system, step, taken)
    has_converged = unconverged == 0 and taken != STUCK and (phase == HELD or rests_on_ground(system, step))
    if not (in_any_case or has_converged):
        return False, iterations
    note_unconverged(system, False, taken)
    take_all(system, step)
    return True, iterations


@kernel
def take_in_any_case(system, time, h):
    """A backward Euler step of h [s] of all lines (modified) at a time [s] with bounded iterations; returns their number.

    If it does not converge with coordinates, or overflows, the lines step alone, with speeds limited to the earlier ones, in
    as many iterations again. Energy made from nothing is then taken from all speeds.
    """
    iterations = 0
    if count_of(system) > 0:
        taken, iterations = take_step(system, Step(time, h, WHOLE, True), LAST_ITERATIONS, False)
        if taken:
            return iterations
        iterations = max(iterations, 0)
        note_unconverged(system, True, 0.0)
        fixed.keep_lengths(system, Step(time, h, WHOLE, False))
    save_start(system)
    _, more = take_step(system, Step(time, h, WHOLE, False), LAST_ITERATIONS, True)
    give_back(system, time, h)
    return more if more < 0 else iterations + more


@kernel
def subdivided_step(system, time, h):
    """One step of h [s] of all lines (modified) at a time [s], subdivided if it does not converge as a whole.

    Returns the number of iterations, at most `limits.WORST_SUBDIVIDED`, with drums WORST_SUBDIVIDED_WITH_DRUM; negative if
    a matrix is singular in a finest part. In longer ones the terms of flowing rope may let the solution overflow.
    """
    iterations, done, size = 0, 0, FINEST
    while done < FINEST:
        own = Step(time + h * done / FINEST, h * size / FINEST, WHOLE, count_of(system) > 0)
        turning.attempt_whole_step(system, own.time, own.h)
        taken, more = True, 0
        if size == 1:
            more = take_in_any_case(system, own.time, own.h)
        else:
            taken, more = take_step(system, own, MOST_ITERATIONS, False)
        if more < 0 and size == 1:
            return more
        if taken:
            turning.end_whole_step(system, own.time, own.h)
        iterations += max(more, 0)
        done, size = backward_euler.next_part(done, size, taken)
    return iterations


# --- stages


@kernel
def begin_stage(system, i, known):
    """Move all lines (modified) from the result of the previous stage to the start of stage i, with expected accelerations.

    known : as for `second_order.expect`.  Before the first stage their motion is saved.
    """
    if i == 0:
        save_start(system)
    for k in range(lines_of(system)):
        w, (x, v) = stages_of(system, k), motion_of(system, k)
        if i > 0 and moves(system, k):
            second_order.go_on(i, x, v, w)
        if moves(system, k) and known > 0:
            second_order.expect(TO_NEXT[i], known, w)


@kernel
def go_back(system):
    """Reset all lines, drums and ropes (modified) to the start of the step."""
    for k in range(lines_of(system)):
        w, (x, v) = stages_of(system, k), motion_of(system, k)
        copy(w.x, x)
        copy(w.v, v)


@kernel
def stages(system, time, h, known):
    """One step of h [s] of all lines (modified) at a time [s]: the reason to reject it, 0 if accepted; its iterations.

    known : number of known accelerations of earlier stages.
    """
    reach, iterations, does_cross = GAMMA * h, 0, False
    for i in range(STAGES):
        begin_stage(system, i, known)
        own = Step(time + (ENDS[i] - GAMMA) * h, reach, EXPECTED if known > 0 else STAGE, count_of(system) > 0)
        turning.begin_stage(system, i, own.time, reach, known)
        taken, more = take_step(system, own, MOST_ITERATIONS, False)
        iterations += max(more, 0)
        if not taken:
            return hard_at(system), iterations
        if not turning.end_stage(system):
            return AT_STOP, iterations
        if i < STAGES - 1:
            does_cross = does_cross or crosses(system, time, time + ENDS[i] * h)
        known += 1
    if not turning.turn_smoothly(system):
        return AT_STOP, iterations
    if bounces(system, h):
        return ON_GROUND, iterations
    place_all_ends(system, time + h)
    does_cross = does_cross or crosses(system, time, time + h)
    is_smooth = not does_cross and iterations <= 2 * STAGES
    return 0 if is_smooth or unexplained(system, time, h) == 0.0 else hard_at(system), iterations


@kernel
def step(system, method, time, h, known):
    """One step of h [s] of all lines (modified) at a time [s]: its iterations, and the reason for a fallback, or 0.

    method : of `backward_euler.FixedSteps`.  known : as for `stages`.
    At most `limits.WORST_WORK` iterations, each with one factorization, with drums WORST_WORK_WITH_DRUM; negative if a
    matrix is singular.
    """
    if method == at.BACKWARD_EULER:
        return subdivided_step(system, time, h), ASKED
    why, iterations = stages(system, time, h, known)
    if why == 0:
        turning.end_stages(system, time, h)
        return iterations, 0
    go_back(system)
    more = subdivided_step(system, time, h)
    return more if more < 0 else iterations + more, why


@kernel
def truncated_step(system, time, h):
    """One backward Euler step of all lines (modified), accepted as unconverged and counted so in all: its iterations."""
    turning.attempt_whole_step(system, time, h)
    iterations = take_in_any_case(system, time, h)
    turning.end_whole_step(system, time, h)
    note_unconverged(system, True, 0.0)
    return iterations


@kernel
def note_peaks(system, time):
    """Store the largest tensions of all lines at a time [s] of the communication step in their states (modified)."""
    for k in range(lines_of(system)):
        conditions, (x, v) = conditions_of(system, k), motion_of(system, k)
        chain = chain_of_state(system, k, time) if has_rope(system, k) else chain_during(conditions, time)
        note_peak(state_of(system, k), segment.largest_tension(chain, x, v))


@kernel
def integrate(system, steps, duration):
    """Advance all lines (modified) over a communication step of `duration` [s] with `backward_euler.FixedSteps`.

    A communication step that is not a multiple is divided evenly into steps of at most their size. Once hard steps have
    used up the iteration budget, the other steps end after `limits.LAST_ITERATIONS` of backward Euler. The state of the
    first line stores the counters, the numbers of each line its truncated iterations. Returns a status:
    OK, FIXED_STEPS_TOO_MANY, STATE_NOT_FINITE or, about a line, NO_LENGTH, REELED_TOO_SHORT or ROPE_RUNS_OFF.
    """
    budget = at.ITERATION_BUDGET // work_of(system)
    count = backward_euler.count_of_steps(steps, duration, budget)
    if count == 0:
        return FIXED_STEPS_TOO_MANY
    h = duration / count
    for k in range(lines_of(system)):
        numbers_of(system, k)[UNCONVERGED] = 0.0
    memory, spent, known, method = state_of(system, 0), 0, 0, steps.method
    if method != at.BACKWARD_EULER:
        swing = h * sqrt(stiff_swing(system, h))
        note(memory, limits.STIFF_STEP, h * h if swing > WELL_RESOLVED else 0.0, 0.0)
        method = at.BACKWARD_EULER if swing > RESOLVED else method
    may_break = begin_breaks(system)
    for i in range(count):
        if spent > STAGES * budget:
            iterations, why = truncated_step(system, i * h, h), HARD
        else:
            iterations, why = step(system, method, i * h, h, known)
        if iterations < 0:
            return STATE_NOT_FINITE
        status = turning.balance(system, i * h + h, GAMMA * h if why == 0 else h)
        if status == OK:
            status = turning.check(system)
        if status == OK:
            status = check_ends(system)
        if status != OK:
            return status
        known = 3 if why == 0 else 0
        spent += iterations
        if steps.method != at.BACKWARD_EULER:
            count_fallback(memory, why)
        if i < count - 1:
            note_peaks(system, i * h + h)
        if may_break and break_lines(system, i * h + h):
            may_break, known = can_any_break(system), 0
    events.begin_directions(system)  # coordinates that move at the end
    memory[at.STEPS] += count
    memory[at.ITERATIONS] += spent
    return OK


# --- bound

worst = kernel(most_of_a_step)


@kernel
def most_iterations(n, steps, has_drum, duration):
    """Maximum number of iterations, each with one factorization, in a communication step of `duration` [s]: bound in code.

        min(w m,  3 b + w + l m),   b = ITERATION_BUDGET/n

    for m `backward_euler.FixedSteps` of n segments; w : of a hard step, l : of one after more than 3 b. 0 : adaptive.
    """
    if steps.size == 0.0:
        return 0.0
    budget = at.ITERATION_BUDGET // n
    count, hard = backward_euler.count_of_steps(steps, duration, budget), worst(steps.method == at.BACKWARD_EULER, has_drum)
    last = 2 * LAST_ITERATIONS if has_drum else LAST_ITERATIONS
    most = min(hard * count, STAGES * budget + hard + last * count)
    return float(min(most, at.LARGEST_INTEGER))
