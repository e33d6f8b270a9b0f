"""Entry points compiled just in time: for development, and to compare them with those compiled ahead of time."""

from functools import cache
from importlib import import_module

from tetherfmu.kernels.compilation import entry_point
from tetherfmu.kernels.entry_points import SIGNATURES, entry_points
from tetherfmu.kernels.variants.tether import tether
from tetherfmu.runtime.kernel_library import PROTOTYPES, SYSTEM, Kernels, verbs


@cache
def compiled(variant):
    """Dict of the entry points of a variant, or of SYSTEM, by their verbs: numba.CFunc, compiled now."""
    module = import_module(f"tetherfmu.kernels.variants.{variant}")
    functions = entry_points(module if variant == SYSTEM else tether(module))
    return {verb: entry_point(getattr(SIGNATURES, verb), getattr(functions, verb)) for verb in verbs(variant)}


def kernels(variant):
    """Entry points of a variant, `kernel_library.Kernels`, or of SYSTEM; some 20 to 40 s of compiling for one with nodes."""
    return Kernels(*(getattr(PROTOTYPES, verb)(found.address) for verb, found in compiled(variant).items()))
