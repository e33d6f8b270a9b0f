"""Taut-slack transition of segments in a Rosenbrock step: its error, and the energy that it would create.

All stages use the stiffness k of a segment at the start of the step, so the step conserves the sum of kinetic energy and
k (l - l0)^2/2. If the segment ends a distance |l - l0| beyond the transition, with stiffness k', the spring has

    (k - k') (l - l0)^2/2

too much energy (it went slack) or too little (it became taut); `keep_energy` transfers it from or to the speed along
the segment. Otherwise steps create energy where segments become taut and lose some where they go slack. The two do not
balance, because slack segments permit longer steps: an undamped tether swung itself up. Source: docs/models/numerics.md,
"Rosenbrock step".
"""

from math import copysign, inf, sqrt

from ..compilation import PARTS, kernel
from ..equations import segment
from ..equations.properties import growth_at, in_section, rest_length
from ..linear_algebra.vectors import add_scaled, dot, get, norm, put, sub

TRANSITION = 0.05  # measured: 0.2 costs more rejections for the same error; with 0.01 an undamped tether may gain energy
OVERSHOOT = 0.1  # part of the velocity tolerance that a wrong damper may cause beyond the transition
ROUNDING = 1e-14  # of positions, relative: smaller overshoots are ignored


@kernel
def lighter_free_node(s, conditions, w):
    """Mass [kg] of the lighter free node of a segment."""
    return min(w.mass[s] if s >= conditions.first else inf, w.mass[s + 1] if s + 1 <= conditions.last else inf)


@kernel
def went_over(s, chain, w):
    """Whether segment s ended the step on the other side of the transition."""
    r = sub(get(w.x, s + 1), get(w.x, s))
    rest = rest_length(chain, s)
    return segment.beyond_rest(r, rest) * w.modes[s] < 0.0


@kernel
def excess(s, chain, w):
    """Stiffness [N/m] and damping [N s/m] that the step used in segment s minus their values beyond the transition."""
    rest = rest_length(chain, s)
    held_k, held_c = segment.stiffness(chain, s, w.modes[s], rest)
    present_k, present_c = segment.stiffness(chain, s, -w.modes[s], rest)
    return held_k - present_k, held_c - present_c


@kernel
def wrong_impulse(s, chain, h, w):
    """Possible impulse error [N s] of segment s in a step of h [s] in which it crossed the transition; else 0.

    Overshoot |l - l0| times the stiffness error over a part TRANSITION of the step; `chain` is at its end.
    """
    if not went_over(s, chain, w):
        return 0.0
    over = abs(norm(sub(get(w.x, s + 1), get(w.x, s))) - rest_length(chain, s))
    return TRANSITION * h * abs(excess(s, chain, w)[0]) * over


@kernel
def transition_error(conditions, chain, h, w):
    """Velocity error estimate [m/s] of the lighter free node of a segment from `wrong_impulse`; 0 without."""
    worst = 0.0
    for s in range(chain.n):
        impulse = wrong_impulse(s, chain, h, w)
        if impulse > 0.0:
            worst = max(worst, impulse / lighter_free_node(s, conditions, w))
    return worst


@kernel
def part_to_transition(conditions, before, after, h, x, v, speed, mass_of_rope, w):
    """Fraction of a step of h [s] that ends with the first segment just beyond the transition; inf if none needs this.

    Beyond the transition the damper of a segment is wrong by |c - c'| times its rate, in total by the impulse
    |c - c'| |l - l0|. The step must end where this changes the velocity of the lighter free node by more than OVERSHOOT
    times its tolerance `speed` [m/s]. l - l0 is modelled as a parabola, and the step ends at half of the permitted l - l0.

    before, after : `Chain` at the start and at the end of the step.  x, v : nodes at the start [m], [m/s].
    mass_of_rope : see `events.mass_of_rate` [kg].
    """
    least, rounding = inf, ROUNDING * max(norm(get(x, 0)), norm(get(x, after.n)))
    for s in range(after.n):
        if went_over(s, after, w):
            over = norm(sub(get(w.x, s + 1), get(w.x, s))) - rest_length(after, s)
            mass = min(lighter_free_node(s, conditions, w), mass_of_rope)
            wrong, harmless = abs(excess(s, after, w)[1]), OVERSHOOT * speed * mass
            if wrong * abs(over) > harmless and abs(over) > rounding:
                allowed = copysign(0.5 * max(harmless / wrong, rounding), over)
                length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
                rest = rest_length(before, s)
                rest_rate = in_section(before, s, rest * before.reeling / before.section)
                if PARTS and before.is_parted:
                    rest_rate = rest * growth_at(before, s)
                rate = h * (dot(e, sub(get(v, s + 1), get(v, s))) - rest_rate)
                first = length - rest - allowed
                least = min(least, part_of_parabola(first, rate, over - allowed))
    return least


@kernel
def part_of_parabola(first, rate, last):
    """Zero in (0, 1) of a parabola with value `first` and slope `rate` at 0, and `last`, of the other sign, at 1."""
    bend = last - first - rate
    part = copysign(sqrt(max(rate * rate - 4.0 * bend * first, 0.0)), last)
    return -2.0 * first / (rate + part)


@kernel
def impulse_between(s, chain, mobility, rate_of_rest, below, above, w):
    """Energy-conserving impulse [N s] along segment s if it crossed the transition, and its direction; 0 without.

    mobility : of the rate of l - l0 [1/kg].  rate_of_rest : of l0 [m/s].  below, above : velocities of its nodes [m/s].
    """
    length, e = segment.geometry(sub(get(w.x, s + 1), get(w.x, s)))
    over = length - rest_length(chain, s)
    rate = dot(e, sub(above, below)) - rate_of_rest
    if not (went_over(s, chain, w) and rate * over > 0.0 and mobility > 0.0):
        return 0.0, e
    square = rate * rate + mobility * excess(s, chain, w)[0] * over * over
    return (copysign(sqrt(max(square, 0.0)), rate) - rate) / mobility, e


@kernel
def keep_energy(conditions, chain, w):
    """Correct the velocities in w.v (modified) of the nodes of segments that crossed the transition.

    With the reduced mass m of the free nodes, m (rate'^2 - rate^2)/2 = (k - k') (l - l0)^2/2; a rate that this would
    reverse becomes 0. A segment that already returns is not corrected. All rates are from before the correction, so the
    result does not depend on the order of the ends. `chain` is at the end of the step. If entering rope moves the only
    segment, see also `events.keep_energy`.
    """
    below = get(w.v, 0)  # before the correction
    for s in range(chain.n):
        above = get(w.v, s + 1)
        mobility_p = 1.0 / w.mass[s] if s >= conditions.first else 0.0
        mobility_q = 1.0 / w.mass[s + 1] if s + 1 <= conditions.last else 0.0
        impulse, e = impulse_between(s, chain, mobility_p + mobility_q, 0.0, below, above, w)
        if impulse != 0.0:
            put(w.v, s, add_scaled(get(w.v, s), -impulse * mobility_p, e))
            put(w.v, s + 1, add_scaled(above, impulse * mobility_q, e))
        below = above
