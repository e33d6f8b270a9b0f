"""Steps with ropes over sheaves: the error of a step, the events that end a piece of it, and its results.

See `rope_directions.py`.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import winch
from ..equations.lines import conditions_of, lines_of, motion_of, put_numbers, state_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import comes_from, goes_on, is_rope, is_turned
from ..line.drum_events import SLOW, part_of_piece
from ..line.rodas4p import GAMMA
from ..line.step_control import allowed_errors
from ..line.taut_slack import keep_energy_of_drum, wrong_impulse
from ..points import sheave_room as at_sheave
from ..points.coordinates import (
    carries_drum,
    coordinate_at,
    count_of,
    count_running,
    growth_of,
    line_of,
    number_coordinates,
    own_numbers,
    portions_of,
    runs,
    weight_of,
)
from ..points.sheave_room import drum_numbers_at, longest_of, numbers_at, shortest_of, take_parts, through, winch_of
from ..points.sheaves import inertia_of
from .rope_directions import may_run, urges_now
from .rope_states import evaluate

LOCATED = 1e-10  # of it: how far a piece may end beyond
STOPS_FORWARDS, STOPS_BACKWARDS, RESTS, FORWARDS, BACKWARDS, NO_EVENT = range(6)  # events that end a piece


@kernel
def begin_ropes(system):
    """Let all coordinates and portions (modified) begin a communication step with their states."""
    number_coordinates(system)
    forget_tensions(system)
    for k in range(lines_of(system)):
        if is_rope(system, k):
            numbers, state, reeling = numbers_at(system, k), state_of(system, k), conditions_of(system, k).reeling
            numbers[at_sheave.LENGTH_NOW] = reeling[0]
            put_numbers(numbers, at_sheave.WINCH, reeling)
            numbers[at_sheave.HAS_RUN] = 0.0
            take_parts(system, k)
            begin_coordinate(numbers, state[at.SHEAVE_SPEED] if goes_on(system, k) else 0.0, state[at.SHEAVE_ACCELERATION])
        if carries_drum(system, k):
            state = state_of(system, k)
            numbers_at(system, k)[at_sheave.LENGTH_NOW] = conditions_of(system, k).reeling[0]  # also of a line that broke
            begin_coordinate(drum_numbers_at(system, k), state[at.DRUM_SPEED], state[at.DRUM_ACCELERATION])


@kernel
def forget_tensions(system):
    """Let the tensions at all coordinates (modified) not be known."""
    numbers_at(system, 0)[at_sheave.KNOWN] = 0.0


@kernel
def begin_coordinate(numbers, speed, gain):
    """Let a coordinate with these numbers (modified) begin a communication step with a speed [m/s] and u' [m/s2]."""
    numbers[at_sheave.SPEED], numbers[at_sheave.GAIN] = speed, gain
    numbers[at_sheave.PAID] = numbers[at_sheave.RUNS] = numbers[at_sheave.SIGN] = 0.0


@kernel
def error_of_rope(system, c, h):
    """Error of a coordinate in a step of h [s] over what is allowed [-], as of a node that moves with the rope there."""
    numbers, worst = own_numbers(system, c), 0.0
    for k in range(*portions_of(system, c)):
        weight = abs(weight_of(system, c, k, IN)) + weight_of(system, c, k, OUT)
        if weight != 0.0:
            _, v = motion_of(system, k)
            position_scale, velocity_scale = allowed_errors(conditions_of(system, k), v)
            fastest = weight * max(abs(numbers[at_sheave.SPEED]), abs(numbers[at_sheave.STAGE_SPEED]))
            velocity_scale = max(velocity_scale, conditions_of(system, k).parameters[at.RELATIVE_TOLERANCE] * fastest)
            worst = max(worst, weight * abs(GAMMA * h * numbers[at_sheave.SOLUTION]) / position_scale)
            worst = max(worst, weight * abs(numbers[at_sheave.INCREMENT]) / velocity_scale)
    return worst


@kernel
def error_of_ropes(system, h):
    """The largest one of those that run."""
    worst = 0.0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if runs(system, c):
            worst = max(worst, error_of_rope(system, c, h))
    return worst


@kernel
def mass_of_rate(system, k):
    """Mass [kg] that L' of portion k moves with the coordinates that run there; 0 where none does."""
    mobility = 0.0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        growth = growth_of(system, c, k)
        if runs(system, c) and growth != 0.0:
            mobility += growth * growth / inertia_of(system, c)
    return 1.0 / mobility if mobility > 0.0 else 0.0


@kernel
def transition_of_ropes(system, k, chain, h, w):
    """Error of L' of portion k, a segment between driven ends, from its `taut_slack.wrong_impulse` in a step of h [s].

    Over what is allowed [-], squared; 0 where it is less. chain, w : as for `step_control.error_of_step`.
    """
    mass, (_, v) = mass_of_rate(system, k), motion_of(system, k)
    if mass == 0.0:
        return 0.0
    conditions = conditions_of(system, k)
    _, scale = allowed_errors(conditions, v)
    scale = max(scale, conditions.parameters[at.RELATIVE_TOLERANCE] * abs(chain.reeling))
    transition = wrong_impulse(0, chain, h, w) / mass / scale
    return transition * transition if transition > 1.0 else 0.0


@kernel
def keep_energy_of_ropes(system, k, chain, w):
    """Let the coordinates (modified) at portion k, a segment between driven ends, have the speeds that keep the energy.

    Each gets its part of what changes L', see `taut_slack.keep_energy_of_drum`.
    """
    mass = mass_of_rate(system, k)
    change = keep_energy_of_drum(mass, chain, w) - chain.reeling
    if change != 0.0:
        for j in range(count_of(system)):
            c = coordinate_at(system, j)
            growth = growth_of(system, c, k)
            if runs(system, c) and growth != 0.0:
                own_numbers(system, c)[at_sheave.STAGE_SPEED] += change * mass * growth / inertia_of(system, c)


@kernel
def room_to_stop(system, c, sign, is_after):
    """Room until a coordinate that runs forwards (sign 1) or backwards (-1) comes to a stop, as `room_of_coordinate`."""
    least, which = inf, at_sheave.LENGTH if is_after else at_sheave.LENGTH_NOW
    for k in range(*portions_of(system, c)):
        growth, length = sign * growth_of(system, c, k), numbers_at(system, k)[which]
        if growth < 0.0:
            least = min(least, (length - shortest_of(system, k)) / (LOCATED * shortest_of(system, k)))
        elif growth > 0.0 and is_turned(system, k):
            least = min(least, (longest_of(system, k) - length) / (LOCATED * longest_of(system, k)))
    return least


@kernel
def room_of_coordinate(system, c, event, is_after):
    """Room until an event of a coordinate, over how far below 0 is as good as 0 [-]; inf: there is none.

    is_after : at a state that is evaluated after the step.
    """
    numbers = own_numbers(system, c)
    sign = 1.0 if event in (STOPS_FORWARDS, FORWARDS) else -1.0
    speed = numbers[at_sheave.STAGE_SPEED if is_after else at_sheave.SPEED]
    if event in (STOPS_FORWARDS, STOPS_BACKWARDS):
        if not runs(system, c) or (is_after and speed * sign <= 0.0):
            return inf
        return room_to_stop(system, c, sign, is_after)
    if event == RESTS:
        if not runs(system, c) or numbers[at_sheave.SIGN] == 0.0:
            return inf
        return speed * numbers[at_sheave.SIGN] / (SLOW * numbers_at(system, line_of(system, c))[at_sheave.LENGTH_NOW])
    forwards, backwards, margin = urges_now(system, c)
    if runs(system, c) or not may_run(system, c, sign) or margin == 0.0:
        return inf
    return -(forwards if sign > 0.0 else backwards) / margin


@kernel
def find_event(system, c):
    """The event of a coordinate that has happened by most after a step, into RIGHT (modified).

    And its room, into RATE; whether there is one.
    """
    numbers, least, found = own_numbers(system, c), -1.0, NO_EVENT
    for event in range(NO_EVENT):
        room = room_of_coordinate(system, c, event, True)
        if room < least:
            least, found = room, event
    numbers[at_sheave.RIGHT], numbers[at_sheave.RATE] = float(found), least
    return found != NO_EVENT


@kernel
def part_to_rope_event(system, time, h, weight):
    """As `pieces.part_to_event`, of coordinates."""
    least, happened, running = inf, 0, count_running(system)
    held = running < count_of(system)
    if held:
        evaluate(system, time, time + h, True)
    for j in range(count_of(system)):
        happened += find_event(system, coordinate_at(system, j))
    numbers_at(system, 0)[at_sheave.KNOWN] = 1.0 if happened == 0 and running == 0 else 0.0
    if happened == 0:
        return inf
    if held:
        keep_results(system, True)
        evaluate(system, time, time, False)
        keep_results(system, False)
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        event, over = int(own_numbers(system, c)[at_sheave.RIGHT]), own_numbers(system, c)[at_sheave.RATE]
        if event != NO_EVENT:
            least = min(least, part_of_piece(weight * room_of_coordinate(system, c, event, False), over))
    return least


@kernel
def keep_results(system, is_kept):
    """Keep what coordinates have after a step that is tried, or put it back where `evaluate` has written (modified)."""
    for j in range(count_of(system)):
        numbers = own_numbers(system, coordinate_at(system, j))
        for i, place in ((0, at_sheave.PASSED), (1, at_sheave.STAGE_SPEED)):
            if is_kept:
                numbers[at_sheave.KEPT + i] = numbers[place]
            else:
                numbers[place] = numbers[at_sheave.KEPT + i]


@kernel
def accept_ropes(system, time, h):
    """Let all coordinates and portions (modified) have the results of the step of h [s] from a time [s] on."""
    for k in range(lines_of(system)):
        if is_rope(system, k):
            numbers = numbers_at(system, k)
            length = numbers[at_sheave.LENGTH_NOW]
            if comes_from(system, k) or is_turned(system, k):
                length += through(system, k, IN, at_sheave.PASSED)
            else:
                paid = winch_of(system, k)
                length += winch.length_at(paid, time + h) - winch.length_at(paid, time)
            if goes_on(system, k):
                length -= through(system, k, OUT, at_sheave.PASSED)
            numbers[at_sheave.LENGTH_NOW] = length
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if runs(system, c):
            numbers = own_numbers(system, c)
            numbers[at_sheave.PAID] += numbers[at_sheave.PASSED]
            speed = numbers[at_sheave.STAGE_SPEED]
            turns_round = numbers[at_sheave.SIGN] * speed < 0.0
            numbers[at_sheave.SPEED] = 0.0 if turns_round else speed
