"""Elastic catenary under a uniform load, in closed form.

A line of unstretched length L and stiffness EA carries the load w per unstretched length, all along one direction. In the
plane of the chord and the load, let a be the span across the load and b the span against it (both from the ground end to
the kite end). With the tension (H, V - w L/2) at the ground end and (H, V + w L/2) at the kite end

    a = H L/EA + H/w (asinh(V2/H) - asinh(V1/H))
    b = V L/EA + (T2 - T1)/w,         V1,2 = V -+ w L/2,  T = sqrt(H^2 + V^2)

The two equations state that the complementary energy  integral (T + T^2/2EA) ds - a H - b V  is stationary in (H, V). It is
convex, so Newton's method with a line search on it finds the only solution from any start, slack or taut.

V2 - V1 is w L, but if V is hundreds of w L, the difference of the two rounded numbers is exact only for every other V. The
span at neighbouring numbers V then alternates by more than the required accuracy. If the tether is stretched to dozens of
times its length, rounding of the energy stops the line search. If Newton's method has not ended after
`USUAL_ITERATIONS`, it therefore continues with w L itself and a line search with a rounding tolerance.

Source: H. M. Irvine, Cable Structures (1981), section 1.3; docs/models/theory.md, "Elastic catenary".
"""

from math import asinh, log, log1p, sinh, sqrt

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations.properties import property_of
from ..equations.segment import SHORTEST
from ..linear_algebra.vectors import add, add_scaled, cross, dot, norm, scale
from ..step.outputs import away_from_chord, place_along_chord, wave_time

MOST_ITERATIONS = 60  # of Newton's method
USUAL_ITERATIONS = 20  # maximum without rounding problems
MOST_HALVINGS = 40  # of one step of it
DECREASE = 1e-4  # part of the slope that a step must achieve (Armijo's rule)
TAUTNESS = 0.999  # chord over length below which the first guess is inextensible
LEAST = 1e-300  # lower limit of divisors
ROUNDING = 4e-15  # of the span and the rise in units of the length
SAMPLES = 24  # pieces of the catenary for wave time and sag
HALVINGS = 40  # of the two pieces with the largest distance from the chord


@kernel
def end_tensions(h, v1, v2):
    """Tensions at the ends: h across the load, v1 and v2 along it."""
    return sqrt(h * h + v1 * v1), sqrt(h * h + v2 * v2)


@kernel
def end_loads(v, exact):
    """v1, v2 and v2 - v1 of a line with v at mid-length, in units of w L; the difference is exactly 1 or rounded."""
    v1, v2 = v - 0.5, v + 0.5
    return v1, v2, 1.0 if exact else v2 - v1


@kernel
def asinh_difference(h, v1, v2, rise):
    """h (asinh(v2/h) - asinh(v1/h)) for h >= 0, v1 < v2, rise = v2 - v1, without cancellation."""
    if h <= 0.0:
        return 0.0
    if v1 < 0.0 < v2:
        return h * (asinh(v2 / h) + asinh(-v1 / h))
    if v2 <= 0.0:
        v1, v2 = -v2, -v1
    t1, t2 = end_tensions(h, v1, v2)
    return h * log1p(rise * (1.0 + (v1 + v2) / (t1 + t2)) / (t1 + v1))


@kernel
def gap(h, v, a, b, elasticity, exact):
    """Span for the tension (h, v) at mid-length, in units of w L, minus (a, b), in units of L.

    exact : see `end_loads`.
    """
    v1, v2, rise = end_loads(v, exact)
    t1, t2 = end_tensions(h, v1, v2)
    across = elasticity * h + asinh_difference(h, v1, v2, rise)
    return across - a, elasticity * v + 2.0 * v / max(t1 + t2, LEAST) - b


@kernel
def energy(h, v, a, b, elasticity, exact):
    """Complementary energy in units of w L^2; its gradient is the span of (h, v) minus (a, b).  exact : see `end_loads`."""
    v1, v2, rise = end_loads(v, exact)
    t1, t2 = end_tensions(h, v1, v2)
    total = t1 + t2  # v2 t2 - v1 t1 = total/2 + 2 v^2/total
    length_term = 0.25 * total + v * v / max(total, LEAST) + 0.5 * h * asinh_difference(h, v1, v2, rise)
    elastic_term = 0.5 * elasticity * (h * h + v * v + 1.0 / 12.0)
    return length_term + elastic_term - a * h - b * v


@kernel
def energy_rounding(h, v, a, b, elasticity, exact):
    """Rounding tolerance of `energy` in the line search: of the tension, or if exact of all its terms."""
    if exact:
        return ROUNDING * (1.0 + elasticity + (1.0 + a + abs(b)) * (h + abs(v)))
    return ROUNDING * (1.0 + h + abs(v))


@kernel
def taut_guess(a, b, elasticity):
    """Tension (h, v) of a shallow elastic parabola: e t^3 + (1 - c) t^2 = cos^2/24 with c the chord, cos = a/c."""
    chord = max(sqrt(a * a + b * b), 1e-12)
    cosine = a / chord
    sag_term = max(cosine * cosine, 1e-12) / 24.0
    t = max(0.0, (chord - 1.0) / elasticity) + (sag_term / elasticity) ** (1.0 / 3.0)
    for _ in range(20):
        value = (elasticity * t + 1.0 - chord) * t * t - sag_term
        slope = (3.0 * elasticity * t + 2.0 * (1.0 - chord)) * t
        change = value / slope
        if not change < t:
            break
        t -= change
        if change < 1e-3 * t:
            break
    return max(t * cosine, 1e-12), t * b / chord


@kernel
def slack_guess(a, b):
    """Tension (h, v) of the inextensible catenary, from sinh(z)/z = sqrt(1 - b^2)/a, h = a/(2 z), v = b coth(z)/2."""
    ratio = sqrt(1.0 - b * b) / max(a, 1e-12)
    z = sqrt(6.0 * (ratio - 1.0)) if ratio < 3.0 else log(2.0 * ratio) + log(log(2.0 * ratio))
    for _ in range(4):
        s = sinh(z)
        c = sqrt(1.0 + s * s)
        z = max(0.5 * z, z - (s - ratio * z) / (c - ratio))
    s = sinh(z)
    return max(a, 1e-12) / (2.0 * z), 0.5 * b * sqrt(1.0 + s * s) / s


@kernel
def solve(span, rise, load, length, axial_stiffness):
    """Tension at mid-length (H, V) [N] of an elastic catenary, and the number of Newton iterations (-1: none found).

    Span across the load [m] (not negative), rise against the load [m], load per unstretched length [N/m] (positive),
    unstretched length [m], EA [N].
    """
    a = span / length
    b = rise / length
    elasticity = load * length / axial_stiffness
    if a * a + b * b < TAUTNESS**2:
        h, v = slack_guess(a, b)
    else:
        h, v = taut_guess(a, b, elasticity)
    unit = load * length
    g1, g2 = gap(h, v, a, b, elasticity, False)
    now = energy(h, v, a, b, elasticity, False)
    for iteration in range(MOST_ITERATIONS):
        exact = iteration >= USUAL_ITERATIONS
        v1, v2, difference = end_loads(v, exact)
        t1, t2 = end_tensions(h, v1, v2)
        vertical = v2 / t2 - v1 / t1
        across = max(asinh_difference(h, v1, v2, difference) / h - vertical, 0.0)
        j11 = elasticity + across
        j12 = h * (1.0 / t2 - 1.0 / t1)
        j22 = elasticity + vertical
        determinant = j11 * j22 - j12 * j12
        if not determinant > 0.0:
            return 0.0, 0.0, -1
        dh = -(j22 * g1 - j12 * g2) / determinant
        dv = -(j11 * g2 - j12 * g1) / determinant
        if abs(dh) + abs(dv) <= 1e-15 * (h + abs(v)):
            return unit * (h + max(dh, -0.9 * h)), unit * (v + dv), iteration
        slope = g1 * dh + g2 * dv
        part = 1.0 if dh > -0.9 * h else 0.9 * h / -dh
        noise = energy_rounding(h, v, a, b, elasticity, exact)
        for _ in range(MOST_HALVINGS):
            h_new = h + part * dh
            v_new = v + part * dv
            then = energy(h_new, v_new, a, b, elasticity, exact)
            if then <= now + DECREASE * part * slope + noise:
                break
            part *= 0.5
        h = h_new
        v = v_new
        now = then
        g1, g2 = gap(h, v, a, b, elasticity, exact)
        if abs(g1) + abs(g2) <= ROUNDING * (1.0 + a + abs(b)) or (h < 1e-14 and abs(g2) <= ROUNDING):
            return unit * h, unit * v, iteration + 1
    return 0.0, 0.0, -1


@kernel
def load_frame(a, load):
    """Size of a load, its direction, and the components of a vector against and across it; also the length of the latter."""
    size = max(norm(load), LEAST)
    down = scale(1.0 / size, load)
    against = -dot(a, down)
    across = add_scaled(a, against, down)
    return size, down, against, across, norm(across)


@kernel
def hang(chord, load, length, axial_stiffness):
    """Tension vector at the ground end [N] of an elastic catenary in space, and the number of iterations (-1: not found).

    Chord from the ground end to the kite [m], load per unstretched length [N/m], not zero, unstretched length [m], EA [N].
    """
    size, down, rise, across, span = load_frame(chord, load)
    horizontal, vertical, iterations = solve(span, rise, size, length, axial_stiffness)
    sideways = scale(horizontal / max(span, SHORTEST), across)
    return add_scaled(sideways, 0.5 * size * length - vertical, down), iterations


@kernel
def point_in_space(ground, tension, load, arc, axial_stiffness):
    """Point [m] at unstretched length `arc` [m] from the ground end [m], from the tension there [N] and the load [N/m]."""
    size, down, vertical, across, horizontal = load_frame(tension, load)
    out, up = point(arc, horizontal, vertical, size, axial_stiffness)
    sideways = scale(out / max(horizontal, LEAST), across)
    return add_scaled(add(ground, sideways), -up, down)


@kernel
def point(arc, horizontal, ground_vertical, load, axial_stiffness):
    """Distance across and against the load [m] of the point at unstretched length `arc` [m] from the ground end.

    Tension at the ground end (horizontal, ground_vertical) [N], load [N/m], EA [N].
    """
    v1 = ground_vertical
    v2 = ground_vertical + load * arc
    if arc <= 0.0:
        return 0.0, 0.0
    t1, t2 = end_tensions(horizontal, v1, v2)
    across = arc * horizontal / axial_stiffness + asinh_difference(horizontal, v1, v2, v2 - v1) / load
    against = 0.5 * arc * (v1 + v2) / axial_stiffness + arc * (v1 + v2) / max(t1 + t2, LEAST)
    return across, against


# --- wave time and sag: docs/models/theory.md, "Outputs"


@kernel
def farthest_between(low, high, start, ground, chord, tension, load, stiffness):
    """Largest distance [m] from the chord between two arcs [m], where (t - s q) . a = 0, with a from the chord."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        away = away_from_chord(point_in_space(start, tension, load, middle, stiffness), ground, chord)
        if dot(away, add_scaled(tension, -middle, load)) > 0.0:
            low = middle
        else:
            high = middle
    return norm(away_from_chord(point_in_space(start, tension, load, low, stiffness), ground, chord))


@kernel
def crossing_and_sag(line, start, length, ground, chord, tension, load):
    """Wave time [s] and largest distance [m] from the chord of a part of a catenary.

    Its start [m], its unstretched length [m], ground end of the chord [m], chord [m], tension vector at the start [N],
    load per unstretched length [N/m].
    """
    stiffness = property_of(line, 0, at.STIFFNESS)
    piece = length / SAMPLES
    # beside its chord the distance is largest where the tether is parallel to it: (t - s q) x c = 0; with one end
    # above the other, in its fold: (t - s q) . q = 0
    bending = cross(load, chord)
    parallel = dot(cross(tension, chord), bending) / max(dot(bending, bending), LEAST)
    fold = dot(tension, load) / max(dot(load, load), LEAST)
    sag, farthest = 0.0, 0.0
    for arc in (parallel, fold):
        arc = min(length, max(0.0, arc))
        distance = norm(away_from_chord(point_in_space(start, tension, load, arc, stiffness), ground, chord))
        if distance > sag:
            sag, farthest = distance, arc
    crossing, longest = 0.0, 0.0
    for k in range(SAMPLES):
        middle = (k + 0.5) * piece
        pull = norm(add_scaled(tension, -middle, load))
        stretched = piece * (1.0 + pull / stiffness)
        longest = max(longest, stretched)
        crossing += wave_time(property_of(line, 0, at.LINE_DENSITY), piece, stretched, pull, stiffness)
        distance = norm(away_from_chord(point_in_space(start, tension, load, middle, stiffness), ground, chord))
        if distance > sag:
            sag, farthest = distance, middle
    place = place_along_chord(point_in_space(start, tension, load, farthest, stiffness), ground, chord)
    if min(place, 1.0 - place) * norm(chord) <= 2.0 * longest:  # the distance may be largest beyond an end of the chord
        low, high = max(0.0, farthest - piece), min(length, farthest + piece)
        sag = max(sag, farthest_between(low, high, start, ground, chord, tension, load, stiffness))
    return crossing, sag
