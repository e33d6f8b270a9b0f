"""Loads on the nodes: forces on a lumped mass other than segment forces, here its weight.

    f = -m (g e_z + a)                                    weight, and inertia if the acceleration a of the node is prescribed
    df/dx = m (|omega|^2 - omega omega) - c               with a = omega x (omega x r), and a damping c of pseudo-time
    potential energy m g z

The Rosenbrock step, Newton's method, backward Euler, the outputs and the power balance all call this file. `load` accepts
numbers and pairs (`linear_algebra.pairs`). Theory: docs/models/theory.md, "The chain" and "Quasi-steady".
"""

from ..compilation import kernel
from ..linear_algebra.matrices import add_to_diagonal, symmetric
from ..linear_algebra.pairs import broadcast
from ..linear_algebra.vectors import NEUTRAL, dot, scale
from . import ground
from .ground import ground_of, has_ground, specific_energy


@kernel
def weight(chain, mass):
    """Weight [N] of a mass [kg], or weight per length or time from a mass per length [kg/m] or a mass rate [kg/s]."""
    nothing = broadcast(NEUTRAL, mass)
    return nothing, nothing, -(chain.gravity * mass)


@kernel
def load(chain, mass, x, v, acceleration):
    """Load [N] on a node of this mass [kg] at x [m] with velocity v [m/s]: its weight, which depends on neither.

    acceleration : of the node [m/s2] if its inertia counts as a load, None in equations of motion.
    """
    if acceleration is None:
        return weight(chain, mass)
    return scale(-mass, (acceleration[0], acceleration[1], acceleration[2] + chain.gravity))


@kernel
def load_rate(chain, mass_rate, x, v):
    """Rate of the load [N/s] on a node at x [m] with velocity v [m/s] whose mass changes at this rate [kg/s]."""
    return weight(chain, mass_rate)


@kernel
def free_acceleration(chain):
    """Acceleration [m/s2] of a node without segments."""
    return 0.0, 0.0, -chain.gravity


@kernel
def specific_potential(chain, x, is_free):
    """Potential energy of the loads of a node at x [m] over its mass [J/kg]; the ground does not carry a driven end."""
    specific = chain.gravity * x[2]
    if is_free and has_ground(chain.parameters):
        specific += specific_energy(ground_of(chain.parameters), x)
    return specific


@kernel
def specific_losses(chain, x, v, is_free):
    """Heat from the loads on a node at x [m] over its mass, in contact and by sliding [W/kg].

    v : (u_x, u_y, v_z) of `flow.velocity_of_rope` [m/s].
    """
    if is_free and has_ground(chain.parameters):
        return ground.specific_losses(ground_of(chain.parameters), x, v)
    return 0.0, 0.0


@kernel
def specific_friction(chain, x, v, slide):
    """Power of friction on rope that passes a node with this velocity [m/s] over its mass [W/kg]; v : as above."""
    if has_ground(chain.parameters) and ground.touches(ground_of(chain.parameters), x, v):
        return dot(slide, ground.acceleration(ground_of(chain.parameters), x, v))
    return 0.0


@kernel
def has_slope(chain, spin, pseudo_damping):
    """Whether `slope` is nonzero."""
    return dot(spin, spin) > 0.0 or pseudo_damping > 0.0


@kernel
def slope(chain, mass, x, v, spin, pseudo_damping):
    """df/dx [N/m] of `load` on a node that turns with omega [rad/s], minus its pseudo-time damping c [N/m]."""
    return add_to_diagonal(symmetric(-mass, spin), mass * dot(spin, spin) - pseudo_damping)


@kernel
def subtract_slope(chain, mass, x, v, spin, pseudo_damping, block):
    """Subtract `slope` from a 3x3 block of a matrix (modified), entry by entry."""
    square = dot(spin, spin)
    for j in range(3):
        for k in range(3):
            block[3 * j + k] += mass * spin[j] * spin[k]
        block[4 * j] += pseudo_damping - mass * square
