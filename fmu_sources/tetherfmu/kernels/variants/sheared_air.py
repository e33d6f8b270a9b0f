"""Air load along a chord where wind or density vary with the height.

The wind profile has kinks: where it ends in calm air, with an infinite slope (power law) or a nearby singularity
(logarithm). The chord is split there. In the part with wind, from its lower end xi_0 over xi_1 - xi_0 upwards,

    xi = xi_0 + (xi_1 - xi_0) s^4,   s = 0 .. 1

makes the integrand smooth. Each part is integrated by the Gauss-Kronrod rule with 7 and 15 points, and halved where
the two differ: near a point without cross-flow, |w| w has a kink of its own.

Source: docs/models/theory.md, "Straight line"; R. Piessens et al., QUADPACK (1983), rule qk15.
"""

from math import exp, inf, log

import numpy as np

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import segment
from ..equations.air import wind_factor
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, norm, scale, sub

# abscissae on -1 .. 1, symmetric, from the end to the middle; weights of 15 points, and of every second point
POINTS = np.array(
    (
        *(0.991455371120812639, 0.949107912342758525, 0.864864423359769073, 0.741531185599394440),
        *(0.586087235467691130, 0.405845151377397167, 0.207784955007898468, 0.0),
    )
)
WEIGHTS = np.array(
    (
        *(0.022935322010529225, 0.063092092629978553, 0.104790010322250184, 0.140653259715525919),
        *(0.169004726639267903, 0.190350578064785410, 0.204432940075298892, 0.209482141084727828),
    )
)
FEWER_WEIGHTS = np.array(
    (
        *(0.0, 0.129484966168869693, 0.0, 0.279705391489276668),
        *(0.0, 0.381830050505118945, 0.0, 0.417959183673469388),
    )
)
TOLERANCE = 1e-7  # largest difference of the two rules on a piece, over the integral of |f|
MOST_PIECES = 200  # of a part; half of them are enough for kinks
STEEP = 0.5  # a part has no nearby singularity if its lower end is above this fraction of its upper one
MOST_ITERATIONS = 60  # of Newton's method for the zeros of the explog profile


@kernel
def calm_height(height, parameters):
    """Height [m] of a zero of the explog profile, by Newton's method from outside of the negative interval.

    e^(alpha y) - 2 - 2 y/ln(h/z0) with y = ln(z/h) is convex, so no step overshoots.
    """
    reference, exponent = parameters[at.WIND_REFERENCE_HEIGHT], parameters[at.WIND_EXPONENT]
    slope = 2.0 / log(reference / parameters[at.SURFACE_ROUGHNESS])
    y = log(height / reference)
    for _ in range(MOST_ITERATIONS):
        power = exp(exponent * y)
        change = (power - 2.0 - slope * y) / (exponent * power - slope)
        y -= change
        if abs(change) <= 1e-15 * (1.0 + abs(y)):
            break
    return reference * exp(y)


@kernel
def windy_heights(top, parameters):
    """Heights [m] between which there is wind, up to the height `top` [m]; whether the lower one is a kink."""
    profile = parameters[at.WIND_PROFILE]
    if profile == at.POWER_LAW:
        return 0.0, inf, True
    roughness = parameters[at.SURFACE_ROUGHNESS]
    if profile == at.LOGARITHMIC:
        return roughness, inf, True
    if profile == at.EXPLOG:
        low, high = calm_height(roughness, parameters), inf
        factor = wind_factor(top, parameters)[0]
        if top > low and factor <= 0.0:
            high = calm_height(top, parameters)
        return low, high, True
    return -inf, inf, False


@kernel
def load_at(line, chord, ends, xi):
    """Load f [N/m] at a point of the chord.

    chord : its direction e, height [m] of its ground end, its rise [m].  ends : velocity [m/s] of the ground end, and
    relative velocity of the kite end.
    """
    e, height, rise = chord
    velocity = add_scaled(ends[0], xi, ends[1])
    return scale(2.0, segment.half_drag(line, 0, 1.0, e, height + xi * rise, velocity))


@kernel
def estimate(line, chord, ends, lower, span, is_graded, start, width):
    """Integrals of f and of xi f over a piece of a part, their largest error, and the integral of |f|; all [N/m].

    lower, span : xi_0 and xi_1 - xi_0.  is_graded : whether xi is graded with s^4, else linear in s.
    start, width : of the piece, in s.
    """
    mean = moment = fewer_mean = fewer_moment = ZERO_VECTOR
    size = 0.0
    last = len(POINTS) - 1
    for k in range(2 * last + 1):
        i = min(k, 2 * last - k)
        offset = POINTS[i] if k > last else -POINTS[i]
        s = start + width * (0.5 + 0.5 * offset)
        part, slope = (s * s * s * s, 4.0 * s * s * s) if is_graded else (s, 1.0)
        xi = lower + span * part
        f = load_at(line, chord, ends, xi)
        weight = 0.5 * width * abs(span) * slope
        mean = add_scaled(mean, weight * WEIGHTS[i], f)
        moment = add_scaled(moment, weight * WEIGHTS[i] * xi, f)
        fewer_mean = add_scaled(fewer_mean, weight * FEWER_WEIGHTS[i], f)
        fewer_moment = add_scaled(fewer_moment, weight * FEWER_WEIGHTS[i] * xi, f)
        size += weight * WEIGHTS[i] * norm(f)
    return mean, moment, max(norm(sub(mean, fewer_mean)), norm(sub(moment, fewer_moment))), size


@kernel
def integral(line, chord, ends, lower, upper, is_graded, size):
    """Integrals of f and of xi f [N/m] from xi = `lower` to `upper`, and `size` [N/m] plus the integral of |f|.

    Where the rules differ by more than `TOLERANCE` times the new size, the part is halved repeatedly.
    """
    part = line, chord, ends, lower, upper - lower, is_graded
    mean, moment, error, more = estimate(*part, 0.0, 1.0)
    size += more
    if not error > TOLERANCE * size:
        return mean, moment, size
    mean = moment = ZERO_VECTOR
    place, pieces, width, tried = 0, 2, 0.5, 0  # next piece: number `place` of `pieces` with this width
    while place < pieces:
        piece_mean, piece_moment, error, _ = estimate(*part, place * width, width)
        tried += 1
        if error > TOLERANCE * size and tried < MOST_PIECES:
            place, pieces, width = 2 * place, 2 * pieces, 0.5 * width
            continue
        mean, moment = add(mean, piece_mean), add(moment, piece_moment)
        place += 1
        while place % 2 == 0 and place > 0 and pieces > 2:
            place, pieces, width = place // 2, pieces // 2, 2.0 * width
    return mean, moment, size


@kernel
def sheared_load(line, height, rise, e, ends):
    """Mean of f [N/m] along a chord, and the mean of xi f [N/m].

    height : of the ground end [m].  rise : of the kite end above it [m].  e : direction of the chord.
    ends : velocity [m/s] of the ground end, and relative velocity of the kite end.
    """
    chord = e, height, rise
    bottom, top = min(height, height + rise), max(height, height + rise)
    if not top > bottom:
        mean, moment, _ = integral(line, chord, ends, 0.0, 1.0, False, 0.0)
        return mean, moment
    low, high, has_kink = windy_heights(top, line.parameters)
    low, high = min(max(low, bottom), top), max(min(high, top), bottom)
    is_graded = has_kink and low < STEEP * high
    # the part with wind is the largest: it sets the size
    mean, moment, size = ZERO_VECTOR, ZERO_VECTOR, 0.0
    for part, (first, last) in enumerate(((low, high), (bottom, low), (high, top))):
        if last > first:
            lower, upper = (first - height) / rise, (last - height) / rise
            more, further, size = integral(line, chord, ends, lower, upper, is_graded and part == 0, size)
            mean, moment = add(mean, more), add(moment, further)
    return mean, moment
