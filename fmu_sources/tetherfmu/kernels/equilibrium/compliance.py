"""Newton's linear system of a chain in equilibrium, solved from its ground end by adding up compliances.

Segment s joins node p to node q. It pulls at p with P more than its tension T e, its drag on each of them changes by F:

    dx_q - dx_p = E P - g e,           E = e e/k + (l/T) (1 - e e),   g = l - l0 - T/k
    F = (G + H) (dx_q - dx_p) + 2 H dx_p,     H: change of the half drag with the mean position of its nodes

The chain up to p gives way to its load by dx_p = C (P + F) + d. So dx_p = M P + m, and the balance of node q with its
residual f_q, its own dF_q/dx_q = R and the load L of what follows,

    -P + F + f_q + R dx_q + L = 0,

gives P = Z (L + y) and the compliance of the chain up to q: C = (M + E) Z. Nothing cancels in these sums, however stiff the
segments are, while in `block_tridiagonal.py` T/l drowned in the rounding errors of k at k l/T = 1e8.
"""

from tetherfmu.kernels.algebra.block_tridiagonal import inverse
from tetherfmu.kernels.algebra.vectors import (
    add,
    add_matrices,
    add_to_diagonal,
    along,
    apply,
    dot,
    get,
    get_matrix,
    multiply,
    put,
    put_matrix,
    scale,
    scale_matrix,
    subtract,
    symmetric,
)
from tetherfmu.kernels.chain import nodes, segment
from tetherfmu.kernels.compilation import kernel

ZERO = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ONE = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@kernel
def of_segment(e, distance, stiffness, tension):
    """E [m/N] of a segment: direction, length [m], stiffness [N/m], tension [N]."""
    across = distance / tension
    return add_to_diagonal(symmetric(1.0 / stiffness - across, e), across)


@kernel
def drag_slopes(record):
    """G + H and H [N/m] of a segment from its record, see `equilibrium.linearize`."""
    a, b, c = get(record[segment.HEIGHT :], 0)
    by_height = (0.0, 0.0, a, 0.0, 0.0, b, 0.0, 0.0, c)
    h = scale_matrix(0.5, subtract(by_height, get_matrix(record, segment.A)))
    return add_matrices(get_matrix(record, segment.G), h), h


@kernel
def node_slope(mass, spin, resistance):
    """R [N/m] of a node: that of its centrifugal force, m (omega^2 - omega omega), less a resistance against motion."""
    return add_to_diagonal(symmetric(-mass, spin), mass * dot(spin, spin) - resistance)


@kernel
def gather(n, spin, resistance, mass, force, records, response, transfer, offset, share):
    """From the ground to the kite: M, Z, m and Z y of all segments, see `solve` (the last four arrays modified)."""
    compliance = ZERO
    displaced = (0.0, 0.0, 0.0)
    for s in range(n):
        record = nodes.record_of(s, n, records)
        own = get_matrix(record, segment.K)
        closing = scale(-record[segment.DAMPER], get(record[segment.DIRECTION :], 0))
        slope, h = drag_slopes(record)
        blown = apply(slope, closing)
        felt = multiply(slope, own)
        back, _ = inverse(subtract(ONE, multiply(compliance, scale_matrix(2.0, h))))
        m_matrix = multiply(back, multiply(compliance, add_matrices(ONE, felt)))
        m = apply(back, add(displaced, apply(compliance, blown)))
        put_matrix(response, 9 * s, m_matrix)
        put(offset, s, m)
        both = add_matrices(m_matrix, own)
        moved = add(m, closing)
        if s == n - 1:  # the kite does not move
            last, _ = inverse(both)
            put_matrix(transfer, 9 * s, ZERO)
            put(share, s, scale(-1.0, apply(last, moved)))
            return
        r = node_slope(mass[s + 1], spin, resistance)
        given = add_matrices(add_matrices(felt, multiply(h, scale_matrix(2.0, m_matrix))), multiply(r, both))
        z, _ = inverse(subtract(ONE, given))
        y = add(add(get(force, s + 1), blown), along(apply(r, moved), 2.0, apply(h, m)))
        put_matrix(transfer, 9 * s, z)
        put(share, s, apply(z, y))
        compliance = multiply(both, z)
        displaced = add(apply(compliance, y), moved)


@kernel
def solve(n, spin, resistance, mass, force, records, response, transfer, offset, share, change, pull):
    """Motions of the nodes [m] into `change` and changes of the tensions [N] into `pull` (both modified).

    Angular velocity [rad/s], resistance of every node against its motion [N/m], node masses [kg], residual forces with the
    tensions as they are [N]. records : as `equilibrium.linearize` makes them, but with E in the place of K and the gap g in
    that of the damper.  response, transfer : 9 (n + 1), get M and Z.  offset, share : 3 (n + 1), get m and Z y.
    """
    gather(n, spin, resistance, mass, force, records, response, transfer, offset, share)
    put(change, n, (0.0, 0.0, 0.0))
    load = (0.0, 0.0, 0.0)
    for k in range(n):
        s = n - 1 - k
        record = nodes.record_of(s, n, records)
        e = get(record[segment.DIRECTION :], 0)
        p = add(get(share, s), apply(get_matrix(transfer, 9 * s), load))
        pull[s] = dot(p, e)
        dx = add(get(offset, s), apply(get_matrix(response, 9 * s), p))
        put(change, s, dx)
        slope, h = drag_slopes(record)
        dr = along(apply(get_matrix(record, segment.K), p), -record[segment.DAMPER], e)
        load = add(p, along(apply(slope, dr), 2.0, apply(h, dx)))
