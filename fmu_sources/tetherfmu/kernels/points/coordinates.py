"""The rope coordinates of a system: metres of rope that pass a sheave, or that a drum pays out.

    sheave at the end of line k     moves rope out of the end of line k and into the start of line k + 1
    drum that line k carries        lets rope into the start of each of its lines, with the ratio of the line
    drum of a line of its own       lets rope into the start of its line with the ratio 1

Payouts of several drums on one line are summed. The motion of all coordinates follows from energies alone:
`equations/rope.py`, `line/strand.py`, `net.py`. This file reads their parameters and provides the scratch space in which
the search for equilibrium lengths stores its numbers.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..compilation import PARTS, kernel, view
from ..equations import winch
from ..equations.lines import inputs_of, lines_of, number_of_line, parameters_of
from ..equations.ropes import goes_on, has_coordinates, is_portion, is_turned
from ..flat_arrays import part


@kernel
def carries_drum(system, k):
    """Whether line k carries a drum that is shared or used with sheaves, even if the line is broken."""
    parameters = parameters_of(system, k)
    control = parameters[at.WHOLE_CONTROL if parameters[at.WINCH_IS_BRAKED] != 0.0 else at.WINCH_CONTROL]
    return number_of_line(system, k, places.DRUM) != 0 and control == at.WINCH_BY_FORCE


@kernel
def has_own_drum(system, k):
    """Whether line k has its own drum: a force-controlled winch in a system without sheaves and shared drums."""
    return winch.follows_force(parameters_of(system, k)) and not has_coordinates(system)


@kernel
def held_ratio(system, k, carrier):
    """Ratio [-] with which the drum on the line `carrier` drives line k; 0 if it does not."""
    total, parameters = 0.0, parameters_of(system, k)
    for i in range(at.MOST_HOLDERS):
        if parameters[at.HELD_BY + i] == carrier + 1.0:
            total += parameters[at.HELD_RATIO + i]
    return total


@kernel
def ratio_of(system, k, carrier):
    """Rope of line k per metre that the drum on the line `carrier` pays out [-]."""
    return held_ratio(system, k, carrier) if is_turned(system, k) else 0.0


@kernel
def shortest_of(system, k):
    """Shortest unstretched length [m] of line k; of a portion as its segments permit."""
    return parameters_of(system, k)[at.LEAST_LENGTH if PARTS and is_portion(system, k) else at.SHORTEST_LENGTH]


@kernel
def part_of_shortest(system, k, part):
    """Length [m] of line k at which its section at the winch has a part [-] of its shortest length."""
    beyond = parameters_of(system, k)[at.LENGTH_BEYOND]
    return beyond + part * (shortest_of(system, k) - beyond)


@kernel
def longest_of(system, k):
    """Longest unstretched length [m] to which its drum pays out line k, or the whole rope that begins with it."""
    return parameters_of(system, k)[at.LONGEST_LENGTH]


# --- start of drums


@kernel
def start_speed(system, k):
    """Initial payout speed [m/s] of line k by drums: sum over its holders, from the inputs of their carriers."""
    total, parameters = 0.0, parameters_of(system, k)
    for i in range(at.MOST_HOLDERS):
        holder = int(parameters[at.HELD_BY + i])
        if holder > 0:
            total += parameters[at.HELD_RATIO + i] * inputs_of(system, holder - 1)[at.REEL_OUT_SPEED]
    return total


@kernel
def largest_ratio(system, carrier):
    """Largest magnitude of the ratios of a drum [-]."""
    most = 0.0
    for k in range(lines_of(system)):
        most = max(most, abs(ratio_of(system, k, carrier)))
    return most


@kernel
def is_alone(system, k):
    """Whether the drum on line k is equivalent to a winch of its own: ratio 1, one line, no other coordinate."""
    others = 0
    for j in range(lines_of(system)):
        others += j != k and (ratio_of(system, j, k) != 0.0 or ratio_of(system, k, j) != 0.0)
    return others == 0 and ratio_of(system, k, k) == 1.0


@kernel
def has_sought_drum(system, k):
    """Whether the drum on line k starts in a balance that involves sheaves or several lines."""
    if not (PARTS and carries_drum(system, k) and winch.is_sought(parameters_of(system, k))):
        return False
    return goes_on(system, k) or not is_alone(system, k)


@kernel
def is_sought_by_drums(system, k):
    """Whether such a drum drives line k."""
    count = 0
    for carrier in range(lines_of(system)):
        count += ratio_of(system, k, carrier) != 0.0 and has_sought_drum(system, carrier)
    return count > 0


@kernel
def is_shared_out(system, k):
    """Whether the initial length of line k is solved with others: a portion, or a line of such a drum."""
    return PARTS and (is_portion(system, k) or is_sought_by_drums(system, k))


# --- scratch space of the search at rest

LENGTH_AT_REST, GIVEN_AT_REST = 0, 1  # [m]; as the search begins [m]
TENSION_AT_REST, REST_NUMBERS = 2, 4  # at both ends [N]


@view
def numbers_at_rest(system, k):
    """Numbers of line k while equilibrium lengths are solved."""
    return part(system.work, number_of_line(system, k, places.PORTION_WORK), REST_NUMBERS)
