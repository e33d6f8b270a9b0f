"""Stiffness continuation: a slack chain that is very stiff for its loads, from its equilibrium when it is softer.

Where both ends are almost together, or where weight is next to nothing, the chain hangs in a fold whose segments hardly feel
a tension, while the least error of a position presses or pulls them with many times their load. What remains of the chain
without that is its shape, and it is almost the same at a smaller stiffness. So all EA are made smaller by one factor, with
which the mean load stretches the chain by `STRAINS`; there the ladder finds the equilibrium. Then they are raised to the
given ones, and each equilibrium is the start of the next one. Where a segment in the fold snaps aside, the next one is not
near: pseudo-transient continuation follows it there. Source: docs/models/numerics.md, "Initial shape".
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel, view
from ..equations.properties import chain_at, property_of, put_property
from . import newton
from .first_guess import axial_compliance
from .rigid_body import Body

STRAINS = (1e-2, 1e-3, 1e-1)  # load times length over EA at which the search begins, in this order
SMALLEST_RISE, LARGEST_RISE = 1.5, 10.0  # of the stiffness from one equilibrium to the next: below, it ends; and at most
SNAPPING_RISE = 2.0  # below it, the next equilibrium may not be near
MOST_RISES = 24  # that are tried; it needs 3 to 20


@kernel
def stiffness_factor(body, load, strain):
    """Factor on all EA at which a mean load per unstretched length [N/m] stretches the chain by `strain`; at most 1."""
    return min(1.0, load * body.chain.length * axial_compliance(body.chain) / strain)


@view
def softened(body, factor, w):
    """The body with this factor on all EA (w.parameters modified)."""
    chain = body.chain
    copy(chain.parameters, w.parameters)
    for s in range(chain.n):
        put_property(chain.n, at.STIFFNESS, s, factor * property_of(chain, s, at.STIFFNESS), w.parameters)
    other = chain_at(chain.n, w.parameters, chain.length, chain.reeling, chain.wind)
    return Body(other, body.spin, body.extension_rate, body.x, body.v, *body[5:])


@kernel
def stiffen(body, factor, load, most, w):
    """Lead the equilibrium with a factor on all EA, in the body and in w.tension (both modified), to that with the given EA.

    load : mean load per unstretched length [N/m].  most : Newton iterations after which it ends.
    Returns whether it has been found, and the number of Newton iterations.
    """
    newton.keep(body, w)
    rise = LARGEST_RISE
    iterations = 0
    for _ in range(MOST_RISES):
        if factor >= 1.0 or rise < SMALLEST_RISE or iterations >= most:
            break
        stiffer = min(1.0, rise * factor)
        other = softened(body, stiffer, w)
        found, more = newton.relax_kept(other, False, False, load, w)
        iterations += more
        if not found and rise < SNAPPING_RISE:  # with compliances first, which succeed more often
            found, more = newton.relax_kept(other, True, True, load, w)
            iterations += more
        if found:
            factor = stiffer
            newton.keep(body, w)
            rise = min(LARGEST_RISE, rise * rise)
        else:
            rise = sqrt(rise)
    return factor >= 1.0, iterations
