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
from math import inf

from tetherfmu.runtime.limits import FINEST, LAST_ITERATIONS, MOST_ITERATIONS

from ..arrays import behind, copy
from ..compilation import kernel, part, view
from ..equations.assembly import longest_part, node_masses
from ..equations.boundary import hold_ends, load_during, place_ends
from ..equations.drum import force_at
from ..equations.node_loads import free_acceleration
from ..equations.properties import point_mass, sees_reeling
from ..linear_algebra.block_tridiagonal import factorize, solve
from ..linear_algebra.vectors import NEUTRAL, add, add_scaled, dot, get, put, scale, sub
from . import backward_euler, incremental_potential, second_order
from .drum_step import chain_with, with_length, with_reeling

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


@kernel
def workspace_size(n):
    """Length of the work array that `workspace` needs."""
    return second_order.workspace_size(n) + 3 * (n + 1)


@view
def workspace(n, work):
    """Cut the work array into the arrays of `Workspace`."""
    column = part(behind(second_order.workspace_size(n), work), 0, 3 * (n + 1))
    return Workspace(second_order.workspace(n, work), column)


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
def put_column(attempt, time, w, column):
    """-dg/du at w.x into the column (modified): masses, springs and dampers change with the length."""
    conditions, n = attempt.conditions, attempt.chain.n
    begin_column(attempt, w, column)
    if conditions.last == n:
        add_load(attempt, n, w.mass[n], load_during(conditions, time + attempt.h), w, column)
    add_pulls(attempt, w, column)


@kernel
def solve_both(attempt, time, w, column):
    """p into w.move and y into the column (both modified) at the positions w.x [m]; whether the matrix is regular."""
    conditions = attempt.conditions
    incremental_potential.linearize(attempt, w.x, w)
    put_column(attempt, time, w, column)
    if conditions.first <= conditions.last:
        if not factorize(conditions.first, conditions.last, w.matrix):
            return False
        solve(conditions.first, conditions.last, w.matrix, w.move)
        solve(conditions.first, conditions.last, w.matrix, column)
    hold_ends(conditions, w.move)
    hold_ends(conditions, column)
    return True


@kernel
def first_difference(a):
    """Difference of the vectors of the first two nodes."""
    return sub(get(a, 1), get(a, 0))


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


@kernel
def next_speed(attempt, trial, speed, w, column):
    """u' [m/s] after a speed [m/s], with p in w.move and y in the column."""
    border = border_of(attempt, trial.drum, w)
    tension = border.tension + dot(border.by_position, first_difference(w.move))
    pivot = pivot_of(border, dot(border.by_position, first_difference(column)))
    wanted = speed - residual_of(trial, speed, tension) / pivot
    return speed_after(attempt.chain, trial, speed, wanted, pivot)


@view
def attempt_at(conditions, trial, speed, v):
    """`backward_euler.Attempt` with a speed of the drum [m/s]; the length of the conditions is that before the step."""
    chain = chain_with(conditions, trial.length + trial.h * speed, speed)
    return backward_euler.Attempt(conditions, chain, trial.h, v)


@kernel
def reel(attempt, time, x, w):
    """Masses, and free flight of a free kite from x [m], into w (modified) after a change of the speed."""
    conditions, chain, h, v = attempt
    node_masses(chain, w.mass)
    if conditions.last == chain.n:
        n = chain.n
        acceleration = add_scaled(free_acceleration(chain), 1.0 / w.mass[n], load_during(conditions, time + h))
        put(w.free, n, backward_euler.flight(get(x, n), get(v, n), h, acceleration))


@kernel
def move_on(now, is_first, goal, x, w):
    """Move w.x [m] (modified) by w.move or a part of it; results as those of `backward_euler.descend`.

    is_first : whether it is the first iteration from accelerations that were expected.  goal : a move [m] for which Phi need
    not be asked then.
    """
    taken = longest_part(now.chain, w.move)
    farthest = taken * backward_euler.largest_move(now.chain.n, w)
    if is_first and farthest <= goal:
        backward_euler.try_part(taken, w)
        copy(w.trial, w.x)
        return farthest
    phi, _ = incremental_potential.potential(now, w.x, w)
    if is_first and backward_euler.is_lower_carried(now, phi, x, w):
        backward_euler.guess(now, x, w)
        return inf
    _, farthest = backward_euler.go_along(now, taken, phi, w)
    return farthest


@kernel
def iterate(conditions, trial, speed, number, is_expected, goal, x, v, b):
    """One iteration from w.x [m] (modified) and a speed [m/s]: whether the matrix is regular, u' [m/s], largest move [m].

    number : of those before.  The move is negative where no part of it goes down.  Where the first ones have not
    converged the speed only changes where the chain converges with it.
    """
    w, column = b.steps.chain, b.column
    now = attempt_at(conditions, trial, speed, v)
    if not solve_both(now, trial.time, w, column):
        return False, speed, inf
    onward = next_speed(now, trial, speed, w, column)
    if number >= MOST_ITERATIONS and backward_euler.largest_move(now.chain.n, w) > goal:
        onward = speed
    for k in range(len(w.move)):
        w.move[k] += (onward - speed) * column[k]
    now = attempt_at(conditions, trial, onward, v)
    reel(now, trial.time, x, w)
    return True, onward, move_on(now, number == 0 and is_expected, goal, x, w)


# --- steps


@kernel
def step(conditions, trial, kind, most, guess, x, v, b):
    """One step of (x, v) (modified if it is taken); kind : as for `backward_euler.start`.

    most : iterations.  guess : of the speed [m/s].  Returns whether it converged, the number of iterations, negative
    where the matrix is singular, and the speed of the drum [m/s].
    """
    h, n, w = trial.h, conditions.n, b.steps.chain
    still = with_length(conditions, trial.length)
    speed = min(trial.highest, max(trial.lowest, guess))
    now = attempt_at(still, trial, speed, v)
    backward_euler.start(now, trial.time, kind, x, w)
    goal, is_expected = backward_euler.goal_of(now, kind), kind == backward_euler.EXPECTED
    if is_expected:
        backward_euler.fly_as_expected(now, x, w)
        backward_euler.add_drag(now, w.x, w)
    else:
        backward_euler.guess(now, x, w)
    iterations, converged = 0, False
    while iterations < most and not (converged and backward_euler.holds(attempt_at(still, trial, speed, v).chain, w.x, w)):
        is_regular, onward, farthest = iterate(still, trial, speed, iterations, is_expected, goal, x, v, b)
        if not is_regular:
            return False, -1, speed
        converged = 0.0 <= farthest <= goal and h * abs(onward - speed) <= n * goal
        speed = onward
        iterations += 1
        if farthest < 0.0:
            break
    if converged:
        backward_euler.take(attempt_at(still, trial, speed, v), trial.time, kind, x, v, w)
    return converged, iterations, speed


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


@kernel
def step_in_any_case(conditions, trial, x, v, b):
    """One step of (x, v) (modified); iterations, negative where the matrix is singular, and the speed of the drum [m/s].

    Where it does not converge, the chain takes it alone with the last speed, in at most as many iterations again.
    """
    w = b.steps.chain
    taken, iterations, speed = step(conditions, trial, backward_euler.WHOLE, LAST_ITERATIONS, trial.speed, x, v, b)
    if taken or iterations < 0:
        return iterations, speed
    w.unconverged[0] += 1.0
    if conditions.first > conditions.last:
        place_ends(conditions, trial.time + trial.h, x, v)
        return iterations, speed
    steady = with_reeling(conditions, (trial.length - speed * trial.time, speed, 0.0, NEUTRAL))
    _, more = backward_euler.step(steady, trial.time, trial.h, backward_euler.WHOLE, True, x, v, w)
    return more if more < 0 else iterations + more, speed


@kernel
def subdivided_step(conditions, drum, time, h, length, speed, x, v, b):
    """`backward_euler.subdivided_step` with a drum from a length [m] and a speed [m/s].

    Returns the number of iterations, at most `limits.WORST_SUBDIVIDED_WITH_DRUM`, negative where the matrix is singular, and
    length and speed of the drum after it.
    """
    iterations, done, size = 0, 0, FINEST
    while done < FINEST:
        trial = trial_of(drum, time + h * done / FINEST, h * size / FINEST, length, speed)
        if size == 1:
            more, found = step_in_any_case(conditions, trial, x, v, b)
            taken = True
        else:
            taken, more, found = step(conditions, trial, backward_euler.WHOLE, MOST_ITERATIONS, speed, x, v, b)
        if more < 0:
            return more, length, speed
        iterations += more
        done, size = backward_euler.next_part(done, size, taken)
        if taken:
            length, speed = at_end(trial, found)
    return iterations, length, speed
