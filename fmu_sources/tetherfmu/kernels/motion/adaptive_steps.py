"""Error-controlled steps within a communication step: the loop of the adaptive solver.

All lines share one step: its error is the largest relative error of any line. `step_control.py` defines the error of a line
and the rule for the next step; the state of the first line stores its memory.
"""

from math import inf, nan

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

from ..arrays import clear, copy
from ..compilation import kernel, view
from ..equations.boundary import chain_during
from ..equations.free_points import points_of
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of, state_of
from ..line.drum_events import LONGEST_PART, SHORTEST_PART, SMALLEST_PIECE
from ..line.step_control import (
    SMALLEST_STEP,
    allowed_errors,
    cut,
    error_of_step,
    even_step,
    first_step,
    is_given_up,
    next_step,
    step_after_event,
)
from ..line.strand_room import LARGEST
from ..line.taut_slack import part_to_transition
from ..linear_algebra.vectors import get
from ..notes import note_peak
from ..points import step as system_step
from ..points.room import (
    chain_at_stage,
    chain_of_state,
    count_free,
    count_of,
    has_free_nodes,
    has_rope,
    integrator_of,
    moves,
    numbers_of,
)
from ..points.step import apply_changes, collect_changes, whole_masses
from . import events
from .breaks import begin_breaks, break_lines, can_any_break, check_ends, part_to_break


@kernel
def larger_error(a, b):
    """The larger of two errors; NaN if one of them is (`max(a, b)` is NaN only if a is)."""
    if a >= b:
        return a
    return b if b > a else nan


@view
def chain_in_step(system, k, time):
    """`Chain` of line k at a time [s] of the communication step, with coordinates at the stage."""
    if has_rope(system, k):
        return chain_at_stage(system, k)
    return chain_during(conditions_of(system, k), time)


@kernel
def error_of_line(system, k, time, h):
    """Relative error of line k in the step of h [s] to a time [s] of the communication step [-]."""
    w, chain, (_, v) = integrator_of(system, k), chain_in_step(system, k, time), motion_of(system, k)
    error, largest = error_of_step(conditions_of(system, k), chain, h, v, events.drum_error(system, k), w)
    numbers_of(system, k)[LARGEST] = largest
    return larger_error(error, events.settle_single_segment(system, k, time, h))


@kernel
def error_of_lines(system, time, h):
    """Relative error of the step of h [s] to a time [s] of the communication step [-].

    If segments of several lines at a point crossed the transition, the point receives the sum of their impulses
    (`taut_slack.keep_energy`).
    """
    clear(points_of(system).change)
    error, changed = events.error_of_coordinates(system, h), 0
    for k in range(lines_of(system)):
        if moves(system, k):
            w = integrator_of(system, k)
            whole_masses(system, k, w)
            before = get(w.v, 0), get(w.v, segments_of(system, k))
            error = larger_error(error, error_of_line(system, k, time, h))
            changed += collect_changes(system, k, before, w)
    if changed > 0:
        for k in range(lines_of(system)):
            if moves(system, k):
                apply_changes(system, k)
    return error


@kernel
def attempt(system, time, h):
    """Try a step of h [s] from a time [s] of the communication step; returns its relative error [-]."""
    if not system_step.step(system, time, h):
        return inf
    error = error_of_lines(system, time + h, h)
    return inf if error <= 1.0 and not events.project_massless(system, time + h, h) else error


@kernel
def accept(system, time, h, is_last):
    """Accept the results of the step of h [s] from a time [s] in lines, drums and coordinates (modified).

    is_last : of the communication step.
    """
    for k in range(lines_of(system)):
        if moves(system, k):
            w, (x, v) = integrator_of(system, k), motion_of(system, k)
            copy(w.x, x)
            copy(w.v, v)
            if not is_last:
                note_peak(state_of(system, k), numbers_of(system, k)[LARGEST])
    if count_of(system) > 0:
        events.accept(system, time + h)


@kernel
def part_to_slack(system, time, h, weight):
    """Fraction of the step of h [s] from a time [s] after which a segment has just crossed its transition.

    inf if no step has to end there, see `part_to_transition`.  weight : as for `part_to_break`.
    """
    least = inf
    for k in range(lines_of(system)):
        after, mass = chain_in_step(system, k, time + h), events.mass_of_rate(system, k)
        if (has_free_nodes(system, k) or mass < inf) and after.slack_damping_ratio != 1.0:
            w, (x, v), conditions = integrator_of(system, k), motion_of(system, k), conditions_of(system, k)
            _, speed = allowed_errors(conditions, v)
            part = part_to_transition(conditions, chain_of_state(system, k, time), after, h, x, v, speed, mass, w)
            if part < inf:
                least = min(least, max(SHORTEST_PART, min(LONGEST_PART, weight * part)))
    return least


@kernel
def work_of(system):
    """Number of segments of all lines."""
    count = 0
    for k in range(lines_of(system)):
        count += segments_of(system, k)
    return count


@kernel
def integrate(system, duration):
    """Advance the lines (modified) over a communication step of `duration` [s] with error-controlled steps.

    The state of the first line stores solver memory and counters. Returns a status: OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL
    or, about a line, NO_LENGTH or ROPE_RUNS_OFF.
    """
    memory = state_of(system, 0)
    time = 0.0
    h, last_error = first_step(duration, memory)
    budget = at.WORK_BUDGET // work_of(system)
    tried, rejected_before = 0, False
    may_break = begin_breaks(system)
    is_new = True  # whether a piece begins
    piece, weight = inf, 1.0
    beyond = 0.0  # a time after the next event of a drum, 0 if unknown
    idle = 0
    while time < duration:
        if is_given_up(memory, tried, budget, time, duration):
            return STEP_BUDGET_SPENT
        if h < SMALLEST_STEP * duration:
            return STEP_TOO_SMALL
        tried += 1
        if is_new:
            if count_of(system) > 0 and not events.turn(system, time, duration):
                return NO_LENGTH
            is_new, piece, weight = False, beyond - time if beyond > time else inf, 1.0
        h_now, is_last = even_step(duration - time, h)
        is_last = is_last and not piece < h_now
        h_now = min(h_now, piece)
        error = attempt(system, time, h_now)
        if not error <= 1.0:
            rejected_before = True
            h = cut(h_now, error)
            memory[at.REJECTIONS] += 1.0
            continue
        before_event = part_to_slack(system, time, h_now, weight)
        if may_break:
            before_event = min(before_event, part_to_break(system, time, h_now, weight))
        if count_of(system) > 0:
            before_event = min(before_event, events.part_to_event(system, time, h_now, weight))
        if before_event < inf and h_now > SMALLEST_PIECE * duration and idle < events.MOST_IDLE:
            piece = h_now * before_event
            weight *= 0.5  # if the next piece is too long again, the one after it will not be
            beyond = time + h_now
            memory[at.REJECTIONS] += 1.0
            continue
        if before_event < inf:
            beyond = 0.0
        idle = idle + 1 if h_now < SMALLEST_PIECE * duration and count_free(system) == 0 else 0
        accept(system, time, h_now, is_last)
        status = check_ends(system)
        if status != OK:
            return status
        is_new = True
        time = duration if is_last else time + h_now
        if may_break and break_lines(system, time):
            may_break = can_any_break(system)
        h = step_after_event(h, h_now, next_step(h, h_now, error, last_error, rejected_before), duration)
        last_error = error
        rejected_before = False
        memory[at.STEPS] += 1.0
    memory[at.SOLVER_STEP] = h
    memory[at.SOLVER_ERROR] = last_error
    return OK
