"""A taut chain under given node loads: a convex problem, so the solution is always found.

The tension vectors t_s of the segments follow from the first one and the loads f_i of the inner nodes,

    t_s = t_0 - f_1 - ... - f_s,

and the chain of these segments, each along its t_s and of length l0 (1 + |t_s|/EA), must span the chord c. This is where the
complementary energy of the chain,

    sum_s l0 (|t_s| + |t_s|^2/(2 EA)) - t_0 . c,

is stationary in t_0. It is strictly convex, so Newton's method with a line search reaches the only solution from any start.
|t| is smoothed to sqrt(t^2 + eps^2) with eps far below the loads: a segment without tension has no direction.
"""

from math import inf, sqrt

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations.properties import property_of, rest_length
from ..linear_algebra.vectors import add_scaled, dot, get, norm, put, scale, sub

MOST_ITERATIONS = 60  # of Newton's method
MOST_HALVINGS = 40  # of one step of it
LEAST = 1e-100  # smallest divisor |t| [N], also to the third power
FLAT = 1e-13  # increase of the energy that is rounding, relative
SLACKEST = 1e-3  # eps over the mean node load
CLOSED = 1e-3  # largest gap of a first guess over the chain length; `newton.py` does the rest


@kernel
def segment_compliance(chain, s, t, eps):
    """l0 (1/|t| + 1/EA) [m/N]: the vector between the nodes of a segment over its tension vector t [N]; also |t| [N]."""
    size = max(sqrt(dot(t, t) + eps * eps), LEAST)
    return rest_length(chain, s) * (1.0 / size + 1.0 / property_of(chain, s, at.STIFFNESS)), size


@kernel
def energy(chain, first_tension, eps, chord, load):
    """Complementary energy [J], its gradient [m] (the gap of the chain) and the upper half of its Hessian [m/N].

    First tension vector [N], chord [m], node loads [N] as a flat array.
    """
    t = first_tension
    total = -dot(t, chord)
    gap = scale(-1.0, chord)
    h00, h01, h02, h11, h12, h22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for s in range(chain.n):
        if s > 0:
            t = sub(t, get(load, s))
        rest = rest_length(chain, s)
        compliance, size = segment_compliance(chain, s, t, eps)
        total += rest * size + 0.5 * (compliance - rest / size) * dot(t, t)
        gap = add_scaled(gap, compliance, t)
        turning = rest / (size * size * size)
        h00 += compliance - turning * t[0] * t[0]
        h01 -= turning * t[0] * t[1]
        h02 -= turning * t[0] * t[2]
        h11 += compliance - turning * t[1] * t[1]
        h12 -= turning * t[1] * t[2]
        h22 += compliance - turning * t[2] * t[2]
    return total, gap, (h00, h01, h02, h11, h12, h22)


@kernel
def solve_symmetric(h, b):
    """Solve the symmetric 3x3 system with upper half h = (h00, h01, h02, h11, h12, h22) for the right-hand side b."""
    c00 = h[3] * h[5] - h[4] * h[4]
    c01 = h[2] * h[4] - h[1] * h[5]
    c02 = h[1] * h[4] - h[2] * h[3]
    c12 = h[1] * h[2] - h[0] * h[4]
    r = 1.0 / (h[0] * c00 + h[1] * c01 + h[2] * c02)
    return (
        r * (c00 * b[0] + c01 * b[1] + c02 * b[2]),
        r * (c01 * b[0] + (h[0] * h[5] - h[2] * h[2]) * b[1] + c12 * b[2]),
        r * (c02 * b[0] + c12 * b[1] + (h[0] * h[3] - h[1] * h[1]) * b[2]),
    )


@kernel
def march(chain, first_tension, eps, load, x, tension):
    """Place the segments one after the other from the ground end, each along its tension vector.

    First tension vector [N], eps [N], node loads [N]. The inner nodes of x [m] and the segment
    tensions [N] are modified. Returns the end point [m] and the last tension vector [N].
    """
    t = first_tension
    position = get(x, 0)
    for s in range(chain.n):
        if s > 0:
            t = sub(t, get(load, s))
            put(x, s, position)
        compliance, size = segment_compliance(chain, s, t, eps)
        tension[s] = size
        position = add_scaled(position, compliance, t)
    return position, t


@kernel
def solve(chain, first_tension, eps, chord, load, closed):
    """First tension vector [N] of the chain with this chord [m] under given node loads, from a guess; and the gap [m].

    eps [N]; closed : acceptable gap over the chain length.
    """
    t = first_tension
    value, gap, hessian = energy(chain, t, eps, chord, load)
    for _ in range(MOST_ITERATIONS):
        if norm(gap) <= closed * chain.length:
            break
        change = solve_symmetric(hessian, scale(-1.0, gap))
        part = 1.0
        for _ in range(MOST_HALVINGS):
            trial = add_scaled(t, part, change)
            then, gap, hessian = energy(chain, trial, eps, chord, load)
            if then <= value + FLAT * abs(value):
                break
            part *= 0.5
        if not then < inf:
            break
        t = trial
        value = then
    return t, norm(gap)


@kernel
def hang(chain, first_tension, load, x, tension):
    """Shape of the chain under given node loads, from a guess of its first tension vector [N].

    The inner nodes of x [m] and the segment tensions [N] (n numbers) are modified; the ends of x are given.
    """
    total = 0.0
    for i in range(1, chain.n):
        total += norm(get(load, i))
    eps = SLACKEST * total / chain.n + 1e-12  # never zero
    t, _ = solve(chain, first_tension, eps, sub(get(x, chain.n), get(x, 0)), load, CLOSED)
    march(chain, t, eps, load, x, tension)
