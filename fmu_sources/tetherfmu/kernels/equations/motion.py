"""Equations of motion of a chain, v' = F/m, one segment after the other. Read this file first to understand the model.

    x_i' = v_i,   m_i v_i' = T_i e_i - T_(i-1) e_(i-1) + F_i + F_(i-1) + f_i - m_i g e_z + N_i + load at the kite end
    T = k (l - l0) + c (l' - (l/l0) l0'),   F = 1/4 rho cd d l |w| w

Segment i joins nodes i and i + 1 in direction e_i. T is its tension, F half of its drag, w the wind component across it
(`segment.py`), and N the ground force (`ground.py`). A driven end follows its prescribed motion, whatever the forces.
Reeling changes L, and with it l0 and the masses in the section at the winch (`properties.rest_length`). Rope then flows past
its nodes, and its momentum adds the forces f (`flow.py`). L' is the reel-out speed.

The solvers compute the same forces from both ends at once (`assembly.py`); tests/kernels/equations/test_motion.py compares
them with this file. Theory: docs/models/theory.md, "One segment" and "The chain".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, put, sub
from . import flow, ground, node_loads, segment
from .assembly import node_masses
from .ground import ground_of, has_ground
from .properties import property_of


@kernel
def accelerations(chain, x, v, load, mass, a):
    """Accelerations v' [m/s2] of all nodes, as if all were free, into `a`, and masses [kg] into `mass` (both modified).

    chain : `Chain` at an instant.  x, v : positions [m] and velocities [m/s].  load : on the kite end [N].
    x, v and a are flat arrays of 3 (n + 1) numbers; mass has n + 1.
    """
    n = chain.n
    node_masses(chain, mass)
    force = a  # one array for both: the last loop divides by the mass
    for i in range(n + 1):
        put(force, i, node_loads.load(chain, mass[i], get(x, i), get(v, i), None))
    put(force, n, add(get(force, n), load))
    part = flow.first_passing(chain)  # fraction of L' that flows past node p
    for s in range(n):
        p, q = s, s + 1
        pull, drag, _ = segment.forces(chain, s, get(x, p), get(x, q), get(v, p), get(v, q))
        put(force, p, add(get(force, p), add(drag, pull)))
        put(force, q, add(get(force, q), sub(drag, pull)))
        if flow.flows(chain):
            of_p, of_q = flow.forces(chain, s, part, get(x, p), get(x, q), get(v, p), get(v, q))
            put(force, p, add(get(force, p), of_p))
            put(force, q, add(get(force, q), of_q))
        part -= property_of(chain, s, at.SHARE)
    for i in range(n + 1):
        put(a, i, add_scaled(of_ground(chain, i, x, v), 1.0 / mass[i], get(force, i)))


@kernel
def of_ground(chain, i, x, v):
    """Acceleration by the ground [m/s2] of node i of a chain at x [m] with velocities v [m/s]."""
    if has_ground(chain.parameters):
        below = ground_of(chain.parameters)
        if ground.touches(below, get(x, i), get(v, i)):
            return ground.acceleration(below, get(x, i), flow.velocity_of_rope(chain, i, x, v))
    return ZERO_VECTOR
