"""One segment with flowing rope: forces on its two nodes, its pull at both line ends, and their slopes.

Rope enters a line over its first node at the rate a_0 and over its last node at the rate a_1, both positive inwards. A drum
pays out a_0, a sheave at the end removes -a_1, and L' = a_0 + a_1. The equations are symmetric in the two ends. A segment
between nodes p and q grows by the shares g_0 and g_1 of these rates; rope flows past node i at c_i, positive from p to q:

    l0' = g_0 a_0 + g_1 a_1,   c_i = W_i0 a_0 + W_i1 a_1

In a plain line g_0 = g_1 = share, W_i0 = 1 - (shares before i), W_i1 = W_i0 - 1; beyond the section at its winch g = 0 and
W_i0 = 0. Half segments move with v_i + c_i r/l0. Lagrange's equations of sum 1/2 (mu l0/2) |v_i + c_i r/l0|^2 add these
forces to the lumped-mass equations,

    f_p = -mu/2 ((c_p' + S) r + (c_p + c_q) u),   f_q = -mu/2 ((c_q' - S) r + (c_p + c_q) u),   S = (c_p^2 + c_q^2)/l0

and determine the inward pull of the rope at end e, where T is the tension, z a height and u = r':

    T + T^2/(2 EA) = sum of R_e + mu a_e^2/2 of the segment at the end,   l = |r|
    R_e = g_e (k (l^2 - l0^2)/(2 l0) + c (r.u - l^2 l0'/l0)/l0 + mu |u|^2/4 - mu g (z - z_e) - mu S l^2/(4 l0))
          - mu/2 (sum over p, q of W_e (c (2 r.u - l^2 l0'/l0)/l0 + c' l^2/l0 + v'.r))

T^2/(2 EA) is the strain energy of the rope at the end, zero where T < 0. Rope that runs into a slack segment piles up and
loses its speed: R_e - sum of W_e mu/2 c |c| ((l/l0)^2 before - after, if positive) over the nodes (`resistance`).

All functions accept numbers, or pairs for the two halves of a line (`linear_algebra.pairs`); p is then the outer node, and
`own` the line end in the same half.
Theory: docs/models/theory.md, "Rope that flows"; docs/models/numerics.md, "Rope coordinates".
"""

from collections import namedtuple
from math import sqrt

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..linear_algebra.pairs import select
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, norm, scale, sub, vector_at
from . import segment
from .boundary import spring_at_ground
from .properties import chain_at, growth_at, half_density, property_of, rest_length, sees_reeling

Piece = namedtuple("Piece", "rest per half k c growth gravity")
Piece.__doc__ = """l0 [m], 1/l0 [1/m], mu/2 [kg/m], k [N/m] and c [N s/m] of a segment; l0'/l0 [1/s]; g [m/s2]."""
Side = namedtuple("Side", "share at_p at_q")
Side.__doc__ = """g, W_p and W_q of rope that enters over one end [-]."""
Flow = namedtuple("Flow", "c_p c_q gain_p gain_q")
Flow.__doc__ = """c_p and c_q [m/s], and their rates [m/s2]."""


@kernel
def feels_rope(parameters):
    """Whether flowing rope acts on drums (strain_rate law); otherwise only the tension of the first segment does."""
    return sees_reeling(parameters)


@view
def piece_of(chain, s, mode):
    """`Piece` of segment s, or of two segments as a pair."""
    rest = rest_length(chain, s)
    k, c = segment.stiffness(chain, s, mode, rest)
    return Piece(rest, 1.0 / rest, half_density(chain, s), k, c, growth_at(chain, s), chain.gravity)


@kernel
def flow_past(own, other, rates, gains):
    """`Flow` of a segment from its two `Side`s, the rates [m/s] and the gains [m/s2] of entering rope."""
    (a, b), (a_gain, b_gain) = rates, gains
    return Flow(
        own.at_p * a + other.at_p * b,
        own.at_q * a + other.at_q * b,
        own.at_p * a_gain + other.at_p * b_gain,
        own.at_q * a_gain + other.at_q * b_gain,
    )


@kernel
def forces(piece, flow, r, u):
    """f_p and f_q [N]."""
    half = -1.0 * piece.half
    both = scale(half * (flow.c_p + flow.c_q), u)
    along = (flow.c_p * flow.c_p + flow.c_q * flow.c_q) * piece.per
    return add_scaled(both, half * (flow.gain_p + along), r), add_scaled(both, half * (flow.gain_q - along), r)


@kernel
def pulls(piece, flow, own, other, r, u, heights, z_p, z_q):
    """Contributions of the segment to R of both ends [N].

    heights : of the segment's midpoint above each end [m].  z_p, z_q : node accelerations [m/s2].
    """
    square, both = dot(r, r), dot(r, u)
    turned = 2.0 * both - piece.growth * square
    spring = 0.5 * piece.k * (square - piece.rest * piece.rest) + piece.c * (both - piece.growth * square)
    squares = (flow.c_p * flow.c_p + flow.c_q * flow.c_q) * piece.per * square
    stored = piece.per * (spring - 0.5 * piece.half * squares) + piece.half * (0.5 * dot(u, u))
    weight, of_flow = 2.0 * piece.half * piece.gravity, piece.half * piece.per
    at_p = of_flow * (flow.c_p * turned + flow.gain_p * square) + piece.half * dot(z_p, r)
    at_q = of_flow * (flow.c_q * turned + flow.gain_q * square) + piece.half * dot(z_q, r)
    return (
        own.share * (stored - weight * heights[0]) - (own.at_p * at_p + own.at_q * at_q),
        other.share * (stored - weight * heights[1]) - (other.at_p * at_p + other.at_q * at_q),
    )


# --- rope that piles up


@kernel
def straightness(piece, square):
    """(l/l0)^2 [-] of a slack segment, 1 of a taut one; square : l^2 [m2]."""
    part = square * piece.per * piece.per
    return select(1.0 - part, part, 1.0)


@kernel
def resistance(piece, c, outside, inside):
    """Loss over c^2 [kg/s] where rope runs past a node at c [m/s], inwards positive.

    outside, inside : `straightness` of the segments on both sides of the node.
    """
    return piece.half * select(c, c * max(outside - inside, 0.0), -1.0 * (c * max(inside - outside, 0.0)))


# --- slopes


@kernel
def column(piece, flow, slope, e, r, u, side, loads):
    """Slopes of (force - mass * acceleration) at p and q: by q_e [N/m], by a_e [N s/m], by a_e' [kg].

    slope : dT/dl0 [N/m], e : direction.  loads : accelerations of p and q without gravity and ground [m/s2].
    """
    squares = piece.half * piece.per * (flow.c_p * flow.c_p + flow.c_q * flow.c_q) * side.share * piece.per
    pulled = add_scaled(scale(slope * side.share, e), squares, r)
    mass = -1.0 * piece.half * side.share
    both = scale(-1.0 * piece.half * (side.at_p + side.at_q), u)
    along = 2.0 * piece.half * piece.per * (flow.c_p * side.at_p + flow.c_q * side.at_q) + piece.c * side.share * piece.per
    return (
        (add_scaled(pulled, mass, loads[0]), add_scaled(scale(-1.0, pulled), mass, loads[1])),
        (add_scaled(both, -1.0 * along, r), add_scaled(both, along, r)),
        (scale(-1.0 * piece.half * side.at_p, r), scale(-1.0 * piece.half * side.at_q, r)),
    )


@kernel
def row(piece, flow, side, r, u, z_p, z_q):
    """Slopes of the contribution to R_e: by r [N/m], by u [N s/m], by l0 [N/m]; `column` has the slopes by z, its a_e'."""
    share, per, square, both, growth = side.share, piece.per, dot(r, r), dot(r, u), piece.growth
    of_flow, damper = piece.half * per, share * per * piece.c
    product, gain = side.at_p * flow.c_p + side.at_q * flow.c_q, side.at_p * flow.gain_p + side.at_q * flow.gain_q
    squares = (flow.c_p * flow.c_p + flow.c_q * flow.c_q) * share * per
    along = share * per * piece.k - 2.0 * damper * growth + of_flow * (2.0 * product * growth - squares - 2.0 * gain)
    across = damper - 2.0 * of_flow * product
    by_r = add_scaled(scale(along, r), across, u)
    by_r = add_scaled(by_r, -1.0 * piece.half, add(scale(side.at_p, z_p), scale(side.at_q, z_q)))
    by_u = add_scaled(scale(across, r), piece.half * share, u)
    of_spring = piece.c * (3.0 * square * growth - 2.0 * both) - piece.k * square
    of_inertia = product * (2.0 * both - 2.0 * square * growth) + (squares + gain) * square
    return by_r, by_u, (share * per * of_spring + of_flow * of_inertia) * per


@kernel
def corner(piece, flow, side, by, r, u):
    """Slope of the contribution to R_e by a_f [N s/m]; side, by : `Side` of e and of f."""
    square, per = dot(r, r), piece.per
    product, crossed = side.at_p * flow.c_p + side.at_q * flow.c_q, side.at_p * by.at_p + side.at_q * by.at_q
    flowing = (product * by.share - (flow.c_p * by.at_p + flow.c_q * by.at_q) * side.share) * square * per
    flowing = flowing - crossed * (2.0 * dot(r, u) - square * piece.growth)
    return piece.half * per * flowing - side.share * by.share * per * per * piece.c * square


@kernel
def inertia(piece, side, by, square):
    """Slope of the contribution to R_e by a_f' [kg] with nodes at rest; square : l^2 [m2]."""
    return -1.0 * piece.half * piece.per * (side.at_p * by.at_p + side.at_q * by.at_q) * square


# --- tension where rope enters


@kernel
def tension_of(stiffness, pull):
    """T [N] from R [N], without cancellation; EA [N]."""
    return pull if pull <= 0.0 else 2.0 * pull / (1.0 + sqrt(1.0 + 2.0 * pull / stiffness))


@kernel
def slope_of(stiffness, tension):
    """dT/dR [-] at a tension [N]."""
    return 1.0 / (1.0 + max(tension, 0.0) / stiffness)


# --- a line at rest, or with the velocities of a state


@kernel
def tensions_of_rope(chain, x, v, moves):
    """Tensions [N] where the rope leaves the winch and at its last node, at x [m], v [m/s], without acceleration terms.

    moves : 1, or 0 to ignore the velocities.
    """
    part, lowest, highest = 1.0, get(x, 0)[2], get(x, chain.n)[2]
    total, at_end = half_density(chain, 0) * chain.reeling * chain.reeling, 0.0
    for s in range(chain.n):
        x_p, x_q = get(x, s), get(x, s + 1)
        r, u = sub(x_q, x_p), scale(moves, sub(get(v, s + 1), get(v, s)))
        share, height = property_of(chain, s, at.SHARE), segment.mean_height(x_p, x_q)
        piece = piece_of(chain, s, segment.beyond_rest(r, rest_length(chain, s)))
        own, other = Side(share, part, part - share), Side(share, part - 1.0, part - share - 1.0)
        if chain.has_sections:  # only the last segment grows at the end
            other = Side(1.0, 0.0, -1.0) if s == chain.n - 1 else Side(0.0, 0.0, 0.0)
        flow, heights = flow_past(own, other, (chain.reeling, 0.0), (0.0, 0.0)), (height - lowest, height - highest)
        of_first, of_last = pulls(piece, flow, own, other, r, u, heights, ZERO_VECTOR, ZERO_VECTOR)
        total += of_first
        at_end += of_last
        part -= share
    last = property_of(chain, chain.n - 1, at.STIFFNESS)
    return tension_of(property_of(chain, 0, at.STIFFNESS), total), tension_of(last, at_end)


@kernel
def tension_of_rope(chain, x, v, moves):
    """First tension of `tensions_of_rope`."""
    first, _ = tensions_of_rope(chain, x, v, moves)
    return first


@kernel
def spring_at_winch(n, parameters, state):
    """Tension where the rope leaves the winch [N] of a chain in equilibrium, from the spring of its first segment.

    The spring force minus the weight of the half segment below it.
    """
    spring, (x, _) = spring_at_ground(n, parameters, state), positions_and_velocities(n, state)
    chain = chain_at(n, parameters, state[at.LENGTH], 0.0, ZERO_VECTOR)
    _, along = segment.geometry(sub(get(x, 1), get(x, 0)))
    return spring - half_density(chain, 0) * rest_length(chain, 0) * chain.gravity * along[2]


@kernel
def tension_at_winch(n, parameters, state):
    """Tension where the rope leaves the winch [N], of a chain at rest in a state.

    `spring_at_winch` if the state stores tensions separately; the first spring's tension under the stretch_rate law.
    """
    held, (x, v) = vector_at(state, at.GROUND_TENSION_VECTOR), positions_and_velocities(n, state)
    if not feels_rope(parameters):
        return spring_at_ground(n, parameters, state)
    if norm(held) > 0.0:
        return spring_at_winch(n, parameters, state)
    chain = chain_at(n, parameters, state[at.LENGTH], 0.0, ZERO_VECTOR)
    return tension_of_rope(chain, x, v, 0.0)
