"""The drum of a winch at a tether that is in equilibrium at every instant: two numbers, length L and speed u.

    m du/dt = T(L, t) - W - c u - F sign(u),   dL/dt = u      (`equations/drum.py`)

T is the tension at the ground of the tether between its ends, found anew for each L. L-stable diagonally implicit
Runge-Kutta method of order 2 with gamma = 1 - 1/sqrt(2), whose second stage is the result; each stage is one equation for
one length, in which T falls and the rest grows:

    m (u - u*)/(gamma h) = T(L) - W - c u - F sign(u),   u = (L - L*)/(gamma h)

Without mass and damping nothing is left to integrate: T(L) = W + F sign(u) at the end of the step. Pieces end where the
drum begins to turn, comes to rest or comes to a stop. See docs/models/numerics.md, "A drum in the same system".
Source: R. Alexander, Diagonally implicit Runge-Kutta methods for stiff ODEs, SIAM J. Numer. Anal. 14 (1977) 1006.
"""

from math import inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

from ..compilation import kernel
from ..equations.boundary import distance_of_ends, put_ends
from ..equations.drum import HELD, INWARDS, OUTWARDS, balance, direction_of, drum_of, force_at, is_at_stop
from ..equations.end_motion import target
from ..equations.properties import chain_of, property_of
from ..line.drum_events import SHORTEST_PART, SLOW, SMALLEST_PIECE, part_of_piece, room_to_turn
from . import secant

STAGE = 1.0 - 1.0 / sqrt(2.0)  # gamma
TOLERANCE = 1e-5  # of the length: by how much the method of order 1 in a piece may differ
MOST_PIECES = 100_000  # of a communication step
SHARES = 4  # of the budget of iterations
MOST_EVALUATIONS = 80  # of the tension for one length
MOST_FAILURES = 2  # shapes that are not found, each after the whole ladder of `equilibrium.solve`, until it is given up
FARTHEST = 0.02  # change of the length, relative, between two of them: each shape is sought from the last one
EXACT, ROUNDING = 1e-13, 3e-16  # of the forces; of the length
NARROW = 1e-12  # interval of the length, relative, in which its tension jumps by rounding
LONGEST = 1e7  # [m], beyond which no length is sought for
SHORTEST_ARRIVAL = 1e-4  # of the communication step: a piece that ends at a stop is no longer
MOST_SHORT = 8  # pieces in a row that end before an event, until the next one is at least twice as long as the last


def drum_at(settle, tension):
    """The kernel advance(n, parameters, given, state, work) of a variant, which returns a status.

    settle : kernel (n, parameters, state, work) that brings a state (modified) into equilibrium between its ends and returns
    a status.  tension : kernel (n, parameters, state) of the tension at the ground [N] of such a state.
    """

    @kernel
    def tension_with(n, parameters, length, state, work):
        """A status, and the tension [N] with an unstretched length [m], which the state (modified) then has."""
        state[at.LENGTH] = length
        status = settle(n, parameters, state, work)
        return status, tension(n, parameters, state)

    @kernel
    def place(n, given, time, state):
        """Put the ends of a state (modified) where they are at a time [s] of the communication step."""
        put_ends(n, state, target(*given.ground, time), target(*given.kite, time))

    @kernel
    def find(n, parameters, drum, direction, time, h, last_length, last_speed, guess, most, state, work):
        """Length [m] of a stage and the tension with it [N]; and a status.

        h : gamma times the length of the piece [s].  last_length, last_speed : L* [m], u* [m/s].  guess : a length [m].
        most : iterations since the start, where the search is given up.
        The state (modified) has this length in the end. A length beyond a stop is that of the stop.
        """
        inertia = drum.mass / (h * h) + drum.damping / h
        stiffness = property_of(chain_of(n, parameters, state), 0, at.STIFFNESS)
        forces = abs(force_at(drum, time)) + drum.friction
        search, length = secant.begin(drum.shortest, min(drum.longest, LONGEST), guess, inertia + stiffness / guess)
        pull, failures = 0.0, 0
        for k in range(MOST_EVALUATIONS):
            status, pull = tension_with(n, parameters, length, state, work)
            if state[at.ITERATIONS] > most:
                return length, pull, STEP_BUDGET_SPENT
            if status != OK:
                failures += 1
                if k == 0 or failures > MOST_FAILURES:
                    return length, 0.0, status
                length = 0.5 * (length + search.last)
                continue
            speed = (length - last_length) / h
            pushing = drum.mass * (speed - last_speed) / h
            residual = pushing - balance(drum, direction, pull, speed, time)
            if abs(residual) <= EXACT * (forces + abs(pushing)) + ROUNDING * (stiffness + inertia * length):
                return length, pull, OK
            if secant.is_at_limit(search, length, residual):
                return length, pull, NO_LENGTH if length == LONGEST else OK
            search, onward = secant.go_on(search, length, residual, FARTHEST * length)
            if onward == length and secant.has_interval(search):
                return length, pull, OK
            length = onward
        is_found = secant.has_interval(search) and search.high - search.low <= NARROW * search.high
        return search.last, pull, OK if is_found else NO_LENGTH

    @kernel
    def speed_of(drum, direction, time, h, last_speed, pull):
        """Speed [m/s] at a stage with this tension [N]: from the forces, as lengths in short pieces are rounded."""
        free = balance(drum, direction, pull, 0.0, time)
        return (drum.mass * last_speed + h * free) / (drum.mass + h * drum.damping)

    @kernel
    def piece_with(n, parameters, given, drum, direction, time, h, length, speed, most, state, work):
        """A piece of h [s] from a length [m] and speed [m/s]: status, both at its end, tension [N], error [-]."""
        end = time + h
        if direction == HELD:
            place(n, given, end, state)
            status, pull = tension_with(n, parameters, length, state, work)
            return status, length, 0.0, pull, 0.0
        if drum.mass == 0.0 and drum.damping == 0.0:
            before = distance_of_ends(n, state)
            place(n, given, end, state)
            guess = length + distance_of_ends(n, state) - before
            found, pull, status = find(n, parameters, drum, direction, end, h, length, 0.0, guess, most, state, work)
            return status, found, (found - length) / h, pull, 0.0
        part = STAGE * h
        place(n, given, time + part, state)
        guess = length + part * speed
        now = time + part
        _, pull, status = find(n, parameters, drum, direction, now, part, length, speed, guess, most, state, work)
        if status != OK:
            return status, length, speed, pull, inf
        first_speed = speed_of(drum, direction, now, part, speed, pull)
        rest = (1.0 - STAGE) * h
        last_length, last_speed = length + rest * first_speed, speed + rest * (first_speed - speed) / part
        place(n, given, end, state)
        guess = last_length + part * first_speed
        found, pull, status = find(
            n, parameters, drum, direction, end, part, last_length, last_speed, guess, most, state, work
        )
        new_speed = speed_of(drum, direction, end, part, last_speed, pull)
        error = part * abs(new_speed - first_speed) / (TOLERANCE * length)
        return status, found, new_speed, pull, error

    @kernel
    def room_left(drum, direction, time, length, speed, pull):
        """Force [N] that a held drum lacks to turn, or speed [m/s] of another until it rests; how far below 0 is 0."""
        if direction == HELD:
            return room_to_turn(drum, length, pull, time)
        return speed * direction, SLOW * length

    @kernel
    def advance(n, parameters, given, state, work):
        """Move a state (modified) over a communication step with `StepInputs`; returns a status."""
        drum = drum_of(parameters, given.force, given.force_rate)
        duration = given.step
        length, speed, pull = state[at.LENGTH], state[at.REELING], tension(n, parameters, state)
        time, h, piece, weight = 0.0, duration, inf, 1.0
        direction = HELD
        beyond = 0.0  # time at which the next event is known to be over, 0 without
        is_new, is_held = True, False
        short, least = 0, 0.0  # pieces in a row that ended before the event that is sought, and how long the next one is [s]
        failures, most = 0, state[at.ITERATIONS] + SHARES * at.ITERATION_BUDGET // n
        for _ in range(MOST_PIECES):
            if is_new:
                direction = HELD if is_held else direction_of(drum, length, speed, pull, time)
                if direction == HELD or (drum.mass > 0.0 and speed * direction < 0.0):
                    speed = 0.0
                is_new, piece, weight = False, beyond - time if beyond > time else inf, 1.0
            if state[at.ITERATIONS] > most:
                return STEP_BUDGET_SPENT
            rest = duration - time
            h_now = min(h, piece, rest)
            end = duration if h_now == rest else time + h_now
            status, new_length, new_speed, new_pull, error = piece_with(
                n, parameters, given, drum, direction, time, h_now, length, speed, most, state, work
            )
            if status != OK:
                failures += 1
                if drum.mass == 0.0 or failures > MOST_FAILURES or state[at.ITERATIONS] > most:
                    return status
                h = 0.25 * h_now
                continue
            if error > 1.0:
                h = h_now * max(0.1, 0.9 / sqrt(error))
                if h < SMALLEST_PIECE * duration:
                    return STEP_TOO_SMALL
                continue
            back = (new_length - length) * direction < -ROUNDING * length
            if drum.mass == 0.0 and drum.friction > 0.0 and back:  # it has turned round, and is held
                if h_now > SHORTEST_PART * duration:
                    piece = 0.25 * h_now
                else:
                    is_new, is_held = True, True
                continue
            way = OUTWARDS if new_length > length else INWARDS
            arrived = new_length != length and is_at_stop(drum, new_length, way)
            if arrived and h_now > SHORTEST_ARRIVAL * duration:
                piece, beyond = 0.5 * h_now, end
                continue
            room, margin = 0.0, 0.0
            if not arrived and (direction == HELD or (drum.friction > 0.0 and drum.mass > 0.0)):
                room, margin = room_left(drum, direction, end, new_length, new_speed, new_pull)
            if room < -margin and h_now > SMALLEST_PIECE * duration:
                before, _ = room_left(drum, direction, time, length, speed, pull)
                piece = h_now * part_of_piece(weight * before, room)
                if short > MOST_SHORT:
                    piece = max(piece, min(least, 0.5 * h_now))
                weight *= 0.5
                beyond = end
                continue
            if room < 0.0 or arrived:
                beyond = 0.0
            short, least = (short + 1, 2.0 * h_now) if beyond > end else (0, 0.0)
            time, length, speed, pull = end, new_length, new_speed, new_pull
            is_new, is_held = True, False
            if direction != HELD:
                if arrived:
                    speed = 0.0
                elif drum.friction > 0.0 and speed * direction < 0.0:
                    speed, is_held = 0.0, drum.mass == 0.0
            if time >= duration:
                state[at.LENGTH], state[at.REELING] = length, speed
                return OK
            h = max(h, h_now * min(5.0, 0.9 / sqrt(max(error, 1e-4))))
        return STEP_BUDGET_SPENT

    return advance
