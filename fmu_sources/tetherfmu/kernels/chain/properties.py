"""A chain at an instant: the properties of its segments, the point masses of its nodes, its unstretched length, the wind."""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..algebra.pairs import number_at
from ..algebra.vectors import vector_at
from ..compilation import kernel, view

Chain = namedtuple("Chain", "n parameters length reeling growth wind")
Chain.__doc__ = """A chain at an instant.

n : number of segments.  parameters : flat array, see `layout.py`.
length, reeling : unstretched length L of the tether [m] and its rate [m/s].  growth : (dL/dt)/L = (dl0/dt)/l0 [1/s].
wind : at the reference height [m/s]; not used where the wind is given at the nodes, see `node_wind`.
"""


@view
def chain_at(n, parameters, length, reeling, wind):
    """`Chain` of this unstretched length [m] and its rate [m/s] in a wind [m/s]."""
    return Chain(n, parameters, length, reeling, reeling / length, wind)


@view
def chain_of(n, parameters, state):
    """`Chain` with the length, the reeling and the wind of a state."""
    return chain_at(n, parameters, state[at.LENGTH], state[at.REELING], vector_at(state, at.WIND))


@kernel
def property_of(chain, s, which):
    """One of the properties `layout.SHARE`, ... of segment s, or of two segments, as a pair."""
    return number_at(chain.parameters, at.PARAMETER_SCALARS + which * chain.n, s)


@kernel
def rest_length(chain, s):
    """Unstretched length l0 [m] of segment s, or of two segments, as a pair."""
    return property_of(chain, s, at.SHARE) * chain.length


@kernel
def point_mass(chain, i):
    """Mass [kg] that node i carries beside its share of the tether."""
    return chain.parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * chain.n + i]


@kernel
def has_node_winds(chain):
    """Whether the wind is given at the nodes; `chain` may be a `Drive`."""
    return chain.parameters[at.WIND_PROFILE] == at.AT_NODES


@kernel
def node_wind(chain, s, above):
    """Wind [m/s] that is given at node s + above; for two s, the winds at two nodes, as pairs; `chain` may be a `Drive`."""
    count = chain.n + 1
    x = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * chain.n + count + above
    y, z = x + count, x + 2 * count
    return number_at(chain.parameters, x, s), number_at(chain.parameters, y, s), number_at(chain.parameters, z, s)
