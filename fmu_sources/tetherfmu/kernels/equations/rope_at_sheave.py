"""What a portion of a rope that runs over sheaves pulls at its ends: the forces conjugate to the rope that passes there.

Rope comes into a portion over its first node at the rate a, and leaves it over its last one at the rate b: L' = a - b, and
c_i = w_i a + (1 - w_i) b flows past node i, where w_i is 1 less the shares before it. With a coordinate y of these two, its
weights W_i = dc_i/dy (w_i, or 1 - w_i) and its sign e = dL'/dy (1, or -1), and with the kinetic energy of `flow.py`,
Lagrange's equation of y says that the rope pulls over that node, in the direction of y, with

    R_y = sum over segments of
          e s (k (l^2 - l0^2)/(2 l0) + D (r . r' - l^2 L'/L) - mu g ((z_p + z_q)/2 - z_y) + mu |r'|^2/4)
          - G (M (2 r . r' - l^2 L'/L) + e N l^2/(2 L) + A l^2) - mu/2 (W_p v_p' + W_q v_q') . r
          + e mu y^2/2,
    D = c/l0,  G = mu/(2 l0),  M = W_p c_p + W_q c_q,  N = c_p^2 + c_q^2,  A = W_p c_p' + W_q c_q'

with s the share of a segment in L and z_y the height of that node. e R_y = T + T^2/(2 EA), with T the tension where the rope
leaves the sheave. On node i, y' exerts the force col_i y', col_p = -mu/2 W_p r, col_q = -mu/2 W_q r. What is b of a portion
is a of the next one: `points/sheaves.py` has the equation of a sheave.
Theory: docs/models/theory.md, "Sheaves".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..linear_algebra.pairs import select
from ..linear_algebra.vectors import add, add_scaled, dot, scale
from . import segment
from .properties import half_density, property_of, rest_length

Passing = namedtuple("Passing", "sign at_p at_q")
Passing.__doc__ = """A coordinate y at a segment: e, and its weights W_p and W_q."""

Rope = namedtuple("Rope", "share rest per_rest half taut taut_damper slack slack_damper")
Rope.__doc__ = """What all segments have of a portion over sheaves, which is of one tether; or one segment of another line.

share, rest, per_rest : in its length [-], [m], its inverse [1/m].  half : mu/2 [kg/m].
taut, slack : stiffness [N/m], and dampers [N s/m].
"""

IN, OUT = 0, 1  # which coordinate: over the first node, over the last one


@kernel
def passing(rope, part, which):
    """`Passing` of a coordinate at a segment; part : w_p."""
    next_part = part - rope.share
    if which == IN:
        return Passing(1.0, part, next_part)
    return Passing(-1.0, 1.0 - part, 1.0 - next_part)


@view
def rope_of(chain, s):
    """`Rope` of segment s, and of a portion, all of whose segments are alike."""
    rest = rest_length(chain, s)
    taut, taut_damper = segment.stiffness(chain, s, segment.TAUT, rest)
    slack, slack_damper = segment.stiffness(chain, s, segment.SLACK, rest)
    share = property_of(chain, s, at.SHARE)
    return Rope(share, rest, 1.0 / rest, half_density(chain, s), taut, taut_damper, slack, slack_damper)


@kernel
def stiffness_of(rope, mode, square):
    """Stiffness [N/m] and damping [N s/m] of a segment with this mode and l^2 [m2]."""
    mode = select(mode * mode, mode, square - rope.rest * rope.rest)
    return select(mode, rope.taut, rope.slack), select(mode, rope.taut_damper, rope.slack_damper)


@kernel
def flowing(chain, part, next_part):
    """c_p and c_q [m/s] of a segment."""
    return part * chain.reeling + chain.leaving, next_part * chain.reeling + chain.leaving


@kernel
def gaining(chain, part, next_part):
    """c_p' and c_q' [m/s2] of a segment."""
    return part * chain.acceleration + chain.leaving_gain, next_part * chain.acceleration + chain.leaving_gain


@kernel
def inertias(rope, part, square):
    """Part of a segment in minus the slopes of R_a by a' and by b', and of R_b by b' [kg]; part : w_p, square : l^2 [m2]."""
    next_part = part - rope.share
    of_flow = rope.half * rope.per_rest * square
    p_out, q_out = 1.0 - part, 1.0 - next_part
    return (
        of_flow * (part * part + next_part * next_part),
        of_flow * (part * p_out + next_part * q_out),
        of_flow * (p_out * p_out + q_out * q_out),
    )


@kernel
def of_speed(rope, sign, speed):
    """e mu y^2/2 [N]; sign : e, speed : y [m/s]."""
    return sign * rope.half * speed * speed


@kernel
def pulls(rope, chain, part, c, mode, r, u, over_first, over_last):
    """Part of a segment in R_a and R_b [N] without accelerations, see `Rope`.

    part : w_p.  c : c_p, c_q [m/s].  r [m], r' [m/s].  over_first, over_last : its mean height over the first and over the
    last node [m].
    """
    square, both = dot(r, r), dot(r, u)
    k, damper = stiffness_of(rope, mode, square)
    strained = (0.5 * k * (square - rope.rest * rope.rest) + damper * (both - square * chain.growth)) * rope.per_rest
    strained = strained + 0.5 * rope.half * dot(u, u)
    weight = 2.0 * rope.half * chain.gravity
    of_a, of_both = part * c[0] + (part - rope.share) * c[1], c[0] + c[1]
    turned, of_flow = 2.0 * both - square * chain.growth, rope.half * rope.per_rest
    squares = 0.5 * (c[0] * c[0] + c[1] * c[1]) * rope.share * rope.per_rest * square
    return (
        rope.share * (strained - weight * over_first) - of_flow * (of_a * turned + squares),
        -rope.share * (strained - weight * over_last) - of_flow * ((of_both - of_a) * turned - squares),
    )


@kernel
def by_motion(rope, chain, y, c, gained, mode, r, u, a_p, a_q):
    """Slopes of the part of a segment in R_y: by r [N/m], by r' [N s/m], by L [N/m].

    c : c_p, c_q [m/s].  gained : c_p', c_q' [m/s2].  a_p, a_q : accelerations of its nodes [m/s2].
    """
    share, square, both, growth = rope.share, dot(r, r), dot(r, u), chain.growth
    (k, damping), per_length, of_flow = stiffness_of(rope, mode, square), share * rope.per_rest, rope.half * rope.per_rest
    damper, product = per_length * damping, y.at_p * c[0] + y.at_q * c[1]
    squares, gain = (c[0] * c[0] + c[1] * c[1]) * per_length, y.at_p * gained[0] + y.at_q * gained[1]
    along = y.sign * (per_length * k - 2.0 * damper * growth)
    along += of_flow * (2.0 * product * growth - y.sign * squares - 2.0 * gain)
    across = y.sign * damper - 2.0 * of_flow * product
    by_r = add_scaled(scale(along, r), across, u)
    by_r = add_scaled(by_r, -rope.half, add(scale(y.at_p, a_p), scale(y.at_q, a_q)))
    by_u = add_scaled(scale(across, r), y.sign * rope.half * share, u)
    of_spring = -per_length * k * square + damper * (3.0 * square * growth - 2.0 * both)
    of_inertia = product * (2.0 * both - 2.0 * square * growth) + (y.sign * squares + gain) * square
    return by_r, by_u, (y.sign * of_spring + of_flow * of_inertia) * per_length


@kernel
def by_rate(rope, chain, y, z, c, mode, r, u):
    """Slope of the part of a segment in R_y by the rate of another coordinate z, or of the same [N s/m]."""
    square, per_length = dot(r, r), rope.share * rope.per_rest
    _, damping = stiffness_of(rope, mode, square)
    product, crossed = y.at_p * c[0] + y.at_q * c[1], y.at_p * z.at_p + y.at_q * z.at_q
    flow = product * z.sign - y.sign * (c[0] * z.at_p + c[1] * z.at_q)
    flow = flow * square * per_length - crossed * (2.0 * dot(r, u) - square * chain.growth)
    return rope.half * rope.per_rest * flow - y.sign * z.sign * per_length * per_length * damping * square


@kernel
def force_by_length(rope, c, r):
    """Slope by L [N/m] of the force of rope that flows on node p, which q has with the other sign."""
    squares = c[0] * c[0] + c[1] * c[1]
    return scale(rope.half * rope.per_rest * squares * rope.share * rope.per_rest, r)


@kernel
def force_by_rate(rope, z, c, r, u):
    """Slopes by the rate of a coordinate z [N s/m] of the forces of rope that flows on the nodes p and q."""
    both = scale(-rope.half * (z.at_p + z.at_q), u)
    along = 2.0 * rope.half * rope.per_rest * (c[0] * z.at_p + c[1] * z.at_q)
    return add_scaled(both, -along, r), add_scaled(both, along, r)
