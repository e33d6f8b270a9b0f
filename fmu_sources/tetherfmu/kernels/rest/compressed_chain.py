"""A compressed chain, which stands on its end: detected by its shape, and abandoned sideways.

If all segments are parallel, each is a lateral spring T/l, in series between the fixed ends. Such springs with one
negative one among them are stable only if it is softer than all others together, with two never. So the chain is in
equilibrium but unstable if

    all segments are parallel, and T < 0 in two segments, or in one and sum_s l/T > 0.

It is moved sideways, in a direction that depends only on its own: towards x, or towards y if it stands along x.
Source: docs/models/numerics.md, "Compressed chains".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import node_loads, segment
from ..equations.properties import has_node_winds, node_wind, property_of, rest_length
from ..linear_algebra.vectors import add_scaled, cross, dot, get, norm, put, scale, sub

COMPRESSED = 1e-9  # compression, relative to the length, above which a segment counts as compressed
PUSHING = 1e-11  # force over EA above which it pushes: at the default slack_stiffness_ratio and COMPRESSED
PARALLEL = 1e-2  # angle [rad] to the first segment up to which a shape in equilibrium counts as straight
NEARLY_NEUTRAL = 1e-3  # sum of l/T over the sum of |l/T| up to which the others hold one compressed segment
EXACTLY = 1e-6  # angle [rad] up to which a moving chain is straight without a sideways force
NUDGE = 1e-4  # sideways displacement over segment length: the solver's default tolerance


@kernel
def is_along(e, a, angle):
    """Whether a vector is parallel to the direction e to within a small angle [rad], or zero."""
    return norm(cross(e, a)) <= angle * norm(a)


@kernel
def is_compressed(chain, x):
    """Whether any segment of the chain with its nodes at x [m] is compressed."""
    for s in range(chain.n):
        r = sub(get(x, s + 1), get(x, s))
        shortest = (1.0 - COMPRESSED) * rest_length(chain, s)
        if dot(r, r) < shortest * shortest:
            return True
    return False


@kernel
def is_unstable(chain, x, angle):
    """Whether the chain with its nodes at x [m] is compressed and unstable, parallel to within an angle [rad]."""
    if not is_compressed(chain, x):
        return False
    first = sub(get(x, 1), get(x, 0))
    compressed = 0
    compliance = 0.0  # lateral compliance of all segments in series [m/N]
    size = 0.0
    idle = False  # whether a segment has no tension: it does not hold the others laterally
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        if not is_along(e, first, angle):
            return False
        rest = rest_length(chain, s)
        pull = segment.spring_tension(chain, s, length)
        idle = idle or pull == 0.0
        across = length / (pull if pull != 0.0 else 1.0)
        compliance += across
        size += abs(across)
        if length - rest < -COMPRESSED * rest and pull < -PUSHING * property_of(chain, s, at.STIFFNESS):
            compressed += 1
    return compressed > 1 or (compressed == 1 and not idle and compliance > NEARLY_NEUTRAL * size)


@kernel
def sideways(a):
    """Direction perpendicular to a vector: closest to the x axis, or to the y axis if the vector is along x."""
    _, e = segment.geometry(a)
    axis = (0.0, 1.0, 0.0) if e[0] * e[0] > 0.9 else (1.0, 0.0, 0.0)
    across = add_scaled(axis, -dot(axis, e), e)
    return scale(1.0 / norm(across), across)


@kernel
def is_moved_along(n, e, v):
    """Whether the velocities v [m/s] of all nodes are along the direction e, or zero."""
    for i in range(n + 1):
        velocity = get(v, i)
        if not is_along(e, velocity, EXACTLY):
            return False
    return True


@kernel
def is_blown_along(chain, e):
    """Whether the wind at all nodes is along the direction e, or zero, or absent."""
    density = chain.parameters[at.AIR_DENSITY]
    if not has_node_winds(chain):
        return is_along(e, scale(density, chain.wind), EXACTLY)
    for i in range(chain.n + 1):
        wind = scale(density, node_wind(chain, i, 0))
        if not is_along(e, wind, EXACTLY):
            return False
    return True


@kernel
def leave(chain, x, v):
    """Move the inner nodes of x [m] (modified) a little sideways if the chain is compressed and no sideways force acts.

    That is if its weight, the wind and the node velocities v [m/s] are along it, or zero.
    """
    _, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    weight = node_loads.free_acceleration(chain)
    if not (is_along(e, weight, EXACTLY) and is_blown_along(chain, e)):
        return
    if is_unstable(chain, x, EXACTLY) and is_moved_along(chain.n, e, v):
        side = sideways(e)
        for i in range(1, chain.n):
            put(x, i, add_scaled(get(x, i), NUDGE * chain.length / chain.n, side))
