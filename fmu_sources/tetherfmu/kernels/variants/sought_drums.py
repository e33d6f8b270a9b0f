"""Drums with a sought balance at the start, over sheaves or with several lines: their data for `rope_shares.py`.

The imbalance of a drum is sum of r T - W - c u - F sign(u), over its lines with ratios r. Rope and
forces refer to the line with its largest ratio.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import NO_BALANCE_OF_DRUMS

from ..compilation import kernel
from ..equations.drum import HELD, INWARDS, OUTWARDS, balance, drum_of
from ..equations.lines import inputs_of, lines_of, parameters_of, state_of
from ..points.coordinates import has_sought_drum, is_alone, largest_ratio, ratio_of
from ..points.room import any_line

WAITING = 0.0  # `winch_start` of drums that are


@kernel
def part_of_drum(system, k, carrier):
    """Rope of line k per metre on the line with the largest ratio of a drum [-]."""
    return ratio_of(system, k, carrier) / largest_ratio(system, carrier)


@kernel
def imbalance_of_drum(system, k):
    """Imbalance [N] of the drum that line k carries, at rest or with its initial speed."""
    inputs = inputs_of(system, k)
    speed, drum = inputs[at.REEL_OUT_SPEED], drum_of(parameters_of(system, k), inputs[at.WINCH_FORCE], 0.0)
    direction = HELD if speed == 0.0 else (OUTWARDS if speed > 0.0 else INWARDS)
    pull = 0.0
    for j in range(lines_of(system)):
        pull += ratio_of(system, j, k) * state_of(system, j)[at.TENSION_FROM]
    return balance(drum, direction, pull, speed, 0.0) / largest_ratio(system, k)


@kernel
def put_start(system, now, then):
    """Replace the `winch_start` of drums that have `now` (in the parameters, modified)."""
    for k in range(lines_of(system)):
        if parameters_of(system, k)[at.WINCH_START] == now:
            parameters_of(system, k)[at.WINCH_START] = then


@kernel
def has_several(system, k):
    """Whether line k carries a sought drum that is not equivalent to a winch of its own."""
    return has_sought_drum(system, k) and not is_alone(system, k)


holds_several = any_line(has_several)


@kernel
def about_drums(system):
    """NO_BALANCE_OF_DRUMS about the line that carries the least balanced sought drum."""
    worst = -1.0
    for k in range(lines_of(system)):
        if has_several(system, k) and not abs(imbalance_of_drum(system, k)) <= worst:
            worst, system.plan[places.STATUS_LINE] = abs(imbalance_of_drum(system, k)), k
    return NO_BALANCE_OF_DRUMS | at.WINCH_FORCE << 8
