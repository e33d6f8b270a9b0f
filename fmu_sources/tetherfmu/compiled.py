"""The compiled entry points as ctypes functions: what the FMU shell calls, with the addresses of its arrays.

Each variant has three: initialize(n, parameters, inputs, state, work), advance(n, parameters, inputs, step, state, work) and
observe(n, parameters, state, shape_points, outputs, work); see `entry.py`.
"""

from collections import namedtuple
from ctypes import CFUNCTYPE, c_double, c_int32, c_int64, c_void_p

from . import entry

Kernels = namedtuple("Kernels", "initialize advance observe")

_INITIALIZE = CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_void_p, c_void_p)
_ADVANCE = CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_double, c_void_p, c_void_p)
_OBSERVE = CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_int64, c_void_p, c_void_p)


def kernels(variant):
    """Entry points of a variant ("dynamic", ...) as a `Kernels` of ctypes functions."""
    return Kernels(
        _INITIALIZE(getattr(entry, f"{variant}_initialize").address),
        _ADVANCE(getattr(entry, f"{variant}_advance").address),
        _OBSERVE(getattr(entry, f"{variant}_observe").address),
    )
