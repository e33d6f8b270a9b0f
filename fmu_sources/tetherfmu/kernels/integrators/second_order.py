"""Fixed steps of order 2, L-stable: two stages, each a step of backward Euler, the minimum of an incremental potential.

The diagonally implicit Runge-Kutta method with g = 1 - 1/sqrt(2), whose second stage is its result:

    x1 = x0 + g h v1,   v1 = v0 + g h a(x1, v1)                at t + g h, a: acceleration
    x0' = x0 + (1 - g) h v1 = x0 + (x1 - x0) (1 - g)/g         and v0' from v0 and v1 alike
    x2 = x0' + g h v2,  v2 = v0' + g h a(x2, v2)               at t + h

Both are `backward_euler.step` over g h, from (x0, v0) and from (x0', v0'). So all that bounds such a step bounds a stage. A
driven end moves by the same formulas with its exact velocities v1 and v2, so that a chain that accelerates as a whole is not
stretched in a stage, and is put on its curve after the step, from which x2 is O(h^3) away.

A step is taken anew by `backward_euler.careful_step` over the whole of h, and then has order 1, where

- a stage does not come to rest within `limits.MOST_ITERATIONS`,
- a node is on the ground,
- a segment is as stiff as `limits.STIFF`: its tension would show by how little a driven end is put right after the stages,
- a segment goes slack or taut, and the energy grows by more than ends, winch, wind and load can have put in: the start of
  the second stage is an extrapolation, which does not know of the transition.

Sources: Alexander, Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14 (1977), theorem 5;
Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6. See docs/models/numerics.md, "Fixed step".
"""

from collections import namedtuple
from math import sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import STIFF
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, OK, STATE_NOT_FINITE

from ..arrays import behind, copy
from ..compilation import kernel, part, view
from ..equations import ground, node_loads, segment
from ..equations.boundary import chain_during, load_during, place_ends
from ..equations.properties import rest_length, stiffest
from ..linear_algebra.vectors import dot, get, norm, sub
from . import backward_euler

GAMMA = 1.0 - sqrt(0.5)  # g
ONWARD = (1.0 - GAMMA) / GAMMA  # from (x0, v0) to (x0', v0') over the first stage
ROUNDING = 1e-9  # of energies, relative: of positions to which an iteration comes close

Workspace = namedtuple("Workspace", "chain x v")
Workspace.__doc__ = (
    """Scratch arrays of a step. chain : `backward_euler.Workspace`.  x, v : at its start, 3 (n + 1) numbers."""
)


@kernel
def workspace_size(n):
    """Length of the work array that `workspace` needs."""
    return backward_euler.workspace_size(n) + 6 * (n + 1)


@view
def workspace(n, work):
    """Cut the work array into the arrays of `Workspace`."""
    room, flat = behind(backward_euler.workspace_size(n), work), 3 * (n + 1)
    return Workspace(backward_euler.workspace(n, work), part(room, 0, flat), part(room, flat, flat))


@kernel
def is_on_ground(conditions, x):
    """Whether a node that moves freely is on the ground or below it, with the nodes at x [m]."""
    if ground.has_ground(conditions.parameters):
        height = ground.ground_of(conditions.parameters).height
        for i in range(conditions.first, conditions.last + 1):
            if x[3 * i + 2] <= height:
                return True
    return False


@kernel
def crosses(conditions, start, x, end, y):
    """Whether a segment is slack with the nodes at x [m] and taut at y [m], or the other way; start, end : times [s]."""
    before, after = chain_during(conditions, start), chain_during(conditions, end)
    for s in range(conditions.n):
        r, rest = sub(get(x, s + 1), get(x, s)), rest_length(before, s)
        q, new = sub(get(y, s + 1), get(y, s)), rest_length(after, s)
        if (dot(r, r) - rest * rest) * (dot(q, q) - new * new) < 0.0:
            return True
    return False


@kernel
def energy_and_power(conditions, time, x, v, mass):
    """Energy [J] at a time [s]; the power [W] that the rest of the world puts in is at most the second number.

    Of nodes of these masses [kg] at x [m] with the velocities v [m/s]: kinetic, elastic, of weight. The power counts the
    magnitudes of forces and velocities.
    """
    chain, n = chain_during(conditions, time), conditions.n
    energy = 0.0
    power = norm(load_during(conditions, time)) * norm(get(v, n))
    for i in range(conditions.first, conditions.last + 1):
        speed = norm(get(v, i))
        energy += mass[i] * (0.5 * speed * speed + node_loads.specific_potential(chain, get(x, i), False))
    for s in range(n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        rest = rest_length(chain, s)
        k, c = segment.stiffness(chain, s, length - rest, rest)
        energy += 0.5 * k * (length - rest) ** 2
        tension = abs(segment.tension(chain, length, dot(e, sub(v_q, v_p)), rest, k, c))
        drag = norm(segment.half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q))
        air, _, _, _ = segment.air_of(chain, s, segment.mean_height(x_p, x_q))
        power += 2.0 * drag * norm(air) + tension * length * abs(chain.growth)
        if s < conditions.first:
            power += (tension + drag) * norm(v_p)
        if s >= conditions.last:
            power += (tension + drag) * norm(v_q)
    return energy, power


@kernel
def is_explained(conditions, time, h, x, v, w):
    """Whether the energy after a step of h [s] at a time [s] is at most that before it and what was put in."""
    before, power = energy_and_power(conditions, time, w.x, w.v, w.chain.mass)
    after, later = energy_and_power(conditions, time + h, x, v, w.chain.mass)
    return after - before <= h * (power + later) + ROUNDING * (abs(before) + abs(after))


@kernel
def two_stages(conditions, time, h, x, v, w):
    """One step of h [s] of (x, v) (modified) at a time [s]; whether it is to be taken, and the number of iterations."""
    copy(x, w.x)
    copy(v, w.v)
    taken, iterations = backward_euler.step(conditions, time, GAMMA * h, True, False, x, v, w.chain)
    if not taken:
        return False, max(iterations, 0)
    middle = time + GAMMA * h
    does_cross = crosses(conditions, time, w.x, middle, x)
    for k in range(len(x)):
        x[k] = w.x[k] + ONWARD * (x[k] - w.x[k])
        v[k] = w.v[k] + ONWARD * (v[k] - w.v[k])
    start = time + (1.0 - GAMMA) * h
    taken, more = backward_euler.step(conditions, start, GAMMA * h, True, False, x, v, w.chain)
    iterations += max(more, 0)
    if not taken or is_on_ground(conditions, x):
        return False, iterations
    place_ends(conditions, time + h, x, v)
    does_cross = does_cross or crosses(conditions, time, w.x, time + h, x)
    return not does_cross or is_explained(conditions, time, h, x, v, w), iterations


@kernel
def step(conditions, time, h, x, v, w):
    """One step of h [s] of (x, v) (modified) at a time [s] of the communication step.

    Returns the number of iterations, each with one factorization, at most `limits.WORST_WORK`, negative where the matrix is
    singular; and whether the two stages were left for backward Euler.
    """
    has_one_stage = conditions.parameters[at.FIXED_STEP_METHOD] == at.BACKWARD_EULER
    if has_one_stage or is_on_ground(conditions, x) or stiffest(chain_during(conditions, time)) >= STIFF:
        return backward_euler.careful_step(conditions, time, h, x, v, w.chain), False
    taken, iterations = two_stages(conditions, time, h, x, v, w)
    if taken:
        return iterations, False
    copy(w.x, x)
    copy(w.v, v)
    more = backward_euler.careful_step(conditions, time, h, x, v, w.chain)
    return more if more < 0 else iterations + more, True


@kernel
def integrate(conditions, duration, state, x, v, w):
    """Advance (x, v) (modified) over a communication step of `duration` [s] with steps of `fixed_step`.

    A communication step that is no multiple is divided evenly into steps of at most `fixed_step`. Counters in `state` are
    modified. Returns a status: OK, FIXED_STEPS_TOO_MANY or STATE_NOT_FINITE.
    """
    budget = at.ITERATION_BUDGET // conditions.n
    count = backward_euler.count_of_steps(conditions, duration, budget)
    if count == 0:
        return FIXED_STEPS_TOO_MANY
    h = duration / count
    spent, left = 0, 0
    for i in range(count):
        if spent > budget:
            return FIXED_STEPS_TOO_MANY
        iterations, is_left = step(conditions, i * h, h, x, v, w)
        if iterations < 0:
            return STATE_NOT_FINITE
        spent += iterations
        left += 1 if is_left else 0
    state[at.STEPS] += count
    state[at.REJECTIONS] += left
    state[at.ITERATIONS] += spent
    return OK
