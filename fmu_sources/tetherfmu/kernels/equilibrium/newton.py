"""Equilibrium of the chain between two given ends: the initial shape.

Unknown are the positions of the inner nodes. Every node moves as a point of a body that turns about the ground end with
omega and stretches with the rate s; at rest both are zero:

    T_i e_i - T_(i-1) e_(i-1) + f_i(x, v) = 0,       f_i = half drags + weight - m_i a_i
    T = k (l - l0),   v_i = v_0 + S r_i,   S r = omega x r + s r,   a_i = omega x (omega x r_i),   r_i = x_i - x_0

There is no damping: nothing changes but the direction. Where the air blows the tether back on itself, the tension has to
pass through zero: a segment there may be slack, with the stiffness that a slack segment has.

1. Start: the hanging chain (`hanging_chain.py`) under the mean load.
2. Newton's method with the tensions as unknowns beside the positions. They are eliminated from its linear system, which
   stays block tridiagonal; what they change is that the lateral stiffness T/l comes from the tension of the last iteration
   and not from the length of the segment, whose error is amplified by EA/l0.
3. If that fails: the same, but with the compliances of the segments instead of their stiffnesses (`compliance.py`), because
   in a stiff and slack chain what holds a segment across drowns in the rounding errors of what holds it along.
4. If that fails: both again with a resistance c against motion, (c - dF/dx) dx = F: implicit steps in the time 1/c of a
   chain that creeps. c falls while the nodes move little, down to Newton's method.
"""

from math import inf, sqrt

from tetherfmu.kernels.algebra.block_tridiagonal import factorize, solve
from tetherfmu.kernels.algebra.pairs import pair
from tetherfmu.kernels.algebra.vectors import (
    add,
    add_to_diagonal,
    along,
    cross,
    dot,
    get,
    get_two,
    multiply,
    norm,
    outer,
    put,
    put_matrix,
    put_pairs,
    scale,
    skew,
    sub,
)
from tetherfmu.kernels.chain import nodes, segment
from tetherfmu.kernels.compilation import kernel
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from . import compliance, elastic_catenary, hanging_chain

NO_PULL, SPRINGS, TENSIONS = 0, 1, 2  # what pulls at the nodes
MOST_ITERATIONS = 30
ROUNDING = 2.3e-16
ACCURACY = 1e-12  # residual over the size of the forces
STALLED = 2.0  # a residual that falls no more is rounding up to this many times the estimate of it
FAST_DECREASE = 1e-4  # of the residual in one iteration: the matrix is kept
SLOWEST_SLACKENING = 0.2  # a tension falls to no less than this part in one iteration
MOST_CREEPING = 300  # iterations of step 4
LOOSEST = 1e-3  # tension over the load of a node above which a segment counts as taut, however short it is, in step 3
NEAR, FAR = 0.5, 1.5  # motion of a node over the length of a segment below and above which the resistance changes
FIRMEST = 100.0  # resistance over that of the first iteration


@kernel
def straighten(n, parameters, x):
    """Put the inner nodes of x (modified) on the straight line between its ends, at equal strain."""
    ground = get(x, 0)
    chord = sub(get(x, n), ground)
    part = 0.0
    for i in range(1, n):
        part += parameters[at.PARAMETER_SCALARS + i - 1]
        put(x, i, along(ground, part, chord))


@kernel
def rigid_motion(n, x, v):
    """Angular velocity [rad/s] and rate of stretch [1/s] of a body about the ground end that carries the kite.

    omega = r x u/|r|^2, s = r . u/|r|^2 with the vector r from the ground end to the kite and its rate u, from the ends that
    x [m] and v [m/s] hold.
    """
    r = sub(get(x, n), get(x, 0))
    u = sub(get(v, n), get(v, 0))
    square = max(dot(r, r), segment.SHORTEST**2)
    return scale(1.0 / square, cross(r, u)), dot(r, u) / square


@kernel
def rigid_velocity(n, spin, stretching, x, v):
    """Velocities [m/s] of the inner nodes into v (modified): v_0 + omega x r + s r at the positions x [m]."""
    ground = get(x, 0)
    for i in range(1, n):
        r = sub(get(x, i), ground)
        put(v, i, add(get(v, 0), along(cross(spin, r), stretching, r)))


@kernel
def node_loads(n, spin, stretching, wind, length, pulls, tension, parameters, x, v, mass, load):
    """Drag, weight and inertia f of all nodes [N] into `load` (modified); v gets the velocities of the inner nodes.

    pulls : what is added to make `load` the residual: NO_PULL, that of the SPRINGS, or the TENSIONS [N].
    """
    rigid_velocity(n, spin, stretching, x, v)
    ground = get(x, 0)
    gravity = parameters[at.GRAVITY]
    x_p = ground
    v_p = get(v, 0)
    from_below = (0.0, 0.0, 0.0)
    for s in range(n):
        x_q = get(x, s + 1)
        v_q = get(v, s + 1)
        distance, e = segment.geometry(sub(x_q, x_p))
        middle = 0.5 * (x_p[2] + x_q[2])
        drag = segment.half_drag(s, n, distance, e, middle, scale(0.5, add(v_p, v_q)), wind, parameters)
        pull = (0.0, 0.0, 0.0)
        if pulls == SPRINGS:
            rest = nodes.rest_length(s, length, parameters)
            stiffness, _ = segment.stiffness(distance - rest, rest, s, n, parameters)
            pull = scale(stiffness * (distance - rest), e)
        elif pulls == TENSIONS:
            pull = scale(tension[s], e)
        acceleration = cross(spin, cross(spin, sub(x_p, ground)))
        body = scale(-mass[s], (acceleration[0], acceleration[1], acceleration[2] + gravity))
        put(load, s, add(add(from_below, body), add(drag, pull)))
        from_below = sub(drag, pull)
        x_p = x_q
        v_p = v_q
    acceleration = cross(spin, cross(spin, sub(x_p, ground)))
    body = scale(-mass[n], (acceleration[0], acceleration[1], acceleration[2] + gravity))
    put(load, n, add(from_below, body))


@kernel
def linearize(n, spin, stretching, length, wind, parameters, x, v, tension, w):
    """Records of all segments into w.records (modified), at velocities that follow the positions.

    K = (k - T/l) e e + T/l with the independent tensions T [N]; the drag's A becomes A S; no damper.
    """
    motion = add_to_diagonal(skew(spin), stretching)
    for s in range((n + 1) // 2):  # a segment in the middle is met twice
        mirror = n - 1 - s
        both = (s, mirror)
        x_p = get_two(x, s, mirror)
        x_q = get_two(x, s + 1, mirror + 1)
        r = sub(x_q, x_p)
        distance, e = segment.geometry(r)
        velocity = scale(0.5, add(get_two(v, s, mirror), get_two(v, s + 1, mirror + 1)))
        height = 0.5 * (x_p[2] + x_q[2])
        drag, drag_by_velocity, a = segment.linearize_drag(both, n, r, height, velocity, wind, parameters)
        rest = nodes.rest_length(both, length, parameters)
        stiffness, _ = segment.stiffness(distance - rest, rest, both, n, parameters)
        stretch = pair(tension[s], tension[mirror]) / distance
        start = 2 * at.SEGMENT_RECORD * s
        put_pairs(w.records, start + 2 * segment.K, add_to_diagonal(outer(scale(stiffness - stretch, e), e), stretch))
        put_pairs(w.records, start + 2 * segment.G, drag)
        put_pairs(w.records, start + 2 * segment.A, multiply(drag_by_velocity, motion))
        put_pairs(w.records, start + 2 * segment.HEIGHT, (*a, *e, 0.0 * stretch))


@kernel
def factorize_newton(n, spin, resistance, w):
    """Matrix of Newton's method from w.records, factorized into the block arrays of w; False if it is singular.

    Resistance c [N/m] of every node against its motion.
    """
    nodes.assemble(n, 0.0, 1.0, 1.0, w.mass, w.records, w.diagonal, w.lower, w.upper)
    square = dot(spin, spin)
    if square > 0.0 or resistance > 0.0:
        for i in range(1, n):
            block = w.diagonal[9 * i : 9 * i + 9]
            for j in range(3):
                for k in range(3):
                    block[3 * j + k] += w.mass[i] * spin[j] * spin[k]
                block[4 * j] += resistance - w.mass[i] * square
    return factorize(1, n - 1, w.diagonal, w.lower, w.upper)


@kernel
def step_by_stiffness(n, length, parameters, x, force, aim, w):
    """Newton step from the factors of `factorize_newton`: motions [m] into w.b, tensions [N] into `aim` (both modified)."""
    for k in range(3, 3 * n):
        w.b[k] = force[k]
    solve(1, n - 1, w.diagonal, w.lower, w.upper, w.b)
    put(w.b, 0, (0.0, 0.0, 0.0))
    put(w.b, n, (0.0, 0.0, 0.0))
    for s in range(n):
        distance, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rest = nodes.rest_length(s, length, parameters)
        stiffness, _ = segment.stiffness(distance - rest, rest, s, n, parameters)
        aim[s] = stiffness * (distance - rest + dot(e, sub(get(w.b, s + 1), get(w.b, s))))


@kernel
def step_by_compliance(n, spin, stretching, length, wind, parameters, x, v, tension, loosest, resistance, aim, w):
    """Newton step with the compliances of the segments: motions [m] into w.b, tensions [N] into `aim` (both modified).

    A segment counts as taut above the tension `loosest` [N]: where it is stiff, the least error of a position makes it
    shorter than its unstretched length.
    """
    linearize(n, spin, stretching, length, wind, parameters, x, v, tension, w)
    change = w.velocities[n : 2 * n]
    for s in range(n):
        record = nodes.record_of(s, n, w.records)
        distance, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rest = nodes.rest_length(s, length, parameters)
        branch = segment.TAUT if tension[s] > loosest else distance - rest
        stiffness, _ = segment.stiffness(branch, rest, s, n, parameters)
        aim[s] = tension[s] if branch > 0.0 else stiffness * (distance - rest)
        put_matrix(record, segment.K, compliance.of_segment(e, distance, stiffness, tension[s]))
        record[segment.DAMPER] = distance - rest - aim[s] / stiffness
    node_loads(n, spin, stretching, wind, length, TENSIONS, aim, parameters, x, v, w.mass, w.force)
    compliance.solve(
        n, spin, resistance, w.mass, w.force, w.records, w.diagonal, w.lower, w.momentum, w.force_rate, w.b, change
    )
    for s in range(n):
        aim[s] += change[s]


@kernel
def apply_step(n, length, parameters, x, tension, aim, change):
    """Move the positions x [m] and the tensions [N] (both modified) by a Newton step, shortened so that no node jumps.

    aim : tensions [N] at its end.  change : its motions [m]. Returns the largest motion over the length of a segment.
    """
    part = 1.0
    for s in range(n):
        rest = nodes.rest_length(s, length, parameters)
        part = min(part, rest / max(norm(sub(get(change, s + 1), get(change, s))), rest))
    for s in range(n):
        tension[s] = max(tension[s] + part * (aim[s] - tension[s]), SLOWEST_SLACKENING * tension[s])
    farthest = 0.0
    for i in range(1, n):
        step = get(change, i)
        farthest = max(farthest, dot(step, step))
        put(x, i, along(get(x, i), part, step))
    return sqrt(farthest) * n / length


@kernel
def smallest_residual(n, length, parameters, x, tension, mass):
    """Norm of the residual [N] that is as good as zero: a part of the forces, or the rounding error of the springs."""
    reach = 0.0
    for k in range(3 * (n + 1)):
        reach = max(reach, abs(x[k]))
    size = 0.0
    rounding = 0.0
    for s in range(n):
        size = max(size, tension[s] + mass[s] * parameters[at.GRAVITY])
        rest = nodes.rest_length(s, length, parameters)
        stiffness = parameters[at.PARAMETER_SCALARS + at.STIFFNESS * n + s] / rest
        rounding = max(rounding, stiffness * ROUNDING * (reach + rest))
    return ACCURACY * size + 4.0 * sqrt(n) * rounding


@kernel
def residual_norm(n, force):
    """Norm of the forces of the inner nodes [N]."""
    square = 0.0
    for k in range(3, 3 * n):
        square += force[k] * force[k]
    return sqrt(square)


@kernel
def relax(n, spin, stretching, length, wind, parameters, x, v, tension, compliant, firmness, creeps, most, w):
    """Newton's method from the positions x [m] and tensions [N] (x, v, tension modified), at most `most` iterations.

    compliant : step 3 instead of step 2, whose matrix is kept while the residual falls fast.  firmness : stiffness [N/m]
    that the loads alone give a node (0 where it is not known), the first resistance if the chain `creeps`.
    Returns (True, iterations) or (False, iterations).
    """
    resistance = firmness if creeps else 0.0
    loosest = LOOSEST * firmness * length / n
    aim = w.velocities[:n]
    last = 0.0
    fresh = False
    for iteration in range(most):
        node_loads(n, spin, stretching, wind, length, SPRINGS, tension, parameters, x, v, w.mass, w.force)
        residual = residual_norm(n, w.force)
        goal = smallest_residual(n, length, parameters, x, tension, w.mass)
        stalled = fresh and not creeps and residual > 0.5 * last
        if residual <= goal or (stalled and residual <= STALLED * goal):
            return True, iteration
        if not residual < inf:
            return False, iteration
        fresh = compliant or not residual < FAST_DECREASE * last
        last = residual
        if compliant:
            step_by_compliance(n, spin, stretching, length, wind, parameters, x, v, tension, loosest, resistance, aim, w)
        else:
            if fresh:
                linearize(n, spin, stretching, length, wind, parameters, x, v, tension, w)
                if not factorize_newton(n, spin, resistance, w):
                    return False, iteration
            step_by_stiffness(n, length, parameters, x, w.force, aim, w)
        motion = apply_step(n, length, parameters, x, tension, aim, w.b)
        if motion < NEAR:
            resistance *= 0.5
        elif motion > FAR:
            resistance = min(2.0 * resistance, FIRMEST * firmness)
    return False, most


@kernel
def first_tension_guess(n, chord, load, length, parameters):
    """First tension vector [N] of the catenary with the chord [m] under the mean load per unstretched length [N/m]."""
    size = norm(load)
    compliance = 0.0
    for s in range(n):
        compliance += parameters[at.PARAMETER_SCALARS + s] / parameters[at.PARAMETER_SCALARS + at.STIFFNESS * n + s]
    if not size * length * compliance > 1e-12:
        distance, e = segment.geometry(chord)
        return scale(max(distance / length - 1.0, 1e-9) / compliance, e)
    down = scale(1.0 / size, load)
    across = along(chord, -dot(chord, down), down)
    span = norm(across)
    horizontal, vertical, iterations = elastic_catenary.solve(span, -dot(chord, down), size, length, 1.0 / compliance)
    if iterations < 0:
        return scale(size, chord)
    sideways = scale(horizontal / max(span, segment.SHORTEST), across)
    return along(sideways, 0.5 * size * length - vertical, down)


@kernel
def hang_under_mean_load(n, length, parameters, x, tension, load):
    """Hang the chain under the mean of the loads [N] of its nodes (x, tension, load modified)."""
    mean = (0.0, 0.0, 0.0)
    for i in range(n + 1):
        mean = add(mean, get(load, i))
    mean = scale(1.0 / length, mean)
    for i in range(1, n):
        share = 0.5 * (parameters[at.PARAMETER_SCALARS + i - 1] + parameters[at.PARAMETER_SCALARS + i])
        put(load, i, scale(share * length, mean))
    guess = first_tension_guess(n, sub(get(x, n), get(x, 0)), mean, length, parameters)
    hanging_chain.hang(n, guess, length, load, parameters, x, tension)


@kernel
def guess(n, spin, stretching, length, wind, parameters, x, v, tension, w):
    """Step 1: positions [m] of the inner nodes and tensions [N] (x, v, tension modified) to start from.

    Returns the stiffness [N/m] that the loads alone give a node: their mean over the length of a segment.
    """
    load = w.x_stage
    straighten(n, parameters, x)
    node_loads(n, spin, stretching, wind, length, NO_PULL, tension, parameters, x, v, w.mass, load)
    total = 0.0
    for i in range(1, n):
        total += norm(get(load, i))
    hang_under_mean_load(n, length, parameters, x, tension, load)
    return total / length


@kernel
def tensions(n, length, parameters, x, tension):
    """Tensions of the taut springs [N] into `tension` (modified, n numbers) at the positions x [m]."""
    for s in range(n):
        distance, _ = segment.geometry(sub(get(x, s + 1), get(x, s)))
        strain = distance / nodes.rest_length(s, length, parameters) - 1.0
        tension[s] = parameters[at.PARAMETER_SCALARS + at.STIFFNESS * n + s] * strain


@kernel
def follow(n, spin, stretching, length, wind, parameters, x, v, tension, w):
    """Equilibrium from positions x [m] and tensions [N] that are close (x, v, tension modified).

    Arguments as in `find`. Returns (found, iterations).
    """
    nodes.node_masses(n, length, parameters, w.mass)
    return relax(n, spin, stretching, length, wind, parameters, x, v, tension, False, 0.0, False, MOST_ITERATIONS, w)


@kernel
def find(n, spin, stretching, length, wind, parameters, x, v, w):
    """Equilibrium between the ends that x [m] and v [m/s] hold (inner nodes of both modified).

    Angular velocity [rad/s] about the ground end, rate of stretch [1/s], unstretched length [m], wind at the reference
    height [m/s]. Returns a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations.
    """
    nodes.node_masses(n, length, parameters, w.mass)
    tension = w.r[:n]
    found = False
    iterations = 0
    for attempt in range(4):
        compliant = attempt % 2 == 1
        creeps = attempt >= 2
        most = MOST_CREEPING if creeps else MOST_ITERATIONS
        firmness = guess(n, spin, stretching, length, wind, parameters, x, v, tension, w)
        found, more = relax(
            n, spin, stretching, length, wind, parameters, x, v, tension, compliant, firmness, creeps, most, w
        )
        iterations += more
        if found:
            break
    return OK if found else NO_EQUILIBRIUM, iterations
