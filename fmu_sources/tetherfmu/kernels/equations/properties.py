"""A chain at an instant: segment properties, point masses, unstretched length, wind."""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..compilation import PARTS, kernel, view
from ..linear_algebra.pairs import broadcast, number_at, select
from ..linear_algebra.vectors import NEUTRAL, vector_at
from .air import is_uniform

Chain = namedtuple(
    "Chain",
    "n parameters length section reeling acceleration leaving leaving_gain flows growth seen_growth slack_stiffness_ratio "
    "slack_damping_ratio gravity wind air_is_uniform has_sections is_parted second second_growth",
)
Chain.__doc__ = """A chain at an instant.

n : number of segments.  parameters : flat array, see `layout.py`.
length, reeling, acceleration : unstretched tether length L [m] and its first [m/s] and second [m/s2] derivative.
section : the part of it in the section at the winch, which reeling changes [m]; L of a uniform line.
leaving, leaving_gain : rate at which rope leaves the last node over a sheave [m/s], its rate [m/s2]; -0 elsewhere.
flows : whether rope flows past the nodes, or begins to, and its momentum counts (strain_rate law).
growth : (dl0/dt)/l0 in this section [1/s]; 0 beyond it, see `in_section`.
seen_growth : the growth that dampers see: all under the strain_rate law, none under the stretch_rate law.
slack_stiffness_ratio, slack_damping_ratio : of a slack segment to a taut one [-].  gravity : along -z [m/s2].
wind : at the reference height [m/s]; unused if the wind is given at the nodes, see `node_wind`.
air_is_uniform : whether wind and density are the same everywhere.
has_sections : whether a part of the chain keeps its unstretched length while the winch runs.
is_parted : whether it is a portion that broke, see `parts.py`.
second, second_growth : minus the unstretched length of its second part [m], and (dl0/dt)/l0 there [1/s]; else 0.

Some fields repeat `parameters`: a loop that writes to arrays would reload them for each segment."""


@kernel
def sees_reeling(parameters):
    """Whether dampers see the strain, and thus the rate of the unstretched length (strain_rate law)."""
    return parameters[at.DAMPING_LAW] == at.STRAIN_RATE


@view
def chain_with_flow(n, parameters, length, reeling, acceleration, leaving, wind, flows):
    """`Chain` of this unstretched length [m] with its first [m/s] and second [m/s2] derivative, in a wind [m/s].

    leaving : the rate at which rope leaves its last node [m/s], and its derivative [m/s2].
    """
    section, is_parted = section_of(parameters, length), PARTS and parameters[at.IS_PARTED] != 0.0
    growth, second, second_growth = reeling / section, 0.0, 0.0
    if PARTS and is_parted:
        second = parameters[at.REST_BETWEEN] - parameters[at.LENGTH_BEYOND]
        growth, second_growth = (reeling + leaving[0]) / section, leaving[0] / second
    seen_growth = growth if sees_reeling(parameters) else 0.0
    motion = length, section, reeling, acceleration, *leaving, flows, growth, seen_growth
    ratios = parameters[at.SLACK_STIFFNESS_RATIO], parameters[at.SLACK_DAMPING_RATIO]
    has_sections = parameters[at.LENGTH_BEYOND] != 0.0
    air = wind, is_uniform(parameters)
    return Chain(
        n, parameters, *motion, *ratios, parameters[at.GRAVITY], *air, has_sections, is_parted, second, second_growth
    )


@view
def chain_in_motion(n, parameters, length, reeling, acceleration, wind):
    """`chain_with_flow` whose rope flows if it reels."""
    flows = (reeling != 0.0 or acceleration != 0.0) and sees_reeling(parameters)
    return chain_with_flow(n, parameters, length, reeling, acceleration, (NEUTRAL, NEUTRAL), wind, flows)


@view
def portion_in_motion(n, parameters, length, reeling, acceleration, leaving, wind):
    """`chain_in_motion` for a portion of a line over sheaves; leaving : as in `chain_with_flow`."""
    flows = reeling != 0.0 or acceleration != 0.0 or leaving[0] != 0.0 or leaving[1] != 0.0
    return chain_with_flow(n, parameters, length, reeling, acceleration, leaving, wind, flows)


@view
def chain_at(n, parameters, length, reeling, wind):
    """`Chain` of this unstretched length [m], which changes at this rate [m/s], in a wind [m/s]."""
    return chain_in_motion(n, parameters, length, reeling, 0.0, wind)


@view
def chain_of(n, parameters, state):
    """`Chain` with the length, the reel-out speed and acceleration, and the wind of a state."""
    motion = state[at.LENGTH], state[at.REELING], state[at.ACCELERATION]
    flows = (motion[1] != 0.0 or motion[2] != 0.0) and sees_reeling(parameters)
    leaving = NEUTRAL, NEUTRAL
    if parameters[at.IS_PORTION] != 0.0:
        leaving = state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION]
        flows = flows or leaving[0] != 0.0 or leaving[1] != 0.0
    return chain_with_flow(n, parameters, *motion, leaving, vector_at(state, at.WIND), flows)


@view
def chain_without_flow(n, parameters, state):
    """`chain_of` in equilibrium, without the momentum of flowing rope."""
    motion = state[at.LENGTH], state[at.REELING], 0.0, (NEUTRAL, NEUTRAL)
    return chain_with_flow(n, parameters, *motion, vector_at(state, at.WIND), False)


@kernel
def property_of(chain, s, which):
    """One of the properties `layout.SHARE`, ... of segment s, or of two segments, as a pair."""
    return property_in(chain.parameters, chain.n, s, which)


@kernel
def property_in(parameters, n, s, which):
    """`property_of` for a chain of n segments in the parameters."""
    return number_at(parameters, at.PARAMETER_SCALARS + which * n, s)


@kernel
def half_density(chain, s):
    """mu/2 [kg/m] of segment s, or of two segments, as a pair."""
    return 0.5 * property_of(chain, s, at.LINE_DENSITY)


@kernel
def has_drag(chain):
    """Whether the air exerts any force on the chain."""
    if chain.parameters[at.AIR_DENSITY] != 0.0:
        for s in range(chain.n):
            if property_of(chain, s, at.DRAG_WIDTH) != 0.0:
                return True
    return False


@kernel
def section_of(parameters, length):
    """Length [m] of the section at the winch in a line of this unstretched length [m]."""
    return length - parameters[at.LENGTH_BEYOND]


@kernel
def rest_length(chain, s):
    """Unstretched length l0 [m] of segment s, or of two segments, as a pair."""
    share = property_of(chain, s, at.SHARE)
    length = share * chain.section
    if chain.has_sections:
        if PARTS:
            length = select(share, length, share * chain.second)
        length = length + property_of(chain, s, at.OFFSET)
    return length


@kernel
def in_section(chain, s, value):
    """A value if segment s is in the section at the winch, else 0; for two segments as a pair."""
    return in_parts(chain, s, value, 0.0)


@kernel
def in_parts(chain, s, value, other):
    """A value if segment s is in the section at the winch or in the first part, else another; for two segments as a pair."""
    share = property_of(chain, s, at.SHARE)
    here, beyond = broadcast((value, other if PARTS else 0.0), share)
    if chain.has_sections:
        here = select(share, here, beyond)
    return here


@kernel
def growth_at(chain, s):
    """(dl0/dt)/l0 [1/s] of segment s, or of two segments, as a pair."""
    return in_parts(chain, s, chain.growth, chain.second_growth)


@kernel
def part_in(parameters, n, s, length):
    """Fraction [-] of the unstretched length [m] that is in segment s of n."""
    share = property_in(parameters, n, s, at.SHARE)
    if PARTS and share < 0.0:
        return share * (parameters[at.REST_BETWEEN] - parameters[at.LENGTH_BEYOND]) / length
    in_winch = property_in(parameters, n, s, at.SHARE) * (section_of(parameters, length) / length)
    return in_winch + property_in(parameters, n, s, at.OFFSET) / length


@kernel
def part_of(chain, s):
    """`part_in` of a chain."""
    return part_in(chain.parameters, chain.n, s, chain.length)


@kernel
def growing_mass(chain, i, mass):
    """The part of the mass of node i [kg] that is proportional to the length of the section at the winch."""
    total = mass - point_mass(chain, i)
    if chain.has_sections:
        for s in range(max(i - 1, 0), min(i + 1, chain.n)):
            if property_of(chain, s, at.SHARE) == 0.0:
                total -= half_density(chain, s) * rest_length(chain, s)
    return total


@kernel
def stiffest(chain):
    """Largest axial stiffness E A of the segments [N]."""
    most = 0.0
    for s in range(chain.n):
        most = max(most, property_of(chain, s, at.STIFFNESS))
    return most


@kernel
def point_mass(chain, i):
    """Mass [kg] of node i in addition to its share of the tether."""
    return point_mass_in(chain.parameters, chain.n, i)


@kernel
def point_mass_in(parameters, n, i):
    """`point_mass` for a chain of n segments in the parameters."""
    return parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n + i]


@kernel
def holds(chain, s):
    """Whether segment s carries load; otherwise the chain is parted there, see `torn.py`."""
    return property_of(chain, s, at.STIFFNESS) > 0.0


@kernel
def place_of(n, which):
    """First place of a property of n segments in the parameters; SEGMENT_PROPERTIES: of the node masses."""
    return at.PARAMETER_SCALARS + which * n


@kernel
def put_property(n, which, s, value, parameters):
    """Set one of the properties `layout.SHARE`, ... of segment s of n in the parameters (modified)."""
    parameters[at.PARAMETER_SCALARS + which * n + s] = value


@kernel
def put_point_mass(n, i, mass, parameters):
    """Set the mass [kg] of node i, in addition to its share of the tether, of n segments in the parameters (modified)."""
    parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n + i] = mass


@kernel
def has_node_winds(chain):
    """Whether the wind is specified at the nodes; `chain` may be a `BoundaryConditions`."""
    return chain.parameters[at.WIND_PROFILE] == at.AT_NODES


@kernel
def node_wind(chain, s, above):
    """Wind [m/s] specified at node s + above; for two values of s, the winds at two nodes, as pairs.

    `chain` may be a `BoundaryConditions`.
    """
    count = chain.n + 1
    x = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * chain.n + count + above
    y, z = x + count, x + 2 * count
    return number_at(chain.parameters, x, s), number_at(chain.parameters, y, s), number_at(chain.parameters, z, s)


@kernel
def put_node_wind(n, i, wind, parameters):
    """Set the wind at node i [m/s] (in the parameters, modified)."""
    x = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n + n + 1 + i
    parameters[x], parameters[x + n + 1], parameters[x + 2 * (n + 1)] = wind


@kernel
def scale_node_winds(n, factor, parameters):
    """Multiply the winds at the nodes in the parameters (modified) by a factor."""
    for k in range(at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n + n + 1, len(parameters)):
        parameters[k] *= factor
