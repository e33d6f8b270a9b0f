"""Entry points compiled just in time: for development, and to compare them with those compiled ahead of time."""

from functools import cache
from importlib import import_module

from tetherfmu.kernels.compilation import entry_point
from tetherfmu.kernels.entry_points import SIGNATURES, entry_points
from tetherfmu.runtime.kernel_library import PROTOTYPES, Kernels, verbs


@cache
def compiled(variant):
    """Dict of the entry points of a variant by their verbs: numba.CFunc, compiled now."""
    functions = entry_points(import_module(f"tetherfmu.kernels.variants.{variant}"))
    return {verb: entry_point(getattr(SIGNATURES, verb), getattr(functions, verb)) for verb in verbs(variant)}


def kernels(variant):
    """Entry points of a variant as `kernel_library.Kernels`; some 20 to 40 s of compiling for one with nodes."""
    found = compiled(variant)
    return Kernels(*(getattr(PROTOTYPES, verb)(function.address) for verb, function in found.items()))
