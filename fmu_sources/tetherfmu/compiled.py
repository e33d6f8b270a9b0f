"""The entry points compiled just in time, for the Python face."""

from functools import cache

from . import entry
from .compilation import compile_entry_point
from .library import PROTOTYPES, Kernels


@cache
def _compiled(name):
    return compile_entry_point(getattr(entry, name))


def kernels(variant):
    """Entry points of a variant ("dynamic", ...) as `library.Kernels`."""
    return Kernels(*(prototype(_compiled(f"{variant}_{verb}").address) for verb, prototype in PROTOTYPES._asdict().items()))
