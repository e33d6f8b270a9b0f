"""One segment: length, direction, tension, drag, and their derivatives.

A segment joins node p (towards the ground) to node q (towards the kite):

    r = x_q - x_p,  u = v_q - v_p,  l = |r|,  e = r/l,  dl/dt = e . u

    T = k (l - l0) + c (dl/dt - (l/l0) dl0/dt)                                                      (tension)
        k = EA/l0 if l > l0, else slack_stiffness_ratio EA/l0
        c = D/l0  if l > l0, else slack_damping_ratio D/l0
        stretch_rate law: without the term of dl0/dt, as Tethers.jl writes it

    F = 1/4 rho cd d l |w| w,  w = W - (W . e) e,  W = air - (v_p + v_q)/2                          (half drag)

Node p feels T e + F, node q feels -T e + F. Theory: docs/models/theory.md, "One segment".

The derivatives of these forces travel in a record of `RECORD` numbers. With the symmetric
A = 1/4 rho cd d l (|w| (1 - e e) + w w/|w|):

    dF_axial = K dr + c e (e . du),                    K = e g + (T/l) (1 - e e),  g = dT/dr
    dF_drag  = G dr - A (dv_p + dv_q)/2 + a (dz_p + dz_q)/2
"""

from math import inf, sqrt

from tetherfmu.runtime import layout as at

from ..arrays import SEGMENT_RECORD
from ..compilation import kernel
from ..linear_algebra.matrices import add_to_diagonal, apply, get_matrix, outer, scale_matrix, skew, subtract, symmetric
from ..linear_algebra.pairs import broadcast, select
from ..linear_algebra.vectors import add, add_scaled, cross, dot, get, scale, sub
from .air import varying_air, varying_density
from .properties import has_node_winds, in_parts, node_wind, property_of, rest_length

# places in the record of derivatives, see `assembly.record_of`
K = 0  # 3x3
G = 9  # 3x3
A = 18  # 3x3
HEIGHT = 27  # a: change of the half drag with the height of the segment, through wind and density
DIRECTION = 30  # e
DAMPER = 33  # c
SLOPE = 34  # dT/dl0
RECORD = SEGMENT_RECORD  # numbers in it

TAUT, SLACK, BY_LENGTH = 1.0, -1.0, 0.0  # which stiffness a segment has

SHORTEST = 1e-9  # floor of |r| [m]: coincident nodes have no direction
STILLEST = 1e-20  # added to |w|^2 [m2/s2], so that the derivative of |w| w exists in still air


@kernel
def geometry(r):
    """Length [m] and direction of a segment from the vector [m] between its nodes."""
    length = max(sqrt(dot(r, r)), SHORTEST)
    return length, scale(1.0 / length, r)


@kernel
def stiffness(chain, s, mode, rest):
    """Stiffness k [N/m] and damping c [N s/m] of a segment of the unstretched length `rest` [m]: taut if mode > 0."""
    per_length = 1.0 / rest
    k = per_length * property_of(chain, s, at.STIFFNESS)
    c = per_length * property_of(chain, s, at.DAMPING)
    slack_k = chain.slack_stiffness_ratio * k
    slack_c = chain.slack_damping_ratio * c
    return select(mode, k, slack_k), select(mode, c, slack_c)


@kernel
def spring(chain, s, length, is_taut):
    """Elongation l - l0 [m] and stiffness k [N/m] of segment s with this length [m], as if it were taut if `is_taut`."""
    rest = rest_length(chain, s)
    k, _ = stiffness(chain, s, TAUT if is_taut else length - rest, rest)
    return length - rest, k


@kernel
def spring_tension(chain, s, length):
    """Spring tension k (l - l0) [N] of segment s with this length [m], without the damper."""
    elongation, k = spring(chain, s, length, False)
    return k * elongation


@kernel
def elastic_energy(k, elongation):
    """Energy [J] of a spring: k [N/m], l - l0 [m]."""
    return 0.5 * k * elongation**2


@kernel
def beyond_rest(r, rest):
    """l^2 - l0^2 [m2] of a segment with the vector r [m] between its nodes: positive if taut; needs no square root."""
    return dot(r, r) - rest * rest


@kernel
def seen_growth(chain, s):
    """l0'/l0 [1/s] that the damper of segment s sees, or those of two segments, as a pair; see `Chain`."""
    return in_parts(chain, s, chain.seen_growth, chain.second_growth)


@kernel
def seen_rate(chain, s, length, length_rate):
    """Rate [m/s] that the damper of segment s sees, from its length l [m] and l' [m/s]: l' - l l0'/l0."""
    return length_rate - seen_growth(chain, s) * length


@kernel
def tension(chain, s, length, length_rate, rest, k, c):
    """Tension of segment s [N]: Kelvin-Voigt rod, equation "tension" of this file.

    Length [m] and its rate [m/s], unstretched length [m], k [N/m], c [N s/m].
    Source: docs/models/theory.md, "One segment".
    """
    return k * (length - rest) + c * seen_rate(chain, s, length, length_rate)


@kernel
def air_of(chain, s, height):
    """Wind [m/s] and air density [kg/m3] at segment s, or at two, and their slopes with the height [1/s], [kg/m4].

    At the mean height of its nodes [m]. Wind specified at the nodes has no slope: it moves with them.
    """
    if chain.air_is_uniform:
        density, zero = broadcast((chain.parameters[at.AIR_DENSITY], 0.0), height)
        return broadcast(chain.wind, height), density, (zero, zero, zero), zero
    if has_node_winds(chain):
        density, density_slope = varying_density(height, chain.parameters)
        zero = 0.0 * density
        return scale(0.5, add(node_wind(chain, s, 0), node_wind(chain, s, 1))), density, (zero, zero, zero), density_slope
    factor, density, wind_slope, density_slope = varying_air(height, chain.parameters)
    return scale(factor, chain.wind), density, scale(wind_slope, chain.wind), density_slope


@kernel
def apparent_wind(wind, e, velocity):
    """Wind across a segment w [m/s] and wind along it W . e [m/s].

    Wind [m/s], direction e, mean velocity of its nodes [m/s].
    """
    relative = sub(wind, velocity)
    lengthwise = dot(relative, e)
    return add_scaled(relative, -lengthwise, e), lengthwise


@kernel
def half_drag(chain, s, length, e, height, velocity):
    """Half of the drag of a segment [N], equation "half drag" of this file.

    Length [m], direction e, mean height [m] and mean velocity [m/s] of its nodes.
    """
    wind, density, _, _ = air_of(chain, s, height)
    return half_drag_in(chain, s, length, e, wind, density, velocity)


@kernel
def half_drag_in(chain, s, length, e, wind, density, velocity):
    """`half_drag` for this wind [m/s] and density [kg/m3]."""
    w, _ = apparent_wind(wind, e, velocity)
    return scale(half_drag_factor(chain, s, length, density) * speed_across(w), w)


@kernel
def half_drag_factor(chain, s, length, density):
    """F/(|w| w) [N s2/m2] of `half_drag`, for this density [kg/m3]; DRAG_WIDTH is cd d."""
    return 0.25 * density * property_of(chain, s, at.DRAG_WIDTH) * length


@kernel
def speed_across(w):
    """|w| [m/s] of the wind across a segment, see `STILLEST`."""
    return sqrt(dot(w, w) + STILLEST)


@kernel
def mean_height(x_p, x_q):
    """Height [m] at which the air acts on a segment with these node heights [m]."""
    return 0.5 * (x_p[2] + x_q[2])


@kernel
def mean_velocity(v_p, v_q):
    """Velocity [m/s] of a segment relative to the ground, as drag sees it, from its node velocities [m/s]."""
    return scale(0.5, add(v_p, v_q))


@kernel
def half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q):
    """`half_drag` of a segment of this length [m] and direction between these nodes [m, m/s]."""
    return half_drag(chain, s, length, e, mean_height(x_p, x_q), mean_velocity(v_p, v_q))


@kernel
def tension_of(chain, s, mode, length, length_rate):
    """Tension T [N] of segment s, or of two, as a pair, from its length l [m] and dl/dt [m/s].

    mode : TAUT or SLACK, or BY_LENGTH to decide by the length.
    """
    rest = rest_length(chain, s)
    mode = select(mode * mode, mode, length - rest)
    k, c = stiffness(chain, s, mode, rest)
    return tension(chain, s, length, length_rate, rest, k, c)


@kernel
def largest_tension(chain, x, v):
    """Largest tension [N] of all segments with nodes at x [m] and velocities v [m/s]."""
    largest = -inf
    for s in range(chain.n):
        length, e = geometry(sub(get(x, s + 1), get(x, s)))
        largest = max(largest, tension_of(chain, s, BY_LENGTH, length, dot(e, sub(get(v, s + 1), get(v, s)))))
    return largest


@kernel
def forces(chain, s, x_p, x_q, v_p, v_q):
    """Tension vector T e [N], half drag F [N] and tension T [N] of segment s between these nodes [m, m/s]."""
    length, e = geometry(sub(x_q, x_p))
    pull = tension_of(chain, s, BY_LENGTH, length, dot(e, sub(v_q, v_p)))
    drag = half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q)
    return scale(pull, e), drag, pull


@kernel
def linearize_tension(chain, s, length, e, u):
    """Derivatives of the tension vector of segment s, or of two: K [N/m], c [N s/m], dT/dl0 [N/m]; TAUT or SLACK.

    Length l [m], direction e, rate u [m/s] of the vector between the nodes. dT/dl0 is at constant l, dl/dt, dl0/dt; k
    and c fall as 1/l0.
    """
    rest = rest_length(chain, s)
    k, c = stiffness(chain, s, length - rest, rest)
    length_rate = dot(e, u)
    across = tension(chain, s, length, length_rate, rest, k, c) / length
    seen = seen_growth(chain, s)
    turning = scale(c / length, add_scaled(u, -length_rate, e))
    g = add_scaled(turning, k - c * seen - across, e)
    slope = -(k * length + c * (length_rate - 2.0 * seen * length)) / rest
    return add_to_diagonal(outer(e, g), across), c, slope, select(length - rest, TAUT, SLACK)


@kernel
def slope_of_square(e, w, speed):
    """S = d(|w| w)/dW = |w| (1 - e e) + w w/|w| [m/s]: direction e, wind across w [m/s] and |w| [m/s]."""
    return add_to_diagonal(subtract(symmetric(1.0 / speed, w), symmetric(speed, e)), speed)


@kernel
def linearize_drag(chain, s, length, e, height, velocity):
    """Half drag [N] of segment s, or of two, and its derivatives G [N/m], A [N s/m] and a [N/m].

    Length l [m], direction e, mean height [m] and mean velocity [m/s] of its nodes.
    G = 1/4 rho cd d (|w| (w e - e w) - (W . e) S),  A = 1/4 rho cd d l S,  S = |w| (1 - e e) + w w/|w|.
    """
    wind, density, wind_slope, density_slope = air_of(chain, s, height)
    w, lengthwise = apparent_wind(wind, e, velocity)
    speed = speed_across(w)
    width, factor = 0.25 * property_of(chain, s, at.DRAG_WIDTH), half_drag_factor(chain, s, length, density)
    across = slope_of_square(e, w, speed)
    drag_by_velocity = scale_matrix(factor, across)
    turn = skew(scale(width * density * speed, cross(e, w)))
    drag_by_position = subtract(turn, scale_matrix(width * density * lengthwise, across))
    a = add_scaled(apply(drag_by_velocity, wind_slope), width * density_slope * length * speed, w)
    return scale(factor * speed, w), drag_by_position, drag_by_velocity, a


@kernel
def linearize_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q):
    """`linearize_drag` of a segment of this length [m] and direction between these nodes [m, m/s]."""
    return linearize_drag(chain, s, length, e, mean_height(x_p, x_q), mean_velocity(v_p, v_q))


@kernel
def direction_in(record):
    """Direction e of a segment from its record of derivatives."""
    return record[DIRECTION], record[DIRECTION + 1], record[DIRECTION + 2]


@kernel
def force_change(record, dx_p, dx_q, dv_p, dv_q):
    """Changes of the axial force and of the half drag [N] for changes of node positions [m] and velocities [m/s]."""
    dr = sub(dx_q, dx_p)
    e = direction_in(record)
    a = (record[HEIGHT], record[HEIGHT + 1], record[HEIGHT + 2])
    axial = add_scaled(apply(get_matrix(record, K), dr), record[DAMPER] * dot(e, sub(dv_q, dv_p)), e)
    drag = add_scaled(apply(get_matrix(record, G), dr), 0.5 * (dx_p[2] + dx_q[2]), a)
    return axial, add_scaled(drag, -0.5, apply(get_matrix(record, A), add(dv_p, dv_q)))
