"""Load continuation: a chain whose loads stretch it to several times its length, from its equilibrium under smaller ones.

Where drag stretches a tether, it sweeps more air with nodes that are farther out and faster, so that drag grows again. The
first guess knows the loads of the straight line only, and Newton's method does not get there from it. At a load level p the
wind, the velocities of the ends, omega and s are p times the given ones, and drag and inertia p^2 times. From the
equilibrium at a lower level (`solve.find` looks for one at 1/2, 1/4, 1/8) the level is raised to 1, and each equilibrium is
the start of the next one.

Where the equilibria end at a level below 1, however fine its steps, there is none: drag that grows with the square of the
distance from the ground end outgrows tension, which grows linearly.
"""

from ..arrays import copy
from ..compilation import kernel, view
from ..equations.properties import chain_at, has_node_winds, scale_node_winds
from ..linear_algebra.vectors import put, scale
from . import newton
from .rigid_body import Body

LOWEST = 0.125  # level below which no start is sought
FIRST_RISE, STEEPEST_RISE = 0.1, 0.3  # of the level from one equilibrium to the next, relative; at the start, and at most
GENTLEST_RISE = 1e-3  # below it, the equilibria have come to an end
STEEPER = 1.5  # rise over the last one, if that found an equilibrium; else half of it
MOST_LEVELS = 60  # that are tried; it needs 4 to 14


@view
def at_level(body, level, w):
    """The body in a wind and with a spin and an extension rate `level` times its own (w.parameters modified)."""
    chain = body.chain
    copy(chain.parameters, w.parameters)
    if has_node_winds(chain):
        scale_node_winds(chain.n, level, w.parameters)
    slower = chain_at(chain.n, w.parameters, chain.length, chain.reeling, scale(level, chain.wind))
    return Body(slower, scale(level, body.spin), level * body.extension_rate, body.x, body.v, *body[5:])


@kernel
def put_end_velocities(body, level, ground, kite):
    """Put `level` times the velocities of the ground end and of the kite [m/s] into the body (modified)."""
    put(body.v, 0, scale(level, ground))
    put(body.v, body.chain.n, scale(level, kite))


@kernel
def raise_level(body, level, ground, kite, w):
    """Lead the equilibrium of a level in the body and in w.tension (both modified) towards the level 1.

    Velocities of the ends at the level 1 [m/s]. Returns the level that it has come to, and the number of Newton iterations.
    """
    newton.keep(body, w)
    rise = FIRST_RISE
    iterations = 0
    for _ in range(MOST_LEVELS):
        higher = min(1.0, (1.0 + rise) * level)
        put_end_velocities(body, higher, ground, kite)
        found, more = newton.relax_kept(at_level(body, higher, w), False, False, 0.0, w)
        iterations += more
        if found:
            level = higher
            newton.keep(body, w)
            rise = min(STEEPER * rise, STEEPEST_RISE)
        else:
            rise *= 0.5
        if level == 1.0 or rise < GENTLEST_RISE:
            break
    return level, iterations
