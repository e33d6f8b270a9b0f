"""Newton's method for the equilibrium of a chain between two given ends.

The unknowns are the positions of the inner nodes. Every node moves as a point of a body (`rigid_body.py`), or rests:

    T_i e_i - T_(i-1) e_(i-1) + f_i(x, v) = 0,       f_i = half drags + loads of the node,   T = k (l - l0)

Where the air blows the tether back on itself, the tension passes through zero: a segment there may be slack, with
slack stiffness.

The tensions are additional unknowns. They are eliminated from the linear system, which remains block tridiagonal; the
difference is that the lateral stiffness T/l uses the tension of the last iteration instead of the segment length,
whose error is amplified by EA/l0.

COMPLIANCES: uses the compliances of the segments instead of their STIFFNESSES (`compliance.py`), because in a stiff
and slack chain the lateral stiffness drowns in the rounding errors of the axial stiffness. EITHER_SIGN: COMPLIANCES with
tensions that may pass through zero, at a part of their size (`compressed_segments.py`).

Pseudo-transient continuation: with a damping c against motion, (c - dF/dx) dx = F, implicit steps in the pseudo-time 1/c. c
decreases while the nodes move little, down to Newton's method.

`solve.py` selects among them.
"""

from collections import namedtuple
from math import inf, sqrt

from tetherfmu.runtime import layout as at

from ..arrays import behind, copy, node_arrays, parameters_size, shared_arrays, shared_size
from ..compilation import kernel, view
from ..equations import assembly, node_loads, segment
from ..equations.ground import carries
from ..equations.properties import property_of, rest_length
from ..flat_arrays import part
from ..linear_algebra import block_tridiagonal
from ..linear_algebra.both_ends import get_two
from ..linear_algebra.matrices import add_to_diagonal, get_matrix, multiply, outer, put_matrix, subtract
from ..linear_algebra.pairs import pair
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, dot, get, put, scale, sub
from . import compliance
from .rigid_body import SPRINGS, TENSIONS, loads, motion_of, support_stiffness

STIFFNESSES, COMPLIANCES, EITHER_SIGN = range(3)  # kinds of step
MOST_ITERATIONS = 30  # warm it needs 2 or 3, cold about 6
ROUNDING = 2.3e-16  # relative, of a 64-bit float
ACCURACY = 1e-12  # residual over the size of the forces
STALLED = 2.0  # a stagnating residual is rounding up to this multiple of the estimate
FAST_DECREASE = 1e-4  # decrease of the residual in one iteration that keeps the matrix
SLOWEST_SLACKENING = 0.2  # lower limit of a tension in one iteration, relative, also for the part left after a sign change
SLOWEST_GROWTH = 5.0  # upper limit of a compression in one iteration, relative
MOST_PSEUDO_STEPS = 300
LOOSEST = 1e-3  # tension over node load above which a segment counts as taut at any length, if compliant
NEAR, FAR = 0.5, 1.5  # node displacement over segment length: limits to change the pseudo-damping
LARGEST_PSEUDO_DAMPING = 100.0  # relative to the first iteration
LEAST_ON_GROUND = 1e-6  # lower limit on the ground, relative: a chain without tension has no stiffness there

Workspace = namedtuple(
    "Workspace",
    "load force move offset share tension aim change kept kept_tension hung hung_tension anchor velocity parameters "
    "matrix response transfer records mass",
)
Workspace.__doc__ = """Scratch arrays of Newton's method; 3 (n + 1) numbers unless stated otherwise.

load : of the nodes without tensions [N].  force : residual [N].  move : displacements in one iteration [m].
tension : of the segments [N], n.  aim : tensions at the end of an iteration [N], n.  change : of the tensions [N], n.
kept, kept_tension : an equilibrium to continue from, positions [m] and tensions [N], n.
hung, hung_tension : an equilibrium without ground.  anchor : friction anchors of the nodes of a pile [m].
velocity : of the nodes under other loads [m/s].  parameters : of the chain at another level, see `arrays.parameters_size`.
response, transfer, offset, share : M, Z, m, Z y of `compliance.solve`; the first two have 9 (n + 1) numbers and share
memory with the matrix blocks.  matrix, records, mass : see `arrays.shared_arrays`."""


@kernel
def workspace_size(n):
    """Length of the work array that `workspace` needs."""
    return shared_size(n) + 10 * 3 * (n + 1) + 2 * n + parameters_size(n)


@view
def workspace(n, work):
    """Cut the work array into the arrays of `Workspace`."""
    blocks, records, mass, room = shared_arrays(n, work)
    load, force, move, offset, share, tensions, room = node_arrays(n, room)
    matrix = block_tridiagonal.Matrix(*blocks)
    three = part(tensions, 0, n), part(tensions, n, n), part(tensions, 2 * n, n)
    flat = 3 * (n + 1)
    kept, room = (part(room, 0, flat), part(room, flat, n)), behind(flat + n, room)
    hung, room = (part(room, 0, flat), part(room, flat, n)), behind(flat + n, room)
    anchor, velocity, other = part(room, 0, flat), part(room, flat, flat), part(room, 2 * flat, parameters_size(n))
    blocks = matrix, matrix.diagonal, matrix.lower
    return Workspace(load, force, move, offset, share, *three, *kept, *hung, anchor, velocity, other, *blocks, records, mass)


@kernel
def keep(body, w):
    """Save the positions of the body and w.tension in w (modified), as an equilibrium to continue from."""
    copy(body.x, w.kept)
    copy(w.tension, w.kept_tension)


@kernel
def restore(body, w):
    """Restore the positions of the body and w.tension (both modified) saved by `keep`."""
    copy(w.kept, body.x)
    copy(w.kept_tension, w.tension)


@kernel
def linearize(body, w):
    """Records of all segments into w.records (modified), at velocities that follow the positions.

    K = (k - T/l) e e + T/l with the independent tensions T = w.tension [N]; drag uses A S for A; no damper.
    """
    chain, x, v = body.chain, body.x, body.v
    motion = motion_of(body)
    for s in range((chain.n + 1) // 2):  # the loop visits a middle segment twice
        mirror = chain.n - 1 - s
        both = (s, mirror)
        x_p = get_two(x, s, mirror)
        x_q = get_two(x, s + 1, mirror + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        v_p, v_q = get_two(v, s, mirror), get_two(v, s + 1, mirror + 1)
        _, drag, drag_by_velocity, a = segment.linearize_drag_between(chain, both, length, e, x_p, x_q, v_p, v_q)
        rest = rest_length(chain, both)
        stiffness, _ = segment.stiffness(chain, both, length - rest, rest)
        across = pair(w.tension[s], w.tension[mirror]) / length
        axial = add_to_diagonal(outer(scale(stiffness - across, e), e), across)
        assembly.put_records(s, axial, drag, multiply(drag_by_velocity, motion), (*a, *e, 0.0 * across), w.records)


@kernel
def factorize(body, pseudo_damping, w):
    """Matrix of Newton's method from w.records, factorized into w.matrix; False if it is singular.

    pseudo_damping : c [N/m], against the motion of every node.
    """
    chain, n, spin = body.chain, body.chain.n, body.spin
    assembly.assemble(n, 0.0, 1.0, 1.0, w.mass, w.records, w.matrix)
    if node_loads.has_slope(chain, spin, pseudo_damping):
        for i in range(1, n):
            block = part(w.matrix.diagonal, 9 * i, 9)
            node_loads.subtract_slope(chain, w.mass[i], get(body.x, i), get(body.v, i), spin, pseudo_damping, block)
    for i in range(1, n):
        if carries(body.ground, get(body.x, i)):
            slope = support_stiffness(body, w.mass[i], i)
            put_matrix(w.matrix.diagonal, 9 * i, subtract(get_matrix(w.matrix.diagonal, 9 * i), slope))
    return block_tridiagonal.factorize(1, n - 1, w.matrix)


@kernel
def step_by_stiffness(body, w):
    """Newton step from the factors of `factorize`: displacements [m] in w.move, tensions [N] in w.aim (both modified)."""
    n = body.chain.n
    for k in range(3, 3 * n):
        w.move[k] = w.force[k]
    block_tridiagonal.solve(1, n - 1, w.matrix, w.move)
    put(w.move, 0, ZERO_VECTOR)
    put(w.move, n, ZERO_VECTOR)
    for s in range(n):
        length, e = segment.geometry(sub(get(body.x, s + 1), get(body.x, s)))
        elongation, k = segment.spring(body.chain, s, length, False)
        w.aim[s] = k * (elongation + dot(e, sub(get(w.move, s + 1), get(w.move, s))))


@kernel
def step_by_compliance(body, loosest, pseudo_damping, w):
    """Newton step with the segment compliances: displacements [m] into w.move, tensions [N] into w.aim (both modified).

    A segment counts as taut above the tension `loosest` [N]: if it is stiff, the smallest position error makes it
    shorter than its unstretched length. Returns False, with invalid results, if a segment has no stiffness at all.
    """
    linearize(body, w)
    n = body.chain.n
    for s in range(n):
        record = assembly.record_of(s, n, w.records)
        taut = w.tension[s] > loosest
        length, e = segment.geometry(sub(get(body.x, s + 1), get(body.x, s)))
        elongation, k = segment.spring(body.chain, s, length, taut)
        if k == 0.0 or w.tension[s] == 0.0:
            return False
        w.aim[s] = w.tension[s] if taut or elongation > 0.0 else k * elongation
        put_matrix(record, segment.K, compliance.of_segment(e, length, k, w.tension[s]))
        record[segment.DAMPER] = elongation - w.aim[s] / k
    loads(body, TENSIONS, w.aim, w.mass, w.force)
    compliance.solve(body, pseudo_damping, w)
    for s in range(n):
        w.aim[s] += w.change[s]
    return True


@kernel
def lowest_tension(kind, tension):
    """Lower limit of a tension [N] in one iteration with this kind of step."""
    if kind != EITHER_SIGN:
        return SLOWEST_SLACKENING * tension
    return -SLOWEST_SLACKENING * tension if tension > 0.0 else SLOWEST_GROWTH * tension


@kernel
def apply_step(body, kind, w):
    """Move the positions of the body [m] and w.tension [N] (both modified) by w.move and towards w.aim.

    Shortened so that no node jumps. Returns the largest displacement over the segment length.
    """
    chain = body.chain
    taken = assembly.longest_part(chain, w.move)
    for s in range(chain.n):
        w.tension[s] = max(w.tension[s] + taken * (w.aim[s] - w.tension[s]), lowest_tension(kind, w.tension[s]))
    farthest = 0.0
    for i in range(1, chain.n):
        step = get(w.move, i)
        farthest = max(farthest, dot(step, step))
        put(body.x, i, add_scaled(get(body.x, i), taken, step))
    return sqrt(farthest) * chain.n / chain.length


@kernel
def changed_damping(pseudo_damping, motion, least, load_stiffness):
    """Pseudo-damping [N/m] after a displacement over the segment length: at least `least`, see `relax`."""
    if motion < NEAR:
        return max(0.5 * pseudo_damping, least)
    if motion > FAR:
        return min(2.0 * pseudo_damping, LARGEST_PSEUDO_DAMPING * load_stiffness)
    return pseudo_damping


@kernel
def smallest_residual(body, w):
    """Residual norm [N] that counts as zero: a part of the forces, or the rounding error of the springs."""
    chain = body.chain
    reach = 0.0
    for k in range(3 * (chain.n + 1)):
        reach = max(reach, abs(body.x[k]))
    size = 0.0
    rounding = 0.0
    for s in range(chain.n):
        size = max(size, w.tension[s] + w.mass[s] * chain.gravity)
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
def loosest(body, load_stiffness):
    """Tension [N] above which a segment counts as taut in `step_by_compliance`; stiffness as in `relax`."""
    return LOOSEST * load_stiffness * body.chain.length / body.chain.n


@kernel
def relax(body, kind, pseudo_transient, load_stiffness, w):
    """Newton's method from the positions of the body [m] and w.tension [N] (both modified).

    kind, pseudo_transient : see the head of this file. With STIFFNESSES, the matrix is kept while the residual decreases
    fast.  load_stiffness : stiffness [N/m] of a node due to the loads alone, the first pseudo-damping (0: unknown).
    Returns (True, iterations) or (False, iterations).
    """
    most = MOST_PSEUDO_STEPS if pseudo_transient else MOST_ITERATIONS
    pseudo_damping = load_stiffness if pseudo_transient else 0.0
    least = LEAST_ON_GROUND * pseudo_damping if body.ground.hardness > 0.0 else 0.0
    last = 0.0
    fresh = False
    for iteration in range(most):
        loads(body, SPRINGS, w.tension, w.mass, w.force)
        residual = residual_norm(body.chain.n, w.force)
        goal = smallest_residual(body, w)
        stalled = fresh and not pseudo_transient and residual > 0.5 * last
        if residual <= goal or (stalled and residual <= STALLED * goal):
            return True, iteration
        if not residual < inf:
            return False, iteration
        fresh = kind != STIFFNESSES or not residual < FAST_DECREASE * last
        last = residual
        if kind != STIFFNESSES:
            if not step_by_compliance(body, loosest(body, load_stiffness), pseudo_damping, w):
                return False, iteration + 1
        else:
            if fresh:
                linearize(body, w)
                if not factorize(body, pseudo_damping, w):
                    return False, iteration
            step_by_stiffness(body, w)
        motion = apply_step(body, kind, w)
        pseudo_damping = changed_damping(pseudo_damping, motion, least, load_stiffness)
    return False, most
