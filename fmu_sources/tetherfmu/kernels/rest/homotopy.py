"""Continuation: from an equilibrium that is easy to solve to the required one, by one number, its level, up to 1.

Each equilibrium is the start of the next one. The ratio of successive levels grows while Newton's method
succeeds; if it fails, the square root of the ratio is tried. The level p means:

LOADS : wind, end velocities, omega and s are multiplied by p; drag and inertia by p^2. Drag that
    stretches a tether exposes more of it to faster air, so drag grows again; the first
    guess includes the loads of the straight line only. If the equilibria end at a level below 1, however fine the steps,
    there is none: drag that grows with the square of the distance from the ground end outgrows tension, which grows
    linearly.
STIFFNESS : all EA are multiplied by p. If both ends almost coincide, or the weight is almost zero, the chain
    hangs in a fold with hardly any tension, while the smallest position error loads its segments with many
    times their load. The shape that remains is almost the same at a smaller stiffness.
LAYER : the wind grows linearly in a layer above z = 0 (`air.py`), `THINNEST`/p thick. It is zero below z = 0, but
    the power law (z/h)^alpha rises steeply just above: to half at 1 mm, with an exponent of 0.08 and h = 6 m. A segment at
    that height is lifted in the wind and sinks without it: Newton's method moves it up and down without end, and the
    equilibrium may need a height above 0 that is less than the rounding error of a position. A segment that finally is
    in the thinnest layer is exposed to between none and all of the wind there.
GROUND : the ground stiffness is multiplied by p, initially so small that the lowest node sinks to its hanging position.

If a segment snaps aside or out of the layer, the next equilibrium is not near: pseudo-transient continuation follows it.
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
GROWTH, LESS = 1.5, np.array((0.5, 0.0, 0.0, 0.0))  # factor on the ratio after an equilibrium, and subtrahend
LARGEST = np.array((1.3, 10.0, 10.0, 10.0))  # at most
SMALLEST = np.array((1.001, 1.5, 1.05, 1.01))  # below it, there are no further equilibria
SNAPPING = 2.0  # ratio below which the next equilibrium may not be near
MOST_LEVELS = 60  # maximum; 3 to 30 suffice
THINNEST = 1e-3  # final layer [m]


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
    """Equilibrium at a level from the one in w.kept and w.kept_tension: (found, Newton iterations).

    is_slow : whether by pseudo-transient homotopy.  change : displacement of the equilibrium, over w.load.
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
    """Continue the equilibrium at a level, in the body and in w.tension (both modified), towards level 1.

    load_stiffness : stiffness [N/m] of a node due to the loads alone; 0: by Newton's method alone.
    most : limit of Newton iterations.
    Returns whether level 1 was reached, and the number of Newton iterations. w.kept and w.kept_tension contain the last
    equilibrium, too.
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
