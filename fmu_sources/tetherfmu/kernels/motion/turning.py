"""Rope coordinates in fixed steps: their joint motion in three-stage steps and in backward Euler.

    q1 = q0 + g h u1,   u1 = u0 + g h f(x1, v1, q1, u1)/m,   and so on, as x and v of a node (`line/second_order.py`)

A stage is a backward Euler step over g h (`points/fixed.py`). A step falls back to backward Euler for the reasons that apply
without coordinates, and where a coordinate starts, comes to rest or reaches a stop. Backward Euler stops the ropes at the
ends of its steps, and nodes absorb their momentum (`events.stop`). If one coordinate falls back, the whole system does.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK, REELED_TOO_SHORT

from ..compilation import kernel
from ..equations import flow, segment
from ..equations.drum import INWARDS, OUTWARDS, is_at_stop
from ..equations.lines import conditions_of, lines_of, note_line
from ..equations.properties import in_section, property_of
from ..equations.rope import feels_rope
from ..equations.ropes import goes_on
from ..line.massless_drum import project
from ..line.second_order import TO_NEXT, start_of_second, start_of_third
from ..line.strand_room import SHEAVE, TENSION
from ..linear_algebra.vectors import dot, get, sub
from ..points import fixed, room
from ..points.coordinates import has_own_drum
from ..points.room import (
    chain_at_stage,
    chain_with_rope,
    coordinate_at,
    count_of,
    has_rope,
    is_drum,
    is_on_drum,
    line_of,
    numbers_of,
    take_rates,
)
from . import events
from .events import drum_at, instant_of
from .states import go_to_state

# --- trial step


@kernel
def attempt(system, time, h):
    """Begin a step of h [s] at a time [s] for all coordinates (modified), with guesses of their speeds in SPEED_NOW."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.IS_HELD], own[room.SIGN], own[room.CHANGE], own[room.IS_FOUND] = 0.0, 0.0, 0.0, 0.0
        if own[room.IS_BRAKED] != 0.0:
            own[room.SPEED_NOW] = 0.0
        fixed.put_speed(own, h, own[room.SPEED_NOW])
    fixed.place_lines(system, time + h)


@kernel
def begin(system):
    """Begin a fixed step of all coordinates (modified) from their states."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.REACHED], own[room.REACHED_SPEED] = own[room.PASSED], own[room.SPEED]
        own[room.START_PASSED], own[room.START_SPEED] = own[room.PASSED], own[room.SPEED]
        own[room.PASSED_NOW], own[room.SPEED_NOW], own[room.KEEPS] = own[room.PASSED], own[room.SPEED], 0.0


# --- backward Euler


@kernel
def attempt_whole_step(system, time, h):
    """Begin a backward Euler step of h [s] at a time [s] for all coordinates (modified); friction reverses none of them."""
    begin(system)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if own[room.FRICTION] != 0.0 and own[room.IS_MASSLESS] == 0.0 and has_inertia(system, j):
            own[room.KEEPS] = 0.0 if own[room.SPEED] == 0.0 else (1.0 if own[room.SPEED] > 0.0 else -1.0)
    attempt(system, time, h)


@kernel
def has_inertia(system, j):
    """Whether the speed is continuous where friction changes sign: rope over a sheave, or a drum with mass."""
    return not is_drum(system, j) or coordinate_at(system, j)[room.MASS] > 0.0


@kernel
def accept(system):
    """Accept the result of the step in all coordinates (modified)."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.PASSED], own[room.SPEED], own[room.ACCELERATION] = (
            own[room.PASSED_NOW],
            own[room.SPEED_NOW],
            own[room.GAIN_NOW],
        )


@kernel
def end_whole_step(system, time, h):
    """Accept a backward Euler step of h [s] from a time [s] in all coordinates (modified), and apply stops."""
    accept(system)
    if count_of(system) > 0:
        go_to_state(system, time + h)
        events.begin_directions(system)
        events.stop(system, time + h)


# --- stages


@kernel
def begin_stage(system, i, time, reach, known):
    """Begin stage i over `reach` [s] at a time [s] in all coordinates (modified), from the results of the previous stage.

    Extrapolates the speeds of earlier stages to a guess; known : number of stages before the step with known speeds.
    """
    if i == 0:
        begin(system)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        speed, passed, start, from_start = (
            own[room.SPEED_NOW],
            own[room.PASSED_NOW],
            own[room.START_SPEED],
            own[room.START_PASSED],
        )
        guess = speed + (TO_NEXT[i] * (speed - own[room.BEFORE]) if known > 0 else 0.0)
        own[room.LONG_BEFORE], own[room.BEFORE] = own[room.BEFORE], speed
        if i == 1:
            own[room.REACHED], own[room.ONWARD_PASSED] = start_of_second(from_start, passed)
            own[room.REACHED_SPEED], own[room.ONWARD_SPEED] = start_of_second(start, speed)
        elif i == 2:
            own[room.REACHED] = start_of_third(own[room.ONWARD_PASSED], from_start, passed)
            own[room.REACHED_SPEED] = start_of_third(own[room.ONWARD_SPEED], start, speed)
        own[room.SPEED_NOW] = guess
    attempt(system, time, reach)


@kernel
def end_stage(system):
    """Whether no coordinate reached a stop in a stage."""
    at_stops = 0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        at_stops += not (own[room.SPEED_NOW] == 0.0 or own[room.LOWEST] < own[room.SPEED_NOW] < own[room.HIGHEST])
    return at_stops == 0


@kernel
def turns_smoothly(has_friction, has_mass, speed, first, second, third):
    """Whether a coordinate either moves or is held throughout a step; speeds [m/s] : at the start and in the stages."""
    if first == 0.0 and second == 0.0 and third == 0.0:
        return not has_mass or speed == 0.0
    if first == 0.0 or second == 0.0 or third == 0.0:
        return False
    if not has_friction:
        return True
    return first * second > 0.0 and second * third > 0.0 and (not has_mass or speed * first > 0.0)


@kernel
def turn_smoothly(system):
    """Whether each coordinate either moves or is held throughout a step after its stages."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        stages = own[room.LONG_BEFORE], own[room.BEFORE], own[room.SPEED_NOW]
        if not turns_smoothly(own[room.FRICTION] != 0.0, has_inertia(system, j), own[room.START_SPEED], *stages):
            return False
    return True


@kernel
def end_stages(system, time, h):
    """Accept the stages of a step of h [s] from a time [s] in all coordinates (modified)."""
    accept(system)
    go_to_state(system, time + h)


# --- energy


@kernel
def go_to_start(system, time):
    """Reset coordinates and lines (modified) to the start of a three-stage step, a time [s]; `come_back` undoes it."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.KEPT], own[room.KEPT + 1], own[room.KEPT + 2] = (
            own[room.PASSED_NOW],
            own[room.SPEED_NOW],
            own[room.GAIN_NOW],
        )
        own[room.PASSED_NOW], own[room.SPEED_NOW], own[room.GAIN_NOW] = own[room.START_PASSED], own[room.START_SPEED], 0.0
    fixed.place_lines(system, time)


@kernel
def come_back(system, time):
    """Return coordinates and lines (modified) to the end of that step, a time [s]."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.PASSED_NOW], own[room.SPEED_NOW], own[room.GAIN_NOW] = (
            own[room.KEPT],
            own[room.KEPT + 1],
            own[room.KEPT + 2],
        )
    fixed.place_lines(system, time)


@kernel
def energy_and_power(system, k, x, v):
    """Kinetic energy [J] of flowing rope in line k and of the sheave at its end; upper bound of the power [W] supplied.

    With the nodes at x [m] and velocities v [m/s], and coordinates at the stage. Rope supplies power from a winch, a drum
    or a driven end, including its strain there.
    """
    numbers, spring = numbers_of(system, k), chain_at_stage(system, k)
    if not feels_rope(spring.parameters):
        return 0.0, power_of_spring(spring, x, v)
    chain, pull, n, energy = chain_with_rope(system, k), 0.0, spring.n, 0.0
    into, leaving, part = chain.reeling + chain.leaving, chain.leaving, flow.first_passing(chain)
    if goes_on(system, k):
        energy += 0.5 * coordinate_at(system, int(numbers[SHEAVE]))[room.MASS] * leaving * leaving
    for s in range(n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        energy += flow.energy(chain, s, part, x_p, x_q, v_p, v_q)
        length, e = segment.geometry(sub(x_q, x_p))
        tension = abs(segment.tension_of(chain, s, segment.BY_LENGTH, length, dot(e, sub(v_q, v_p))))
        pull += in_section(chain, s, tension * length / chain.section)
        part -= property_of(chain, s, at.SHARE)
    density = property_of(chain, 0, at.LINE_DENSITY)
    tension, comes_from_winch = max(numbers[TENSION], 0.0), not room.is_held(system, k, 0)
    strain = pull if comes_from_winch else 0.5 * tension * tension / property_of(chain, 0, at.STIFFNESS)
    brought = density * (0.5 * into * into + chain.gravity * abs(x[2]) + dot(get(v, 0), get(v, 0)))
    if has_own_drum(system, k):
        return energy, abs(into) * (brought + strain)
    power = flow.most_power(chain, x, v) + density * abs(leaving) * dot(get(v, n), get(v, n))
    power += density * abs(into) * (into * into + dot(get(v, 0), get(v, 0)))
    if is_on_drum(system, k) or comes_from_winch:
        power += abs(into) * (strain + density * chain.gravity * abs(x[2]))
    return energy, power


@kernel
def power_of_spring(chain, x, v):
    """Upper bound of the power [W] gained when a drum lengthens all segments but only the first one pulls on it."""
    power, first = 0.0, 0.0
    for s in range(chain.n):
        stretched, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        tension = segment.tension_of(chain, s, segment.BY_LENGTH, stretched, dot(e, sub(get(v, s + 1), get(v, s))))
        first = tension if s == 0 else first
        power += abs(property_of(chain, s, at.SHARE) * first - in_section(chain, s, tension * stretched / chain.section))
    return power * abs(chain.reeling)


@kernel
def energy_of_drums(system):
    """Kinetic energy [J] of all drums at the stage."""
    energy = 0.0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        energy += 0.5 * own[room.MASS] * own[room.SPEED_NOW] ** 2 if is_drum(system, j) else 0.0
    return energy


@kernel
def work_of_motors(system, time, h):
    """Work of all motors [J] in the stages of a step of h [s] at a time [s] of the communication step."""
    work = 0.0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        mean = own[room.LOAD] + (time + 0.5 * h) * own[room.LOAD_RATE]
        work -= mean * (own[room.PASSED_NOW] - own[room.START_PASSED])
    return work


# --- after a step


@kernel
def balance(system, time, d):
    """Restore T = W + c u + F sign(u) for all turning massless drums (modified) at the end of a step [s]; returns a status.

    d : as for `massless_drum.project`.  The plan (modified) stores the line of the status.
    """
    for j in range(count_of(system)):
        own, k = coordinate_at(system, j), line_of(system, j)
        if own[room.IS_MASSLESS] != 0.0 and own[room.IS_BRAKED] == 0.0:
            now, drum = instant_of(system, j, time, False), drum_at(system, j)
            may_rest = drum.friction > 0.0 or is_at_stop(drum, now.length, OUTWARDS) or is_at_stop(drum, now.length, INWARDS)
            if not (now.speed == 0.0 and may_rest):
                direction = INWARDS if now.speed < 0.0 else OUTWARDS
                length, speed, found = project(conditions_of(system, k), drum, direction, d, now)
                if not found:
                    note_line(system.plan, k)
                    return NO_LENGTH
                own[room.PASSED] += length - now.length
                own[room.SPEED] = speed
                own[room.PASSED_NOW], own[room.SPEED_NOW] = own[room.PASSED], speed
                take_rates(system, k, time)
    return OK


@kernel
def check(system):
    """OK, or REELED_TOO_SHORT for a line that its winch has left too short, whose number the plan (modified) stores."""
    for k in range(lines_of(system)):
        for end in range(room.limited_parts(system, k)):
            least = room.least_of_part(system, k, end, at.SHORTEST_PART)
            if has_rope(system, k) and room.length_of_part(system, k, end) < least:
                note_line(system.plan, k)
                return REELED_TOO_SHORT
    return OK
