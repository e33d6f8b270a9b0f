"""Lines of a system that are portions of ropes over sheaves, and lines that drums beside them pay out."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..arrays import outputs_size
from ..compilation import kernel, view
from ..flat_arrays import part
from .lines import number_in, number_of_line, parameters_of
from .winch import follows_force


@kernel
def sheaves_of(system):
    """Number of sheaves."""
    return number_in(system.plan, places.SHEAVES)


@kernel
def has_sheaves(system):
    """Whether any line runs over a sheave."""
    return sheaves_of(system) > 0


@kernel
def coordinates_in(system):
    """Number of sheaves and of drums that may turn beside them; see `points/coordinates.py`."""
    return number_in(system.plan, places.COORDINATES)


@kernel
def has_coordinates(system):
    """Whether there is any sheave or such drum."""
    return coordinates_in(system) > 0


@kernel
def goes_on(system, k):
    """Whether line k continues over a sheave at its end."""
    return number_of_line(system, k, places.THROUGH) != 0


@kernel
def comes_from(system, k):
    """Whether line k begins at a sheave."""
    return has_sheaves(system) and k > 0 and number_of_line(system, k - 1, places.THROUGH) != 0


@kernel
def first_of(system, k):
    """First portion of the rope that includes line k."""
    while comes_from(system, k):
        k -= 1
    return k


@kernel
def is_freed(system, k):
    """Whether the arrays of line k belong to a line that was released at its end."""
    return number_of_line(system, k, places.FREED) != 0


@kernel
def runs_off(system, k):
    """Whether rope of a released line may run off the sheave at the start of line k: joints of tethers in series do not."""
    return is_freed(system, k) and parameters_of(system, k)[at.LENGTH_BEYOND] == 0.0


@kernel
def freed_of(system, k):
    """1 for a line that was released, else 0: the number of its additional segments."""
    return 1 if is_freed(system, k) else 0


@kernel
def is_portion(system, k):
    """Whether line k is a portion of a line over sheaves."""
    return has_sheaves(system) and (goes_on(system, k) or comes_from(system, k))


@kernel
def is_turned(system, k):
    """Whether drums that are shared or used with sheaves pay out line k."""
    if not has_coordinates(system):
        return False
    return parameters_of(system, k)[at.HELD_BY] != 0.0 and follows_force(parameters_of(system, k))


@kernel
def is_rope(system, k):
    """Whether rope may run into or out of line k, over a sheave or from such a drum."""
    return is_portion(system, k) or is_turned(system, k)


@view
def outputs_of_line(system, k, outputs):
    """The part of an output array for line k."""
    size = outputs_size(number_of_line(system, k, places.SHAPE_POINTS), is_portion(system, k))
    return part(outputs, number_of_line(system, k, places.OUTPUTS_AT), size)
