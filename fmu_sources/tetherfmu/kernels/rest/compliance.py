"""Newton's linear system of a chain in equilibrium, solved from its ground end by accumulating compliances.

Segment s joins node p to node q. Its pull at p increases by P above its tension T e, its drag on each node changes by F:

    dx_q - dx_p = E P - g e,           E = e e/k + (l/T) (1 - e e),   g = l - l0 - T/k
    F = (G + H) (dx_q - dx_p) + 2 H dx_p,     H: change of the half drag with the mean position of its nodes

The chain up to p yields to its load by dx_p = C (P + F) + d. So dx_p = M P + m, and the balance of node q with its
residual f_q, its own dF_q/dx_q = R and the load L of the rest of the chain,

    -P + F + f_q + R dx_q + L = 0,

yields P = Z (L + y) and the compliance of the chain up to q: C = (M + E) Z. Nothing cancels in these sums, however stiff the
segments are, while in `block_tridiagonal.py` T/l drowned in the rounding errors of k at k l/T = 1e8.
"""

from ..compilation import kernel
from ..equations import node_loads, segment
from ..equations.assembly import record_of
from ..equations.ground import carries
from ..linear_algebra.block_tridiagonal import inverse
from ..linear_algebra.matrices import (
    IDENTITY,
    ZERO_MATRIX,
    add_matrices,
    add_to_diagonal,
    apply,
    get_matrix,
    multiply,
    put_matrix,
    scale_matrix,
    subtract,
    symmetric,
)
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, put, scale, vector_at
from .rigid_body import support_stiffness


@kernel
def of_segment(e, distance, stiffness, tension):
    """E [m/N] of a segment: direction, length [m], stiffness [N/m], tension [N]."""
    across = distance / tension
    return add_to_diagonal(symmetric(1.0 / stiffness - across, e), across)


@kernel
def drag_slopes(record):
    """G + H and H [N/m] of a segment from its record, see `newton.linearize`."""
    a, b, c = vector_at(record, segment.HEIGHT)
    by_height = (0.0, 0.0, a, 0.0, 0.0, b, 0.0, 0.0, c)
    h = scale_matrix(0.5, subtract(by_height, get_matrix(record, segment.A)))
    return add_matrices(get_matrix(record, segment.G), h), h


@kernel
def gather(body, pseudo_damping, w):
    """M, Z, m and Z y of all segments, from the ground to the kite, into their arrays of w; see `solve`."""
    n = len(w.tension)
    compliance = ZERO_MATRIX
    displaced = ZERO_VECTOR
    for s in range(n):
        record = record_of(s, n, w.records)
        own = get_matrix(record, segment.K)
        closing = scale(-record[segment.DAMPER], vector_at(record, segment.DIRECTION))
        slope, h = drag_slopes(record)
        blown = apply(slope, closing)
        felt = multiply(slope, own)
        back, _ = inverse(subtract(IDENTITY, multiply(compliance, scale_matrix(2.0, h))))
        m_matrix = multiply(back, multiply(compliance, add_matrices(IDENTITY, felt)))
        m = apply(back, add(displaced, apply(compliance, blown)))
        put_matrix(w.response, 9 * s, m_matrix)
        put(w.offset, s, m)
        both = add_matrices(m_matrix, own)
        moved = add(m, closing)
        if s == n - 1:  # the kite does not move
            last, _ = inverse(both)
            put_matrix(w.transfer, 9 * s, ZERO_MATRIX)
            put(w.share, s, scale(-1.0, apply(last, moved)))
            return
        x, v = get(body.x, s + 1), get(body.v, s + 1)
        r = node_loads.slope(body.chain, w.mass[s + 1], x, v, body.spin, pseudo_damping)
        if carries(body.ground, x):
            r = add_matrices(r, support_stiffness(body, w.mass[s + 1], s + 1))
        given = add_matrices(add_matrices(felt, multiply(h, scale_matrix(2.0, m_matrix))), multiply(r, both))
        z, _ = inverse(subtract(IDENTITY, given))
        y = add(add(get(w.force, s + 1), blown), add_scaled(apply(r, moved), 2.0, apply(h, m)))
        put_matrix(w.transfer, 9 * s, z)
        put(w.share, s, apply(z, y))
        compliance = multiply(both, z)
        displaced = add(apply(compliance, y), moved)


@kernel
def solve(body, pseudo_damping, w):
    """Displacements of the nodes [m] into w.move and tension changes [N] into w.change (both modified).

    `Body`, pseudo-damping of every node [N/m]. Uses the node masses w.mass [kg], the
    residual forces w.force at the present tensions [N], and w.records from `newton.linearize`, with E in place of K
    and the gap g in place of the damper. w.response, w.transfer, w.offset, w.share receive M, Z, m and Z y.
    """
    gather(body, pseudo_damping, w)
    n = len(w.tension)
    put(w.move, n, ZERO_VECTOR)
    load = ZERO_VECTOR
    for k in range(n):
        s = n - 1 - k
        record = record_of(s, n, w.records)
        e = vector_at(record, segment.DIRECTION)
        p = add(get(w.share, s), apply(get_matrix(w.transfer, 9 * s), load))
        w.change[s] = dot(p, e)
        dx = add(get(w.offset, s), apply(get_matrix(w.response, 9 * s), p))
        put(w.move, s, dx)
        slope, h = drag_slopes(record)
        dr = add_scaled(apply(get_matrix(record, segment.K), p), -record[segment.DAMPER], e)
        load = add(p, add_scaled(apply(slope, dr), 2.0, apply(h, dx)))
