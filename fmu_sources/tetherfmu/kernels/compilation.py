"""How kernels are compiled: by numba, without exceptions and without allocation.

Rules of a kernel, so that its machine code can stand alone without Python: arguments are numbers, tuples and flat
arrays; work space comes from the caller; a failure is a status code; other kernels are called by name only. Nothing
is allocated, raised or received as a function.

Kernels are compiled into the entry points (`entry_points.py`), and only those are cached on disk.
"""

from contextlib import contextmanager

from numba import cfunc, config, njit

from .sources import PACKAGE, source_digest


def kernel(function):
    """Compile a function for other kernels (and for tests) at its first call."""
    return njit(error_model="numpy")(function)


def view(function):
    """Compile a kernel that returns arrays, as views or in a record; always inlined, so that no reference is counted."""
    return njit(error_model="numpy", forceinline=True)(function)


@contextmanager
def _cache_of_these_sources():
    """Point numba's cache at a folder named by the sources: numba itself does not see an edit in another file."""
    users_choice = config.CACHE_DIR
    config.CACHE_DIR = users_choice or str(PACKAGE / "__pycache__" / f"kernels_{source_digest()}")
    try:
        yield
    finally:
        config.CACHE_DIR = users_choice


def compile_entry_point(function, on_disk=True):
    """Compile a function of `entry_points.py` to a numba.CFunc, or load it from the cache, if `on_disk`."""
    with _cache_of_these_sources():
        return cfunc(function.signature, error_model="numpy", cache=on_disk)(function)
