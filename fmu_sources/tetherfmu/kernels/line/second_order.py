"""Fixed steps of order 2, L-stable: three stages, each a step of backward Euler, the minimum of an incremental potential.

A diagonally implicit Runge-Kutta method with the same g in each stage, whose last stage is its result:

    x1 = x0 + g h v1,           v1 = v0 + g h a(x1, v1)        at t + g h, a: acceleration
    x2 = x0 + (c - g) h v1 + g h v2,  v2 alike                 at t + c h
    x3 = x0 + h (b1 v1 + b2 v2 + g v3),  v3 alike              at t + h

    b1 + b2 + g = 1,   b1 g + b2 c + g = 1/2,   b1 g^2 + b2 c^2 + g = 1/3

Any g from 0.1804 to 2.18 makes it L-stable; the smaller g, the smaller its error and the longer waves ring that a step does
not resolve. The third condition is that of order 3 for forces that depend on time only. Each stage is a backward Euler step
over g h, from where the stages before lead: so all that bounds such a step bounds a stage. A driven end moves by the same
formulas with its exact velocities, so that a chain that accelerates as a whole is not stretched in a stage, and is put on
its curve after the step, from which x3 is O(h^3) away.

The accelerations of the last two stages, also of those of the step before, are continued linearly for the first guess of a
stage: in smooth flight one iteration does.

A step is taken anew by `fixed_steps.subdivided_step` over the whole of h, and then has order 1, where `motion/fallback.py`
says why: the start of a stage is an extrapolation, which knows neither of transitions nor of a chain that turns far in a
step; and where a step is too long for a stiff line, stages keep the nodes at the distances of rods, but not the tensions
that these take.

Sources: Alexander, Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14 (1977);
Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6. See docs/models/numerics.md, "Fixed step".
"""

from collections import namedtuple

from ..arrays import behind, split
from ..compilation import kernel, view
from ..equations import flow, node_loads, segment
from ..equations.boundary import load_during
from ..equations.properties import rest_length
from ..flat_arrays import part
from ..linear_algebra.vectors import dot, get, norm, sub
from . import backward_euler

GAMMA = 0.182  # g
_FIRST, _SECOND = 0.5 - GAMMA - GAMMA * (1.0 - GAMMA), 1.0 / 3.0 - GAMMA - GAMMA**2 * (1.0 - GAMMA)
MIDDLE = _SECOND / _FIRST - GAMMA  # c
B2 = _FIRST / (MIDDLE - GAMMA)
B1 = 1.0 - GAMMA - B2
# parts of the moves in the first and in the second stage in the starts of the second and of the third one
TO_SECOND, TO_THIRD, BESIDE = MIDDLE / GAMMA - 1.0, B1 / GAMMA, B2 / GAMMA
ENDS = GAMMA, MIDDLE, 1.0  # of the stages, in steps
# to continue the accelerations of two stages to the next one: time to there over the time between them
TO_NEXT = GAMMA / (1.0 - MIDDLE), MIDDLE / GAMMA - 1.0, (1.0 - MIDDLE) / (MIDDLE - GAMMA)
ROUNDING = 1e-9  # of energies, relative: of positions to which an iteration comes close

Workspace = namedtuple("Workspace", "chain x v x_onward v_onward before")
Workspace.__doc__ = """Scratch arrays of a step, 3 (n + 1) numbers each.

chain : `backward_euler.Workspace`.  x, v : at the start of the step [m, m/s].  x_onward, v_onward : the start of the third
stage but for the result of the second one.  before : accelerations in the last stage but one [m/s2].
"""


@kernel
def workspace_size(n):
    """Length of the room that `workspace` needs, beside `arrays.shared_arrays`."""
    return backward_euler.workspace_size(n) + 5 * 3 * (n + 1)


@view
def workspace(n, shared, room):
    """Cut a room into the arrays of `Workspace`; shared : as for `backward_euler.workspace`."""
    flat, chain = 3 * (n + 1), backward_euler.workspace(n, shared, room)
    x, v, before, room = split(flat, behind(backward_euler.workspace_size(n), room))
    x_onward, v_onward = part(room, 0, flat), part(room, flat, flat)
    return Workspace(chain, x, v, x_onward, v_onward, before)


@kernel
def energy_and_power(conditions, chain, time, x, v, mass):
    """Energy [J] at a time [s]; the power [W] that the rest of the world puts in is at most the second number.

    Of nodes of the `Chain` there, of these masses [kg] at x [m] with the velocities v [m/s]: kinetic, elastic, of weight and
    ground. The power counts the magnitudes of forces and velocities.
    """
    n = conditions.n
    energy = 0.0
    power = norm(load_during(conditions, time)) * norm(get(v, n))
    for i in range(conditions.first, conditions.last + 1):
        speed = norm(get(v, i))
        energy += mass[i] * (0.5 * speed * speed + node_loads.specific_potential(chain, get(x, i), True))
    if flow.flows(chain):
        power += flow.most_power(chain, x, v)
    for s in range(n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        rest = rest_length(chain, s)
        k, c = segment.stiffness(chain, s, length - rest, rest)
        energy += segment.elastic_energy(k, length - rest)
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
def expect(onward, known, w):
    """Continue the accelerations of the last two stages to the next one, in w.chain.acceleration (modified) [m/s2].

    onward : time to there over that between the two [-].  known : of how many of the last two stages the accelerations are.
    """
    now = w.chain.acceleration
    for k in range(len(now)):
        latest = now[k]
        now[k] = latest + (onward * (latest - w.before[k]) if known > 1 else 0.0)
        w.before[k] = latest


@kernel
def start_of_second(start, reached):
    """Where the second stage starts of what the first one has led to from a start; and the third one, see `start_of_third`.

    What has not moved stays exactly where it is: a drum at its stop.
    """
    move = reached - start
    onward = TO_SECOND * move
    return start + onward, start + TO_THIRD * move - BESIDE * onward


@kernel
def start_of_third(onward, start, reached):
    """Where the third stage starts of what the second one has led to; start : of the step."""
    return onward + BESIDE * (reached - start)


@kernel
def go_on(i, x, v, w):
    """Put (x, v) [m, m/s] (modified), the result of the stage before, where the second (i = 1) or the third stage starts."""
    for k in range(len(x)):
        if i == 1:
            x[k], w.x_onward[k] = start_of_second(w.x[k], x[k])
            v[k], w.v_onward[k] = start_of_second(w.v[k], v[k])
        else:
            x[k] = start_of_third(w.x_onward[k], w.x[k], x[k])
            v[k] = start_of_third(w.v_onward[k], w.v[k], v[k])
