"""The entry points compiled just in time, for the Python face."""

from functools import cache

from tetherfmu.kernels import entry_points
from tetherfmu.kernels.compilation import compile_entry_point
from tetherfmu.runtime.kernel_library import PROTOTYPES, Kernels


@cache
def _compiled(name):
    return compile_entry_point(getattr(entry_points, name))


def kernels(variant):
    """Entry points of a variant ("dynamic", ...) as `library.Kernels`."""
    return Kernels(*(prototype(_compiled(f"{variant}_{verb}").address) for verb, prototype in PROTOTYPES._asdict().items()))
