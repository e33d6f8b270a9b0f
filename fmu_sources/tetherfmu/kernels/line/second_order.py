"""Fixed steps of order 2, L-stable: three backward Euler stages, each the minimum of an incremental potential.

A diagonally implicit Runge-Kutta method with the same g in each stage, whose last stage is its result:

    x1 = x0 + g h v1,           v1 = v0 + g h a(x1, v1)        at t + g h, a: acceleration
    x2 = x0 + (c - g) h v1 + g h v2,  v2 accordingly           at t + c h
    x3 = x0 + h (b1 v1 + b2 v2 + g v3),  v3 accordingly        at t + h

    b1 + b2 + g = 1,   b1 g + b2 c + g = 1/2,   b1 g^2 + b2 c^2 + g = 1/3

Any g from 0.1804 to 2.18 is L-stable; a smaller g reduces the error, but waves that the step does not resolve ring longer.
The third condition is the order-3 condition for forces that depend on time only. Each stage is a backward Euler step over
g h from a start that the earlier stages determine, so all bounds of such a step hold. A driven end moves by the same
formulas with its exact velocities, so a uniformly accelerating chain is not stretched in a stage; after the step it is put
on its curve, which differs from x3 by O(h^3).

The accelerations of the last two stages, including the step before, are extrapolated linearly to the first guess of a
stage: in smooth motion one iteration suffices.

`fixed_steps.subdivided_step` repeats a step over the whole of h, with order 1, for the reasons in `motion/fallback.py`: the
start of a stage is an extrapolation, which ignores transitions and large rotations of the chain within a step; and if a step
is too long for a stiff line, stages keep the nodes at the right distances, but with wrong tensions.

Sources: Alexander, Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14 (1977);
Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.6. See docs/models/numerics.md, "Fixed step".
"""

from collections import namedtuple

from ..arrays import behind, split
from ..compilation import kernel, view
from ..equations import flow, node_loads, segment
from ..equations.boundary import load_during
from ..equations.properties import growth_at, rest_length
from ..flat_arrays import part
from ..linear_algebra.vectors import add, dot, get, norm, sub
from . import backward_euler

GAMMA = 0.182  # g
_FIRST, _SECOND = 0.5 - GAMMA - GAMMA * (1.0 - GAMMA), 1.0 / 3.0 - GAMMA - GAMMA**2 * (1.0 - GAMMA)
MIDDLE = _SECOND / _FIRST - GAMMA  # c
B2 = _FIRST / (MIDDLE - GAMMA)
B1 = 1.0 - GAMMA - B2
# fractions of the displacements of stages 1 and 2 in the starts of stages 2 and 3
TO_SECOND, TO_THIRD, BESIDE = MIDDLE / GAMMA - 1.0, B1 / GAMMA, B2 / GAMMA
ENDS = GAMMA, MIDDLE, 1.0  # ends of the stages, in steps
# extrapolation of two stage accelerations: time to the next stage over their distance
TO_NEXT = GAMMA / (1.0 - MIDDLE), MIDDLE / GAMMA - 1.0, (1.0 - MIDDLE) / (MIDDLE - GAMMA)
ROUNDING = 1e-9  # of energies, relative: error of a converged iteration

Workspace = namedtuple("Workspace", "chain x v x_onward v_onward before")
Workspace.__doc__ = """Scratch arrays of a step, 3 (n + 1) numbers each.

chain : `backward_euler.Workspace`.  x, v : at the start of the step [m, m/s].  x_onward, v_onward : start of the third
stage without the result of the second.  before : accelerations in the last but one stage [m/s2]."""


@kernel
def workspace_size(n):
    """Length of the room for `workspace`, in addition to `arrays.shared_arrays`."""
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
    """Energy [J] at a time [s], and an upper bound of the power [W] supplied from outside.

    For nodes of the `Chain` there, of these masses [kg] at x [m] with velocities v [m/s]: kinetic, elastic, gravity and
    ground energy. The bound sums the magnitudes of forces and velocities.
    """
    n = conditions.n
    energy = 0.0
    power = norm(load_during(conditions, time)) * norm(get(v, n))
    for i in range(conditions.first, conditions.last + 1):
        speed = norm(get(v, i))
        energy += mass[i] * (0.5 * speed * speed + node_loads.specific_potential(chain, get(x, i), True))
        slide = flow.slide(chain, i, flow.passing_at(chain, i), x)
        power += mass[i] * abs(node_loads.specific_friction(chain, get(x, i), add(get(v, i), slide), slide))
    if flow.flows(chain):
        power += flow.most_power(chain, x, v)
    for s in range(n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        rest = rest_length(chain, s)
        k, c = segment.stiffness(chain, s, length - rest, rest)
        energy += segment.elastic_energy(k, length - rest)
        tension = abs(segment.tension(chain, s, length, dot(e, sub(v_q, v_p)), rest, k, c))
        drag = norm(segment.half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q))
        air, _, _, _ = segment.air_of(chain, s, segment.mean_height(x_p, x_q))
        power += 2.0 * drag * norm(air) + tension * length * abs(growth_at(chain, s))
        if s < conditions.first:
            power += (tension + drag) * norm(v_p)
        if s >= conditions.last:
            power += (tension + drag) * norm(v_q)
    return energy, power


@kernel
def expect(onward, known, w):
    """Extrapolate the accelerations of the last two stages to the next one, in w.chain.acceleration (modified) [m/s2].

    onward : time to there over the time between the two [-].  known : number of these stages with known accelerations.
    """
    now = w.chain.acceleration
    for k in range(len(now)):
        latest = now[k]
        now[k] = latest + (onward * (latest - w.before[k]) if known > 1 else 0.0)
        w.before[k] = latest


@kernel
def start_of_second(start, reached):
    """Start of the second stage from the result of the first; of the third, see `start_of_third`.

    Values that have not changed stay exact: a drum at its stop.
    """
    move = reached - start
    onward = TO_SECOND * move
    return start + onward, start + TO_THIRD * move - BESIDE * onward


@kernel
def start_of_third(onward, start, reached):
    """Start of the third stage from the result of the second; start : of the step."""
    return onward + BESIDE * (reached - start)


@kernel
def go_on(i, x, v, w):
    """Move (x, v) [m, m/s] (modified) from the result of the last stage to the start of the second (i = 1) or third."""
    for k in range(len(x)):
        if i == 1:
            x[k], w.x_onward[k] = start_of_second(w.x[k], x[k])
            v[k], w.v_onward[k] = start_of_second(w.v[k], v[k])
        else:
            x[k] = start_of_third(w.x_onward[k], w.x[k], x[k])
            v[k] = start_of_third(w.v_onward[k], w.v[k], v[k])
