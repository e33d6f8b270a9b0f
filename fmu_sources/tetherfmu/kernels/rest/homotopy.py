"""Continuation: an equilibrium where there is one at hand, led by one number, its level, to the level 1, where it is sought.

Each equilibrium is the start of the next one. The ratio of a level to the one before grows while Newton's method
succeeds; where it fails, the root of it is tried. What the level p is:

LOADS : wind, velocities of the ends, omega and s are p times the given ones; drag and inertia p^2 times. Where drag
    stretches a tether, it sweeps more air with nodes that are farther out and faster, so that drag grows again; the first
    guess knows the loads of the straight line only. Where the equilibria end at a level below 1, however fine its steps,
    there is none: drag that grows with the square of the distance from the ground end outgrows tension, which grows
    linearly.
STIFFNESS : all EA are p times the given ones. Where both ends are almost together, or weight is next to nothing, the chain
    hangs in a fold whose segments hardly feel a tension, while the least error of a position presses or pulls them with many
    times their load. What remains of the chain without that is its shape, and it is almost the same at a smaller stiffness.
LAYER : the wind grows linearly in a layer above z = 0 (`air.py`), `THINNEST`/p thick. Below z = 0 there is none, just above
    the power law (z/h)^alpha has most of it: at 1 mm, with an exponent of 0.08 and h = 6 m, half. A segment at that height
    is lifted where it has wind, and sinks where it has none: Newton's method moves it up and down without end, and the
    equilibrium may need a height above 0 that is less than the rounding error of a position. If a segment is in the
    thinnest layer in the end, it has between none and all of the wind there.
GROUND : p times the stiffness of the ground, the first so small that the lowest node sinks to where it hangs.

Where a segment snaps aside or out of the layer, the next equilibrium is not near: pseudo-transient continuation follows it.
Source: docs/models/numerics.md, "Initial shape".
"""

from math import sqrt

import numpy as np

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel, view
from ..equations.ground import softer
from ..equations.properties import chain_at, has_node_winds, property_of, put_property, scale_node_winds
from ..linear_algebra.vectors import get, put, scale
from . import newton
from .rigid_body import Body

LOADS, STIFFNESS, LAYER, GROUND = range(4)
FIRST = np.array((1.1, 10.0, 2.0, 4.5))  # ratio of a level to the one before, at the start
GROWTH, LESS = 1.5, np.array((0.5, 0.0, 0.0, 0.0))  # factor on the ratio after an equilibrium, and what is taken off
LARGEST = np.array((1.3, 10.0, 10.0, 10.0))  # at most
SMALLEST = np.array((1.001, 1.5, 1.05, 1.01))  # below it, the equilibria have come to an end
SNAPPING = 2.0  # ratio below which the next equilibrium may not be near
MOST_LEVELS = 60  # that are tried; it needs 3 to 30
THINNEST = 1e-3  # layer [m] in the end


@view
def at_level(kind, body, level, w):
    """The body at a level of a continuation (w.parameters modified, w.velocity if the loads are continued)."""
    chain, ground, v = body.chain, body.ground, body.v
    wind, spin, extension_rate = chain.wind, body.spin, body.extension_rate
    copy(chain.parameters, w.parameters)
    if kind == LOADS:
        if has_node_winds(chain):
            scale_node_winds(chain.n, level, w.parameters)
        wind, spin, extension_rate, v = scale(level, wind), scale(level, spin), level * extension_rate, w.velocity
        put(v, 0, scale(level, get(body.v, 0)))
        put(v, chain.n, scale(level, get(body.v, chain.n)))
    elif kind == STIFFNESS:
        for s in range(chain.n):
            put_property(chain.n, at.STIFFNESS, s, level * property_of(chain, s, at.STIFFNESS), w.parameters)
    elif kind == LAYER:
        w.parameters[at.CALM_LAYER] = THINNEST / level
    else:
        ground = softer(ground, level)
    other = chain_at(chain.n, w.parameters, chain.length, chain.reeling, wind)
    return Body(other, spin, extension_rate, body.x, v, ground, body.anchor, body.is_piled)


@kernel
def relax_at(kind, body, level, is_slow, change, load_stiffness, w):
    """Equilibrium at a level from that in w.kept and w.kept_tension: (found, Newton iterations).

    is_slow : whether by pseudo-transient homotopy.  change : of the place of the equilibrium, over w.load.
    load_stiffness : see `newton.relax`.
    """
    other = at_level(kind, body, level, w)
    iterations = 0
    for step in (newton.STIFFNESSES, newton.EITHER_SIGN if is_slow else newton.COMPLIANCES):
        newton.restore(body, w)
        if not is_slow:
            for k in range(len(w.load)):
                body.x[k] += change * w.load[k]
        found, more = newton.relax(other, step, is_slow, load_stiffness, w)
        iterations += more
        if found:
            return True, iterations
    return False, iterations


@kernel
def lead(kind, body, level, load_stiffness, most, w):
    """Lead the equilibrium at a level, in the body and in w.tension (both modified), towards the level 1.

    load_stiffness : stiffness [N/m] that the loads alone give a node; 0: by Newton's method alone.
    most : Newton iterations after which it ends.
    Returns whether the level 1 has been reached, and the number of Newton iterations. The last equilibrium is in w.kept and
    w.kept_tension, too.
    """
    newton.keep(body, w)
    clear(w.load)
    ratio = FIRST[kind]
    iterations = 0
    for _ in range(MOST_LEVELS):
        if level >= 1.0 or ratio < SMALLEST[kind] or iterations >= most:
            break
        higher = min(1.0, ratio * level)
        change = 1.0 / higher - 1.0 / level
        found, more = relax_at(kind, body, higher, False, change, load_stiffness, w)
        iterations += more
        is_slow = not found and load_stiffness > 0.0 and ratio < SNAPPING
        if is_slow:
            found, more = relax_at(kind, body, higher, True, change, load_stiffness, w)
            iterations += more
        if found:
            for k in range(len(w.load)):
                w.load[k] = 0.0 if is_slow or kind != LAYER else (body.x[k] - w.kept[k]) / change
            level = higher
            newton.keep(body, w)
            ratio = min(LARGEST[kind], GROWTH * ratio - LESS[kind])
        else:
            ratio = sqrt(ratio)
    return level >= 1.0, iterations
