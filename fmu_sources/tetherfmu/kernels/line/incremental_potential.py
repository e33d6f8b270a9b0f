"""Incremental potential minimized by a backward Euler step, its gradient and its matrix.

    Phi(x) = sum_i m_i |x_i - y_i|^2/(2 h^2) + sum_s (k (l - l0)^2/2 + h c s^2/(2 b)) + drag,   v1 = (x - x0)/h
    y_i = x0 + h v0 + h^2 (gravity + load/m_i)            position after free flight
    s = (b l - e . r0)/h,  b = 1 - h (dl0/dt)/l0          the rate that the damper sees; r0: r before the step
    drag = sum_s h u . A u - F . (x_p + x_q)              u: change of the mean velocity of the nodes p, q of a segment
    and for nodes on the ground `equations/ground.py`: int m a_n dd + h mu m N sqrt(|v_t|^2 + v_r^2)

Its gradient vanishes where the equations of motion hold with the forces at the new positions and velocities: backward
Euler. Its matrix omits negative tension across a segment and is therefore positive definite.

The gradient of s points along e - (r0 across e)/(b l), which differs from e by a term of order h: this makes Phi a potential
and keeps a whole step bounded. In a stage of `second_order.py` s = e . (b r - r0)/h with e of the iteration.

`segment.py` defines k, c, T, F and A. Half drag F and its slope A use the old velocities and the directions at the start of
the iteration; N is the a_n of the iteration, frozen until the next one. A driven end is on its curve; its old position
counts as x - h v, so the damper sees its exact velocity.

Source: Martin, Thomaszewski, Grinspun and Gross, Example-based elastic materials, ACM Trans. Graph. 30 (2011), section 4.
See docs/models/numerics.md, "Fixed step".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import clear
from ..compilation import kernel
from ..equations import flow, ground, segment
from ..equations.properties import property_of, rest_length
from ..linear_algebra.matrices import (
    ZERO_MATRIX,
    add_matrices,
    add_to_diagonal,
    apply,
    get_matrix,
    put_matrix,
    scale_matrix,
    subtract,
    symmetric,
)
from ..linear_algebra.vectors import add, add_scaled, dot, get, norm, put, scale, sub

ROUNDING = 1e-15  # of positions and of the terms of the potential, relative
PRESSED = 1e-3  # of the weight and the pressure: largest error of the frozen pressure in friction
SLID = 0.03  # of the sliding distance in a step; the error after it is its square
SHORTEST_PART = 0.1  # of its old length: lower limit for the length of a segment that turns

Attempt = namedtuple("Attempt", "conditions chain h v is_stage")
Attempt.__doc__ = """A trial step.

conditions : `BoundaryConditions`.  chain : `Chain` at the end of the step.  h : length of the step [s].
v : velocities before it [m/s].  is_stage : whether it is a stage of `second_order.py`."""


@kernel
def segment_at(attempt, s, x, is_new, w):
    """Length l [m], direction, l0 [m], spring k [N/m], damper c [N s/m], damper rate s [m/s], h/b ds/dr.

    For segment s; the mode of k follows from the positions x [m], the mode of c is in w.modes.
    is_new : whether an iteration begins at these positions; their directions then go into w.along (modified).
    """
    chain, b = attempt.chain, shrinkage(attempt, s)
    r0 = sub(get(w.old, s + 1), get(w.old, s))
    length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
    rest = rest_length(chain, s)
    k, _ = segment.stiffness(chain, s, length - rest, rest)
    _, c = segment.stiffness(chain, s, w.modes[s], rest)
    if attempt.is_stage:
        along = e if is_new else get(w.along, s)
        put(w.along, s, along)
        return length, e, rest, k, c, (b * length * dot(along, e) - dot(along, r0)) / attempt.h, along
    rate = segment.seen_rate(chain, s, length, (length - dot(e, r0)) / attempt.h)
    return length, e, rest, k, c, rate, slant_of(b, length, e, r0)


@kernel
def shrinkage(attempt, s):
    """b = 1 - h (dl0/dt)/l0 [-] as the damper of segment s sees it: if positive, the old part of its unstretched length."""
    return 1.0 - attempt.h * segment.seen_growth(attempt.chain, s)


@kernel
def slant_of(b, length, e, r0):
    """Direction of the damper force of a segment: h/b d(its rate)/dr, from l [m], e and r before the step [m]."""
    turned = add_scaled(r0, -dot(e, r0), e)
    return add_scaled(e, -1.0 / (b * max(length, SHORTEST_PART * norm(r0), segment.SHORTEST)), turned)


@kernel
def moved(s, x, w):
    """Sum of the displacements [m] of the nodes of a segment that are at x [m] after the step."""
    return add(sub(get(x, s), get(w.old, s)), sub(get(x, s + 1), get(w.old, s + 1)))


@kernel
def velocity_change(attempt, s, x, w):
    """Mean velocity change u [m/s] of the nodes of a segment that are at x [m] after the step."""
    before = add(get(attempt.v, s), get(attempt.v, s + 1))
    return scale(0.5, sub(scale(1.0 / attempt.h, moved(s, x, w)), before))


@kernel
def ground_potential(attempt, x, w):
    """Contribution of the ground to Phi [J] at the positions x [m]."""
    of_ground = ground.ground_of(attempt.chain.parameters)
    total = 0.0
    for i in range(attempt.conditions.first, attempt.conditions.last + 1):
        frozen = w.pressed[i], slide_at(attempt.chain, i, w.x)
        total += w.mass[i] * ground.potential_of_step(of_ground, get(w.old, i), get(x, i), attempt.h, *frozen)
    return total


@kernel
def slide_at(chain, i, x):
    """Velocity [m/s] of the rope relative to node i at x [m], or its change by displacements x [m]."""
    return flow.slide(chain, i, flow.passing_at(chain, i), x)


@kernel
def add_ground(attempt, x, is_held, w):
    """Add the ground to the iteration matrix, and minus its gradient to w.move (both modified).

    is_held : whether the a_n of the friction is frozen.
    """
    of_ground, h, diagonal = ground.ground_of(attempt.chain.parameters), attempt.h, w.matrix.diagonal
    for i in range(attempt.conditions.first, attempt.conditions.last + 1):
        if not is_held:
            w.pressed[i], _ = ground.normal_of_step(of_ground, get(w.old, i), get(x, i), h)
        frozen = w.pressed[i], slide_at(attempt.chain, i, x)
        force, by_position = ground.force_of_step(of_ground, get(w.old, i), get(x, i), h, *frozen)
        put(w.move, i, add_scaled(get(w.move, i), w.mass[i], force))
        block = get_matrix(diagonal, 9 * i)
        put_matrix(diagonal, 9 * i, subtract(block, scale_matrix(w.mass[i], by_position)))


@kernel
def find_flow(attempt, x, w):
    """Forces of flowing rope with the nodes at x [m] into w.flow (modified)."""
    chain, h, part = attempt.chain, attempt.h, flow.first_passing(attempt.chain)
    clear(w.flow)
    for s in range(chain.n):
        r = sub(get(x, s + 1), get(x, s))
        r0 = sub(get(w.old, s + 1), get(w.old, s))
        flow.add_change(chain, s, part, r, scale(1.0 / h, sub(r, r0)), w.flow)
        part -= property_of(chain, s, at.SHARE)


@kernel
def add_flow(attempt, x, w):
    """Add the forces of flowing rope to the iteration: w.flow at the positions x [m], w.move, w.matrix (modified)."""
    find_flow(attempt, x, w)
    flow.subtract_slopes(attempt.chain, 1.0 / attempt.h, 1.0, w.matrix)
    for k in range(len(w.flow)):
        w.move[k] += w.flow[k]


@kernel
def rests_on_ground(attempt, x, w):
    """Whether ground contact and friction of the nodes at x [m] agree with the last iteration.

    The pressure of each node equals the frozen value within PRESSED; its last slide, and the change of that of the rope
    past it, are at most a part SLID of its total slide.
    """
    of_ground = ground.ground_of(attempt.chain.parameters)
    for i in range(attempt.conditions.first, attempt.conditions.last + 1):
        old, new, move = get(w.old, i), get(x, i), get(w.move, i)
        normal, _ = ground.normal_of_step(of_ground, old, new, attempt.h)
        if abs(normal - w.pressed[i]) > PRESSED * (w.pressed[i] + attempt.chain.gravity):
            return False
        if w.pressed[i] > 0.0:
            _, way = ground.slide_of_step(old, new, attempt.h, slide_at(attempt.chain, i, x))
            if move[0] ** 2 + move[1] ** 2 > (SLID * way) ** 2:
                return False
            if norm(slide_at(attempt.chain, i, w.move)) * attempt.h > SLID * way:
                return False
    return True


@kernel
def potential(attempt, x, w):
    """Phi [J] at the positions x [m], and its error of rounding [J]."""
    h = attempt.h
    total, size = 0.0, 0.0
    for i in range(attempt.conditions.first, attempt.conditions.last + 1):
        away = sub(get(x, i), get(w.free, i))
        total += 0.5 * w.mass[i] / (h * h) * dot(away, away)
    for s in range(attempt.chain.n):
        length, _, rest, k, c, rate, _ = segment_at(attempt, s, x, False, w)
        total += segment.elastic_energy(k, length - rest) + 0.5 * h * c / shrinkage(attempt, s) * rate * rate
        size += (k * abs(length - rest) + c * abs(rate)) * (norm(get(x, s)) + length)
        u = velocity_change(attempt, s, x, w)
        work = dot(get(w.drag, s), moved(s, x, w))
        total += h * dot(u, apply(get_matrix(w.slope, 9 * s), u)) - work
        size += abs(work)
    if ground.has_ground(attempt.chain.parameters):
        total += ground_potential(attempt, x, w)
    if flow.flows(attempt.chain):
        for i in range(attempt.conditions.first, attempt.conditions.last + 1):
            work = dot(get(w.flow, i), sub(get(x, i), get(w.old, i)))
            total -= work
            size += abs(work)
    return total, ROUNDING * (size + abs(total))


@kernel
def inertia(attempt, i, x, w):
    """Contribution of the mass of node i to the iteration matrix and to minus the gradient of Phi."""
    m = w.mass[i] / (attempt.h * attempt.h)
    return add_to_diagonal(ZERO_MATRIX, m), scale(m, sub(get(w.free, i), get(x, i)))


@kernel
def linearize(attempt, x, is_held, w):
    """Matrix of the iteration into w.matrix, minus the gradient of Phi into w.move (both modified).

    is_held : as for `add_ground`.
    """
    n = attempt.chain.n
    h = attempt.h
    diagonal, lower, upper = w.matrix
    block, force = inertia(attempt, 0, x, w)
    for s in range(n):
        length, e, rest, k, c, rate, slant = segment_at(attempt, s, x, True, w)
        w.held[s] = length - rest
        spring = k * (length - rest)
        across = max(spring + c * rate, 0.0) / length
        air = sub(get(w.drag, s), apply(get_matrix(w.slope, 9 * s), velocity_change(attempt, s, x, w)))
        pull = add(scale(spring, e), scale(c * rate, slant))
        damped = symmetric(shrinkage(attempt, s) * c / h, slant)
        stiff = add_to_diagonal(add_matrices(symmetric(k - across, e), damped), across)
        both = scale_matrix(0.5 / h, get_matrix(w.slope, 9 * s))
        put_matrix(upper, 9 * s, subtract(both, stiff))
        put_matrix(lower, 9 * s + 9, subtract(both, stiff))
        own = add_matrices(stiff, both)
        put_matrix(diagonal, 9 * s, add_matrices(block, own))
        put(w.move, s, add(force, add(air, pull)))
        block, force = inertia(attempt, s + 1, x, w)
        block, force = add_matrices(block, own), add(force, sub(air, pull))
    put_matrix(diagonal, 9 * n, block)
    put(w.move, n, force)
    if flow.flows(attempt.chain):
        add_flow(attempt, x, w)
    if ground.has_ground(attempt.chain.parameters):
        add_ground(attempt, x, is_held, w)
