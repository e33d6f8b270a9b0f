"""Steps with ropes over sheaves: the error of a step, the events that end a piece of it, and its results.

See `rope_directions.py`.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import winch
from ..equations.lines import (
    comes_from,
    conditions_of,
    goes_on,
    is_portion,
    lines_of,
    motion_of,
    state_of,
)
from ..line.drum_events import SLOW, part_of_piece
from ..line.rodas4p import GAMMA
from ..line.step_control import allowed_errors
from ..points import sheave_room as at_sheave
from ..points.sheave_pulls import number_sheaves
from ..points.sheave_room import (
    numbers_at,
    runs_over,
    shortest_of,
    winch_of,
)
from .rope_directions import may_run, overload, urge
from .rope_states import evaluate

LOCATED = 1e-10  # of it: how far a piece may end beyond
SHORT_BEHIND, SHORT_AHEAD, RESTS, FORWARDS, BACKWARDS, NO_EVENT = range(6)  # events that end a piece


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
