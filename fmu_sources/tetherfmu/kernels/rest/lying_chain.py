"""A chain that lies on the ground where it would otherwise hang below it.

The equilibrium without ground is continued over ever stiffer grounds (`homotopy.GROUND`).

A chain longer than the heights of its ends plus their horizontal distance has no tension on the ground, and any
curve on the ground is an equilibrium: the continuation then ends in a compressed chain, or fails. `pile` constructs one of
these equilibria, and load continuation adapts it to the wind. Such a pile does not turn with the kite; friction keeps it at
its initial position. Source: docs/models/numerics.md, "Initial shape".
"""

from math import inf, pi, sqrt

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel, view
from ..equations import segment
from ..equations.ground import carries
from ..equations.properties import point_mass, property_of, rest_length
from ..linear_algebra.vectors import ZERO_VECTOR, get, put, sub
from . import homotopy, newton
from .rigid_body import Body

LIGHTEST = 0.125  # level of the loads for the first equilibrium of a pile
MOST_COMPRESSION = 1e-3  # compression of a lying segment over the chain's weight that rules out a solution
MOST_TIGHTENED = 2.0  # tension on the ground over tension without ground plus all friction
LONG, FEW = 1.2, 4.0  # length on the ground of a far too long chain: over the distance of the feet, in segments
HALVINGS = 60  # of the interval for the curvature of an arc


@view
def on(body, ground):
    """A copy of the body on another `Ground`."""
    return Body(body.chain, body.spin, body.extension_rate, body.x, body.v, ground, body.anchor, False)


@kernel
def deepest(body):
    """Depth [m] of the lowest inner node below the ground; 0 if none is."""
    depth = 0.0
    for i in range(1, body.chain.n):
        depth = max(depth, body.ground.height - body.x[3 * i + 2])
    return depth


@kernel
def weight_of(body, w):
    """Weight of the chain [N], without point masses at its ends."""
    n = body.chain.n
    mass = -point_mass(body.chain, 0) - point_mass(body.chain, n)
    for i in range(n + 1):
        mass += w.mass[i]
    return mass * body.chain.gravity


@kernel
def is_compressed(body, w):
    """Whether a segment with a node on the ground is in compression."""
    chain, weight = body.chain, weight_of(body, w)
    for s in range(chain.n):
        x_p, x_q = get(body.x, s), get(body.x, s + 1)
        if (s > 0 and carries(body.ground, x_p)) or (s < chain.n - 1 and carries(body.ground, x_q)):
            length, _ = segment.geometry(sub(x_q, x_p))
            if segment.spring_tension(chain, s, length) < -MOST_COMPRESSION * weight:
                return True
    return False


@kernel
def by_sinking(body, w):
    """From the equilibrium without ground in the body (modified) to the one on its ground: (found, Newton iterations)."""
    newton.keep(body, w)
    softest = min(1.0, body.chain.gravity / (deepest(body) * body.ground.hardness))
    found, iterations = homotopy.relax_at(homotopy.GROUND, body, softest, False, 0.0, 0.0, w)
    if found:
        found, more = homotopy.lead(homotopy.GROUND, body, softest, 0.0, inf, w)
        iterations += more
    if not found:
        found, more = slowly(body, w)
        iterations += more
    return found, iterations


@kernel
def slowly(body, w):
    """Pseudo-transient continuation from the shape in w.kept and w.kept_tension: (found, Newton iterations)."""
    newton.restore(body, w)
    return newton.relax(body, newton.STIFFNESSES, True, weight_of(body, w) / body.chain.length, w)


@kernel
def by_piling(body, level, w):
    """From the first guess of an overlong chain: (found, iterations).

    level : initial level of the load continuation.
    """
    if not pile(body, w):
        return False, 0
    copy(body.x, w.anchor)
    still = Body(body.chain, ZERO_VECTOR, 0.0, body.x, body.v, body.ground, w.anchor, True)
    lighter = homotopy.at_level(homotopy.LOADS, still, level, w)
    stiffness = weight_of(body, w) / body.chain.length
    found, iterations = newton.relax(lighter, newton.STIFFNESSES, True, stiffness, w)
    if found and level < 1.0:
        found, more = homotopy.lead(homotopy.LOADS, still, level, 0.0, inf, w)
        iterations += more
    return found, iterations


@kernel
def is_long(body):
    """Whether the chain on the ground is far longer than the distance of its feet: no turning draws it tight."""
    start, end, height = get(body.x, 0), get(body.x, body.chain.n), body.ground.height
    lying = body.chain.length - max(0.0, start[2] - height) - max(0.0, end[2] - height)
    across = sub(end, start)
    chord = sqrt(across[0] * across[0] + across[1] * across[1])
    return lying > LONG * chord + FEW * body.chain.length / body.chain.n


@kernel
def largest(tension):
    """The largest of several tensions [N]."""
    most = 0.0
    for s in range(len(tension)):
        most = max(most, tension[s])
    return most


@kernel
def find(body, hangs, w):
    """An equilibrium on the ground: (found, Newton iterations); hangs : whether the body is at rest without ground."""
    copy(body.x, w.hung)
    copy(w.tension, w.hung_tension)
    found, iterations = False, 0
    if is_long(body):
        found, iterations = by_piling(body, LIGHTEST, w)
    if not found and hangs:
        copy(w.hung, body.x)
        copy(w.hung_tension, w.tension)
        found, more = by_sinking(body, w)
        iterations += more
        # friction adds at most its share of the weight; a turning chain may find another, distant equilibrium
        friction = body.ground.friction * weight_of(body, w)
        found = found and not is_compressed(body, w)
        found = found and largest(w.tension) <= MOST_TIGHTENED * (largest(w.hung_tension) + friction)
    for level in (1.0, LIGHTEST):
        if not found:
            found, more = by_piling(body, level, w)
            iterations += more
    return found, iterations


@kernel
def hanging_nodes(body, end, way, w):
    """Number of inner nodes that hang straight down from an end, and the height [m] of the lowest of them, or of the end.

    end : its node.  way : 1 from the ground end, -1 from the kite.
    """
    chain, top = body.chain, body.x[3 * end + 2] - body.ground.height
    lowest, length = top, 0.0
    count = 0
    while count < chain.n - 1:
        s = end + count if way > 0 else end - count - 1
        length += rest_length(chain, s)
        if top - length <= 0.0:
            break
        count += 1
    while count > 0:
        lowest = lower(body, end, way, count, w)
        if lowest > 0.0:
            break
        count -= 1
    return count, lowest if count > 0 else top


@kernel
def lower(body, end, way, count, w):
    """Hang `count` inner nodes straight down from an end (modified): height [m] of the lowest above the ground."""
    chain, x = body.chain, body.x
    pull = 0.0
    for k in range(count):
        pull += w.mass[end + way * (k + 1)] * chain.gravity
    below = get(x, end)
    for k in range(count):
        s = end + k if way > 0 else end - k - 1
        w.tension[s] = pull
        stretched = rest_length(chain, s) * (1.0 + pull / property_of(chain, s, at.STIFFNESS))
        below = below[0], below[1], below[2] - stretched
        put(x, end + way * (k + 1), below)
        pull -= w.mass[end + way * (k + 1)] * chain.gravity
    return below[2] - body.ground.height


@kernel
def turned(e, sine):
    """Direction (x, y) turned to the right by an angle of at most pi/2 with this sine."""
    cosine = sqrt(1.0 - sine * sine)
    return cosine * e[0] + sine * e[1], cosine * e[1] - sine * e[0]


@kernel
def lay(body, first, last, curvature, e):
    """Place the nodes after `first` up to `last` (modified) as a polygon in a circle of this curvature [1/m].

    e : initial direction (x, y) of the circle, which bends to the right. Returns the vector from the first to the last
    node (x, y) [m], and whether the circle is more than closed.
    """
    chain, start = body.chain, get(body.x, first)
    x = y = 0.0
    now = e
    turns_back = False
    for s in range(first, last):
        rest = rest_length(chain, s)
        sine = min(1.0, 0.5 * rest * curvature)
        now = turned(now, sine)
        turns_back = turns_back or e[0] * now[1] - e[1] * now[0] > 0.0
        x, y = x + rest * now[0], y + rest * now[1]
        put(body.x, s + 1, (start[0] + x, start[1] + y, start[2]))
        now = turned(now, sine)
    return (x, y), turns_back and e[0] * now[1] - e[1] * now[0] < 0.0


@kernel
def lay_between(body, first, last):
    """Place the nodes between `first` and `last` (modified) on a circular arc through both, all unstretched."""
    start, end = get(body.x, first), get(body.x, last)
    goal = end[0] - start[0], end[1] - start[1]
    chord = sqrt(goal[0] * goal[0] + goal[1] * goal[1])
    arc = 0.0
    for s in range(first, last):
        arc += rest_length(body.chain, s)
    low, high = 0.0, 2.0 * pi / arc
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        way, is_closed = lay(body, first, last, middle, (1.0, 0.0))
        if is_closed or way[0] * way[0] + way[1] * way[1] < chord * chord:
            high = middle
        else:
            low = middle
    way, _ = lay(body, first, last, low, (1.0, 0.0))
    square = way[0] * way[0] + way[1] * way[1]
    if chord > 0.0 and square > 0.0:  # rotate it to its end point
        size = 1.0 / sqrt(square * chord * chord)
        e = (way[0] * goal[0] + way[1] * goal[1]) * size, (way[0] * goal[1] - way[1] * goal[0]) * size
        lay(body, first, last, low, e)
    put(body.x, last, end)


@kernel
def reach(body, s, lowest):
    """Horizontal reach [m] of segment s on the ground from a height [m] above it."""
    rest, depth = rest_length(body.chain, s), body.chain.gravity / body.ground.hardness
    return sqrt(max(0.0, rest * rest - (lowest + depth) ** 2))


@kernel
def foot(body, point, away, e):
    """Position [m] on the ground at a distance `away` [m] in the direction e (x, y) from below this point [m]."""
    depth = body.chain.gravity / body.ground.hardness
    return point[0] + away * e[0], point[1] + away * e[1], body.ground.height - depth


@kernel
def pile(body, w):
    """First guess of an overlong chain (positions and w.tension modified); False if it is not overlong.

    Straight down from the ends, and an unstretched circular arc on the ground: an equilibrium without
    wind and motion. The arc lies to the left of the direction to the kite.
    """
    chain, x = body.chain, body.x
    clear(w.tension)
    low, bottom = hanging_nodes(body, 0, 1, w)
    high, top = hanging_nodes(body, chain.n, -1, w)
    first, last = low + 1, chain.n - high - 1  # nodes on the ground
    if last < first:
        return False
    start, end = get(x, low), get(x, chain.n - high)
    across = end[0] - start[0], end[1] - start[1]
    chord = sqrt(across[0] * across[0] + across[1] * across[1])
    from_start, from_end = reach(body, low, bottom), reach(body, last, top)
    if from_start + from_end < chord:  # both point towards each other, else to the same side
        e = across[0] / chord, across[1] / chord
        back = -e[0], -e[1]
    else:
        e = back = (-across[1] / chord, across[0] / chord) if chord > 0.0 else (0.0, 1.0)
    put(x, first, foot(body, start, from_start, e))
    put(x, last, foot(body, end, from_end, back))
    if last - first < 2:
        return True
    arc = 0.0
    for s in range(first, last):
        arc += rest_length(chain, s)
    way = sub(get(x, last), get(x, first))
    if arc * arc <= way[0] * way[0] + way[1] * way[1]:
        return False
    lay_between(body, first, last)
    return True
