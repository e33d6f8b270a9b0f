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
5. If what is found is a strut (`strut.py`), or nothing is found and the chain has no load: all of it again, with a breath
   of air from the side in step 1.

What this leaves, `slower_motion.py` and `turn.py` find.
"""

from collections import namedtuple
from math import inf, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from ..algebra import block_tridiagonal
from ..algebra.both_ends import get_two
from ..algebra.matrices import add_to_diagonal, multiply, outer, put_matrix, skew
from ..algebra.pairs import pair
from ..algebra.vectors import add, along, cross, dot, get, norm, put, scale, sub
from ..arrays import node_arrays, shared_arrays
from ..chain import nodes, segment
from ..chain.properties import point_mass, property_of, rest_length
from ..compilation import kernel, view
from . import compliance, elastic_catenary, hanging_chain, strut

NO_PULL, SPRINGS, TENSIONS = 0, 1, 2  # what pulls at the nodes
MOST_ITERATIONS = 30  # of steps 2 and 3; warm it needs 2 or 3, cold about 6
ROUNDING = 2.3e-16  # relative, of a 64-bit float
LIGHTEST = 1e-12  # mean load over EA below which the first guess is a straight line
ACCURACY = 1e-12  # residual over the size of the forces
STALLED = 2.0  # a residual that falls no more is rounding up to this many times the estimate of it
FAST_DECREASE = 1e-4  # of the residual in one iteration: the matrix is kept
SLOWEST_SLACKENING = 0.2  # a tension falls to no less than this part in one iteration
MOST_CREEPING = 300  # iterations of step 4
LOOSEST = 1e-3  # tension over the load of a node above which a segment counts as taut, however short it is, in step 3
NEAR, FAR = 0.5, 1.5  # motion of a node over the length of a segment below and above which the resistance changes
FIRMEST = 100.0  # resistance over that of the first iteration
BREATH, FAINTEST_BREATH = 0.01, 1e-6  # load from the side in step 5 over the mean load; at least, over EA

Body = namedtuple("Body", "chain spin stretching x v")
Body.__doc__ = """A chain that moves as a body about its ground end.

chain : `Chain`.  spin : angular velocity omega [rad/s].  stretching : rate of stretch s [1/s].
x, v : positions [m] and velocities [m/s] of all nodes; those of the ends are given, those of the inner nodes modified.
"""

Balance = namedtuple(
    "Balance", "load force move offset share tension aim change kept kept_tension matrix response transfer records mass"
)
Balance.__doc__ = """Scratch arrays of Newton's method; 3 (n + 1) numbers where nothing else is said.

load : of the nodes without tensions [N].  force : residual [N].  move : of the nodes in one iteration [m].
tension : of the segments [N], n.  aim : tensions at the end of an iteration [N], n.  change : of the tensions [N], n.
kept, kept_tension : an equilibrium to go on from, positions [m] and tensions [N], n.
response, transfer, offset, share : M, Z, m, Z y of `compliance.solve`; the first two have 9 (n + 1) numbers and stand where
blocks of the matrix are.  matrix, records, mass : see `arrays.shared_arrays`.
"""


@view
def balance(n, work):
    """Cut the work array into the arrays of `Balance`."""
    blocks, records, mass, room = shared_arrays(n, work)
    load, force, move, offset, share, tensions, room = node_arrays(n, room)
    matrix = block_tridiagonal.Matrix(*blocks)
    three = tensions[:n], tensions[n : 2 * n], tensions[2 * n : 3 * n]
    kept = room[: 3 * (n + 1)], room[3 * (n + 1) : 4 * n + 3]
    return Balance(load, force, move, offset, share, *three, *kept, matrix, matrix.diagonal, matrix.lower, records, mass)


@kernel
def straighten(chain, x):
    """Put the inner nodes of x (modified) on the straight line between its ends, at equal strain."""
    ground = get(x, 0)
    chord = sub(get(x, chain.n), ground)
    part = 0.0
    for i in range(1, chain.n):
        part += property_of(chain, i - 1, at.SHARE)
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
def rigid_velocity(body):
    """Velocities [m/s] of the inner nodes of the body (modified): v_0 + omega x r + s r at their positions."""
    x, v = body.x, body.v
    ground = get(x, 0)
    for i in range(1, body.chain.n):
        r = sub(get(x, i), ground)
        put(v, i, add(get(v, 0), along(cross(body.spin, r), body.stretching, r)))


@kernel
def spring(chain, s, length, is_taut):
    """Elongation l - l0 [m] and stiffness k [N/m] of a segment of this length [m], as if it were taut if `is_taut`."""
    rest = rest_length(chain, s)
    k, _ = segment.stiffness(chain, s, segment.TAUT if is_taut else length - rest, rest)
    return length - rest, k


@kernel
def body_force(body, mass, x):
    """Weight and inertia [N] of a node of this mass [kg] at x [m]."""
    acceleration = cross(body.spin, cross(body.spin, sub(x, get(body.x, 0))))
    gravity = body.chain.parameters[at.GRAVITY]
    return scale(-mass, (acceleration[0], acceleration[1], acceleration[2] + gravity))


@kernel
def node_loads(body, pulls, tension, mass, load):
    """Drag, weight and inertia f of all nodes [N] into `load` (modified); the body gets the velocities of its inner nodes.

    pulls : what is added to make `load` the residual: NO_PULL, that of the SPRINGS, or the TENSIONS [N].
    """
    rigid_velocity(body)
    chain = body.chain
    x_p = get(body.x, 0)
    v_p = get(body.v, 0)
    from_below = (0.0, 0.0, 0.0)
    for s in range(chain.n):
        x_q = get(body.x, s + 1)
        v_q = get(body.v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        drag = segment.half_drag(chain, s, length, e, 0.5 * (x_p[2] + x_q[2]), scale(0.5, add(v_p, v_q)))
        pull = (0.0, 0.0, 0.0)
        if pulls == SPRINGS:
            elongation, k = spring(chain, s, length, False)
            pull = scale(k * elongation, e)
        elif pulls == TENSIONS:
            pull = scale(tension[s], e)
        put(load, s, add(add(from_below, body_force(body, mass[s], x_p)), add(drag, pull)))
        from_below = sub(drag, pull)
        x_p = x_q
        v_p = v_q
    put(load, chain.n, add(from_below, body_force(body, mass[chain.n], x_p)))


@kernel
def linearize(body, w):
    """Records of all segments into w.records (modified), at velocities that follow the positions.

    K = (k - T/l) e e + T/l with the independent tensions T = w.tension [N]; the drag's A becomes A S; no damper.
    """
    chain, x, v = body.chain, body.x, body.v
    motion = add_to_diagonal(skew(body.spin), body.stretching)
    for s in range((chain.n + 1) // 2):  # a segment in the middle is met twice
        mirror = chain.n - 1 - s
        both = (s, mirror)
        x_p = get_two(x, s, mirror)
        x_q = get_two(x, s + 1, mirror + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        velocity = scale(0.5, add(get_two(v, s, mirror), get_two(v, s + 1, mirror + 1)))
        drag, drag_by_velocity, a = segment.linearize_drag(chain, both, length, e, 0.5 * (x_p[2] + x_q[2]), velocity)
        rest = rest_length(chain, both)
        stiffness, _ = segment.stiffness(chain, both, length - rest, rest)
        stretch = pair(w.tension[s], w.tension[mirror]) / length
        axial = add_to_diagonal(outer(scale(stiffness - stretch, e), e), stretch)
        nodes.put_records(s, axial, drag, multiply(drag_by_velocity, motion), (*a, *e, 0.0 * stretch), w.records)


@kernel
def factorize(body, resistance, w):
    """Matrix of Newton's method from w.records, factorized into w.matrix; False if it is singular.

    Resistance c [N/m] of every node against its motion.
    """
    n = body.chain.n
    spin = body.spin
    nodes.assemble(n, 0.0, 1.0, 1.0, w.mass, w.records, w.matrix)
    square = dot(spin, spin)
    if square > 0.0 or resistance > 0.0:
        for i in range(1, n):
            block = w.matrix.diagonal[9 * i : 9 * i + 9]
            for j in range(3):
                for k in range(3):
                    block[3 * j + k] += w.mass[i] * spin[j] * spin[k]
                block[4 * j] += resistance - w.mass[i] * square
    return block_tridiagonal.factorize(1, n - 1, w.matrix)


@kernel
def step_by_stiffness(body, w):
    """Newton step from the factors of `factorize`: motions [m] into w.move, tensions [N] into w.aim (both modified)."""
    n = body.chain.n
    for k in range(3, 3 * n):
        w.move[k] = w.force[k]
    block_tridiagonal.solve(1, n - 1, w.matrix, w.move)
    put(w.move, 0, (0.0, 0.0, 0.0))
    put(w.move, n, (0.0, 0.0, 0.0))
    for s in range(n):
        length, e = segment.geometry(sub(get(body.x, s + 1), get(body.x, s)))
        elongation, k = spring(body.chain, s, length, False)
        w.aim[s] = k * (elongation + dot(e, sub(get(w.move, s + 1), get(w.move, s))))


@kernel
def step_by_compliance(body, loosest, resistance, w):
    """Newton step with the compliances of the segments: motions [m] into w.move, tensions [N] into w.aim (both modified).

    A segment counts as taut above the tension `loosest` [N]: where it is stiff, the least error of a position makes it
    shorter than its unstretched length.
    """
    linearize(body, w)
    n = body.chain.n
    for s in range(n):
        record = nodes.record_of(s, n, w.records)
        taut = w.tension[s] > loosest
        length, e = segment.geometry(sub(get(body.x, s + 1), get(body.x, s)))
        elongation, k = spring(body.chain, s, length, taut)
        w.aim[s] = w.tension[s] if taut or elongation > 0.0 else k * elongation
        put_matrix(record, segment.K, compliance.of_segment(e, length, k, w.tension[s]))
        record[segment.DAMPER] = elongation - w.aim[s] / k
    node_loads(body, TENSIONS, w.aim, w.mass, w.force)
    compliance.solve(body.spin, resistance, w)
    for s in range(n):
        w.aim[s] += w.change[s]


@kernel
def apply_step(body, w):
    """Move the positions of the body [m] and w.tension [N] (both modified) by w.move and towards w.aim.

    Shortened so that no node jumps. Returns the largest motion over the length of a segment.
    """
    chain = body.chain
    part = nodes.longest_part(chain, w.move)
    for s in range(chain.n):
        w.tension[s] = max(w.tension[s] + part * (w.aim[s] - w.tension[s]), SLOWEST_SLACKENING * w.tension[s])
    farthest = 0.0
    for i in range(1, chain.n):
        step = get(w.move, i)
        farthest = max(farthest, dot(step, step))
        put(body.x, i, along(get(body.x, i), part, step))
    return sqrt(farthest) * chain.n / chain.length


@kernel
def smallest_residual(body, w):
    """Norm of the residual [N] that is as good as zero: a part of the forces, or the rounding error of the springs."""
    chain = body.chain
    reach = 0.0
    for k in range(3 * (chain.n + 1)):
        reach = max(reach, abs(body.x[k]))
    size = 0.0
    rounding = 0.0
    for s in range(chain.n):
        size = max(size, w.tension[s] + w.mass[s] * chain.parameters[at.GRAVITY])
        rest = rest_length(chain, s)
        rounding = max(rounding, property_of(chain, s, at.STIFFNESS) / rest * ROUNDING * (reach + rest))
    return ACCURACY * size + 4.0 * sqrt(chain.n) * rounding


@kernel
def residual_norm(n, force):
    """Norm of the forces of the inner nodes [N]."""
    square = 0.0
    for k in range(3, 3 * n):
        square += force[k] * force[k]
    return sqrt(square)


@kernel
def relax(body, compliant, creeps, firmness, w):
    """Newton's method from the positions of the body [m] and w.tension [N] (both modified).

    compliant : step 3 instead of step 2, whose matrix is kept while the residual falls fast.  creeps : step 4.  firmness :
    stiffness [N/m] that the loads alone give a node (0 where it is not known), the first resistance if the chain creeps.
    Returns (True, iterations) or (False, iterations).
    """
    most = MOST_CREEPING if creeps else MOST_ITERATIONS
    resistance = firmness if creeps else 0.0
    loosest = LOOSEST * firmness * body.chain.length / body.chain.n
    last = 0.0
    fresh = False
    for iteration in range(most):
        node_loads(body, SPRINGS, w.tension, w.mass, w.force)
        residual = residual_norm(body.chain.n, w.force)
        goal = smallest_residual(body, w)
        stalled = fresh and not creeps and residual > 0.5 * last
        if residual <= goal or (stalled and residual <= STALLED * goal):
            return True, iteration
        if not residual < inf:
            return False, iteration
        fresh = compliant or not residual < FAST_DECREASE * last
        last = residual
        if compliant:
            step_by_compliance(body, loosest, resistance, w)
        else:
            if fresh:
                linearize(body, w)
                if not factorize(body, resistance, w):
                    return False, iteration
            step_by_stiffness(body, w)
        motion = apply_step(body, w)
        if motion < NEAR:
            resistance *= 0.5
        elif motion > FAR:
            resistance = min(2.0 * resistance, FIRMEST * firmness)
    return False, most


@kernel
def softness_of(chain):
    """1/EA [1/N] of the whole chain."""
    softness = 0.0
    for s in range(chain.n):
        softness += property_of(chain, s, at.SHARE) / property_of(chain, s, at.STIFFNESS)
    return softness


@kernel
def is_loaded(chain, load):
    """Whether a mean load per unstretched length [N/m] is enough to give the chain a shape."""
    return load * chain.length * softness_of(chain) > LIGHTEST


@kernel
def first_tension_guess(chain, chord, load):
    """First tension vector [N] of the catenary with the chord [m] under the mean load per unstretched length [N/m]."""
    size = norm(load)
    softness = softness_of(chain)
    if not is_loaded(chain, size):
        distance, e = segment.geometry(chord)
        return scale(max(distance / chain.length - 1.0, 1e-9) / softness, e)
    tension, iterations = elastic_catenary.hang(chord, load, chain.length, 1.0 / softness)
    if iterations < 0:
        return scale(size, chord)
    return tension


@kernel
def breath(chain, chord, load):
    """Load per unstretched length [N/m] from the side of a strut: across its mean load [N/m], without load its chord [m]."""
    least = FAINTEST_BREATH / (chain.length * softness_of(chain))
    size = norm(load)
    return scale(max(BREATH * size, least), strut.sideways(load if size > least else chord))


@kernel
def hang_under_mean_load(body, aside, w):
    """Hang the chain under the mean of the loads w.load [N] of its nodes (positions, w.tension, w.load modified).

    A point mass at the kite end is held by that end and does not pull at the chain.
    aside : whether under a `breath` from the side, too.
    """
    chain, x = body.chain, body.x
    mean = (0.0, 0.0, 0.0)
    for i in range(chain.n + 1):
        mean = add(mean, get(w.load, i))
    mean = sub(mean, body_force(body, point_mass(chain, chain.n), get(x, chain.n)))
    mean = scale(1.0 / chain.length, mean)
    chord = sub(get(x, chain.n), get(x, 0))
    if aside:
        mean = add(mean, breath(chain, chord, mean))
    for i in range(1, chain.n):
        share = 0.5 * (property_of(chain, i - 1, at.SHARE) + property_of(chain, i, at.SHARE))
        put(w.load, i, scale(share * chain.length, mean))
    guess = first_tension_guess(chain, chord, mean)
    hanging_chain.hang(chain, guess, w.load, x, w.tension)


@kernel
def guess(body, aside, w):
    """Step 1: positions of the inner nodes [m] and w.tension [N] (both modified) to start from.

    aside : whether away from a strut, see `hang_under_mean_load`.
    Returns the stiffness [N/m] that the loads alone give a node: their mean over the length of a segment.
    """
    straighten(body.chain, body.x)
    node_loads(body, NO_PULL, w.tension, w.mass, w.load)
    total = 0.0
    for i in range(1, body.chain.n):
        total += norm(get(w.load, i))
    hang_under_mean_load(body, aside, w)
    return total / body.chain.length


@kernel
def tensions(chain, x, tension):
    """Tensions of the taut springs [N] into `tension` (modified, n numbers) at the positions x [m]."""
    for s in range(chain.n):
        length, _ = segment.geometry(sub(get(x, s + 1), get(x, s)))
        tension[s] = property_of(chain, s, at.STIFFNESS) * (length / rest_length(chain, s) - 1.0)


@kernel
def follow(body, w):
    """Stable equilibrium from positions [m] and w.tension [N] that are close (both modified): (found, iterations)."""
    nodes.node_masses(body.chain, w.mass)
    found, iterations = relax(body, False, False, 0.0, w)
    return found and not strut.is_strut(body.chain, body.x, strut.PARALLEL), iterations


@kernel
def find(body, w):
    """Stable equilibrium between the ends of the body (positions and velocities of its inner nodes modified).

    Returns a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations.
    """
    nodes.node_masses(body.chain, w.mass)
    iterations = 0
    attempt = 0
    aside = False
    while attempt < 4:
        firmness = guess(body, aside, w)
        found, more = relax(body, attempt % 2 == 1, attempt >= 2, firmness, w)
        iterations += more
        stands = found and strut.is_strut(body.chain, body.x, strut.PARALLEL)
        if found and not stands:
            return OK, iterations
        turns_aside = not aside and (stands or (attempt == 3 and not is_loaded(body.chain, firmness)))
        attempt = 0 if turns_aside else attempt + 1
        aside = aside or turns_aside
    return NO_EQUILIBRIUM, iterations
