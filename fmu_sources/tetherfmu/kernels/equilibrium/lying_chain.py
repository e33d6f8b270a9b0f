"""A chain that lies on the ground where without it the equilibrium would hang below.

Ground continuation: from the equilibrium without ground over ever stiffer grounds, the first so soft that it lets the lowest
node sink to where it hangs, the last the ground itself. Each equilibrium is the start of the next one.

A chain that is longer than its ends' heights and their horizontal distance together has no tension where it lies, and any
curve on the ground is an equilibrium: the continuation then ends in a chain in compression, or nowhere. The first guess of
`pile` hangs straight down from both ends, and lies in two straight legs between the two feet; pseudo-transient continuation
from there leaves them alone. Source: docs/models/numerics.md, "Initial shape".
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel, view
from ..equations import segment
from ..equations.ground import softer
from ..equations.properties import property_of
from ..linear_algebra.vectors import get, put, sub
from . import newton
from .rigid_body import Body, spring

FIRST_STEP, LARGEST_STEP, SMALLEST_STEP, GROWTH = 3.0, 10.0, 1.01, 1.5  # factor from one stiffness of the ground to the next
MOST_GROUNDS = 60  # that are tried; it needs 5 to 15
PRESSED = 1e-3  # compression of a segment that lies over the weight of the chain, above which the chain is piled up
TAUT = 1e-6  # strain of the legs of the first guess


@view
def on(body, ground):
    """The body on another `Ground`."""
    return Body(body.chain, body.spin, body.extension_rate, body.x, body.v, ground)


@kernel
def deepest(body):
    """How far below the ground the lowest inner node is [m]; 0 if none is."""
    depth = 0.0
    for i in range(1, body.chain.n):
        depth = max(depth, body.ground.height - body.x[3 * i + 2])
    return depth


@kernel
def weight_of(body, w):
    """Weight of the chain [N]."""
    weight = 0.0
    for i in range(body.chain.n + 1):
        weight += w.mass[i] * body.chain.gravity
    return weight


@kernel
def is_pressed(body, w):
    """Whether a segment on the ground is in compression."""
    chain, weight = body.chain, weight_of(body, w)
    for s in range(1, chain.n - 1):
        x_p, x_q = get(body.x, s), get(body.x, s + 1)
        if max(x_p[2], x_q[2]) < body.ground.height:
            length, _ = segment.geometry(sub(x_q, x_p))
            elongation, k = spring(chain, s, length, False)
            if k * elongation < -PRESSED * weight:
                return True
    return False


@kernel
def relax(body, w):
    """Newton's method from w.kept and w.kept_tension with the stiffnesses, then the compliances: (found, iterations)."""
    iterations = 0
    for compliant in (False, True):
        copy(w.kept, body.x)
        copy(w.kept_tension, w.tension)
        found, more = newton.relax(body, compliant, False, 0.0, w)
        iterations += more
        if found:
            return True, iterations
    return False, iterations


@kernel
def by_ground_continuation(body, w):
    """From the equilibrium without ground in the body (modified) to that on its ground: (found, Newton iterations)."""
    copy(body.x, w.kept)
    copy(w.tension, w.kept_tension)
    level = min(1.0, body.chain.gravity / (deepest(body) * body.ground.hardness))  # stiffness over that of the ground
    reached, factor, iterations = 0.0, FIRST_STEP, 0
    for _ in range(MOST_GROUNDS):
        found, more = relax(on(body, softer(body.ground, level)), w)
        iterations += more
        if found:
            if level == 1.0:
                return True, iterations
            reached, factor = level, min(LARGEST_STEP, factor * GROWTH)
            copy(body.x, w.kept)
            copy(w.tension, w.kept_tension)
        else:
            factor = sqrt(factor)
            if reached == 0.0 or factor < SMALLEST_STEP:
                break
        level = min(1.0, factor * reached)
    return False, iterations


@kernel
def by_piling(body, w):
    """From the first guess of a chain with too much length: (found, iterations)."""
    if not pile(body, w):
        return False, 0
    return newton.relax(body, False, True, weight_of(body, w) / body.chain.length, w)


@kernel
def find(body, w):
    """From the equilibrium without ground in the body (modified) to one on the ground: (found, Newton iterations)."""
    found, iterations = by_ground_continuation(body, w)
    if found and not is_pressed(body, w):
        return True, iterations
    found, more = by_piling(body, w)
    return found, iterations + more


@kernel
def pile(body, w):
    """First guess of a chain with too much length (positions and w.tension modified); False if it has not.

    Straight down from the ends, and between the feet in two equal legs, to the left of the way to the kite.
    """
    chain, x = body.chain, body.x
    height, weight = body.ground.height, chain.gravity * property_of(chain, 0, at.LINE_DENSITY)
    start, end = get(x, 0), get(x, chain.n)
    first, last = max(0.0, start[2] - height), max(0.0, end[2] - height)  # lengths that hang
    across, along = sub(end, start), 0.0
    chord = sqrt(across[0] * across[0] + across[1] * across[1])
    lying = chain.length - first - last
    if not lying > chord:
        return False
    e = (across[0] / chord, across[1] / chord) if chord > 0.0 else (1.0, 0.0)
    aside = sqrt(lying * lying - chord * chord)
    depth = chain.gravity / body.ground.hardness
    for s in range(chain.n):
        along += property_of(chain, s, at.SHARE) * chain.length
        from_end = chain.length - along
        w.tension[s] = TAUT * weight
        if s == chain.n - 1:
            break
        if along < first:
            put(x, s + 1, (start[0], start[1], start[2] - along))
        elif from_end < last:
            put(x, s + 1, (end[0], end[1], end[2] - from_end))
        else:
            part = (1.0 + TAUT) * (along - first) / lying
            forwards, left = part * chord, min(part, 1.0 - part) * aside
            put(x, s + 1, (start[0] + forwards * e[0] - left * e[1], start[1] + forwards * e[1] + left * e[0], height - depth))
    return True
