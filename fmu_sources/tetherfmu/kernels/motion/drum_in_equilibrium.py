"""Winch drum on a tether that is in equilibrium at every instant: two unknowns, length L and speed u.

    m du/dt = T(L, t) - W - c u - F sign(u),   dL/dt = u      (`equations/drum.py`)

T is the ground tension of the tether between its ends, solved for each L. The method is an L-stable diagonally implicit
Runge-Kutta method of order 3, whose third stage is the result. Each stage is one equation for one length, in which T
decreases and the other terms increase:

    m (u - u*)/(g h) = T(L) - W - c u - F sign(u),   u = (L - L*)/(g h)
    L*, u* = L0, u0 + h sum of b (dL/dt, du/dt) over earlier stages;   after g h, c h, h

The error of a piece is measured as a tension error: see `error_of_piece`. With `fixed_step` pieces have that length and no
error estimate; with backward Euler a piece is one stage over h.

Without mass and damping nothing needs to be integrated: T(L) = W + F sign(u) at the end of the step. The force law, events
and pieces are those of any rope coordinate (`equations/drum.py`, `line/drum_events.py`). See docs/models/numerics.md,
"Rope coordinates".
Source: R. Alexander, Diagonally implicit Runge-Kutta methods for stiff ODEs, SIAM J. Numer. Anal. 14 (1977) 1006.
"""

from collections import namedtuple
from math import inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

from ..compilation import kernel
from ..equations.boundary import distance_of_ends, move_ends, put_ends
from ..equations.drum import HELD, INWARDS, OUTWARDS, balance, direction_of, drum_of, force_at, is_at_stop
from ..equations.end_motion import target
from ..equations.properties import chain_of, property_of
from ..equations.winch import follows_force
from ..line.backward_euler import count_of_steps, given_steps
from ..line.drum_events import SHORTEST_PART, SMALLEST_PIECE, part_of_piece, room_to_rest, turns_round, urges
from ..line.step_control import LARGEST_GROWTH, LEAST_ERROR, PER_TOLERANCE, SAFETY, TENSION, even_step
from ..notes import note_peak
from .balanced_length import ROUNDING, Stage, search_with

NOTHING, WITHIN, AT_STOP, TURNED_BACK = range(4)  # events of a piece
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
FARTHEST = 0.02  # relative change of the length between evaluations: each shape starts from the last one
MOST_FAILURES = 2  # failed pieces before it gives up
MOST_SHORT = 8  # pieces in a row that end before an event, until the next one is at least twice as long as the last
SHORTEST_ARRIVAL = 1e-4  # of the communication step: a piece that ends at a stop is no longer

Step = namedtuple("Step", "n parameters ground kite drum most fixed")
Step.__doc__ = """A communication step.

n, parameters : number of segments and flat array.  ground, kite : prescribed motion of the ends, see `StepInputs`.
drum : `Drum`.  most : iterations since the start at which the equilibrium search is abandoned.  fixed : `FixedSteps`."""
Instant = namedtuple("Instant", "time length speed pull")
Instant.__doc__ = """The drum at a time [s] of the communication step: length L [m], speed u [m/s], tension T [N]."""
Piece = namedtuple("Piece", "direction start h end")
Piece.__doc__ = """A piece of a communication step, in which the drum turns in a direction or is held.

start : `Instant`.  h : its length [s].  end : its end [s], exactly the end of the communication step in the last piece."""


# --- stages


@kernel
def place(step, time, state):
    """Move the ends of a state (modified) to a time [s] of the communication step."""
    put_ends(step.n, state, target(*step.ground, time), target(*step.kite, time))


@kernel
def is_balanced(drum):
    """Whether a turning drum is in balance at every instant, without mass and damping."""
    return drum.mass == 0.0 and drum.damping == 0.0


@kernel
def speed_with(drum, stage, length, pull):
    """Speed [m/s] at a stage: from the forces, because lengths in short pieces are rounded."""
    if is_balanced(drum):
        return (length - stage.length) / stage.h
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
def room_to_change(drum, direction, now):
    """Margin until a drum, turning in a direction or held, starts or comes to rest without a stop; its tolerance of 0."""
    if direction != HELD:
        return room_to_rest(direction, now.speed, now.length) if drum.friction > 0.0 and drum.mass > 0.0 else (inf, 0.0)
    force = force_at(drum, now.time)
    outwards, inwards, margin = urges(now.pull - force, drum.friction, abs(now.pull) + abs(force) + drum.friction)
    outwards = -inf if is_at_stop(drum, now.length, OUTWARDS) else outwards
    inwards = -inf if is_at_stop(drum, now.length, INWARDS) else inwards
    return -max(outwards, inwards), margin


@kernel
def find_event(drum, piece, end, weight):
    """Event of a piece with an `Instant` at its end; the fraction of it to try next, and whether that is long enough.

    weight : on the interpolation, below 1 after a piece that was too long.
    """
    start, direction, change = piece.start, piece.direction, end.length - piece.start.length
    if drum.mass == 0.0 and turns_round(drum.friction, direction, change) and abs(change) > ROUNDING * start.length:
        return TURNED_BACK, 0.25, SHORTEST_PART
    if end.length != start.length and is_at_stop(drum, end.length, OUTWARDS if end.length > start.length else INWARDS):
        return AT_STOP, 0.5, SHORTEST_ARRIVAL
    over, margin = room_to_change(drum, direction, end)
    if over < 0.0:
        room, _ = room_to_change(drum, direction, start)
        return WITHIN, part_of_piece(weight * room, over), SMALLEST_PIECE if over < -margin else inf
    return NOTHING, inf, inf


@kernel
def turn(drum, now, is_held):
    """Next direction of the drum, and the `Instant` of its start; is_held : whether friction holds it."""
    direction = HELD if is_held else direction_of(drum, now.length, now.speed, now.pull, now.time)
    rests = direction == HELD or (drum.mass > 0.0 and now.speed * direction < 0.0)
    return direction, Instant(now.time, now.length, 0.0 if rests else now.speed, now.pull)


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

    find = search_with(tension_with, FARTHEST)

    @kernel
    def end_of_stage(step, direction, h, onward, going, state, work):
        """A stage of h [s] from an `Instant`, the end of its start: a status, and the `Instant` at its end.

        going : speed [m/s] for the guess of its length, if the drum is not balanced at every instant.
        """
        stage = Stage(direction, onward.time + h, h, onward.length, onward.speed)
        before = distance_of_ends(step.n, state)
        place(step, stage.time, state)
        move = distance_of_ends(step.n, state) - before if is_balanced(step.drum) else h * going
        length, pull, status = find(step, step.drum, stage, onward.length + move, step.most, state, work)
        return status, Instant(stage.time, length, speed_with(step.drum, stage, length, pull), pull)

    @kernel
    def attempt(step, piece, state, work):
        """A piece of a drum, turning or held: a status, the `Instant` at its end, and its error [-].

        A turning drum takes three stages; one with backward Euler, or if it is balanced at every instant.
        """
        direction, start, h, part = piece.direction, piece.start, piece.h, GAMMA * piece.h
        if direction == HELD:
            place(step, start.time + h, state)
            status, pull = tension_with(step, start.length, state, work)
            return status, Instant(piece.end, start.length, 0.0, pull), 0.0
        if is_balanced(step.drum) or (step.fixed.size > 0.0 and step.fixed.method == at.BACKWARD_EULER):
            status, end = end_of_stage(step, direction, h, start, start.speed, state, work)
            return status, Instant(piece.end, end.length, end.speed, end.pull), 0.0
        status, first = end_of_stage(step, direction, part, start, start.speed, state, work)
        if status != OK:
            return status, start, inf
        u1, a1 = first.speed, (first.speed - start.speed) / part
        rest = (MIDDLE - GAMMA) * h
        onward = Instant(start.time + rest, start.length + rest * u1, start.speed + rest * a1, 0.0)
        status, second = end_of_stage(step, direction, part, onward, u1, state, work)
        if status != OK:
            return status, start, inf
        u2, a2 = second.speed, (second.speed - onward.speed) / part
        onward = Instant(
            start.time + h - part, start.length + h * (B1 * u1 + B2 * u2), start.speed + h * (B1 * a1 + B2 * a2), 0.0
        )
        status, third = end_of_stage(step, direction, part, onward, u2, state, work)
        u3, a3 = third.speed, (third.speed - onward.speed) / part
        error = 0.0
        if step.fixed.size == 0.0:
            stiffness = property_of(chain_of(step.n, step.parameters, state), 0, at.STIFFNESS)
            error = error_of_piece(step, piece, (u1, u2, u3), (a1, a2, a3), third.pull, stiffness)
        return status, Instant(piece.end, third.length, third.speed, third.pull), error

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
        start = Instant(0.0, state[at.LENGTH], state[at.REELING], tension(n, parameters, state))
        direction, is_new, is_held, beyond, room, weight, short, least = HELD, True, False, 0.0, inf, 1.0, 0, 0.0
        for _ in range(MOST_PIECES):
            if state[at.ITERATIONS] > most:
                return STEP_BUDGET_SPENT
            if is_new:
                direction, start = turn(drum, start, is_held)
                is_new, is_held, room, weight = False, False, beyond - start.time if beyond > start.time else inf, 1.0
            rest = duration - start.time
            h_even, _ = even_step(rest, h)
            h_now = min(h_even, room)
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
            event, part, shortest = find_event(drum, piece, end, weight)
            if event != NOTHING and h_now > shortest * duration:
                room = h_now * part
                if event == WITHIN:
                    room = max(room, min(least, 0.5 * h_now)) if short > MOST_SHORT else room
                    weight *= 0.5  # if the next piece is too long again, the one after it will not be
                beyond = beyond if event == TURNED_BACK else piece.end
                continue
            is_new, is_held = True, event == TURNED_BACK  # immediately held by friction
            if is_held:
                continue
            turned_round = turns_round(drum.friction, direction, end.speed)
            is_held = turned_round and event != AT_STOP and drum.mass == 0.0
            start = Instant(end.time, end.length, 0.0 if event == AT_STOP or turned_round else end.speed, end.pull)
            is_before = event == NOTHING and beyond > end.time
            beyond, short, least = (beyond, short + 1, 2.0 * h_now) if is_before else (0.0, 0, 0.0)
            state[at.STEPS] += 1.0
            proposal = h_now * min(LARGEST_GROWTH, SAFETY * max(error, LEAST_ERROR) ** (-1.0 / 3.0))
            h = min(longest, proposal if h_now == h_even else max(h, proposal))
            if start.time >= duration:
                state[at.LENGTH], state[at.REELING], state[at.SOLVER_STEP] = start.length, start.speed, h
                return OK
            note_peak(state, largest(n, parameters, state, work))
        return STEP_BUDGET_SPENT

    return advance
