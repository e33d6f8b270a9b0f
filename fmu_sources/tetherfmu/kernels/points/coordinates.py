"""Which rope coordinates a system has: metres of rope that pass a sheave, or that a drum pays out.

    sheave at the end of line k     takes rope out of line k over its end, and lets it into line k + 1 over its start
    drum that line k carries        lets rope into the start of each line that it holds, with the ratio of the line
    drum of a line of its own       the same with one line and the ratio 1

A line at several drums has the sum of what they let in. What a coordinate does follows from energies alone, whatever it is:
`equations/rope.py`, `line/strand.py`, `net.py`. Here is what the parameters say of them, and where the search for the
lengths of lines at rest keeps its numbers.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..compilation import kernel, view
from ..equations import winch
from ..equations.lines import inputs_of, lines_of, number_in, number_of_line, parameters_of
from ..equations.ropes import goes_on, has_coordinates, is_portion, is_turned
from ..equations.torn import is_torn
from ..flat_arrays import part


@kernel
def carries_drum(system, k):
    """Whether line k carries a drum that turns beside sheaves or that several lines share, also where it broke."""
    parameters = parameters_of(system, k)
    control = parameters[at.WHOLE_CONTROL if is_torn(parameters) else at.WINCH_CONTROL]
    return number_of_line(system, k, places.DRUM) != 0 and control == at.WINCH_BY_FORCE


@kernel
def has_own_drum(system, k):
    """Whether line k has a drum to itself: a winch controlled by force, in a system without sheaves and shared drums."""
    return winch.follows_force(parameters_of(system, k)) and not has_coordinates(system)


@kernel
def held_ratio(system, k, carrier):
    """Ratio [-] with which the drum that the line `carrier` carries holds line k; 0 where it does not."""
    total, parameters = 0.0, parameters_of(system, k)
    for i in range(at.MOST_HOLDERS):
        if parameters[at.HELD_BY + i] == carrier + 1.0:
            total += parameters[at.HELD_RATIO + i]
    return total


@kernel
def ratio_of(system, k, carrier):
    """Rope of line k for each metre that the drum pays out which the line `carrier` carries [-]."""
    return held_ratio(system, k, carrier) if is_turned(system, k) else 0.0


@kernel
def shortest_of(system, k):
    """Unstretched length [m] below which line k does not get."""
    return parameters_of(system, k)[at.SHORTEST_LENGTH]


@kernel
def longest_of(system, k):
    """Unstretched length [m] to which its drum pays out line k at most."""
    return parameters_of(system, k)[at.LONGEST_LENGTH]


# --- how drums start


@kernel
def start_speed(system, k):
    """Speed [m/s] at which drums pay out line k at the start: those of its holders, which their carriers have as inputs."""
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
    """Whether the drum that line k carries is as a winch of its own: with the ratio 1, and nothing else at either."""
    others = 0
    for j in range(lines_of(system)):
        others += j != k and (ratio_of(system, j, k) != 0.0 or ratio_of(system, k, j) != 0.0)
    return others == 0 and ratio_of(system, k, k) == 1.0


@kernel
def has_sought_drum(system, k):
    """Whether line k carries a drum that is to be in balance at the start together with sheaves, or with several lines."""
    if not (carries_drum(system, k) and winch.is_sought(parameters_of(system, k))):
        return False
    return goes_on(system, k) or not is_alone(system, k)


@kernel
def is_sought_by_drums(system, k):
    """Whether such a drum holds line k."""
    count = 0
    for carrier in range(lines_of(system)):
        count += ratio_of(system, k, carrier) != 0.0 and has_sought_drum(system, carrier)
    return count > 0


@kernel
def is_shared_out(system, k):
    """Whether line k starts with a length that is found with others: a portion, or one that such a drum holds."""
    return is_portion(system, k) or is_sought_by_drums(system, k)


# --- room for the search at rest

LENGTH_AT_REST, REST_NUMBERS = 0, 2  # [m]


@view
def numbers_at_rest(system, k):
    """Numbers of line k while lengths are sought at rest: LENGTH_AT_REST."""
    return part(system.work, number_of_line(system, k, places.PORTION_WORK), REST_NUMBERS)


@kernel
def rest_size(count):
    """Length of what `shared_at_rest` needs of so many coordinates."""
    return count * (2 * count + 4) + 1


@view
def shared_at_rest(system, count):
    """Two matrices and three vectors of so many coordinates; room for one number more of each, and one."""
    first, square = number_in(system.plan, places.SHEAVES_WORK), count * count
    vectors = first + 2 * square
    matrices = part(system.work, first, square), part(system.work, first + square, square)
    three = part(system.work, vectors, count), part(system.work, vectors + count, count)
    last = part(system.work, vectors + 2 * count, count)
    behind_them = part(system.work, vectors + 3 * count, count)
    return (*matrices, *three, last), behind_them, part(system.work, vectors + 4 * count, 1)
