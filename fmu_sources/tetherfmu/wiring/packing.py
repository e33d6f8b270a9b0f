"""The `parameters` array of the kernels, which their entry point `pack` checks and fills."""

from array import array
from itertools import accumulate

from ..runtime import layout as at
from ..runtime import status
from ..runtime.instance import address, zeros
from ..runtime.naming import prefixed
from ..runtime.parameters import QUANTITIES_OF_TETHER, Ground, Winch, numbers_of
from .variables import PARAMETERS

_NAMES = [each.name for each in PARAMETERS]
_SEGMENTS, _LENGTH = _NAMES.index("segments"), _NAMES.index("initial_length")
_ROUGHNESS, _HEIGHT = _NAMES.index("surface_roughness"), _NAMES.index("wind_reference_height")
_SHORTEST, _LONGEST = _NAMES.index("shortest_length"), _NAMES.index("longest_length")


def pack(kernels, numbers, tethers=1, kites=0, tolerance=0.0):
    """Number of segments for the variant, and the `parameters` array; ValueError if a number is not allowed.

    kernels : `kernel_library.Kernels` of the variant.  numbers : quantities of tethers in series, of the environment and the
    solver, with kites = 1 also of a free kite, in the order of `variables.PARAMETERS`.  tolerance : the importer's
    relative tolerance [-], for a solver without one of its own; 0 for none.
    """
    quantities = array("d", numbers)
    segments = kernels.segments(tethers, address(quantities))
    parameters = zeros(at.parameters_size(segments))
    result = kernels.pack(tethers, kites, address(quantities), tolerance, address(parameters))
    if result != status.OK:
        raise ValueError(_sentence(result, numbers, tethers))
    return segments, parameters


def put_ends(segments, parameters, free_ends, point_masses=()):
    """Say in parameters (modified) which ends move freely, ground first, and which masses [kg] nodes have: pairs."""
    parameters[at.GROUND_IS_FREE], parameters[at.KITE_IS_FREE] = free_ends
    for node, mass in point_masses:
        parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * segments + node] = mass
    if inner := [node for node, mass in point_masses if 0 < node < segments and mass != 0.0]:
        end_section(segments, parameters, min(inner))


def end_section(segments, parameters, node):
    """End the section at the winch at a node, where a mass is fixed to the rope, in parameters (modified)."""
    shares = at.PARAMETER_SCALARS + at.SHARE * segments
    offsets = at.PARAMETER_SCALARS + at.OFFSET * segments
    if parameters[shares + node] == 0.0:  # it ends there or before
        return
    length = (parameters[at.INITIAL_LENGTH] - parameters[at.LENGTH_BEYOND]) * parameters[shares]
    for s in range(segments):
        if s < node:
            parameters[shares + s] = 1.0 / node
        elif parameters[shares + s] != 0.0:
            parameters[shares + s], parameters[offsets + s] = 0.0, length
            parameters[at.LENGTH_BEYOND] += length
    parameters[at.LEAST_LENGTH] = parameters[at.LENGTH_BEYOND] + node * at.MIN_SEGMENT_LENGTH
    parameters[at.SHORTEST_LENGTH] = max(parameters[at.SHORTEST_LENGTH], parameters[at.LEAST_LENGTH])


def pack_lines(kernels, lines, tolerance=0.0, kites=0):
    """Numbers of segments of lines, a tuple, and their parameters, one array; ValueError names a named line.

    lines : for each its name, the numbers for `pack`, the number of tethers, whether its start and its end are
    free points, and the masses of these [kg] that it carries: all in the first line at a point, 0 in the others.
    """
    counts, found = (), array("d")
    for name, numbers, tethers, free_ends, (first, last) in lines:
        with prefixed(f"the line {name}: " if name else ""):
            segments, parameters = pack(kernels, numbers, tethers, kites, tolerance)
        if any(free_ends):
            put_ends(segments, parameters, free_ends, ((0, first), (segments, last)))
        counts, found = (*counts, segments), found + parameters
    return counts, found


def put_sheaves(counts, parameters, sheaves):
    """Write portions and sheaves into the parameters of all lines (modified).

    counts : segments of each line.  sheaves : for each line None, or the numbers from `layout.IS_PORTION` on.
    """
    first = 0
    for segments, numbers in zip(counts, sheaves, strict=True):
        if numbers is not None:
            place = first + at.IS_PORTION
            parameters[place : place + len(numbers)] = array("d", numbers)
        first += at.parameters_size(segments)


def put_holders(counts, parameters, holders):
    """Write the drums that drive lines with force-controlled winches into the parameters of all lines (modified).

    counts : segments of each line.  holders : rows (line, place from `layout.HELD_BY` on, number).
    """
    firsts = list(accumulate(map(at.parameters_size, counts), initial=0))
    for line, place, number in holders:
        if parameters[firsts[line] + at.WINCH_CONTROL] == at.WINCH_BY_FORCE:
            parameters[firsts[line] + place] = number


def pack_records(
    kernels,
    tethers,
    environment,
    solver,
    winch=Winch(),  # noqa: B008 (a constant record)
    ground=Ground(),  # noqa: B008
    *,
    point_masses=(),
    free_ends=(False, False),
    kite_start=0,
):
    """As `pack`, of records.

    tethers : in series from the ground to the kite; the winch changes the length of the first, up to the first inner node
    with a mass.  point_masses : pairs (node, extra mass [kg]), nodes counted from 0 at the ground.  free_ends : whether the
    ground end and the kite end move freely.  kite_start : of a free kite, as `parameters.FreeKite` has it.
    """
    segments, parameters = pack(kernels, numbers_of(tethers, environment, solver, winch, ground), len(tethers))
    put_ends(segments, parameters, free_ends, point_masses)
    parameters[at.KITE_START] = kite_start
    return segments, parameters


def _sentence(result, numbers, tethers):
    """Message of a status about quantities."""
    place, shift = status.index(result), (tethers - 1) * QUANTITIES_OF_TETHER
    is_of_tether = place < tethers * QUANTITIES_OF_TETHER
    declared = PARAMETERS[place % QUANTITIES_OF_TETHER if is_of_tether else place - shift]
    first = place - place % QUANTITIES_OF_TETHER if is_of_tether else 0  # of the tether that it is about
    counts = [_whole(numbers[t * QUANTITIES_OF_TETHER + _SEGMENTS]) for t in range(tethers)]
    return status.sentence(
        result,
        name=declared.name,
        value=numbers[place] if declared.kind == "Real" else _whole(numbers[place]),
        range=declared.quantity.range(),
        roughness=numbers[shift + _ROUGHNESS],
        height=numbers[shift + _HEIGHT],
        shortest_stop=numbers[shift + _SHORTEST],
        longest_stop=numbers[shift + _LONGEST],
        length=numbers[first + _LENGTH],
        segments=counts[first // QUANTITIES_OF_TETHER],
        in_all=sum(counts),
    )


def _whole(value):
    """A whole number as an integer."""
    return int(value) if float(value).is_integer() else value
