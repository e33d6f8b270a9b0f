"""Declared parameters: checked, and packed into the `parameters` array of the other kernels.

The quantities are one flat array: first the fields of `Tether` for each tether in series, ground first, then those of
`Environment` and `Solver`, and for a free kite its mass, its start and its initial motion: in the order of
`variables.PARAMETERS`, whose limits are frozen here. A status carries the number of the wrong quantity in this array.
"""

from math import pi

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, OF_THE_WHOLE_CHAIN, QUANTITIES_OF_TETHER
from tetherfmu.runtime.status import (
    GROUND_WITHOUT_GRAVITY,
    NOT_THE_SAME_IN_SERIES,
    OK,
    PARAMETER_NOT_WHOLE,
    PARAMETER_OUT_OF_RANGE,
    ROUGHNESS_TOO_LARGE,
    SEGMENTS_TOO_MANY,
    SEGMENTS_TOO_SHORT,
    STOPS_CROSSED,
    UNKNOWN_WIND_LAW,
)
from tetherfmu.wiring.variables import PARAMETERS, PARAMETERS_WITHOUT_KITE

from .compilation import kernel, power
from .equations import air
from .equations.properties import put_point_mass, put_property

_NAMES = [each.name for each in PARAMETERS]
_CHOICES = [len(each.quantity.choices) for each in PARAMETERS]
MINIMA = np.array([1.0 if choices else each.quantity.minimum for each, choices in zip(PARAMETERS, _CHOICES, strict=True)])
MAXIMA = np.array([choices or each.quantity.maximum for each, choices in zip(PARAMETERS, _CHOICES, strict=True)], float)
IS_REAL = np.array([each.kind == "Real" for each in PARAMETERS])
NOT_IN_USE = np.array(
    [0 if all(each.quantity.choices) else list(each.quantity.choices).index("") + 1 for each in PARAMETERS], float
)
IS_ENUMERATION = np.array([each.kind == "Enumeration" for each in PARAMETERS])
NOWHERE = -1
PLACES = np.array([getattr(at, name.upper(), NOWHERE) for name in _NAMES])  # of the scalars in the `parameters` array
SAME_IN_SERIES = np.array([_NAMES.index(name) for name in OF_THE_WHOLE_CHAIN])
SEGMENTS, LENGTH, DIAMETER, DENSITY = map(_NAMES.index, ("segments", "initial_length", "diameter", "density"))
STIFFNESS, DAMPING, DRAG = map(_NAMES.index, ("axial_stiffness", "axial_damping", "drag_coefficient"))
STRENGTH = _NAMES.index("breaking_force")
PROFILE, HEIGHT = map(_NAMES.index, ("wind_profile", "wind_reference_height"))
ROUGHNESS = _NAMES.index("surface_roughness")
GRAVITY, CONTACT = map(_NAMES.index, ("gravity", "ground_contact"))
SHORTEST, LONGEST = map(_NAMES.index, ("shortest_length", "longest_length"))
KITE_MASS, KITE_START = map(_NAMES.index, ("kite_mass", "kite_start"))


@kernel
def count_of_quantities(tethers, kites):
    """Length of the array of quantities of so many tethers in series, with a free kite (kites = 1) or without (0)."""
    return (tethers - 1) * QUANTITIES_OF_TETHER + (len(MINIMA) if kites > 0 else PARAMETERS_WITHOUT_KITE)


@kernel
def declaration(tethers, k):
    """Number in `variables.PARAMETERS` of quantity k."""
    return k % QUANTITIES_OF_TETHER if k < tethers * QUANTITIES_OF_TETHER else k - (tethers - 1) * QUANTITIES_OF_TETHER


@kernel
def refused(code, k):
    """Status with this code and the number k."""
    return k << 8 | code


@kernel
def is_whole(value):
    """Whether a number of moderate size is an integer."""
    return value == float(int(value))


@kernel
def check_quantity(value, k, number):
    """Status: whether quantity k, declared under this number, has an allowed value."""
    if not (MINIMA[number] <= value <= MAXIMA[number]):  # also refuses NaN
        return refused(PARAMETER_OUT_OF_RANGE, k)
    if IS_REAL[number] or (is_whole(value) and value != NOT_IN_USE[number]):
        return OK
    return refused(PARAMETER_OUT_OF_RANGE if IS_ENUMERATION[number] else PARAMETER_NOT_WHOLE, k)


@kernel
def check_series(tethers, quantities, has_nodes):
    """Status: whether tethers fit together, with an allowed number of segments of sufficient length."""
    for t in range(1, tethers):
        for i in range(len(SAME_IN_SERIES)):
            place = t * QUANTITIES_OF_TETHER + SAME_IN_SERIES[i]
            if quantities[place] != quantities[SAME_IN_SERIES[i]]:
                return refused(NOT_THE_SAME_IN_SERIES, place)
    if count_segments(tethers, quantities, has_nodes) > at.MAX_SEGMENTS:
        return SEGMENTS_TOO_MANY
    for t in range(tethers):
        first = t * QUANTITIES_OF_TETHER
        if quantities[first + LENGTH] / segments_of(quantities, first, has_nodes) < at.MIN_SEGMENT_LENGTH:
            return refused(SEGMENTS_TOO_SHORT, first + LENGTH)
    return OK


@kernel
def check(tethers, kites, quantities, has_nodes):
    """Status: whether all quantities are allowed, alone and together."""
    for k in range(count_of_quantities(tethers, kites)):
        status = check_quantity(quantities[k], k, declaration(tethers, k))
        if status != OK:
            return status
    shift = (tethers - 1) * QUANTITIES_OF_TETHER
    profile = quantities[shift + PROFILE]
    if not air.is_known(profile):
        return refused(UNKNOWN_WIND_LAW, shift + PROFILE)
    is_logarithmic = profile == at.LOGARITHMIC or profile == at.EXPLOG
    if is_logarithmic and quantities[shift + ROUGHNESS] >= quantities[shift + HEIGHT]:
        return refused(ROUGHNESS_TOO_LARGE, shift + ROUGHNESS)
    if quantities[shift + CONTACT] == at.FLAT and quantities[shift + GRAVITY] == 0.0:
        return refused(GROUND_WITHOUT_GRAVITY, shift + CONTACT)
    if 0.0 < quantities[shift + LONGEST] <= quantities[shift + SHORTEST]:
        return refused(STOPS_CROSSED, shift + SHORTEST)
    return check_series(tethers, quantities, has_nodes)


@kernel
def segments_of(quantities, first, has_nodes):
    """Number of segments of the tether with quantities from place `first` on: one if the variant has no nodes."""
    return int(quantities[first + SEGMENTS]) if has_nodes else 1


@kernel
def count_segments(tethers, quantities, has_nodes):
    """Number of segments of all tethers together; 0 if a number is invalid."""
    n = 0
    for t in range(tethers):
        first = t * QUANTITIES_OF_TETHER
        if check_quantity(quantities[first + SEGMENTS], first, SEGMENTS) != OK:
            return 0
        n += segments_of(quantities, first, has_nodes)
    return n


@kernel
def line_density(quantities, first):
    """Mass per unstretched length [kg/m] of a tether with quantities from place `first` on."""
    return quantities[first + DENSITY] * pi * power(quantities[first + DIAMETER], 2.0) / 4.0


@kernel
def pack(tethers, kites, quantities, tolerance, has_nodes, has_waves, parameters):
    """Fill the parameters (modified), without point masses except a free kite; a status; unchanged on any status except OK.

    tolerance : relative tolerance [-] of the importer, for a solver without one of its own; 0 for none.
    has_nodes, has_waves : of the variant. Without nodes a tether has one segment, without waves it has no damping.
    The winch is at the start of the first tether, whose length alone it changes.
    """
    status = check(tethers, kites, quantities, has_nodes)
    if status != OK:
        return status
    shift = (tethers - 1) * QUANTITIES_OF_TETHER
    n = count_segments(tethers, quantities, has_nodes)
    for place in range(len(parameters)):
        parameters[place] = 0.0
    for number in range(PARAMETERS_WITHOUT_KITE):
        if PLACES[number] != NOWHERE:
            parameters[PLACES[number]] = quantities[number if number < QUANTITIES_OF_TETHER else shift + number]
    length = 0.0
    for t in range(tethers):
        length += quantities[t * QUANTITIES_OF_TETHER + LENGTH]
    parameters[at.INITIAL_LENGTH] = length
    if parameters[at.SLACK_STIFFNESS_RATIO] == 0.0:  # a damper alone would support a slack rope for seconds
        parameters[at.SLACK_DAMPING_RATIO] = 0.0
    if parameters[at.RELATIVE_TOLERANCE] == 0.0:
        parameters[at.RELATIVE_TOLERANCE] = tolerance if tolerance != 0.0 else DEFAULT_TOLERANCE
    if parameters[at.LONGEST_LENGTH] == 0.0:
        parameters[at.LONGEST_LENGTH] = at.NO_STOP
    of_winch = quantities[LENGTH]
    for t in range(1, tethers):
        parameters[at.LENGTH_BEYOND] += quantities[t * QUANTITIES_OF_TETHER + LENGTH]
    s = 0
    for t in range(tethers):
        first = t * QUANTITIES_OF_TETHER
        count = segments_of(quantities, first, has_nodes)
        share, offset = of_winch / count / of_winch, 0.0
        if t == 0:
            parameters[at.LEAST_LENGTH] = parameters[at.LENGTH_BEYOND] + at.MIN_SEGMENT_LENGTH / share
            parameters[at.SHORTEST_LENGTH] = max(parameters[at.SHORTEST_LENGTH], parameters[at.LEAST_LENGTH])
        else:
            share, offset = 0.0, quantities[first + LENGTH] / count
        damping = quantities[first + DAMPING] if has_waves else 0.0
        density, drag_width = line_density(quantities, first), quantities[first + DRAG] * quantities[first + DIAMETER]
        for _ in range(count):
            put_property(n, at.SHARE, s, share, parameters)
            put_property(n, at.OFFSET, s, offset, parameters)
            put_property(n, at.STIFFNESS, s, quantities[first + STIFFNESS], parameters)
            put_property(n, at.DAMPING, s, damping, parameters)
            put_property(n, at.LINE_DENSITY, s, density, parameters)
            put_property(n, at.DRAG_WIDTH, s, drag_width, parameters)
            if has_waves and quantities[first + STRENGTH] > 0.0:
                put_property(n, at.STRENGTH, s, quantities[first + STRENGTH], parameters)
                parameters[at.CAN_BREAK] = 1.0
            s += 1
    if kites > 0:
        parameters[at.KITE_IS_FREE] = 1.0
        parameters[at.KITE_START] = quantities[shift + KITE_START]
        put_point_mass(n, n, quantities[shift + KITE_MASS], parameters)
    return OK
