"""First guess of a chain in equilibrium: the hanging chain (`hanging_chain.py`) under the mean load of its nodes."""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import segment
from ..equations.properties import part_of, point_mass, property_of
from ..linear_algebra.vectors import ZERO_VECTOR, add, get, norm, put, scale, sub
from . import elastic_catenary, hanging_chain
from .compressed_chain import sideways
from .rigid_body import NO_PULL, load_of, loads, straighten

LIGHTEST = 1e-12  # mean load over EA below which the first guess is a straight line
FAINTEST_STRAIN = 1e-9  # lower limit of the strain of this straight line
PERTURBATION, LEAST_PERTURBATION = 0.01, 1e-6  # load from the side over the mean load; at least, over EA


@kernel
def axial_compliance(chain):
    """1/EA [1/N] of the whole chain."""
    compliance = 0.0
    for s in range(chain.n):
        compliance += part_of(chain, s) / property_of(chain, s, at.STIFFNESS)
    return compliance


@kernel
def is_loaded(chain, load):
    """Whether a mean load per unstretched length [N/m] is large enough to shape the chain."""
    return load * chain.length * axial_compliance(chain) > LIGHTEST


@kernel
def first_tension_guess(chain, chord, load):
    """First tension vector [N] of the catenary with the chord [m] under the mean load per unstretched length [N/m]."""
    size = norm(load)
    compliance = axial_compliance(chain)
    if not is_loaded(chain, size):
        distance, e = segment.geometry(chord)
        return scale(max(distance / chain.length - 1.0, FAINTEST_STRAIN) / compliance, e)
    tension, iterations = elastic_catenary.hang(chord, load, chain.length, 1.0 / compliance)
    if iterations < 0:
        return scale(size, chord)
    return tension


@kernel
def perturbation_load(chain, chord, load):
    """Lateral load per unstretched length [N/m] on a compressed chain.

    Perpendicular to its mean load [N/m], or without load to its chord [m].
    """
    least = LEAST_PERTURBATION / (chain.length * axial_compliance(chain))
    size = norm(load)
    return scale(max(PERTURBATION * size, least), sideways(load if size > least else chord))


@kernel
def hang_under_mean_load(body, perturbed, w):
    """Hang the chain under the mean of the node loads w.load [N] (positions, w.tension, w.load modified).

    A point mass at the kite end is supported there and does not load the chain.
    perturbed : whether a `perturbation_load` is added.
    """
    chain, x = body.chain, body.x
    mean = ZERO_VECTOR
    for i in range(chain.n + 1):
        mean = add(mean, get(w.load, i))
    mean = sub(mean, load_of(body, point_mass(chain, chain.n), get(x, chain.n), get(body.v, chain.n)))
    mean = scale(1.0 / chain.length, mean)
    chord = sub(get(x, chain.n), get(x, 0))
    if perturbed:
        mean = add(mean, perturbation_load(chain, chord, mean))
    for i in range(1, chain.n):
        share = 0.5 * (part_of(chain, i - 1) + part_of(chain, i))
        put(w.load, i, scale(share * chain.length, mean))
    guess = first_tension_guess(chain, chord, mean)
    hanging_chain.hang(chain, guess, w.load, x, w.tension)


@kernel
def guess(body, perturbed, w):
    """Initial positions of the inner nodes [m] and w.tension [N] (both modified).

    perturbed : whether to avoid a compressed chain, see `hang_under_mean_load`.
    Returns the stiffness [N/m] of a node due to the loads alone: their mean over the segment length.
    """
    straighten(body.chain, body.x)
    loads(body, NO_PULL, w.tension, w.mass, w.load)
    total = 0.0
    for i in range(1, body.chain.n):
        total += norm(get(w.load, i))
    hang_under_mean_load(body, perturbed, w)
    return total / body.chain.length
