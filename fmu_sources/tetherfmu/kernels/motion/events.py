"""Events of a rope coordinate within a communication step: it starts moving, comes to rest, or stops.

    RESTS                  friction brings it to rest: its speed reaches 0
    FORWARDS, BACKWARDS    it starts: rope forces exceed its friction, or leave the cone of a sheave,
                           1/E <= T_1/T_2 <= E
    STOPS                  one of its lines is as short as its segments permit (two-blocking), or fully paid out

A step that passes an event is repeated, shorter, until it ends there: a piece of the communication step. `room_until`
measures the margin to each event, `part_to_event` the end of the next piece, `turn` selects the coordinates that move in it.
At a stop no force acts on the rope for an instant, so it keeps its momentum: when rates of rope jump by da, nodes jump too,

    m_i dv_i = sum over both ends of col_ie da_e,   col_ie: slope of the force on node i by a_e' (`equations/rope.py`)

and so do other coordinates and free points, with the matrix of the accelerations. Massless drums under the stretch_rate law
have no momentum: `line/massless_drum.py`.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..equations.drum import HELD, direction_of, drum_of, is_at_stop, stop_ahead
from ..equations.free_points import free_points, is_at_point, point_at
from ..equations.lines import (
    conditions_of,
    lines_of,
    motion_of,
    note_line,
    parameters_of,
    put_reeling,
    segments_of,
)
from ..equations.rope import feels_rope
from ..equations.winch import from_length
from ..line.drum_events import part_of_piece, room_to_rest, turns_round
from ..line.massless_drum import Instant, project, tension_at_rest
from ..line.rodas4p import GAMMA
from ..line.step_control import DrumError, allowed_errors
from ..line.strand_room import LENGTH, RATE, TENSION, rope_in
from ..line.taut_slack import impulse_between, wrong_impulse
from ..linear_algebra import profile
from ..linear_algebra.vectors import add_at, add_scaled, get, put, scale
from ..points import net, room
from ..points.coordinates import has_own_drum, longest_of, shortest_of
from ..points.room import (
    chain_at_stage,
    coordinate_at,
    count_free,
    count_of,
    globals_of,
    growth_of,
    has_longest,
    has_rope,
    integrator_of,
    is_drum,
    is_free,
    is_rope,
    line_of,
    numbers_of,
    section_now,
    strand_of,
    take_rates,
    unknowns_of,
    weight_of,
)
from .states import evaluate, go_to_state, hold, nodes_of

AT_STOP = 1e-9  # relative to the shortest length: tolerance within which a line is at its stop
MOST_STARTS = 2  # starts of a coordinate while `turn` searches
LOCATED = 1e-10  # relative to a length: how far a piece may end beyond a stop
MOST_IDLE = 100  # consecutive pieces without motion, so short that rounding keeps the tensions
AT_ONCE = 1e-6  # part of the communication step in which a massless drum absorbs a force jump
RESTS, FORWARDS, BACKWARDS, STOPS_FORWARDS, STOPS_BACKWARDS, NO_EVENT = range(6)

# --- stops


@kernel
def room_to_stop(system, j, sign):
    """Margin until a coordinate that moves forwards (sign 1) or backwards (-1) reaches a stop, over LOCATED, at a stage."""
    least = inf
    for k in range(lines_of(system)):
        for end in range(room.limits_of(system, k)):
            growth = sign * room.growth_of_part(system, j, k, end)
            length = room.length_of_part(system, k, end) if growth != 0.0 else 0.0
            if growth < 0.0:
                shortest = room.shortest_of_part(system, k, end)
                least = min(least, (length - shortest) / (LOCATED * shortest))
            elif growth > 0.0 and has_longest(system, k, end):
                least = min(least, (longest_of(system, k) - length) / (LOCATED * longest_of(system, k)))
    return least


@kernel
def may_move(system, j, sign):
    """Whether a coordinate can move forwards (sign 1) or backwards (-1) from a stage."""
    own = coordinate_at(system, j)
    is_rounded = own[room.SPEED] == 0.0 and parameters_of(system, 0)[at.FIXED_STEP] > 0.0  # as fixed steps stop it
    close = at.ROUNDED_STOP if is_rounded else AT_STOP
    return own[room.IS_BRAKED] == 0.0 and room_to_stop(system, j, sign) > close / LOCATED


@kernel
def has_to_stop(system, j):
    """Whether a coordinate moves against a stop, in the state."""
    speed = coordinate_at(system, j)[room.SPEED]
    return speed != 0.0 and not may_move(system, j, 1.0 if speed > 0.0 else -1.0)


@kernel
def stop(system, time):
    """Stop all coordinates at their stops (modified), with the jumps of nodes and points (modified); whether any stopped.

    All are in their state.
    """
    stops = 0
    for j in range(count_of(system)):
        stops += has_to_stop(system, j)
    if stops == 0:
        return False
    go_to_state(system, time)
    evaluate(system, time, False)
    whole, m, points = globals_of(system), unknowns_of(system), 3 * free_points(system)
    net.place_masses(system)
    for i in range(m):
        whole.right[i] = 0.0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if has_to_stop(system, j):
            profile.hold_row(whole.matrix, m, points + j)
            whole.right[points + j] = -own[room.SPEED]
    if not profile.factorize(whole.matrix, m):
        return False
    profile.solve(whole.matrix, m, whole.right, whole.solution)
    for k in range(lines_of(system)):
        if has_rope(system, k):
            jump(system, k, net.solution_of_end(system, k, 0), net.solution_of_end(system, k, 1))
        jump_ends(system, k, whole.solution)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        stopped = has_to_stop(system, j)
        own[room.SPEED] += whole.solution[points + j]
        if stopped:
            hold(own)
            own[room.SPEED] = 0.0
            place_at_stop(system, j)
    go_to_state(system, time)
    return True


@kernel
def place_at_stop(system, j):
    """Set the line of a drum of its own (modified) to exactly the length of the stop reached."""
    k = line_of(system, j)
    if has_own_drum(system, k):
        length, reeling = numbers_of(system, k)[LENGTH], conditions_of(system, k).reeling
        shortest, longest = shortest_of(system, k), longest_of(system, k)
        exact = longest if abs(longest - length) < abs(shortest - length) else shortest
        put_reeling(system, k, from_length(exact, reeling))


@kernel
def jump(system, k, change_first, change_last):
    """Apply jumps of the rates of entering rope [m/s] to the inner nodes of line k (modified)."""
    own, n, (_, v), conditions = strand_of(system, k), segments_of(system, k), motion_of(system, k), conditions_of(system, k)
    a, b = rope_in(n, own.ropes, 0).by_gain, rope_in(n, own.ropes, 1).by_gain
    for i in range(conditions.first, conditions.last + 1):
        is_shared = (i == 0 and is_at_point(system, k, 0)) or (i == n and is_at_point(system, k, 1))
        if not is_shared:
            mass = own.w.stage_mass[i]
            add_at(v, i, scale(change_first / mass, get(a, i)))
            add_at(v, i, scale(change_last / mass, get(b, i)))


@kernel
def jump_ends(system, k, changes):
    """Apply the velocity jumps [m/s] of its free points to the ends of line k (modified)."""
    _, v = motion_of(system, k)
    for end in range(2):
        if is_at_point(system, k, end):
            add_at(v, segments_of(system, k) * end, get(changes, point_at(system, k, end)))


# --- friction


@kernel
def urges_now(system, j):
    """`net.urges` with the known tensions."""
    own, k = coordinate_at(system, j), line_of(system, j)
    if is_drum(system, j):
        return net.urges(system, j, own[room.AGAINST], own[room.PULLED], 1.0)
    return net.urges(system, j, numbers_of(system, k)[TENSION + 1], numbers_of(system, k + 1)[TENSION], own[room.LOSS])


@kernel
def set_free(own, sign):
    """Permit a coordinate with these numbers (modified) to move in a direction, 0 for any."""
    own[room.IS_HELD], own[room.SIGN] = 0.0, sign


@kernel
def begin_directions(system):
    """Moving coordinates according to their speeds (modified); returns how many more may start."""
    undecided = 0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if own[room.IS_MASSLESS] != 0.0:
            continue
        is_open = may_move(system, j, 1.0) and may_move(system, j, -1.0)
        if own[room.FRICTION] == 0.0 and (is_open or own[room.SPEED] != 0.0):
            set_free(own, 0.0)
        elif own[room.SPEED] != 0.0:
            set_free(own, 1.0 if own[room.SPEED] > 0.0 else -1.0)
        else:
            hold(own)
            undecided += own[room.IS_BRAKED] == 0.0
    return undecided


@kernel
def hold_what_turns_round(system):
    """Hold the fastest coordinate that would reverse immediately (modified); whether there is one."""
    found, most = -1, 0.0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        back = -own[room.SIGN] * own[room.GAIN_NOW]
        if is_free(system, j) and own[room.SPEED] == 0.0 and back > most:
            found, most = j, back
    if found >= 0:
        hold(coordinate_at(system, found))
    return found >= 0


@kernel
def start_what_is_pulled(system):
    """Start the coordinate with the largest force beyond friction (modified); whether there is one.

    Each is started no more than twice, in any direction.
    """
    found, most, way = -1, 0.0, 0.0
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if not is_free(system, j) and own[room.STARTED] < MOST_STARTS and own[room.IS_MASSLESS] == 0.0:
            forwards, backwards, margin = urges_now(system, j)
            for sign, pulled in ((1.0, forwards), (-1.0, backwards)):
                if may_move(system, j, sign) and pulled > most * margin:
                    found, most, way = j, pulled / margin, sign
    if found >= 0:
        set_free(coordinate_at(system, found), way)
        coordinate_at(system, found)[room.STARTED] += 1.0
    return found >= 0


@kernel
def turn(system, time, duration):
    """Select the coordinates (modified) that move from a time [s] on; False if a massless drum has no balance.

    duration : of the communication step [s].
    """
    go_to_state(system, time)
    for j in range(count_of(system)):
        if coordinate_at(system, j)[room.IS_MASSLESS] != 0.0 and not turn_massless(system, j, time, duration):
            return False
    undecided = begin_directions(system)
    if stop(system, time):
        undecided = begin_directions(system)
    if undecided > 0:
        for j in range(count_of(system)):
            coordinate_at(system, j)[room.STARTED] = 0.0
        if globals_of(system).header[room.IS_KNOWN] == 0.0 or count_free(system) > 0:
            evaluate(system, time, False)
        while hold_what_turns_round(system) or start_what_is_pulled(system):
            evaluate(system, time, False)
    return True


# --- massless drums


@view
def drum_at(system, j):
    """`Drum` of a drum coordinate."""
    conditions = conditions_of(system, line_of(system, j))
    return drum_of(conditions.parameters, conditions.force, conditions.force_rate)


@view
def instant_of(system, j, time, is_after):
    """`Instant` of a massless drum at a time [s]; is_after : of a trial step."""
    numbers = numbers_of(system, line_of(system, j))
    return Instant(time, numbers[LENGTH], numbers[RATE], *nodes_of(system, line_of(system, j), is_after))


@kernel
def turn_massless(system, j, time, duration):
    """Turn or hold a massless drum (modified) from a time [s] on; False if that is impossible."""
    k, own, drum, now = line_of(system, j), coordinate_at(system, j), drum_at(system, j), instant_of(system, j, time, False)
    conditions, direction, length, speed, found = conditions_of(system, k), HELD, now.length, 0.0, True
    if own[room.TURNED_BACK] == 0.0:
        direction = direction_of(drum, now.length, now.speed, tension_at_rest(conditions, now), time)
    if direction != HELD:
        length, speed, found = project(conditions, drum, direction, AT_ONCE * duration, now)
        if is_at_stop(drum, length, direction):
            direction, length, speed, found = HELD, stop_ahead(drum, direction), 0.0, True
    own[room.SIGN], own[room.IS_HELD] = direction, 1.0 if direction == HELD else 0.0
    own[room.PASSED] += length - now.length
    own[room.SPEED] = speed
    room.settle(system)
    own[room.PASSED_NOW], own[room.SPEED_NOW] = 0.0, speed
    take_rates(system, k, time)
    if not found:
        note_line(system.plan, k)
    return found


@kernel
def project_massless(system, time, h):
    """Balance massless drums (modified) after a step of h [s] to a time [s]; whether all are balanced."""
    for j in range(count_of(system)):
        own, k = coordinate_at(system, j), line_of(system, j)
        if own[room.IS_MASSLESS] != 0.0 and is_free(system, j):
            now = instant_of(system, j, time, True)
            length, speed, found = project(conditions_of(system, k), drum_at(system, j), own[room.SIGN], GAMMA * h, now)
            own[room.PASSED_NOW] += length - now.length
            own[room.SPEED_NOW] = speed
            take_rates(system, k, time)
            if not found:
                return False
    return True


# --- errors of a step


@view
def drum_error(system, k):
    """`DrumError` of line k, with the mass of its own drum."""
    if not has_rope(system, k):
        return DrumError(0.0, 0.0, inf, False, 0.0, 0.0)
    if room.is_parted(parameters_of(system, k)):
        return error_of_parts(system, k)
    length, speed = room.let_in_over_both(system, k, room.WRONG), room.let_in_over_both(system, k, room.WRONG_SPEED)
    growth, mass = speed / section_now(system, k) if feels_rope(parameters_of(system, k)) else 0.0, inf
    if has_own_drum(system, k):
        j, _ = room.holder(system, k, 0, 0)
        if is_free(system, j):
            mass = net.mass_at(system, j, k)
    return DrumError(length, growth, mass, segments_of(system, k) == 1, 0.0, 0.0)


@kernel
def error_of_parts(system, k):
    """`DrumError` of a portion in two parts."""
    first, second = room.length_of_part(system, k, 0), room.length_of_part(system, k, 1)
    return DrumError(
        room.let_in(system, k, 0, room.WRONG),
        room.let_in(system, k, 0, room.WRONG_SPEED) / first,
        inf,
        False,
        room.let_in(system, k, 1, room.WRONG) / second,
        room.let_in(system, k, 1, room.WRONG_SPEED) / second,
    )


@kernel
def error_of_coordinate(system, j, h):
    """Relative error of a coordinate in a step of h [s] [-], as for a node that moves with its rope."""
    own, worst = coordinate_at(system, j), 0.0
    for k in range(lines_of(system)):
        weight = abs(weight_of(system, j, k, 0)) + abs(weight_of(system, j, k, 1))
        if weight != 0.0:
            (_, v), conditions = motion_of(system, k), conditions_of(system, k)
            position_scale, velocity_scale = allowed_errors(conditions, v)
            worst = max(worst, weight * abs(GAMMA * h * own[room.WRONG]) / position_scale)
            if own[room.IS_MASSLESS] == 0.0:
                fastest = weight * max(abs(own[room.SPEED]), abs(own[room.SPEED_NOW]))
                velocity_scale = max(velocity_scale, conditions.parameters[at.RELATIVE_TOLERANCE] * fastest)
                worst = max(worst, weight * abs(own[room.WRONG_SPEED]) / velocity_scale)
                if has_own_drum(system, k):
                    impulse = wrong_impulse(0, chain_at_stage(system, k), h, integrator_of(system, k))
                    transition = impulse / net.mass_at(system, j, k) / velocity_scale
                    worst = max(worst, transition * transition if transition > 1.0 else 0.0)
    return worst


@kernel
def error_of_coordinates(system, h):
    """Largest relative error of the moving coordinates."""
    worst = 0.0
    for j in range(count_of(system)):
        if is_free(system, j):
            worst = max(worst, error_of_coordinate(system, j, h))
    return worst


# --- single-segment lines: entering rope moves the ends apart as nodes do


@kernel
def mobility_of_rate(system, k):
    """Change of L' of line k per impulse along it [1/kg], with its free coordinates."""
    mobility = 0.0
    for j in range(count_of(system)):
        growth = growth_of(system, j, k)
        if is_free(system, j) and growth != 0.0:
            inertia = net.inertia_of(system, j)
            mobility += growth * growth / inertia if inertia > 0.0 else 0.0
    return mobility


@kernel
def mass_of_rate(system, k):
    """Mass [kg] that entering rope has to move in line k if it is a single segment; inf in another, or if no rope enters."""
    if not has_rope(system, k) or segments_of(system, k) > 1:
        return inf
    mobility = mobility_of_rate(system, k)
    return 1.0 / mobility if mobility > 0.0 else inf


@kernel
def mobility_of_ends(system, k, w):
    """Change of the end velocities of line k, a single segment, per impulse [1/kg]: 0 for driven ends."""
    conditions = conditions_of(system, k)
    return 1.0 / w.mass[0] if conditions.first == 0 else 0.0, 1.0 / w.mass[1] if conditions.last == 1 else 0.0


@kernel
def transition_of_rate(system, k, chain, h, w):
    """Error of L' of line k, a single segment, from its `taut_slack.wrong_impulse` in a step of h [s].

    Relative to the tolerance [-], squared; 0 if it is below. chain, w : as for `step_control.error_of_step`.
    """
    of_rope, (_, v), conditions = mobility_of_rate(system, k), motion_of(system, k), conditions_of(system, k)
    if has_own_drum(system, k):
        of_rope = 0.0  # `drum_error` covers it
    of_start, of_end = mobility_of_ends(system, k, w)
    _, allowed = allowed_errors(conditions, v)
    allowed = max(allowed, conditions.parameters[at.RELATIVE_TOLERANCE] * abs(chain.reeling))
    transition = wrong_impulse(0, chain, h, w) * max(of_rope, max(of_start, of_end)) / allowed
    return transition * transition if transition > 1.0 else 0.0


@kernel
def keep_energy(system, k, chain, w):
    """Correct the speeds of ends and coordinates (modified) of line k, a single segment, so that energy is conserved.

    Each receives its part of the impulse, see `taut_slack.impulse_between`.
    """
    of_rope, (of_start, of_end) = mobility_of_rate(system, k), mobility_of_ends(system, k, w)
    mobility = of_rope + of_start + of_end
    impulse, e = impulse_between(0, chain, mobility, chain.reeling, get(w.v, 0), get(w.v, 1), w)
    if impulse != 0.0:
        put(w.v, 0, add_scaled(get(w.v, 0), -impulse * of_start, e))
        put(w.v, 1, add_scaled(get(w.v, 1), impulse * of_end, e))
        for j in range(count_of(system)):
            growth = growth_of(system, j, k)
            if is_free(system, j) and growth != 0.0:
                coordinate_at(system, j)[room.SPEED_NOW] -= impulse * growth / net.inertia_of(system, j)


@kernel
def settle_single_segment(system, k, time, h):
    """Error of L' of line k, if it is a single segment with ropes, in a step to a time [s]; corrects speeds for energy."""
    if not has_rope(system, k) or segments_of(system, k) > 1:
        return 0.0
    chain, w = chain_at_stage(system, k), integrator_of(system, k)
    error = transition_of_rate(system, k, chain, h, w)
    keep_energy(system, k, chain, w)
    take_rates(system, k, time)
    return error


# --- end of a piece


@kernel
def room_until(system, j, event, is_after):
    """Margin until an event of a coordinate, relative to the tolerance of 0 [-]; inf: there is none.

    is_after : after a trial step, else in the state, both evaluated as at the stage.
    """
    own = coordinate_at(system, j)
    sign, speed = 1.0 if event in (STOPS_FORWARDS, FORWARDS) else -1.0, own[room.SPEED_NOW]
    if event in (STOPS_FORWARDS, STOPS_BACKWARDS):
        moves_there = is_free(system, j) and not (is_after and speed * sign <= 0.0)
        return room_to_stop(system, j, sign) if moves_there else inf
    if event == RESTS:
        if not is_free(system, j) or own[room.SIGN] == 0.0 or own[room.IS_MASSLESS] != 0.0:
            return inf
        left, margin = room_to_rest(own[room.SIGN], speed, numbers_of(system, line_of(system, j))[LENGTH])
        return left / margin
    forwards, backwards, margin = urges_now(system, j)
    if is_free(system, j) or not may_move(system, j, sign) or margin == 0.0:
        return inf
    return -(forwards if sign > 0.0 else backwards) / margin


@kernel
def find_event(system, j):
    """Store the event that a coordinate passed by most in a step, with its margin, in its numbers (modified).

    Returns whether there is one.
    """
    own, least, found = coordinate_at(system, j), -1.0, NO_EVENT
    for event in range(NO_EVENT):
        left = room_until(system, j, event, True)
        if left < least:
            least, found = left, event
    own[room.EVENT], own[room.ROOM] = float(found), least
    return found != NO_EVENT


@kernel
def part_to_event(system, time, h, weight):
    """Fraction of the step of h [s] from a time [s] after which the first event is expected; inf if none has happened.

    weight : on the interpolation, below 1 after a piece that was too long.
    """
    least, happened, free = inf, 0, count_free(system)
    if free < count_of(system):
        evaluate(system, time + h, True)
    for j in range(count_of(system)):
        happened += find_event(system, j)
    globals_of(system).header[room.IS_KNOWN] = 1.0 if happened == 0 and free == 0 else 0.0
    if happened == 0:
        return inf
    keep_results(system, True)
    go_to_state(system, time)
    if free < count_of(system):
        evaluate(system, time, False)
    for j in range(count_of(system)):
        event, over = int(coordinate_at(system, j)[room.EVENT]), coordinate_at(system, j)[room.ROOM]
        if event != NO_EVENT:
            least = min(least, part_of_piece(weight * room_until(system, j, event, False), over))
    keep_results(system, False)
    for k in range(lines_of(system)):
        if is_rope(system, k):
            take_rates(system, k, time + h)
    return least


@kernel
def keep_results(system, is_kept):
    """Save the coordinates after a trial step, or restore them (modified)."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        for i, place in ((0, room.PASSED_NOW), (1, room.SPEED_NOW), (2, room.GAIN_NOW)):
            if is_kept:
                own[room.KEPT + i] = own[place]
            else:
                own[place] = own[room.KEPT + i]


@kernel
def accept(system, time):
    """Accept the results of a step to a time [s] in all coordinates (modified); friction and stops bring them to rest."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if is_free(system, j):
            turned_round = turns_round(own[room.FRICTION], own[room.SIGN], own[room.SPEED_NOW])
            own[room.PASSED], own[room.SPEED] = own[room.PASSED_NOW], 0.0 if turned_round else own[room.SPEED_NOW]
            own[room.TURNED_BACK] = 1.0 if turned_round else 0.0  # for a massless drum
    go_to_state(system, time)
    stop(system, time)
