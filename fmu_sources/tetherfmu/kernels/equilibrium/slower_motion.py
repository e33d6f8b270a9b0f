"""Equilibrium of a chain whose loads stretch it to several times its length: led to it from that of a slower motion.

Where drag stretches a tether, it sweeps more air with nodes that are farther out and faster, so that drag grows again. The
hanging chain of `newton.py` knows the loads of the straight line only, and Newton's method does not get there from it. At a
pace p the wind, the velocities of the ends, omega and s are p times the given ones, and drag and inertia p^2 times. From the
equilibrium at p = 1/2 (or 1/4, 1/8) the pace is raised to 1, and each equilibrium is the start of the next one.

Where the equilibria end at a pace below 1, however fine its steps, there is none: drag that grows with the square of the
distance from the ground end outgrows tension, which grows linearly.
"""

from tetherfmu.runtime.status import OK

from ..algebra.vectors import get, put, scale
from ..arrays import copy
from ..chain.properties import chain_at
from ..compilation import kernel, view
from . import newton, strut, turn

SLOWEST = 0.125  # pace below which no start is sought
FIRST_RISE, STEEPEST_RISE = 0.1, 0.3  # of the pace from one equilibrium to the next, relative; at the start, and at most
GENTLEST_RISE = 1e-3  # below it, the equilibria have come to an end
STEEPER = 1.5  # rise over the last one, if that found an equilibrium; else half of it
MOST_PACES = 60  # that are tried; it needs 4 to 14


@view
def at_pace(body, pace):
    """The body in a wind and with a spin and a rate of stretch `pace` times its own; wind that is given at nodes stays."""
    chain = body.chain
    slower = chain_at(chain.n, chain.parameters, chain.length, chain.reeling, scale(pace, chain.wind))
    return newton.Body(slower, scale(pace, body.spin), pace * body.stretching, body.x, body.v)


@kernel
def relax(body, pace, w):
    """Newton's method from the equilibrium in w.kept and w.kept_tension, at a pace: (found, iterations).

    Positions of the body [m] and w.tension [N] are modified; velocities of its ends [m/s] are those of the pace.
    """
    slower = at_pace(body, pace)
    iterations = 0
    for compliant in (False, True):
        copy(w.kept, body.x)
        copy(w.kept_tension, w.tension)
        found, more = newton.relax(slower, compliant, False, 0.0, w)
        iterations += more
        if found:
            return True, iterations
    return False, iterations


@kernel
def put_end_velocities(body, pace, ground, kite):
    """Put `pace` times the velocities of the ground end and of the kite [m/s] into the body (modified)."""
    put(body.v, 0, scale(pace, ground))
    put(body.v, body.chain.n, scale(pace, kite))


@kernel
def find_slower(body, ground, kite, w):
    """Equilibrium at the largest of the paces 1/2, 1/4, ... that has one: the pace (0: none found), iterations.

    Velocities of the ends at the pace 1 [m/s]. The body gets positions and velocities of that pace.
    """
    iterations = 0
    pace = 0.5
    while pace >= SLOWEST:
        put_end_velocities(body, pace, ground, kite)
        status, more = newton.find(at_pace(body, pace), w)
        iterations += more
        if status == OK:
            return pace, iterations
        pace *= 0.5
    return 0.0, iterations


@kernel
def raise_pace(body, pace, ground, kite, w):
    """Lead the equilibrium of a pace in the body and in w.tension (both modified) towards the pace 1.

    Velocities of the ends at the pace 1 [m/s]. Returns the pace that it has come to, and the number of Newton iterations.
    """
    copy(body.x, w.kept)
    copy(w.tension, w.kept_tension)
    rise = FIRST_RISE
    iterations = 0
    for _ in range(MOST_PACES):
        faster = min(1.0, (1.0 + rise) * pace)
        put_end_velocities(body, faster, ground, kite)
        found, more = relax(body, faster, w)
        iterations += more
        if found:
            pace = faster
            copy(body.x, w.kept)
            copy(w.tension, w.kept_tension)
            rise = min(STEEPER * rise, STEEPEST_RISE)
        else:
            rise *= 0.5
        if pace == 1.0 or rise < GENTLEST_RISE:
            break
    return pace, iterations


@kernel
def find(body, w):
    """As `newton.find`, and where that finds nothing, from the equilibrium of a slower motion, then as `turn.find`.

    Returns a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations.
    """
    status, iterations = newton.find(body, w)
    if status == OK:
        return OK, iterations
    ground, kite = get(body.v, 0), get(body.v, body.chain.n)
    pace, more = find_slower(body, ground, kite, w)
    iterations += more
    if pace > 0.0:
        pace, more = raise_pace(body, pace, ground, kite, w)
        iterations += more
    put(body.v, 0, ground)
    put(body.v, body.chain.n, kite)
    if pace == 1.0 and not strut.is_strut(body.chain, body.x, strut.PARALLEL):
        return OK, iterations
    status, more = turn.find(body, w)
    return status, iterations + more
