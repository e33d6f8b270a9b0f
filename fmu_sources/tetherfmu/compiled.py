"""The compiled entry points as ctypes functions: what the shells call, with the addresses of their arrays.

Each variant has three: initialize(n, parameters, inputs, state, work), advance(n, parameters, inputs, step, state, work) and
observe(n, parameters, state, shape_points, outputs, work); see `entry.py`.
"""

from collections import namedtuple
from ctypes import CFUNCTYPE, c_double, c_int32, c_int64, c_void_p
from functools import cache

from . import entry
from .compilation import compile_entry_point

Kernels = namedtuple("Kernels", "initialize advance observe")
PROTOTYPES = Kernels(
    CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_void_p, c_void_p),
    CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_double, c_void_p, c_void_p),
    CFUNCTYPE(c_int32, c_int64, c_void_p, c_void_p, c_int64, c_void_p, c_void_p),
)


@cache
def _compiled(name):
    return compile_entry_point(getattr(entry, name))


def kernels(variant):
    """Entry points of a variant ("dynamic", ...) as a `Kernels` of ctypes functions."""
    return Kernels(*(prototype(_compiled(f"{variant}_{verb}").address) for verb, prototype in PROTOTYPES._asdict().items()))
