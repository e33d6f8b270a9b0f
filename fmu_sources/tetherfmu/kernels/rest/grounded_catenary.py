"""Elastic catenary with a part of its length on a flat, rigid ground: lengths in units of L, forces in units of q L.

The load q per unstretched length is uniform: n down and g along the ground, n^2 + |g|^2 = 1. From the touchdown point a
part of length h hangs up to an end at the height z. Its tension at s from there is u - g s along the
ground and n s up, together T. Its horizontal extent x and its height are, with c = u.g and e = q L/EA,

    x = u J - g K + e (u h - g h^2/2),   J = int ds/T = asinh((h - c)/p) + asinh(c/p),   p^2 = |u|^2 - c^2
    z = n K + e n h^2/2,                 K = int s ds/T = T(h) - T(0) + c J

The part on the ground, of length l = 1 - h_high - h_low, is straight. The ground carries n per length and resists the
sideways load; friction reduces the tension from H at the side of the higher end to H_low at the other side:

    H_low = max(0, H - F),   F = m n l*,   l* = 1 - h_high(H) - h_low(H),   S = l + e int_0^l max(0, H - F s/l) ds

l* is l unless both ends are above the ground; statics then leave F open up to m n l. The unknowns are
H and the direction d of the part on the ground: v = S d with v = D - x_high + x_low and the horizontal chord D from the low
end to the high one. For each H the direction equals the direction of v; v.d - S decreases with H. If it is negative for
H = 0, the tether is slack: the part on the ground is longer than the distance it spans.

Source: J. M. Jonkman, Dynamics Modeling and Loads Analysis of an Offshore Floating Wind Turbine, NREL/TP-500-41958 (2007),
section 2.6; docs/models/theory.md, "Catenary on the ground".
"""

from collections import namedtuple
from math import sqrt

from ..compilation import kernel
from ..linear_algebra.vectors import norm
from ..motion import secant
from .elastic_catenary import LEAST, asinh_difference

MOST_LENGTHS = 60  # Newton iterations for the length of a hanging part
MOST_TURNS = 40  # rotations of the part on the ground per tension
MOST_TENSIONS = 320  # maximum number of trials
GROWTH = 4.0  # of the tension over the one before, at most
LEAST_TENSION = 1e-6  # first trial
LARGEST_TURN = 1.0  # [rad]
ROUNDING = 1e-15
EXACT = 1e-16  # of the length
GREATEST_GAP = 1e-9  # of the length, of a solution

Grounded = namedtuple("Grounded", "dx dy low high gx gy n elasticity friction")
Grounded.__doc__ = """Boundary conditions of a tether on the ground, in units of L and q L.

dx, dy : horizontal chord D from the low end to the high one.  low, high : heights of the ends above the ground.
gx, gy, n : load along the ground g and down.  elasticity : e.  friction : m n."""

Parts = namedtuple("Parts", "high low lying low_tension friction vx vy spread")
Parts.__doc__ = """A tether with a tension and a direction on the ground, in units of L and q L.

high, low, lying : lengths that hang from the ends and lie on the ground.  low_tension : H_low.  friction : F/l.
vx, vy : v, the span of the part on the ground.  spread : rate at which -v.d_across rotates with the direction d."""


@kernel
def extent(ux, uy, h, load):
    """Horizontal extent x, height z, rate of the height and J + e h of a part of length h that hangs; load: `Grounded`."""
    c = ux * load.gx + uy * load.gy
    square = ux * ux + uy * uy
    p = sqrt(max(0.0, square - c * c))
    t0 = sqrt(square)
    t1 = sqrt(max(0.0, square + h * (h - 2.0 * c)))
    total = max(t0 + t1, LEAST)
    j = asinh_difference(p, -c, h - c, h) / p if p > 0.0 else 0.0
    along = h * (h - 2.0 * c) / total + c * j
    x = ux * j - load.gx * along + load.elasticity * h * (ux - 0.5 * h * load.gx)
    y = uy * j - load.gy * along + load.elasticity * h * (uy - 0.5 * h * load.gy)
    z = load.n * (along + 0.5 * load.elasticity * h * h)
    rate = load.n * h * (1.0 / max(t1, LEAST) + load.elasticity)
    return x, y, z, rate, j + load.elasticity * h


@kernel
def calm_length(tension, height, load):
    """Length of a hanging part below an end at a height, with a load that pulls straight down."""
    stiffened = 1.0 + load.elasticity * tension
    rise = 2.0 * load.n * height
    excess = rise / (sqrt(stiffened * stiffened + load.elasticity * rise) + stiffened)
    return sqrt(excess * (excess + 2.0 * tension)) / load.n


@kernel
def hanging_length(ux, uy, height, load):
    """Length of the part that hangs below an end at a height, with the tension (ux, uy) at its touchdown point."""
    if height <= 0.0:
        return 0.0
    h = calm_length(sqrt(ux * ux + uy * uy), height, load)
    if load.gx == 0.0 and load.gy == 0.0:
        return h
    low, high = 0.0, 0.0
    for _ in range(MOST_LENGTHS):
        _, _, z, rate, _ = extent(ux, uy, h, load)
        if z < height:
            low = h
        else:
            high = h
        change = (height - z) / max(rate, LEAST)
        onward = h + change
        if not low < onward or (high > 0.0 and not onward < high):
            onward = 0.5 * (low + high) if high > 0.0 else 2.0 * h
        if abs(onward - h) <= ROUNDING * h:
            break
        h = onward
    return h


@kernel
def parts_with(tension, ex, ey, load):
    """`Parts` of a tether with a tension on the ground at its high side, in the direction (ex, ey)."""
    ux, uy = tension * ex, tension * ey
    high = hanging_length(ux, uy, load.high, load)
    x_high, y_high, _, _, spread_high = extent(ux, uy, high, load)
    low = hanging_length(-ux, -uy, load.low, load)
    held = max(0.0, load.friction * (1.0 - high - low))
    low_tension = max(0.0, tension - held)
    if held > 0.0 and load.low > 0.0:
        low = hanging_length(-low_tension * ex, -low_tension * ey, load.low, load)
    x_low, y_low, _, _, spread_low = extent(-low_tension * ex, -low_tension * ey, low, load)
    lying = 1.0 - high - low
    vx, vy = load.dx - x_high + x_low, load.dy - y_high + y_low
    spread = tension * spread_high + low_tension * spread_low
    return Parts(high, low, lying, low_tension, held / lying if held > 0.0 else 0.0, vx, vy, spread)


@kernel
def lying_span(tension, friction, lying, elasticity):
    """Stretched length S of a part on the ground with this tension at its high side and this friction per length."""
    if tension < friction * lying:
        return lying + 0.5 * elasticity * tension * tension / friction
    return lying * (1.0 + elasticity * (tension - 0.5 * friction * lying))


@kernel
def excess(tension, ex, ey, parts, load):
    """Distance of the touchdown points minus the length between them."""
    return ex * parts.vx + ey * parts.vy - lying_span(tension, parts.friction, parts.lying, load.elasticity)


@kernel
def rotated(x, y, angle):
    """A vector turned by an angle [rad], exactly by 2 atan(angle/2)."""
    square = 0.25 * angle * angle
    c, s = (1.0 - square) / (1.0 + square), angle / (1.0 + square)
    return x * c - y * s, x * s + y * c


@kernel
def turned(tension, ex, ey, load):
    """Direction of the part on the ground with a tension at its high side, from a first guess; and `Parts`."""
    parts = parts_with(tension, ex, ey, load)
    if load.gx == 0.0 and load.gy == 0.0:
        return ex, ey, parts
    angle, slope = 0.0, 0.0
    off = ex * parts.vy - ey * parts.vx
    for _ in range(MOST_TURNS):
        estimate = max(ex * parts.vx + ey * parts.vy, 0.0) + parts.spread
        if not 0.2 * estimate < slope < 5.0 * estimate:
            slope = estimate
        angle = max(-LARGEST_TURN, min(LARGEST_TURN, off / max(slope, LEAST)))
        if abs(angle) <= ROUNDING:
            break
        ex, ey = rotated(ex, ey, angle)
        parts = parts_with(tension, ex, ey, load)
        before, off = off, ex * parts.vy - ey * parts.vx
        slope = (before - off) / angle
    return ex, ey, parts


@kernel
def lie(load, guess):
    """Tension on the ground at its high side, its direction, `Parts`, and the number of tensions tried (-1: none found).

    load : `Grounded`.  guess : of the tension.
    """
    parts = parts_with(0.0, 1.0, 0.0, load)
    span = sqrt(parts.vx * parts.vx + parts.vy * parts.vy)
    ex, ey = (parts.vx / span, parts.vy / span) if span > 0.0 else (1.0, 0.0)
    if span <= parts.lying:
        return 0.0, ex, ey, parts, 0
    value, tried, farthest = span - parts.lying, 0, max(guess, LEAST_TENSION)
    search, tension = secant.begin(0.0, 1.0 / LEAST, 0.0, LEAST)
    while abs(value) > EXACT and tried < MOST_TENSIONS and search.high - search.low > ROUNDING * search.high:
        search, onward = secant.go_on(search, tension, -value, farthest)
        if onward == tension:
            break
        tried += 1
        tension = onward
        ex, ey, parts = turned(tension, ex, ey, load)
        value, farthest = excess(tension, ex, ey, parts, load), GROWTH * tension
    span = lying_span(tension, parts.friction, parts.lying, load.elasticity)
    missing = abs(parts.vx - span * ex) + abs(parts.vy - span * ey)
    return tension, ex, ey, parts, tried if missing <= GREATEST_GAP and parts.lying >= 0.0 else -1


@kernel
def scene_of(ground, kite, load, length, axial_stiffness, friction, plane):
    """`Grounded` of a tether, the size of its load [N/m], and whether the kite is its low end.

    Ground end [m], kite [m], load per unstretched length [N/m], unstretched length [m], EA [N], friction coefficient, height
    of the ground [m]. If both ends are above the ground, friction acts with the part (high - low)/(high + low).
    """
    size = max(norm(load), LEAST)
    dx, dy = (kite[0] - ground[0]) / length, (kite[1] - ground[1]) / length
    low, high = (ground[2] - plane) / length, (kite[2] - plane) / length
    kite_is_low = high < low
    if kite_is_low:
        dx, dy, low, high = -dx, -dy, high, low
    gx, gy, n = load[0] / size, load[1] / size, -load[2] / size
    held = friction * n * ((high - low) / (high + low) if low > 0.0 else 1.0)
    return Grounded(dx, dy, low, high, gx, gy, n, size * length / axial_stiffness, held), size, kite_is_low


@kernel
def pull_of(ux, uy, h, unit, load):
    """Force [N] on the end above a hanging part of length h, with the tension u at its touchdown point."""
    return unit * (h * load.gx - ux), unit * (h * load.gy - uy), 0.0 - unit * h * load.n


@kernel
def hang_on_ground(ground, kite, load, length, axial_stiffness, friction, plane, guess):
    """Forces of the tether on its ground end and on its kite end [N], length on the ground [m], number of tensions tried.

    guess : tension vector at the lowest point of the tether, without the ground [N].  Other arguments : see `scene_of`.
    The number is -1 if none was found.
    """
    scene, size, kite_is_low = scene_of(ground, kite, load, length, axial_stiffness, friction, plane)
    unit = size * length
    tension, ex, ey, parts, tried = lie(scene, norm(guess) / unit)
    behind = parts.low_tension
    high = pull_of(tension * ex, tension * ey, parts.high, unit, scene)
    low = pull_of(-behind * ex, -behind * ey, parts.low, unit, scene)
    if kite_is_low:
        low, high = high, low
    return low, high, length * parts.lying, tried
