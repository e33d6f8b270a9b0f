"""The entry points as ctypes functions, and the compiled library that an FMU carries.

Each variant has three: initialize(n, parameters, inputs, state, work), advance(n, parameters, inputs, step, state, work) and
observe(n, parameters, state, shape_points, outputs, work); arrays are passed by addresses. See `kernels/entry_points.py`.
"""

import platform
import sys
from collections import namedtuple
from ctypes import CDLL, CFUNCTYPE, c_double, c_int32, c_int64, c_void_p
from functools import lru_cache
from pathlib import Path

Kernels = namedtuple("Kernels", "initialize advance observe")
PROTOTYPES = Kernels(
    CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_void_p, c_void_p),
    CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_double, c_void_p, c_void_p),
    CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_int64, c_void_p, c_void_p),
)
SUFFIXES = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}


def this_platform():
    """Processor and system of this machine, such as "x86_64-linux"."""
    machine = platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    return f"{machine}-{system}"


def file_name(variant, target):
    """Name of the library of a variant for a platform, such as "dynamic-x86_64-linux.so"."""
    return f"{variant}-{target}{SUFFIXES[target.rsplit('-', 1)[1]]}"


@lru_cache
def load(folder, variant):
    """Entry points of a variant, from its library for this platform in a folder; OSError says what is missing.

    Loaded once: all instances share them (they hold no state), and the folder may vanish afterwards.
    """
    available = sorted(path.name for path in Path(folder).glob(f"{variant}-*"))
    names = [name for name in available if name.startswith(f"{variant}-{this_platform()}.")]
    if not names:
        raise OSError(
            f"this FMU has no kernels for {this_platform()}, only {', '.join(available)}; "
            f"build it with: python build_fmus.py --platforms {this_platform()}"
        )
    shared = CDLL(str(Path(folder) / names[0]))
    return Kernels(*(prototype((f"{variant}_{verb}", shared)) for verb, prototype in PROTOTYPES._asdict().items()))
