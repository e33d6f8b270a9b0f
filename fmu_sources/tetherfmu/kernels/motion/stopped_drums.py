"""A drum that comes to a stop: nothing pulls at the rope at such an instant, so that it keeps its momentum.

Half segments move with v_i + c_i r/l0, where c_i = w_i u is the rope that flows past node i (`equations/flow.py`). When u
jumps, nodes that move freely jump with it:

    m_i (v_i+ - v_i-) = (u+ - u-) col_i,   col_i = -sum 1/2 mu w_i r over the segments of the node

So the change begins at the winch, as a wave. m_i of a free point is the mass of all that meets there. Where the speed of a
winch is given and jumps, its rope gains it during a step: `equations/winch.py`.
Theory: docs/models/theory.md, "Rope that flows".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import rope_at_drum
from ..equations.boundary import chain_with
from ..equations.lines import (
    add_at,
    conditions_of,
    is_at_point,
    is_rope,
    lines_of,
    motion_of,
    parameters_of,
    point_at,
    segments_of,
    state_of,
)
from ..equations.properties import point_mass, rest_length
from ..linear_algebra.vectors import ZERO_VECTOR, add, get, scale, sub
from ..points.sheave_room import LENGTH_NOW, numbers_at
from ..points.system_room import put_length


@kernel
def mass_at_end(system, k, length, end):
    """Mass [kg] of the first (end 0) or the last node (1) of line k with an unstretched length [m], with its point mass."""
    chain = chain_with(conditions_of(system, k), length, 0.0)
    s = (chain.n - 1) * end
    return rope_at_drum.half_density(chain, s) * rest_length(chain, s) + point_mass(chain, chain.n * end)


@kernel
def push_point(system, point, impulse):
    """Let a free point (modified, at the ends of all its lines) take an impulse [N s]."""
    mass = 0.0
    for k in range(lines_of(system)):
        for end in range(2):
            if point_at(system, k, end) == point:
                length = numbers_at(system, k)[LENGTH_NOW] if is_rope(system, k) else state_of(system, k)[at.LENGTH]
                mass += mass_at_end(system, k, length, end)
    for k in range(lines_of(system)):
        for end in range(2):
            if point_at(system, k, end) == point:
                _, v = motion_of(system, k)
                add_at(v, segments_of(system, k) * end, scale(1.0 / mass, impulse))


@kernel
def jump(system, k, length, change):
    """Let the nodes of line k (modified), of an unstretched length [m], take a change of its reel-out speed [m/s]."""
    conditions, (x, v), part = conditions_of(system, k), motion_of(system, k), 1.0
    chain, below, mass_below = chain_with(conditions, length, 0.0), ZERO_VECTOR, 0.0
    for s in range(chain.n):
        of_p, of_q = rope_at_drum.columns(chain, s, part, sub(get(x, s + 1), get(x, s)))
        impulse, half = scale(change, add(below, of_p)), rope_at_drum.half_density(chain, s) * rest_length(chain, s)
        if s == 0 and is_at_point(system, k, 0):
            push_point(system, point_at(system, k, 0), impulse)
        elif s >= conditions.first:
            add_at(v, s, scale(1.0 / (mass_below + half + point_mass(chain, s)), impulse))
        below, mass_below, part = of_q, half, rope_at_drum.next_part(chain, s, part)


@kernel
def put_reeling_speed(system, k, length, speed, old):
    """Let the drum of line k (modified) have a length [m] and a speed [m/s], which may have jumped from an old one."""
    if speed != old and rope_at_drum.feels_rope(parameters_of(system, k)):
        jump(system, k, length, speed - old)
    put_length(system, k, length, speed)
