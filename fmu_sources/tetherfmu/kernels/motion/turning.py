"""The drums in fixed steps: how all of them turn in the stages of a step, and in backward Euler.

    L1 = L0 + g h u1,   u1 = u0 + g h f(x1, v1, L1, u1)/m,   and so on, as x and v of a node (`second_order.py`)

A stage is a step of backward Euler over g h (`system_fixed_drums.py`). Without mass f = 0 in each stage, and what putting
driven ends on their curves leaves of it is taken away by `moving_drum.project`. A step is taken anew by backward Euler where
one without a drum is, and where a drum comes to rest or to a stop, or leaves them, within the step: it then rests, or turns,
at its end. What makes a step of one drum one of backward Euler makes that of the whole system one.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK

from ..compilation import kernel
from ..equations import flow, segment
from ..equations.boundary import chain_with
from ..equations.drum import INWARDS, OUTWARDS, force_at, is_at_stop
from ..equations.lines import conditions_of, hold_length, lines_of, motion_of, note_line, parameters_of, put_reeling
from ..equations.properties import property_of
from ..equations.rope_at_drum import feels_rope
from ..equations.winch import steadily
from ..line.moving_drum import Instant, first_tension, project
from ..line.second_order import TO_NEXT, start_of_second, start_of_third
from ..linear_algebra.vectors import dot, get, sub
from ..points import system_room as at_line
from ..points.system_room import drum_at, has_drum, length_of, numbers_of, put_length
from .stopped_drums import put_reeling_speed

# --- a step that is attempted


@kernel
def limits_of(system, k, h):
    """Speeds [m/s] with which the drum of line k would come to its stops in a step of h [s], inwards and outwards."""
    drum, (length, _) = drum_at(system, k), length_of(system, k)
    return (drum.shortest - length) / h, (drum.longest - length) / h


@kernel
def attempt(system, k, lowest, highest, guess):
    """Let the drum of line k (modified) begin a step with a guess of its speed, which has these limits [m/s]."""
    numbers, (length, _) = numbers_of(system, k), length_of(system, k)
    numbers[at_line.LOWEST], numbers[at_line.HIGHEST] = lowest, highest
    numbers[at_line.TRIAL], numbers[at_line.CHANGE], numbers[at_line.IS_FOUND] = min(highest, max(lowest, guess)), 0.0, 0.0
    hold_length(system, k, length)


# --- backward Euler


@kernel
def attempt_whole_step(system, h):
    """Let all drums (modified) begin a step of backward Euler of h [s]; one that friction stops does not turn round."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            drum, (_, speed), (lowest, highest) = drum_at(system, k), length_of(system, k), limits_of(system, k, h)
            if drum.friction > 0.0 and drum.mass > 0.0:
                if speed > 0.0:
                    lowest = min(max(lowest, 0.0), highest)
                elif speed < 0.0:
                    highest = max(min(highest, 0.0), lowest)
            attempt(system, k, lowest, highest, speed)


@kernel
def end_whole_step(system, h):
    """Let all drums (modified) have the result of a step of backward Euler of h [s]: stops are inelastic."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            drum, (length, _), (lowest, highest) = drum_at(system, k), length_of(system, k), limits_of(system, k, h)
            speed = numbers_of(system, k)[at_line.TRIAL]
            if speed <= lowest:
                put_reeling_speed(system, k, drum.shortest, 0.0, speed)
            elif speed >= highest:
                put_reeling_speed(system, k, drum.longest, 0.0, speed)
            else:
                put_length(system, k, length + h * speed, speed)


@kernel
def turn_evenly(system, time):
    """Let all drums (modified) turn with the speeds of the iteration from a time [s] on, for lines that move alone."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            (length, _), speed = length_of(system, k), numbers_of(system, k)[at_line.TRIAL]
            put_reeling(system, k, steadily(length - speed * time, speed, 0.0))


# --- stages


@kernel
def begin_stage(system, i, reach, known):
    """Let all drums (modified), the results of the stage before, begin stage i of `reach` [s].

    Their speeds in the last stages are continued to a guess; known : of how many of these before the step they are known.
    """
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, (length, speed) = numbers_of(system, k), length_of(system, k)
            guess = speed + (TO_NEXT[i] * (speed - numbers[at_line.BEFORE]) if known > 0 else 0.0)
            numbers[at_line.LONG_BEFORE], numbers[at_line.BEFORE] = numbers[at_line.BEFORE], speed
            if i == 0:
                numbers[at_line.START_LENGTH], numbers[at_line.START_SPEED] = length, speed
            elif i == 1:
                length, numbers[at_line.ONWARD_LENGTH] = start_of_second(numbers[at_line.START_LENGTH], length)
                speed, numbers[at_line.ONWARD_SPEED] = start_of_second(numbers[at_line.START_SPEED], speed)
            else:
                length = start_of_third(numbers[at_line.ONWARD_LENGTH], numbers[at_line.START_LENGTH], length)
                speed = start_of_third(numbers[at_line.ONWARD_SPEED], numbers[at_line.START_SPEED], speed)
            put_length(system, k, length, speed)
            attempt(system, k, *limits_of(system, k, reach), guess)


@kernel
def end_stage(system, time, h, reach):
    """Let all drums (modified) have the results of a stage of `reach` [s]; whether none has come to a stop.

    From then on the lengths of their lines change evenly from the start of the step to there: h [s] from its time [s] on.
    """
    at_stops = 0
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, (length, _) = numbers_of(system, k), length_of(system, k)
            speed = numbers[at_line.TRIAL]
            at_stops += not (speed == 0.0 or numbers[at_line.LOWEST] < speed < numbers[at_line.HIGHEST])
            put_length(system, k, length + reach * speed, speed)
            rate = (length + reach * speed - numbers[at_line.START_LENGTH]) / h
            put_reeling(system, k, steadily(numbers[at_line.START_LENGTH] - rate * time, rate, 0.0))
    return at_stops == 0


@kernel
def turns_smoothly(has_friction, has_mass, speed, first, second, third):
    """Whether a drum turns, or is held, throughout a step, with its speeds [m/s] at the start and in the stages."""
    if first == 0.0 and second == 0.0 and third == 0.0:
        return not has_mass or speed == 0.0
    if first == 0.0 or second == 0.0 or third == 0.0:
        return False
    if not has_friction:
        return True
    return first * second > 0.0 and second * third > 0.0 and (not has_mass or speed * first > 0.0)


@kernel
def turn_smoothly(system):
    """Whether each drum turns, or is held, throughout a step whose stages are done."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, drum, (_, speed) = numbers_of(system, k), drum_at(system, k), length_of(system, k)
            stages = numbers[at_line.START_SPEED], numbers[at_line.LONG_BEFORE], numbers[at_line.BEFORE], speed
            if not turns_smoothly(drum.friction != 0.0, drum.mass != 0.0, *stages):
                return False
    return True


@kernel
def go_back(system, k):
    """Put the drum of line k (modified) back to the start of the step."""
    if has_drum(system, k):
        numbers = numbers_of(system, k)
        put_length(system, k, numbers[at_line.START_LENGTH], numbers[at_line.START_SPEED])


# --- energy


@kernel
def energy_and_power(system, k, is_new, x, v):
    """Energy of the drum of line k [J] and the power [W] at most with which energy grows as not all segments pull alike.

    What the drum pays out lengthens all segments, and only the first one pulls at it. With the nodes at x [m] and velocities
    v [m/s] after the stages of a step, or at its start; the line (modified) then has the length there.
    """
    conditions, numbers = conditions_of(system, k), numbers_of(system, k)
    length, speed = length_of(system, k) if is_new else (numbers[at_line.START_LENGTH], numbers[at_line.START_SPEED])
    hold_length(system, k, length)
    chain, power = chain_with(conditions, length, speed), 0.0
    if feels_rope(chain.parameters):
        return energy_and_power_with_rope(system, k, chain, x, v)
    first = first_tension(chain, x, v)
    for s in range(chain.n):
        stretched, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rate = dot(e, sub(get(v, s + 1), get(v, s)))
        tension = segment.tension_of(chain, s, segment.BY_LENGTH, stretched, rate)
        power += abs(property_of(chain, s, at.SHARE) * first - tension * stretched / length)
    return 0.5 * drum_at(system, k).mass * speed * speed, power * abs(speed)


@kernel
def energy_and_power_with_rope(system, k, chain, x, v):
    """The same where the drum feels the rope that flows: with the kinetic energy of the rope beyond that of the nodes.

    The power is what rope from the drum brings, and the strain that it has there.
    """
    speed = chain.reeling
    energy, part = 0.5 * parameters_of(system, k)[at.WINCH_MASS] * speed * speed, 1.0
    for s in range(chain.n):
        energy += flow.energy(chain, s, part, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1))
        part -= property_of(chain, s, at.SHARE)
    drum, density = drum_at(system, k), property_of(chain, 0, at.LINE_DENSITY)
    force = abs(drum.force) + drum.damping * abs(speed) + drum.friction
    stored = 0.5 * force * force / property_of(chain, 0, at.STIFFNESS)
    brought = density * (0.5 * speed * speed + chain.gravity * abs(x[2]) + dot(get(v, 0), get(v, 0)))
    return energy, (brought + stored) * abs(speed)


@kernel
def work_of_motors(system, time, h):
    """Work of all motors [J] in the stages of a step of h [s] at a time [s] of the communication step."""
    work = 0.0
    for k in range(lines_of(system)):
        if has_drum(system, k):
            drum, start, (end, _) = drum_at(system, k), numbers_of(system, k)[at_line.START_LENGTH], length_of(system, k)
            work += 0.5 * (force_at(drum, time) + force_at(drum, time + h)) * (start - end)
    return work


# --- drums without mass


@kernel
def balance(system, time, d):
    """Let all drums without mass that turn (modified) have T = W + c u + F sign(u) after a step, at its end [s]; a status.

    d : as for `moving_drum.project`.  The plan (modified) then says which line it is about.
    """
    for k in range(lines_of(system)):
        if has_drum(system, k):
            drum, (length, speed) = drum_at(system, k), length_of(system, k)
            may_rest = drum.friction > 0.0 or is_at_stop(drum, length, OUTWARDS) or is_at_stop(drum, length, INWARDS)
            if drum.mass == 0.0 and not (speed == 0.0 and may_rest):
                direction = INWARDS if speed < 0.0 else OUTWARDS
                now = Instant(time, length, speed, *motion_of(system, k))
                length, speed, found = project(conditions_of(system, k), drum, direction, d, now)
                if not found:
                    note_line(system.plan, k)
                    return NO_LENGTH
                put_length(system, k, length, speed)
    return OK
