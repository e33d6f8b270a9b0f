"""The entry points of a library as ctypes functions, and the library that has them: of a tether, or SYSTEM, of several.

segments(tethers, quantities), pack(tethers, kites, quantities, tolerance, parameters), complete(plan), initialize(plan,
parameters, inputs, state, outputs, work), advance(plan, parameters, inputs, step, state, before, outputs, work),
outputs(plan, parameters, inputs, state, outputs, work); for the Python API also fly and energy. Arrays are passed by
addresses. See `kernels/entry_points.py`.
"""

import platform
import sys
from collections import namedtuple
from ctypes import CDLL, CFUNCTYPE, c_double, c_int32, c_int64, c_void_p
from functools import lru_cache
from pathlib import Path

from .variants import BY_NAME

Kernels = namedtuple("Kernels", "segments pack complete initialize advance outputs fly energy", defaults=(None,))
SYSTEM = "system"
# platforms of PythonFMU's libraries, and where an FMU has those
PYTHONFMU = {"x86_64-linux": "binaries/linux64/", "x86_64-windows": "binaries/win64/"}
NO_LIBRARY_OF_PYTHONFMU = (
    f"PythonFMU has libraries for {' and '.join(PYTHONFMU)} only, not for {{platforms}}; "
    "build a native FMU: tetherfmu build --native"
)


class Plan(c_void_p):
    """Address of whole numbers."""


class Array(c_void_p):
    """Address of floats."""


_FIXED = Plan, Array, Array  # plan, parameters, inputs
PROTOTYPES = Kernels(
    segments=CFUNCTYPE(c_int64, c_int64, Array),
    pack=CFUNCTYPE(c_int32, c_int64, c_int64, Array, c_double, Array),
    complete=CFUNCTYPE(c_int32, Plan),
    initialize=CFUNCTYPE(c_int32, *_FIXED, Array, Array, Array),
    advance=CFUNCTYPE(c_int32, *_FIXED, c_double, Array, Array, Array, Array),
    outputs=CFUNCTYPE(c_int32, *_FIXED, Array, Array, Array),
    fly=CFUNCTYPE(c_int64, *_FIXED, c_int64, c_double, c_int64, c_int64, Array, Array, Array, Array),
    energy=CFUNCTYPE(c_int32, *_FIXED, c_int64, Array, Array, Array),
)
SUFFIXES = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}


def verbs(variant):
    """Names of the entry points of a library, without its name: of those with nodes one accounts for their energy."""
    has_nodes = variant == SYSTEM or BY_NAME[variant].has_nodes
    return Kernels._fields[: None if has_nodes else -1]


def this_platform():
    """Processor and system of this machine, such as "x86_64-linux"."""
    machine = platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    return f"{machine}-{system}"


def file_name(variant, target):
    """Name of the library of a variant for a platform, such as "dynamic-x86_64-linux.so"."""
    return f"{variant}-{target}{SUFFIXES[target.rsplit('-', 1)[1]]}"


def platform_of(library):
    """Platform of the library of a variant by its file name: the inverse of `file_name`."""
    return Path(library).stem.partition("-")[2]


@lru_cache
def load(folder, variant):
    """Entry points of a variant, from its library for this platform in a folder; OSError names a missing file.

    Loaded once: all instances share them (they are stateless), and the folder may vanish afterwards.
    """
    libraries = {platform_of(path): path for path in sorted(Path(folder).glob(f"{variant}-*"))}
    if this_platform() not in libraries:
        raise OSError(
            f"this FMU has no kernels for {this_platform()}, only for {', '.join(libraries) or 'no platform'}; "
            f"build it with: tetherfmu build --platforms {this_platform()}"
        )
    shared = CDLL(str(libraries[this_platform()]))
    return Kernels(*(getattr(PROTOTYPES, verb)((f"{variant}_{verb}", shared)) for verb in verbs(variant)))
