"""Lines over sheaves, and drums with a sought start, at rest: where the search of `resting_points.py` begins.

It solves free points, portion lengths and payouts of sought drums (`winch_start`) together. If it fails from the initial
lengths (`first_shares.py`), it starts from straight ropes or from softer rope, and for drums of several lines from the
solution without them.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import INPUT_NOT_FINITE, NO_BALANCE_OF_DRUMS, NO_SHARES, OK, REELED_TOO_SHORT, WINCH_TOO_SHORT

from ..compilation import kernel
from ..equations.free_points import free_points
from ..equations.lines import lines_of, parameters_of, segments_of
from ..equations.properties import property_in, put_property
from ..equations.ropes import is_portion
from ..points.coordinates import has_sought_drum
from ..points.room import any_line
from ..rest import resting_points
from ..rest.resting_forces import search_of
from .first_shares import fits, has_several, share_ropes

SOFTEST, STIFFER = 2.0**-15, 8.0  # relative stiffness of rope that fits anywhere; factor from step to step
WAITING = 0.0  # `winch_start` of drums that are

holds_several = any_line(has_several)
holds_sought = any_line(has_sought_drum)


@kernel
def put_start(system, now, then):
    """Replace the `winch_start` of drums that have `now` (in the parameters, modified)."""
    for k in range(lines_of(system)):
        if parameters_of(system, k)[at.WINCH_START] == now:
            parameters_of(system, k)[at.WINCH_START] = then


@kernel
def about_drums(system):
    """NO_BALANCE_OF_DRUMS about the line that carries the least balanced sought drum of several lines."""
    search, worst = search_of(system), -1.0
    for j in range(int(search.count[0])):
        k, left = int(-1.0 - search.carrier[j]), abs(search.residual[3 * free_points(system) + j])
        if k >= 0 and has_several(system, k) and not left <= worst:
            worst, system.plan[places.STATUS_LINE] = left, k
    return NO_BALANCE_OF_DRUMS | at.WINCH_FORCE << 8


@kernel
def put_stiffness(system, factor):
    """Multiply the axial stiffness of all portions by a factor, a power of 2 (in the parameters, modified)."""
    for k in range(lines_of(system)):
        n, parameters = segments_of(system, k), parameters_of(system, k)
        for s in range(n):
            if is_portion(system, k):
                put_property(n, at.STIFFNESS, s, factor * property_in(parameters, n, s, at.STIFFNESS), parameters)


@kernel
def search_for_shares(system):
    """Search of `find_shares` from the initial lengths; a status."""
    status = resting_points.find(system, False)
    if status != OK and holds_sought(system):
        share_ropes(system, True)
        return resting_points.find(system, False)
    if status == OK:
        return OK
    share_ropes(system, False)
    factor, found = SOFTEST, OK
    put_stiffness(system, SOFTEST)
    while factor <= 1.0 and found == OK:
        found = resting_points.find(system, factor > SOFTEST)
        put_stiffness(system, STIFFER if factor < 1.0 else 1.0)
        factor *= STIFFER
    if factor <= 1.0:
        put_stiffness(system, 1.0 / factor)
    return found if found == OK else status


@kernel
def search_from_given(system):
    """`search_for_shares` from the solution with all drums as given; a status."""
    put_start(system, float(at.WINCH_IN_BALANCE), WAITING)
    sought = share_ropes(system, False)
    status = search_for_shares(system) if sought > 0 else resting_points.find(system, False)
    put_start(system, WAITING, float(at.WINCH_IN_BALANCE))
    if status != OK:
        return status
    return OK if resting_points.find(system, True) == OK else about_drums(system)


@kernel
def find_shares(system):
    """Solve all sought points and portion lengths for equilibrium (modified); a status.

    Portions that become too short during the search are NO_SHARES.
    """
    if share_ropes(system, False) == 0:
        return resting_points.find(system, False)
    status = search_for_shares(system)
    if status != OK and status & 0xFF != INPUT_NOT_FINITE and holds_several(system):
        share_ropes(system, False)  # of whole lines
        status = search_from_given(system)
    is_short = status in (REELED_TOO_SHORT, WINCH_TOO_SHORT)
    return NO_SHARES if is_short and fits(system) else status
