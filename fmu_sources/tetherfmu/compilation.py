"""How kernels are compiled: numba without exceptions, cached on disk by the content of the sources.

Rules of a kernel, so that its machine code can stand alone without Python: arguments are numbers, tuples and flat
arrays; work space comes from the caller; a failure is a status code; other kernels are called by name only. Nothing
is allocated, raised or received as a function.
"""

import hashlib
from contextlib import contextmanager
from pathlib import Path

from numba import cfunc, config, njit

_PACKAGE = Path(__file__).parent


def source_digest():
    """Hash of all sources of the package: 12 hexadecimal digits."""
    digest = hashlib.sha256()
    for path in sorted(_PACKAGE.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


_CACHE_FOLDER = str(_PACKAGE / "__pycache__" / f"kernels_{source_digest()}")


@contextmanager
def _cache_folder():
    """Point numba's cache at a folder of these sources only: numba does not see an edit in another file."""
    users_choice = config.CACHE_DIR
    config.CACHE_DIR = users_choice or _CACHE_FOLDER
    try:
        yield
    finally:
        config.CACHE_DIR = users_choice


def kernel(function):
    """Compile a function for other kernels (and for tests) at its first call."""
    with _cache_folder():
        return njit(error_model="numpy", cache=True)(function)


def entry_point(signature):
    """Compile a function of numbers and pointers, callable through ctypes, at once (or load it from the cache)."""

    def decorate(function):
        with _cache_folder():
            return cfunc(signature, error_model="numpy", cache=True)(function)

    return decorate
