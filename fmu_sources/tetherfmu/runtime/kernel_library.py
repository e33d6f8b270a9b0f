"""The entry points of a variant as ctypes functions, and the compiled library that has them.

segments(tethers, quantities), pack(tethers, kites, quantities, tolerance, parameters), work_size(n), initialize(n,
parameters, inputs, state, shape_points, outputs, work), advance(n, parameters, inputs, step, state, before, shape_points,
outputs, work), outputs(n, parameters, state, shape_points, outputs, work); for the Python API also fly and energy. Arrays
are passed by addresses. See `kernels/entry_points.py`. The library SYSTEM moves several tethers at once and has entry points
of its own, see `kernels/system_entry_points.py`.
"""

import platform
import sys
from collections import namedtuple
from ctypes import CDLL, CFUNCTYPE, c_double, c_int32, c_int64, c_void_p
from functools import lru_cache
from pathlib import Path

from .variants import BY_NAME

Kernels = namedtuple("Kernels", "segments pack work_size initialize advance outputs fly energy", defaults=(None,))
# platforms of PythonFMU's libraries, and where an FMU has those
PYTHONFMU = {"x86_64-linux": "binaries/linux64/", "x86_64-windows": "binaries/win64/"}
NO_LIBRARY_OF_PYTHONFMU = (
    f"PythonFMU has libraries for {' and '.join(PYTHONFMU)} only, not for {{platforms}}; "
    "build a native FMU: tetherfmu build --native"
)
_ARRAY = c_void_p
PROTOTYPES = Kernels(
    segments=CFUNCTYPE(c_int64, c_int64, _ARRAY),
    pack=CFUNCTYPE(c_int32, c_int64, c_int64, _ARRAY, c_double, _ARRAY),
    work_size=CFUNCTYPE(c_int64, c_int64),
    initialize=CFUNCTYPE(c_int32, c_int64, _ARRAY, _ARRAY, _ARRAY, c_int64, _ARRAY, _ARRAY),
    advance=CFUNCTYPE(c_int32, c_int64, _ARRAY, _ARRAY, c_double, _ARRAY, _ARRAY, c_int64, _ARRAY, _ARRAY),
    outputs=CFUNCTYPE(c_int32, c_int64, _ARRAY, _ARRAY, c_int64, _ARRAY, _ARRAY),
    fly=CFUNCTYPE(
        c_int64, c_int64, _ARRAY, _ARRAY, c_int64, c_double, c_int64, c_int64, _ARRAY, _ARRAY, c_int64, _ARRAY, _ARRAY
    ),
    energy=CFUNCTYPE(c_int32, c_int64, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
)
SYSTEM = "system"
SystemKernels = namedtuple("SystemKernels", "segments pack complete initialize advance outputs fly")
SYSTEM_PROTOTYPES = SystemKernels(
    segments=CFUNCTYPE(c_int64, c_int64, _ARRAY),
    pack=CFUNCTYPE(c_int32, c_int64, _ARRAY, c_double, c_int64, c_int64, c_double, c_double, _ARRAY),
    complete=CFUNCTYPE(c_int32, _ARRAY),
    initialize=CFUNCTYPE(c_int32, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    advance=CFUNCTYPE(c_int32, _ARRAY, _ARRAY, _ARRAY, c_double, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    outputs=CFUNCTYPE(c_int32, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    fly=CFUNCTYPE(c_int64, _ARRAY, _ARRAY, _ARRAY, c_int64, c_double, c_int64, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
)
SUFFIXES = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}


def prototypes(variant):
    """Prototypes of the entry points of a variant, or of SYSTEM."""
    return SYSTEM_PROTOTYPES if variant == SYSTEM else PROTOTYPES


def verbs(variant):
    """Names of the entry points of a variant, without its name: those with nodes also account for their energy."""
    if variant == SYSTEM:
        return SystemKernels._fields
    return Kernels._fields[: None if BY_NAME[variant].has_nodes else -1]


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
    """Entry points of a variant, from its library for this platform in a folder; OSError says what is missing.

    Loaded once: all instances share them (they hold no state), and the folder may vanish afterwards.
    """
    libraries = {platform_of(path): path for path in sorted(Path(folder).glob(f"{variant}-*"))}
    if this_platform() not in libraries:
        raise OSError(
            f"this FMU has no kernels for {this_platform()}, only for {', '.join(libraries) or 'no platform'}; "
            f"build it with: tetherfmu build --platforms {this_platform()}"
        )
    shared = CDLL(str(libraries[this_platform()]))
    declared = prototypes(variant)
    return type(declared)(*(getattr(declared, verb)((f"{variant}_{verb}", shared)) for verb in verbs(variant)))
