"""Coordinates of rope that runs: over a sheave, or off a drum that turns beside sheaves or holds several lines.

The rate u of a coordinate [m/s] is that at which rope runs over a sheave, or at which a drum pays out a line with ratio 1.
It acts on portions, IN over the first node or OUT over the last one, with weights r in their rates a and b there:

    sheave at the end of line k     OUT of k with r = 1, IN of k + 1 with r = 1
    drum that line k carries        IN of the first portion of each line that it holds, with the ratio of the line

A line at several drums has the sum of what they let in. So what follows from energies is the same for both; `sheaves.py` has
the equation of a sheave, `running_drums.py` that of a drum. A coordinate is a number: k of the sheave at the end of line k,
and k more than the number of lines of the drum that line k carries.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..compilation import kernel, view
from ..equations import winch
from ..equations.lines import inputs_of, lines_of, number_of_line, parameters_of, state_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import goes_on, has_coordinates, is_portion
from ..equations.torn import is_torn
from ..flat_arrays import part
from ..line.rodas4p import STAGES
from . import sheave_room as at_sheave
from .sheave_room import drum_numbers_at, held_ratio, numbers_at, ratio_of, shared_of
from .system_room import shares_of


@kernel
def carries_drum(system, k):
    """Whether line k carries a drum that is a coordinate, also where it broke."""
    parameters = parameters_of(system, k)
    control = parameters[at.WHOLE_CONTROL if is_torn(parameters) else at.WINCH_CONTROL]
    return number_of_line(system, k, places.DRUM) != 0 and control == at.WINCH_BY_FORCE


@kernel
def is_drum(system, c):
    """Whether a coordinate is a drum."""
    return c >= lines_of(system)


@kernel
def line_of(system, c):
    """The line before a sheave, or that carries a drum."""
    return c - lines_of(system) if is_drum(system, c) else c


@view
def own_numbers(system, c):
    """Numbers of a coordinate, at the first places of `sheave_room.py`."""
    return drum_numbers_at(system, line_of(system, c)) if is_drum(system, c) else sheave_numbers_at(system, c)


@view
def sheave_numbers_at(system, k):
    """Those of the sheave at the end of line k; an array as long as `drum_numbers_at`."""
    return part(numbers_at(system, k), 0, at_sheave.DRUM_NUMBERS)


@kernel
def is_braked(system, c):
    """Whether a coordinate is a drum whose lines all broke: it turns no more."""
    if not is_drum(system, c):
        return False
    whole = 0
    for k in range(lines_of(system)):
        whole += state_of(system, k)[at.TORN_SEGMENT] == 0.0 and held_ratio(system, k, line_of(system, c)) != 0.0
    return whole == 0


# --- which there are


@kernel
def append(system, c, count):
    """Let a coordinate (modified) have a number."""
    own_numbers(system, c)[at_sheave.NUMBER] = count
    shared_of(system)[4][count] = c


@kernel
def number_coordinates(system):
    """Number all coordinates (modified), sheaves in the order of their lines, then drums."""
    count, lines = 0, lines_of(system)
    for k in range(lines):
        if goes_on(system, k):
            append(system, k, count)
            count += 1
    for k in range(lines):
        if carries_drum(system, k):
            append(system, lines + k, count)
            count += 1
    numbers_at(system, 0)[at_sheave.COUNT] = count


@kernel
def count_of(system):
    """How many there are, of a system that has numbered them."""
    return int(numbers_at(system, 0)[at_sheave.COUNT])


@kernel
def coordinate_at(system, j):
    """The coordinate with a number."""
    return int(shared_of(system)[4][j])


@kernel
def number_of(system, c):
    """Number of a coordinate."""
    return int(own_numbers(system, c)[at_sheave.NUMBER])


@kernel
def runs(system, c):
    """Whether rope runs over the sheave, or the drum turns."""
    return own_numbers(system, c)[at_sheave.RUNS] != 0.0


@kernel
def count_running(system):
    """Over how many sheaves rope runs, and how many drums turn."""
    count = 0
    if has_coordinates(system):
        for j in range(count_of(system)):
            count += runs(system, coordinate_at(system, j))
    return count


@kernel
def is_any_running(system):
    """Whether rope runs over any sheave or off any drum."""
    return count_running(system) > 0


@view
def stages_of(system, c):
    """What the stages of a step make of the speed of a coordinate [m/s]."""
    if is_drum(system, c):
        return part(drum_numbers_at(system, line_of(system, c)), at_sheave.DRUM_NUMBERS, STAGES)
    return shares_of(system, c).speeds


# --- on which portions they act


@kernel
def portions_of(system, c):
    """The first portion on which a coordinate acts, and the one behind the last; a drum need not act on all in between."""
    return (0, lines_of(system)) if is_drum(system, c) else (c, c + 2)


@kernel
def weight_of(system, c, k, side):
    """r [-] with which a coordinate acts on an end of portion k; 0 where it does not."""
    if is_drum(system, c):
        return ratio_of(system, k, line_of(system, c)) if side == IN else 0.0
    return 1.0 if k + side == c + 1 else 0.0


@kernel
def growth_of(system, c, k):
    """By how much a coordinate makes portion k longer for each metre that passes [-]."""
    return weight_of(system, c, k, IN) - weight_of(system, c, k, OUT)


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
