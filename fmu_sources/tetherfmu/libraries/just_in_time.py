"""Entry points compiled just in time: for development, and to compare them with those compiled ahead of time."""

from functools import cache
from importlib import import_module

from tetherfmu.kernels import entry_points, system_entry_points
from tetherfmu.kernels.compilation import entry_point
from tetherfmu.runtime.kernel_library import SYSTEM, prototypes, verbs


@cache
def compiled(variant):
    """Dict of the entry points of a variant, or of SYSTEM, by their verbs: numba.CFunc, compiled now."""
    if variant == SYSTEM:
        signatures, functions = system_entry_points.SIGNATURES, system_entry_points.ENTRY_POINTS
    else:
        signatures = entry_points.SIGNATURES
        functions = entry_points.entry_points(import_module(f"tetherfmu.kernels.variants.{variant}"))
    return {verb: entry_point(getattr(signatures, verb), getattr(functions, verb)) for verb in verbs(variant)}


def kernels(variant):
    """Entry points of a variant, `kernel_library.Kernels`, or of SYSTEM; some 20 to 40 s of compiling for one with nodes."""
    declared = prototypes(variant)
    return type(declared)(*(getattr(declared, verb)(found.address) for verb, found in compiled(variant).items()))
