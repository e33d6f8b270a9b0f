"""A step of backward Euler with the drum of a winch: its speed u is found in the iteration of the chain.

    m (u - u0)/h + c u + W + F sign(u) = T,   L = L0 + h u,   F sign(0): any force from -F to F

T is the tension of the first segment at the end of the step. In each iteration the matrix A of the chain is solved for two
right-hand sides, minus the gradient g of Phi and its change with u:

    A p = -g,   A y = -dg/du,   r = m (u - u0)/h + c u + W - T,   P = dr/du - T_x y
    u' = the speed nearest to u - (r - T_x p)/P, by F/P nearer to 0 and within the stops;   move = p + (u' - u) y

The move is the direction of Newton's method for the potential with the new speed, and is shortened until that falls. So each
iteration descends as one of `backward_euler.py` does, and one factorization does for chain and drum. A drum that friction
holds, and one that is at a stop, is no case of its own. See docs/models/numerics.md, "A drum in the same system".
"""

from collections import namedtuple

from ..compilation import kernel
from ..equations.drum import force_at
from ..equations.properties import point_mass, sees_reeling
from ..linear_algebra.vectors import add, add_scaled, get, put, scale, sub
from . import incremental_potential

MOST_REELED = 0.1  # part of the length by which it changes in an iteration
LEAST_PIVOT = 1e-3  # of what P is where the chain does not yield

Trial = namedtuple("Trial", "drum time h length speed lowest highest")
Trial.__doc__ = """A step that is attempted.

drum : `Drum`.  time, h : its start within the communication step and its length [s].  length, speed : L0 [m], u0 [m/s].
lowest, highest : limits of the speed [m/s].
"""
Border = namedtuple("Border", "tension by_position by_speed lowest_pivot")
Border.__doc__ = """The equation of the drum in an iteration.

tension : T [N].  by_position : dT/dr of the first segment [N/m].  by_speed : dr/du [N s/m].  lowest_pivot : of P [N s/m].
"""
Workspace = namedtuple("Workspace", "steps column")
Workspace.__doc__ = """Scratch arrays of a step.

steps : `second_order.Workspace`.  column : -dg/du [N s/m], then y [s], 3 (n + 1) numbers.
"""


# --- one iteration


@kernel
def pull_by_speed(attempt, length, k, c, rate):
    """What the pull of a segment gains with u [N s/m]: along its direction, along `incremental_potential.slant_of`.

    Length [m], k [N/m], c [N s/m] and the rate that the damper sees [m/s].
    """
    chain = attempt.chain
    if sees_reeling(chain.parameters):
        shrinkage = incremental_potential.shrinkage(attempt)
        return -attempt.h / chain.length * (k * length + c * rate), -c * length * shrinkage / chain.length
    return -attempt.h / chain.length * k * length, -attempt.h / chain.length * c * rate


@kernel
def mass_by_speed(attempt, i, w):
    """What the mass of node i gains with u [kg s/m]."""
    chain = attempt.chain
    return attempt.h / chain.length * (w.mass[i] - point_mass(chain, i))


@kernel
def begin_column(attempt, w, column):
    """What the masses add to -dg/du at w.x into the column (modified)."""
    h = attempt.h
    for i in range(attempt.chain.n + 1):
        gained = mass_by_speed(attempt, i, w)
        put(column, i, scale(gained / (h * h), sub(get(w.free, i), get(w.x, i))))


@kernel
def add_load(attempt, i, mass, load, w, column):
    """What a load [N] on node i adds to -dg/du (modified), whose free flight depends on its whole mass [kg]."""
    put(column, i, add_scaled(get(column, i), -mass_by_speed(attempt, i, w) / mass, load))


@kernel
def add_pulls(attempt, w, column):
    """What springs and dampers add to -dg/du at w.x (modified)."""
    chain, b = attempt.chain, incremental_potential.shrinkage(attempt)
    for s in range(chain.n):
        length, e, _, k, c, rate, r0 = incremental_potential.segment_at(attempt, s, w.x, w)
        along, aslant = pull_by_speed(attempt, length, k, c, rate)
        pull = add(scale(along, e), scale(aslant, incremental_potential.slant_of(b, length, e, r0)))
        put(column, s, add(get(column, s), pull))
        put(column, s + 1, sub(get(column, s + 1), pull))


@kernel
def nearest_speed(trial, speed, pivot, friction):
    """A speed [m/s] drawn nearer to 0 by friction, and within the limits."""
    drawn = max(abs(speed) - friction / pivot, 0.0)
    return min(trial.highest, max(trial.lowest, drawn if speed > 0.0 else -drawn))


@kernel
def border_of(attempt, drum, w):
    """`Border` at w.x."""
    h, chain = attempt.h, attempt.chain
    length, e, rest, k, c, rate, r0 = incremental_potential.segment_at(attempt, 0, w.x, w)
    b = incremental_potential.shrinkage(attempt)
    by_position = add(scale(k, e), scale(c * b / h, incremental_potential.slant_of(b, length, e, r0)))
    along, aslant = pull_by_speed(attempt, length, k, c, rate)
    inertia = drum.mass / h + drum.damping
    lowest = LEAST_PIVOT * (inertia + (h * k + c) * length / chain.length)
    return Border(k * (length - rest) + c * rate, by_position, inertia - along - aslant, lowest)


@kernel
def pivot_of(border, yielded):
    """P [N s/m]; yielded : T_x y, what the tension gains as the chain yields to u [N s/m]."""
    return max(border.by_speed - yielded, border.lowest_pivot)


@kernel
def residual_of(trial, speed, tension):
    """r [N] with a speed [m/s] and a tension [N]."""
    drum, h = trial.drum, trial.h
    residual = drum.mass * (speed - trial.speed) / h + drum.damping * speed
    return residual + (force_at(drum, trial.time + h) - tension)


@kernel
def farthest_change(chain, h):
    """By how much the speed changes at most in an iteration [m/s]."""
    return MOST_REELED * chain.length / h


@kernel
def speed_after(chain, trial, speed, wanted, pivot):
    """u' [m/s] after a speed [m/s], from the one that is wanted without friction and stops."""
    farthest = farthest_change(chain, trial.h)
    change = nearest_speed(trial, wanted, pivot, trial.drum.friction) - speed
    return speed + max(-farthest, min(farthest, change))


# --- steps


@kernel
def limits_of(drum, length, h):
    """Speeds [m/s] with which a drum would come to its stops in a step of h [s] from a length [m], inwards and outwards."""
    return (drum.shortest - length) / h, (drum.longest - length) / h


@kernel
def trial_of(drum, time, h, length, speed):
    """`Trial` of a step in which a drum that friction brings to rest does not turn round."""
    lowest, highest = limits_of(drum, length, h)
    if drum.friction > 0.0 and drum.mass > 0.0:
        if speed > 0.0:
            lowest = min(max(lowest, 0.0), highest)
        elif speed < 0.0:
            highest = max(min(highest, 0.0), lowest)
    return Trial(drum, time, h, length, speed, lowest, highest)


@kernel
def at_end(trial, speed):
    """Length [m] and speed [m/s] after a step with a speed [m/s]: stops are inelastic."""
    lowest, highest = limits_of(trial.drum, trial.length, trial.h)
    if speed <= lowest:
        return trial.drum.shortest, 0.0
    if speed >= highest:
        return trial.drum.longest, 0.0
    return trial.length + trial.h * speed, speed
