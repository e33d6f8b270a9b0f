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
wind : at the reference height [m/s].
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
