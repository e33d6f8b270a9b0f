"""Winch drum on a tether that is in equilibrium at every instant: two unknowns, length L and speed u.

    m du/dt = T(L, t) - W - c u - F sign(u),   dL/dt = u      (`equations/drum.py`)

T is the ground tension of the tether between its ends, solved for each L. The method is an L-stable diagonally implicit
Runge-Kutta method of order 3, whose third stage is the result. Each stage is one equation for one length, in which T
decreases and the other terms increase:

    m (u - u*)/(g h) = T(L) - W - c u - F sign(u),   u = (L - L*)/(g h)
    L*, u* = L0, u0 + h sum of b (dL/dt, du/dt) over earlier stages;   after g h, c h, h

The error of a piece is measured as a tension error: see `error_of_piece`. With `fixed_step` pieces have that length and no
error estimate; with backward Euler a piece is one stage over h.

Without mass and damping nothing needs to be integrated: T(L) = W + F sign(u) at the end of the step. Pieces end where the
drum starts, comes to rest or reaches a stop. See docs/models/numerics.md, "Rope coordinates".
Source: R. Alexander, Diagonally implicit Runge-Kutta methods for stiff ODEs, SIAM J. Numer. Anal. 14 (1977) 1006.
"""

from collections import namedtuple
from math import inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, NO_LENGTH, OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

from ..compilation import kernel
from ..equations.boundary import distance_of_ends, move_ends, put_ends
from ..equations.drum import HELD, INWARDS, OUTWARDS, balance, drum_of, force_at, is_at_stop
from ..equations.end_motion import target
from ..equations.properties import chain_of, property_of
from ..equations.winch import follows_force
from ..line.backward_euler import count_of_steps, given_steps
from ..line.drum_events import SHORTEST_PART, SMALLEST_PIECE, may_change, next_motion, part_of_piece, room_to_change
from ..line.step_control import LARGEST_GROWTH, LEAST_ERROR, PER_TOLERANCE, SAFETY, TENSION, even_step
from ..notes import note_peak
from . import secant

NOTHING, AT_END, WITHIN, AT_STOP, TURNED_BACK = range(5)  # events of a piece; the first two need no shorter one
GAMMA = 0.43586652150845906  # g: the root of g^3 - 3 g^2 + 3/2 g - 1/6 = 0 that makes it L-stable
MIDDLE = 0.5 * (1.0 + GAMMA)  # c
B1, B2 = -1.5 * GAMMA**2 + 4.0 * GAMMA - 0.25, 1.5 * GAMMA**2 - 5.0 * GAMMA + 1.25
# weights of an order-2 method in the first two stages, minus the weights of this method
_SECOND = (1.0 - 2.0 * GAMMA) / (1.0 - GAMMA)
ERROR_1, ERROR_2, ERROR_3 = 1.0 - _SECOND - B1, _SECOND - B2, -GAMMA
FROM_START = 1.0 / 6.0  # weight of the initial slope and of its extrapolation from these stages
IN_DRUMS = 0.15  # nothing else damps a drum that swings on its tether, and errors add up
STRONGEST_CUT = 0.1  # of a piece over the one before
MOST_PIECES = 100_000  # of a communication step
SHARES = 4  # of the budget of iterations
MOST_EVALUATIONS = 80  # of the tension for one length
MOST_FAILURES = 2  # failed shapes, each after the whole ladder of `rest.solve`, before it gives up
FARTHEST = 0.02  # relative change of the length between evaluations: each shape starts from the last one
EXACT, ROUNDING = 1e-13, 3e-16  # of the forces; of the length
NARROW = 1e-12  # interval of the length, relative, in which its tension jumps by rounding
LONGEST = 1e7  # [m], upper limit of the search
SHORTEST_ARRIVAL = 1e-4  # of the communication step: a piece that ends at a stop is no longer
MOST_SHORT = 8  # pieces in a row that end before an event, until the next one is at least twice as long as the last

Step = namedtuple("Step", "n parameters ground kite drum most fixed")
Step.__doc__ = """A communication step.

n, parameters : number of segments and flat array.  ground, kite : prescribed motion of the ends, see `StepInputs`.
drum : `Drum`.  most : iterations since the start at which the equilibrium search is abandoned.  fixed : `FixedSteps`."""
Instant = namedtuple("Instant", "time length speed pull")
Instant.__doc__ = """The drum at a time [s] of the communication step: length L [m], speed u [m/s], tension T [N]."""
Piece = namedtuple("Piece", "direction start h end")
Piece.__doc__ = """A piece of a communication step, in which the drum turns in a direction or is held.

start : `Instant`.  h : its length [s].  end : its end [s], exactly the end of the communication step in the last piece."""
Stage = namedtuple("Stage", "direction time h length speed")
Stage.__doc__ = """A stage of a piece that ends at a time [s].

h : gamma times the length of the piece, or all of it without mass and damping [s].  length, speed : L* [m], u* [m/s].
"""
EventSearch = namedtuple("EventSearch", "h weight beyond short least")
EventSearch.__doc__ = """The search for the next event.

h : length of the piece to try next [s], inf without an event.  weight : on the interpolation, below 1 after a piece that was
too long.  beyond : a time after the event [s], 0 without.  short : consecutive pieces that ended before it.
least : length of the next piece after more than `MOST_SHORT` of them [s]."""


# --- stages


@kernel
def place(step, time, state):
    """Move the ends of a state (modified) to a time [s] of the communication step."""
    put_ends(step.n, state, target(*step.ground, time), target(*step.kite, time))


@kernel
def residual_of(drum, stage, length, pull):
    """Residual of the equation of a stage with a length [m] and its tension [N], and the inertial force in it [N]."""
    speed = (length - stage.length) / stage.h
    inertial = drum.mass * (speed - stage.speed) / stage.h
    return inertial - balance(drum, stage.direction, pull, speed, stage.time), inertial


@kernel
def speed_with(drum, stage, pull):
    """Speed [m/s] at a stage with this tension [N]: from the forces, because lengths in short pieces are rounded."""
    free = balance(drum, stage.direction, pull, 0.0, stage.time)
    return (drum.mass * stage.speed + stage.h * free) / (drum.mass + stage.h * drum.damping)


@kernel
def slope_error(h, first, slopes):
    """Error estimate from slopes in the stages of a piece of h [s], and the first slope, at its start.

    The larger of two estimates: an order-2 method in the first two stages, and the distance of the initial slope from its
    extrapolation back from them, which detects a tether that goes slack or taut before the first stage.
    """
    one, two, three = slopes
    by_order = ERROR_1 * one + ERROR_2 * two + ERROR_3 * three
    by_start = FROM_START * (first - one + GAMMA / (MIDDLE - GAMMA) * (two - one))
    return h * max(abs(by_order), abs(by_start))


@kernel
def error_of_piece(step, piece, speeds, rates, pull, stiffness):
    """Relative error of the tension after a piece, from speeds [m/s] and their rates [m/s2] in its stages.

    For a tether with the stiffness EA [N], under an end tension [N]. The tolerance is IN_DRUMS times the tolerance of
    chains, relative to the largest force, see `step_control.errors_of_segments`.
    """
    drum, start, h = step.drum, piece.start, piece.h
    spring, tolerance = stiffness / start.length, step.parameters[at.RELATIVE_TOLERANCE]
    free = balance(drum, piece.direction, start.pull, 0.0, start.time)
    by_speed = 0.0
    if drum.mass > 0.0:
        at_start = (free - drum.damping * start.speed) / drum.mass
        by_speed = sqrt(drum.mass * spring) * slope_error(h, at_start, rates)
        first = start.speed
    else:
        first = free / drum.damping
    by_length = spring * slope_error(h, first, speeds)
    largest = max(start.pull, pull, abs(force_at(drum, start.time)) + drum.friction)
    allowed = IN_DRUMS * min(TENSION, PER_TOLERANCE * tolerance) * largest + ROUNDING * stiffness
    return max(by_length, by_speed) / allowed


# --- events


@kernel
def event_of(drum, piece, end):
    """Event of a piece with an `Instant` at its end; and the margin until it, negative if it has passed."""
    start, direction, change = piece.start, piece.direction, end.length - piece.start.length
    if drum.mass == 0.0 and drum.friction > 0.0 and change * direction < -ROUNDING * start.length:
        return TURNED_BACK, 0.0
    if end.length != start.length and is_at_stop(drum, end.length, OUTWARDS if end.length > start.length else INWARDS):
        return AT_STOP, 0.0
    if not may_change(drum, direction):
        return NOTHING, 0.0
    room, margin = room_to_change(drum, direction, end.time, end.length, end.speed, end.pull)
    if room < -margin:
        return WITHIN, room
    return AT_END if room < 0.0 else NOTHING, room


@kernel
def is_too_long(event, h, duration):
    """Whether to repeat a piece of h [s] with this event, shorter.  duration : of the communication step [s]."""
    if event == TURNED_BACK:
        return h > SHORTEST_PART * duration
    if event == AT_STOP:
        return h > SHORTEST_ARRIVAL * duration
    return event == WITHIN and h > SMALLEST_PIECE * duration


@kernel
def search_from(time, beyond, short, least):
    """`EventSearch` from a time [s] on; other arguments as for `EventSearch`."""
    return EventSearch(beyond - time if beyond > time else inf, 1.0, beyond, short, least)


@kernel
def shorten(search, drum, piece, event, room):
    """`EventSearch` after a piece that is too long; room : margin at its end."""
    weight, h, beyond = search.weight, 0.5 * piece.h, piece.end
    if event == TURNED_BACK:
        h, beyond = 0.25 * piece.h, search.beyond
    elif event == WITHIN:
        start = piece.start
        before, _ = room_to_change(drum, piece.direction, start.time, start.length, start.speed, start.pull)
        h = piece.h * part_of_piece(weight * before, room)
        if search.short > MOST_SHORT:
            h = max(h, min(search.least, 0.5 * piece.h))
        weight *= 0.5
    return EventSearch(h, weight, beyond, search.short, search.least)


@kernel
def search_after(search, piece, event):
    """`EventSearch` after an accepted piece."""
    if event != NOTHING or search.beyond <= piece.end:
        return search_from(piece.end, 0.0, 0, 0.0)
    return search_from(piece.end, search.beyond, search.short + 1, 2.0 * piece.h)


@kernel
def turn(drum, now, is_held):
    """Next direction of the drum, and the `Instant` of its start; is_held : whether friction holds it."""
    direction, speed = next_motion(drum, is_held, now.time, now.length, now.speed, now.pull)
    return direction, Instant(now.time, now.length, speed, now.pull)


@kernel
def come_to_rest(drum, direction, end, event):
    """The `Instant` after an accepted piece, at rest at a stop or by friction; and whether friction then holds the drum."""
    turned_round = drum.friction > 0.0 and end.speed * direction < 0.0
    speed = 0.0 if event == AT_STOP or turned_round else end.speed
    return Instant(end.time, end.length, speed, end.pull), turned_round and event != AT_STOP and drum.mass == 0.0


def advance_with(settle, tension, largest):
    """Return the kernel advance(n, parameters, given, state, work) of a variant, which returns a status.

    settle : kernel (n, parameters, state, work) that solves the equilibrium of a state (modified) between its ends and
    returns a status.  tension : kernel (n, parameters, state) of the ground tension [N] in such a state.  largest : kernel
    (n, parameters, state, work) of its largest tension [N].
    """

    @kernel
    def tension_with(step, length, state, work):
        """A status, and the tension [N] at an unstretched length [m], which is written to the state (modified)."""
        state[at.LENGTH] = length
        status = settle(step.n, step.parameters, state, work)
        return status, tension(step.n, step.parameters, state)

    @kernel
    def find(step, stage, guess, state, work):
        """Length [m] of a stage, from an initial guess [m], with its tension [N]; and a status.

        Leaves the state (modified) at this length. A length beyond a stop is replaced by the stop.
        """
        drum, h = step.drum, stage.h
        inertia = drum.mass / (h * h) + drum.damping / h
        stiffness = property_of(chain_of(step.n, step.parameters, state), 0, at.STIFFNESS)
        forces = abs(force_at(drum, stage.time)) + drum.friction
        search, length = secant.begin(drum.shortest, min(drum.longest, LONGEST), guess, inertia + stiffness / guess)
        pull, failures = 0.0, 0
        for k in range(MOST_EVALUATIONS):
            status, pull = tension_with(step, length, state, work)
            if state[at.ITERATIONS] > step.most:
                return length, pull, STEP_BUDGET_SPENT
            if status != OK:
                failures += 1
                if k == 0 or failures > MOST_FAILURES:
                    return length, 0.0, status
                length = 0.5 * (length + search.last)
                continue
            residual, inertial = residual_of(drum, stage, length, pull)
            if abs(residual) <= EXACT * (forces + abs(inertial)) + ROUNDING * (stiffness + inertia * length):
                return length, pull, OK
            if length == (search.highest if residual < 0.0 else search.lowest):  # the root lies beyond it
                return length, pull, NO_LENGTH if length == LONGEST else OK
            search, onward = secant.go_on(search, length, residual, FARTHEST * length)
            if onward == length and secant.has_interval(search):
                return length, pull, OK
            length = onward
        is_found = secant.has_interval(search) and search.high - search.low <= NARROW * search.high
        return search.last, pull, OK if is_found else NO_LENGTH

    @kernel
    def keep_balance(step, piece, state, work):
        """A piece in which a massless, undamped drum turns: status, `Instant` at its end, error [-]."""
        start, h = piece.start, piece.h
        before = distance_of_ends(step.n, state)
        stage = Stage(piece.direction, start.time + h, h, start.length, 0.0)
        place(step, stage.time, state)
        guess = start.length + distance_of_ends(step.n, state) - before
        length, pull, status = find(step, stage, guess, state, work)
        return status, Instant(piece.end, length, (length - start.length) / h, pull), 0.0

    @kernel
    def end_of_stage(step, direction, h, onward, guess, state, work):
        """A stage of h [s] from an `Instant`, the end of its start: a status, and the `Instant` at its end."""
        stage = Stage(direction, onward.time + h, h, onward.length, onward.speed)
        place(step, stage.time, state)
        length, pull, status = find(step, stage, guess, state, work)
        return status, Instant(stage.time, length, speed_with(step.drum, stage, pull), pull)

    @kernel
    def integrate(step, piece, state, work):
        """`keep_balance` for any other turning drum, in three stages; one with backward Euler."""
        direction, start, h, part = piece.direction, piece.start, piece.h, GAMMA * piece.h
        if step.fixed.size > 0.0 and step.fixed.method == at.BACKWARD_EULER:
            status, end = end_of_stage(step, direction, h, start, start.length + h * start.speed, state, work)
            return status, Instant(piece.end, end.length, end.speed, end.pull), 0.0
        status, first = end_of_stage(step, direction, part, start, start.length + part * start.speed, state, work)
        if status != OK:
            return status, start, inf
        u1, a1 = first.speed, (first.speed - start.speed) / part
        rest = (MIDDLE - GAMMA) * h
        onward = Instant(start.time + rest, start.length + rest * u1, start.speed + rest * a1, 0.0)
        status, second = end_of_stage(step, direction, part, onward, onward.length + part * u1, state, work)
        if status != OK:
            return status, start, inf
        u2, a2 = second.speed, (second.speed - onward.speed) / part
        onward = Instant(
            start.time + h - part, start.length + h * (B1 * u1 + B2 * u2), start.speed + h * (B1 * a1 + B2 * a2), 0.0
        )
        status, third = end_of_stage(step, direction, part, onward, onward.length + part * u2, state, work)
        u3, a3 = third.speed, (third.speed - onward.speed) / part
        error = 0.0
        if step.fixed.size == 0.0:
            stiffness = property_of(chain_of(step.n, step.parameters, state), 0, at.STIFFNESS)
            error = error_of_piece(step, piece, (u1, u2, u3), (a1, a2, a3), third.pull, stiffness)
        return status, Instant(piece.end, third.length, third.speed, third.pull), error

    @kernel
    def attempt(step, piece, state, work):
        """`keep_balance` for any drum, turning or held."""
        if piece.direction == HELD:
            place(step, piece.start.time + piece.h, state)
            status, pull = tension_with(step, piece.start.length, state, work)
            return status, Instant(piece.end, piece.start.length, 0.0, pull), 0.0
        if step.drum.mass == 0.0 and step.drum.damping == 0.0:
            return keep_balance(step, piece, state, work)
        return integrate(step, piece, state, work)

    @kernel
    def advance(n, parameters, given, state, work):
        """Move a state (modified) over a communication step with `StepInputs`, with any winch; returns a status."""
        if not follows_force(parameters):
            move_ends(n, given, state)
            return settle(n, parameters, state, work)
        drum, duration, h, failures = drum_of(parameters, given.force, given.force_rate), given.step, given.step, 0
        most = state[at.ITERATIONS] + SHARES * at.ITERATION_BUDGET // n
        step = Step(n, parameters, given.ground, given.kite, drum, most, given_steps(parameters))
        if step.fixed.size > 0.0:
            count = count_of_steps(step.fixed, duration, MOST_PIECES)
            if count == 0:
                return FIXED_STEPS_TOO_MANY
            h = duration / count
        elif state[at.SOLVER_STEP] > 0.0:
            h = state[at.SOLVER_STEP]
        longest = h if step.fixed.size > 0.0 else LARGEST_GROWTH * duration
        now = Instant(0.0, state[at.LENGTH], state[at.REELING], tension(n, parameters, state))
        direction, start = turn(drum, now, False)
        search = search_from(0.0, 0.0, 0, 0.0)
        for _ in range(MOST_PIECES):
            if state[at.ITERATIONS] > most:
                return STEP_BUDGET_SPENT
            rest = duration - start.time
            h_even, _ = even_step(rest, h)
            h_now = min(h_even, search.h)
            piece = Piece(direction, start, h_now, duration if h_now == rest else start.time + h_now)
            status, end, error = attempt(step, piece, state, work)
            if status != OK:
                failures += 1
                if drum.mass == 0.0 or failures > MOST_FAILURES or state[at.ITERATIONS] > most:
                    return status
                h = 0.25 * h_now
                continue
            if not error <= 1.0:
                h = h_now * max(STRONGEST_CUT, SAFETY * error ** (-1.0 / 3.0))
                state[at.REJECTIONS] += 1.0
                if h < SMALLEST_PIECE * duration:
                    return STEP_TOO_SMALL
                continue
            event, room = event_of(drum, piece, end)
            if is_too_long(event, h_now, duration):
                search = shorten(search, drum, piece, event, room)
            elif event == TURNED_BACK:  # immediately held by friction
                search = search_from(start.time, search.beyond, search.short, search.least)
                direction, start = turn(drum, start, True)
            else:
                end, is_held = come_to_rest(drum, direction, end, event)
                state[at.STEPS] += 1.0
                proposal = h_now * min(LARGEST_GROWTH, SAFETY * max(error, LEAST_ERROR) ** (-1.0 / 3.0))
                h = min(longest, proposal if h_now == h_even else max(h, proposal))
                if end.time >= duration:
                    state[at.LENGTH], state[at.REELING], state[at.SOLVER_STEP] = end.length, end.speed, h
                    return OK
                note_peak(state, largest(n, parameters, state, work))
                search = search_after(search, piece, event)
                direction, start = turn(drum, end, is_held)
        return STEP_BUDGET_SPENT

    return advance
