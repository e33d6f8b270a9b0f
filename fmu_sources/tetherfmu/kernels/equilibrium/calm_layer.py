"""A tether with a segment at z = 0, where the wind begins, from its equilibrium in air where it grows gradually.

Below z = 0 there is no wind, just above it the power law (z/h)^alpha has most of it: at 1 mm, with an exponent of 0.08 and
h = 6 m, half. A segment at that height is lifted where it has wind, and sinks where it has none: Newton's method moves it up
and down without end, and the equilibrium may need a height above 0 that is less than the rounding error of a position.

So the wind grows linearly in a layer above z = 0 (`air.py`), first as thick as a segment is long, in which the ladder finds
the equilibrium. Then the layer gets thinner, down to `THINNEST`, and each equilibrium is the start of the next one: moved on
as from the one before to it, since the segment stays in the layer. Where a segment snaps out of the layer, or segments come
to its edge and Newton's method moves them to and fro, pseudo-transient continuation follows them. If a segment is in the
thinnest layer in the end, it has between none and all of the wind there; if none is, the equilibrium is one without a layer.
Source: docs/models/numerics.md, "Initial shape".
"""

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel, view
from ..equations.properties import chain_at
from . import compressed_segments, newton
from .rigid_body import Body

THINNEST = 1e-3  # layer [m] in the end
FIRST_FACTOR, SMALLEST_FACTOR = 0.5, 0.1  # of the thickness from one equilibrium to the next: at the start, and at least
SNAPPING_FACTOR = 0.7  # above it, the next equilibrium may not be near
LARGEST_FACTOR = 0.95  # beyond it, the equilibria have come to an end
MOST_LAYERS = 40  # that are tried; it needs 10 to 30


@kernel
def thickest(body):
    """Thickness [m] of the first layer: the length of a segment."""
    return max(body.chain.length / body.chain.n, THINNEST)


@view
def in_layer(body, thickness, w):
    """The body in air with a calm layer of this thickness [m] (w.parameters modified)."""
    chain = body.chain
    copy(chain.parameters, w.parameters)
    w.parameters[at.CALM_LAYER] = thickness
    other = chain_at(chain.n, w.parameters, chain.length, chain.reeling, chain.wind)
    return Body(other, body.spin, body.extension_rate, body.x, body.v, *body[5:])


@kernel
def relax(body, thickness, change, w):
    """Newton's method with a layer of this thickness [m]: (found, iterations).

    It starts from w.kept [m], moved by the change of the thickness [m] times w.load, and from w.kept_tension. Positions of
    the body [m] and w.tension [N] are modified.
    """
    other = in_layer(body, thickness, w)
    iterations = 0
    for compliant in (False, True):
        for k in range(len(w.kept)):
            body.x[k] = w.kept[k] + change * w.load[k]
        copy(w.kept_tension, w.tension)
        found, more = newton.relax(other, compliant, False, 0.0, w)
        iterations += more
        if found:
            return True, iterations
    return False, iterations


@kernel
def relax_slowly(body, thickness, load_stiffness, w):
    """The same by pseudo-transient continuation from w.kept [m] and w.kept_tension [N].

    load_stiffness : stiffness [N/m] that the loads alone give a node.
    """
    other = in_layer(body, thickness, w)
    newton.restore(body, w)
    found, iterations = newton.relax(other, False, True, load_stiffness, w)
    if not found:
        newton.restore(body, w)
        found, more = compressed_segments.relax(other, load_stiffness, w)
        iterations += more
    return found, iterations


@kernel
def thin(body, thickness, load_stiffness, most, w):
    """Lead the equilibrium in a layer [m], in the body and in w.tension (both modified), to that in the thinnest one.

    load_stiffness : stiffness [N/m] that the loads alone give a node; 0: by Newton's method alone.
    most : Newton iterations after which it ends.
    w.load (modified) : motion of each node over the change of the thickness.
    Returns whether it has been found, and the number of Newton iterations.
    """
    newton.keep(body, w)
    for k in range(len(w.load)):
        w.load[k] = 0.0
    factor = FIRST_FACTOR
    iterations = 0
    for _ in range(MOST_LAYERS):
        if thickness <= THINNEST or factor > LARGEST_FACTOR or iterations >= most:
            break
        thinner = max(factor * thickness, THINNEST)
        change = thinner - thickness
        found, more = relax(body, thinner, change, w)
        iterations += more
        foreseen = found
        if not found and load_stiffness > 0.0 and factor > SNAPPING_FACTOR:
            found, more = relax_slowly(body, thinner, load_stiffness, w)
            iterations += more
        if found:
            for k in range(len(w.load)):
                w.load[k] = (body.x[k] - w.kept[k]) / change if foreseen else 0.0
            newton.keep(body, w)
            thickness = thinner
            factor = max(SMALLEST_FACTOR, factor * factor)
        else:
            factor = 0.5 * (1.0 + factor)
    return thickness <= THINNEST, iterations
