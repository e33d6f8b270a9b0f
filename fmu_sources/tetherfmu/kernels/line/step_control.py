"""Error of a Rosenbrock step, and the permitted steps within a communication step.

The error of a step is the largest of three relative errors: the embedded estimate (`error_norm`), the possible error of
segments that crossed the taut-slack transition (`transition_error`), and the tension errors (`errors_of_segments`), each
over its tolerance (`allowed_errors`). See docs/models/numerics.md, "Rosenbrock step".
"""

from collections import namedtuple
from math import ceil, inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import LEAST_REMAINDER, MOST_BUDGETS, MOST_EXPECTED, STIFF

from ..compilation import kernel
from ..equations import segment
from ..equations.ground import has_ground
from ..equations.properties import has_node_winds, in_parts, node_wind, property_of, rest_length
from ..linear_algebra.vectors import dot, get, sub
from . import contact
from .rodas4p import GAMMA
from .taut_slack import keep_energy, lighter_free_node, transition_error

# PI rule of a method whose error estimate has order 4: h_new/h = SAFETY error^(-0.7/4) last_error^(0.4/4)
# Source: Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.2
SAFETY = 0.9  # of the step that the estimate permits
EXPONENT, LAST_EXPONENT = 0.7 / 4, 0.4 / 4  # exponents of the last error and of the one before
LEAST_ERROR, LEAST_LAST_ERROR = 1e-10, 1e-4  # lower limits of the errors
LARGEST_GROWTH = 5.0  # of a step over the one before
STRONGEST_CUT = 0.2  # smallest step over the one before
CUT_WITHOUT_ESTIMATE = 0.1  # for a singular matrix or an error that is not a number
WEAKEST_CUT = 0.9  # of a step that is rejected
SMALLEST_STEP = 1e-10  # part of the communication step
# see `errors_of_segments`
DAMPER = 0.01  # part of the largest tension
TENSION, PER_TOLERANCE = 1e-3, 10.0  # parts of the largest tension: at most, and per relative_tolerance
IN_STIFF, SMALL_STRAIN = 10.0, 1e-6
FINEST = 5e-5  # part of the length of a segment, per relative_tolerance
HARMLESS = 0.01  # part of the velocity tolerance that a wrong tension may cause in a step
ROUNDING = 1e-15  # of positions, relative, as seen in the error estimate; measured: 0.3e-15
UNRESOLVED = 2.0  # replaces the last error after an abandoned communication step
TINY = 1e-200  # avoids 0/0

SegmentErrors = namedtuple("SegmentErrors", "damper_velocity damper tension largest is_stiff has_crossed")
SegmentErrors.__doc__ = """Results of the last step for the segments of a line; see `errors_of_segments`.

damper_velocity, damper : error estimate of a damper's tension as a velocity [m/s], and over the largest tension [-].
tension : of any tension over its tolerance [-].  largest : tension of all segments [N].  is_stiff : whether the line is.
has_crossed : whether a segment crossed the taut-slack transition."""
DrumError = namedtuple("DrumError", "length growth mass moves_segment second_length second_growth")
DrumError.__doc__ = """Error estimates of the drum of a line in the last step.

length : of the length over gamma h [m/s].  growth : of l0'/l0 in the section at the winch, as dampers see it [1/s].
mass : of the drum [kg], inf without a drum and if it is held; 0: it controls the tension of the first segment.
moves_segment : whether entering rope moves the only segment of the line, see `events.keep_energy`.
second_length, second_growth : of the second part of a portion that broke, relative to its length [1/s], [1/s]; else 0."""


@kernel
def error_norm(conditions, h, position_scale, velocity_scale, w):
    """Root mean square of the error estimate of a step over the position [m] and velocity [m/s] tolerances."""
    squares = 0.0
    velocity_squares = 0.0
    for k in range(3 * (conditions.n + 1)):
        squares += w.q[k] * w.q[k]
        velocity_squares += w.velocity_error[k] * w.velocity_error[k]
    squares = squares * (GAMMA * h / position_scale) ** 2 + velocity_squares / velocity_scale**2
    return sqrt(squares / (6 * (conditions.last - conditions.first + 1)))


@kernel
def errors_of_segments(conditions, chain, h, speed, drum, w):
    """`SegmentErrors` of the last step, of h [s], with the velocity tolerance `speed` [m/s] and a `DrumError`.

    The error of a damper tension is c e.du, of a total tension k (e.dr - dl0) + c e.du, from the differences of the
    position and velocity error estimates of the two nodes, and of the drum. `chain` is at the end of the step.

    A damper: c |e.du|/sqrt(k m), with the impedance sqrt(k m) of the taut segment and the mass of the lighter free node. A
    step in which this exceeds the velocity tolerance is rejected if the tension error also exceeds DAMPER times the largest
    tension. Otherwise permitted velocity errors times a stiff damper's c would be kilonewtons.

    Any tension: the tolerance is PER_TOLERANCE relative_tolerance, at most TENSION, times the largest tension, plus the
    effect of an error FINEST relative_tolerance of the segment length, of rounding of positions, and the tension that
    changes the velocity of the lighter free node by HARMLESS times its tolerance within the step.

    Stiff: if a segment has more than STIFF, and no such segment is certainly stretched by more than SMALL_STRAIN, even if
    its vector is shorter by its error estimate. Below, the permitted position errors may be a multiple of the stretch that
    causes the tension; IN_STIFF times the tension error is then permitted.
    """
    tolerance, reach, mass_of_drum = conditions.parameters[at.RELATIVE_TOLERANCE], GAMMA * h, drum.mass
    ground, kite = get(w.x, 0), get(w.x, chain.n)
    rounding = ROUNDING * sqrt(max(dot(ground, ground), dot(kite, kite)))
    has_stiff = is_stretched = has_crossed = False
    square, impedance, of_dampers, of_both, largest, highest = 0.0, 1.0, 0.0, 0.0, TINY, -inf
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(w.x, s + 1), get(w.x, s)))
        rest, mode = rest_length(chain, s), w.modes[s]
        has_crossed = has_crossed or (length - rest) * mode < 0.0
        k, c = segment.stiffness(chain, s, mode, rest)
        taut, _ = segment.stiffness(chain, s, segment.TAUT, rest)
        pull = segment.tension(chain, s, length, dot(e, sub(get(w.v, s + 1), get(w.v, s))), rest, k, c)
        largest, highest = max(largest, abs(pull)), max(highest, pull)
        entering = in_parts(chain, s, rest / chain.section * drum.length, rest * drum.second_length)
        growth = in_parts(chain, s, drum.growth, drum.second_growth)
        wrong = reach * (dot(e, sub(get(w.q, s + 1), get(w.q, s))) - entering)
        of_damper = c * (dot(e, sub(get(w.velocity_error, s + 1), get(w.velocity_error, s))) - length * growth)
        mass = lighter_free_node(s, conditions, w)
        harmless = HARMLESS * min(mass, mass_of_drum) * speed / h
        if mass_of_drum == 0.0:
            wrong = 0.0
        mass_of_drum = inf
        finest = FINEST * tolerance * rest
        if property_of(chain, s, at.STIFFNESS) > STIFF:
            has_stiff, finest = True, 0.0
            is_stretched = is_stretched or length - abs(wrong) > rest * (1.0 + SMALL_STRAIN)
        if of_damper * of_damper * impedance > square * taut * mass:  # a larger quotient
            square, impedance = of_damper * of_damper, taut * mass
        of_dampers = max(of_dampers, abs(of_damper))
        of_both = max(of_both, abs(k * wrong + of_damper) - max(harmless, k * max(rounding, finest)))
    is_stiff = has_stiff and not is_stretched
    allowed = min(TENSION, PER_TOLERANCE * tolerance) * largest * (IN_STIFF if is_stiff else 1.0)
    return SegmentErrors(sqrt(square / impedance), of_dampers / largest, of_both / allowed, highest, is_stiff, has_crossed)


@kernel
def square_of_wind(conditions, velocity):
    """Squared wind at the reference height [m2/s2] relative to a velocity [m/s], or the largest one at a node."""
    if not has_node_winds(conditions):
        wind = sub(conditions.wind, velocity)
        return dot(wind, wind)
    square = 0.0
    for i in range(conditions.n + 1):
        wind = sub(node_wind(conditions, i, 0), velocity)
        square = max(square, dot(wind, wind))
    return square


@kernel
def allowed_errors(conditions, v):
    """Error that one step may make in a position [m] and in a velocity [m/s] at the tolerance in the parameters.

    relative_tolerance times the mean segment length, and times the largest of: node speed, wind speed relative to an
    end (the smaller one of both ends), and the speed after free fall over one segment.
    """
    tolerance, segment_length = conditions.parameters[at.RELATIVE_TOLERANCE], conditions.reeling[0] / conditions.n
    first, last = get(v, 0), get(v, conditions.n)
    from_first, from_last = square_of_wind(conditions, first), square_of_wind(conditions, last)
    for i in range(conditions.n + 1):
        velocity = get(v, i)
        way, back = sub(velocity, first), sub(velocity, last)
        from_first, from_last = max(from_first, dot(way, way)), max(from_last, dot(back, back))
    square = max(2.0 * conditions.parameters[at.GRAVITY] * segment_length, min(from_first, from_last))
    return tolerance * segment_length, tolerance * sqrt(square) + 1e-12


@kernel
def error_of_step(conditions, chain, h, v, drum, w):
    """Relative error [-] of the step of h [s] that `step.step` has made from the velocities v [m/s].

    Also returns the largest segment tension after it [N].

    chain : at the end of the step.  drum : `DrumError`.  The step result, in w, is corrected for segments that crossed
    the transition, see `taut_slack.keep_energy`.
    """
    position_scale, velocity_scale = allowed_errors(conditions, v)
    found = errors_of_segments(conditions, chain, h, velocity_scale, drum, w)
    tension = found.tension
    if found.is_stiff and tension > 0.0:
        tension = tension ** (2 / 3)  # it falls with h^6, the other estimates with h^4
    if not conditions.first <= conditions.last:
        return tension, found.largest
    damper, transition = found.damper_velocity / velocity_scale, 0.0
    if damper > 1.0:
        damper = min(damper, found.damper / DAMPER)
    error = max(error_norm(conditions, h, position_scale, velocity_scale, w), damper, tension)
    if found.has_crossed and not drum.moves_segment:
        transition = transition_error(conditions, chain, h, w) / velocity_scale
        keep_energy(conditions, chain, w)
    if has_ground(chain.parameters):
        transition = max(transition, contact.transition_error(conditions, chain, h, w) / velocity_scale)
    if transition > 1.0:
        error = max(error, transition * transition)  # it falls with h^2, the other estimate with h^4
    return error, found.largest


@kernel
def step_factor(error, last_error):
    """Factor for the next step [-] from the error estimates of the last two accepted steps (PI rule)."""
    factor = SAFETY * max(error, LEAST_ERROR) ** -EXPONENT * max(last_error, LEAST_LAST_ERROR) ** LAST_EXPONENT
    return min(LARGEST_GROWTH, max(STRONGEST_CUT, factor))


@kernel
def cut(h, error):
    """Step to try [s] after one of h [s] with this error [-], which is too large."""
    part = CUT_WITHOUT_ESTIMATE if not error < inf else max(STRONGEST_CUT, SAFETY * error ** (-1 / 4))
    return h * min(part, WEAKEST_CUT)


@kernel
def next_step(h, done, error, last_error, rejected_before):
    """Step to try [s] after an accepted one of `done` [s] if h [s] was permitted.

    error, last_error : of this step and the last accepted one [-].  rejected_before : whether the step before it was.
    """
    proposal = done * step_factor(error, last_error)
    if rejected_before:
        return min(proposal, done)
    return max(proposal, h) if done < h else proposal


@kernel
def first_step(duration, state):
    """First step to try [s] in a communication step of `duration` [s], and the error of the last one, from a state."""
    if state[at.SOLVER_STEP] <= 0.0:
        return duration, 1.0
    return state[at.SOLVER_STEP], state[at.SOLVER_ERROR]


@kernel
def even_step(rest, h):
    """Step to try [s] if h [s] is permitted: an equal part of the rest [s] of the communication step; whether all of it."""
    left = ceil(rest / h - LEAST_REMAINDER)
    return rest / left if left > 1.0 else rest, not left > 1.0


@kernel
def step_after_event(h, done, proposal, duration):
    """Step to try [s] if a drum event may have ended a step of `done` [s] early, although h [s] was permitted.

    The proposal [s] of `next_step`, unless an event has cut the piece to almost nothing: the error estimate is then
    meaningless, and after a rejection the next step would be no longer.
    """
    return h if done < h and proposal < SMALLEST_STEP * duration else proposal


@kernel
def is_given_up(state, tried, budget, time, duration):
    """Whether too many internal steps were tried: MOST_BUDGETS, or one budget on course to more than MOST_EXPECTED.

    time : reached [s] within the communication step of `duration` [s].  state : before it; after an abandoned
    communication step, the next one has a single budget.
    """
    expects_too_many = tried * duration >= MOST_EXPECTED * budget * time or state[at.SOLVER_ERROR] == UNRESOLVED
    return tried >= MOST_BUDGETS * budget or (tried >= budget and expects_too_many)
