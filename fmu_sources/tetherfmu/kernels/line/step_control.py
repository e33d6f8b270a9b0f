"""Error of a Rosenbrock step, and the steps that it allows within a communication step.

The error of a step is the largest of: its embedded estimate (`error_norm`), what segments that went over the taut-slack
transition may have got wrong (`transition_error`), the error of the tension of the dampers (`damper_error`), and in a stiff
tether that of its tension (`tension_errors`), each over what is allowed (`allowed_errors`). See docs/models/numerics.md,
"Rosenbrock step".
"""

from math import ceil, inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import HOPELESS, LEAST_REMAINDER, MOST_BUDGETS, STIFF

from ..compilation import kernel
from ..equations import segment
from ..equations.ground import has_ground
from ..equations.properties import has_node_winds, node_wind, property_of, rest_length
from ..linear_algebra.vectors import dot, get, sub
from . import contact
from .rodas4p import GAMMA
from .taut_slack import keep_energy, lighter_free_node, transition_error

# PI rule of a method whose error estimate has order 4: h_new/h = SAFETY error^(-0.7/4) last_error^(0.4/4)
# Source: Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.2
SAFETY = 0.9  # of the step that the estimate allows
EXPONENT, LAST_EXPONENT = 0.7 / 4, 0.4 / 4  # of the last error and of the one before
LEAST_ERROR, LEAST_LAST_ERROR = 1e-10, 1e-4  # an error counts as at least so much
LARGEST_GROWTH = 5.0  # of a step over the one before
STRONGEST_CUT = 0.2  # the same, downwards
CUT_WITHOUT_ESTIMATE = 0.1  # where the matrix is singular or the error is no number
WEAKEST_CUT = 0.9  # of a step that is rejected
SMALLEST_STEP = 1e-10  # part of the communication step
DAMPER = 0.01  # part of the largest tension; see `damper_error`
SMALL_STRAIN = 1e-6  # see `is_stiff`
TENSION = 0.01  # part of the largest tension; see `tension_errors`
HARMLESS = 0.01  # part of the allowed error of a velocity that a wrong tension may cause in a step; see there
ROUNDING = 1e-15  # of positions, relative, as far as it shows in the error estimate; measured: 0.3e-15
UNRESOLVED = 2.0  # in the place of the last error after a communication step that was given up
TINY = 1e-200  # what keeps a quotient from 0/0


@kernel
def error_norm(conditions, h, position_scale, velocity_scale, w):
    """Root mean square of the error estimate of a step over the allowed error of positions [m] and velocities [m/s]."""
    squares = 0.0
    velocity_squares = 0.0
    for k in range(3 * (conditions.n + 1)):
        squares += w.q[k] * w.q[k]
        velocity_squares += w.velocity_error[k] * w.velocity_error[k]
    squares = squares * (GAMMA * h / position_scale) ** 2 + velocity_squares / velocity_scale**2
    return sqrt(squares / (6 * (conditions.last - conditions.first + 1)))


@kernel
def damper_error(conditions, chain, w):
    """Largest error estimate of a damper's tension in the last step as a velocity [m/s]: c |e.dv|/sqrt(k m).

    dv is the difference of the error estimates of the two nodes, sqrt(k m) the impedance of the taut segment with the mass
    of the lighter free node. A step in which it is more than the velocity error allowed is rejected if this tension is also
    more than DAMPER times the largest one (`tension_errors`). Without it the velocities of a stiff damper are allowed
    errors that, times c, are kilonewtons. `chain` is that at the end of the step.
    """
    worst = 0.0  # squared
    for s in range(chain.n):
        r = sub(get(w.x, s + 1), get(w.x, s))
        rest = rest_length(chain, s)
        k, _ = segment.stiffness(chain, s, segment.TAUT, 1.0)  # times l0
        _, c = segment.stiffness(chain, s, w.modes[s], 1.0)  # times l0
        wrong = c * dot(r, sub(get(w.velocity_error, s + 1), get(w.velocity_error, s)))  # times l0 l
        worst = max(worst, wrong * wrong / (k * rest * lighter_free_node(s, conditions, w) * dot(r, r) + TINY))
    return sqrt(worst)


@kernel
def is_stiff(chain, h, w):
    """Whether a segment has more than STIFF, and after the last step of h [s] none of these is certainly stretched much.

    Certainly by more than SMALL_STRAIN: also if its vector r [m] were shorter by its error estimate. Below, the errors of
    positions that the tolerance allows may be a multiple of the stretch that the tension comes from. `chain` is that at the
    end of the step.
    """
    stiff = False
    for s in range(chain.n):
        if property_of(chain, s, at.STIFFNESS) > STIFF:
            stiff = True
            r = sub(get(w.x, s + 1), get(w.x, s))
            doubt = 2.0 * GAMMA * h * abs(dot(r, sub(get(w.q, s + 1), get(w.q, s))))
            rest = rest_length(chain, s)
            if dot(r, r) - doubt > rest * rest * (1.0 + 2.0 * SMALL_STRAIN):
                return False
    return stiff


@kernel
def tension_errors(conditions, chain, h, speed, w):
    """Error estimates of tensions in the last step, of h [s]: of a damper over the largest one, of all over what is allowed.

    c e.du and k e.dr + c e.du, with the differences of the error estimates of the two nodes in positions and velocities.
    Allowed is TENSION times the largest tension, and as much more as rounding of the positions makes in the spring, or as
    changes the velocity of the lighter free node by HARMLESS times the allowed `speed` [m/s] within the step. `chain` is
    that at the end of the step.
    """
    of_dampers, of_both, largest = 0.0, 0.0, TINY
    for s in range(chain.n):
        x_p, x_q = get(w.x, s), get(w.x, s + 1)
        stretched, e = segment.geometry(sub(x_q, x_p))
        rest = rest_length(chain, s)
        k, c = segment.stiffness(chain, s, w.modes[s], rest)
        rate = dot(e, sub(get(w.v, s + 1), get(w.v, s)))
        largest = max(largest, abs(segment.tension(chain, stretched, rate, rest, k, c)))
        by_position = k * GAMMA * h * dot(e, sub(get(w.q, s + 1), get(w.q, s)))
        by_velocity = c * dot(e, sub(get(w.velocity_error, s + 1), get(w.velocity_error, s)))
        rounding = ROUNDING * k * sqrt(max(dot(x_p, x_p), dot(x_q, x_q)))
        harmless = max(rounding, HARMLESS * lighter_free_node(s, conditions, w) * speed / h)
        of_dampers = max(of_dampers, abs(by_velocity))
        of_both = max(of_both, abs(by_position + by_velocity) - harmless)
    return of_dampers / largest, of_both / (TENSION * largest)


@kernel
def square_of_wind(conditions):
    """Square of the wind at the reference height [m2/s2], or of the largest one that is given at a node."""
    if not has_node_winds(conditions):
        return dot(conditions.wind, conditions.wind)
    square = 0.0
    for i in range(conditions.n + 1):
        wind = node_wind(conditions, i, 0)
        square = max(square, dot(wind, wind))
    return square


@kernel
def allowed_errors(conditions, v):
    """Error that one step may make in a position [m] and in a velocity [m/s] at the tolerance in the parameters.

    relative_tolerance times the mean segment length, and times the largest of: node speed, wind speed and the speed
    after falling freely over one segment.
    """
    tolerance = conditions.parameters[at.RELATIVE_TOLERANCE]
    segment_length = conditions.reeling[0] / conditions.n
    square = max(2.0 * conditions.parameters[at.GRAVITY] * segment_length, square_of_wind(conditions))
    for i in range(conditions.n + 1):
        square = max(square, dot(get(v, i), get(v, i)))
    return tolerance * segment_length, tolerance * sqrt(square) + 1e-12


@kernel
def error_of_step(conditions, chain, h, v, w):
    """Error of the step of h [s] that `system_step.step` has made from the velocities v [m/s] over what is allowed [-].

    chain : at the end of the step. The result of the step, in w, is put right where segments went over the transition, see
    `taut_slack.keep_energy`.
    """
    position_scale, velocity_scale = allowed_errors(conditions, v)
    error = error_norm(conditions, h, position_scale, velocity_scale, w)
    damper, stiff, tension = damper_error(conditions, chain, w) / velocity_scale, is_stiff(chain, h, w), 0.0
    if damper > 1.0 or stiff:
        of_dampers, tension = tension_errors(conditions, chain, h, velocity_scale, w)
        if damper > 1.0:
            damper = min(damper, of_dampers / DAMPER)
    error = max(error, damper)
    if stiff:
        error = max(error, tension ** (2 / 3))  # it falls with h^6, the estimates of positions and velocities with h^4
    transition = transition_error(conditions, chain, h, w) / velocity_scale
    if transition > 0.0:
        keep_energy(conditions, chain, w)
    if has_ground(chain.parameters):
        transition = max(transition, contact.transition_error(conditions, chain, h, w) / velocity_scale)
    if transition > 1.0:
        error = max(error, transition * transition)  # it falls with h^2, the other estimate with h^4
    return error


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
    """Step to try [s] after an accepted one of `done` [s] where h [s] was allowed.

    error, last_error : of this step and the last accepted one [-].  rejected_before : whether the step before it was.
    """
    proposal = done * step_factor(error, last_error)
    if rejected_before:
        return min(proposal, done)
    return max(proposal, h) if done < h else proposal


@kernel
def first_step(duration, state):
    """Step [s] to try first in a communication step of `duration` [s], and the error of the last one, from a state."""
    if state[at.SOLVER_STEP] <= 0.0:
        return duration, 1.0
    return state[at.SOLVER_STEP], state[at.SOLVER_ERROR]


@kernel
def even_step(rest, h):
    """Step to try [s] where h [s] is allowed: an equal part of the rest [s] of the communication step; whether all of it."""
    left = ceil(rest / h - LEAST_REMAINDER)
    return rest / left if left > 1.0 else rest, not left > 1.0


@kernel
def step_after_event(h, done, proposal, duration):
    """Step to try [s] where an event of a drum may have ended one of `done` [s] early, though h [s] was allowed.

    The proposal [s] of `next_step`, but not what is left of a piece that an event has cut to nothing: the estimate of its
    error says nothing, and after a rejection the next step would be no longer.
    """
    return h if done < h and proposal < SMALLEST_STEP * duration else proposal


@kernel
def is_given_up(state, tried, budget, time, duration):
    """Whether the internal steps tried are too many: MOST_BUDGETS, or one budget on a course to more than HOPELESS of them.

    time : reached [s] within the communication step of `duration` [s].  state : before it; after a communication step that
    was given up, the next one has a single budget.
    """
    is_hopeless = tried * duration >= HOPELESS * budget * time or state[at.SOLVER_ERROR] == UNRESOLVED
    return tried >= MOST_BUDGETS * budget or (tried >= budget and is_hopeless)
