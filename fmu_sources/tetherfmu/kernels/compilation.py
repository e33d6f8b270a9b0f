"""How kernels are compiled: by numba, without exceptions and without allocation.

Rules of a kernel, so that its machine code can stand alone without Python: arguments are numbers, tuples and flat
arrays; work space comes from the caller; a failure is a status code; other kernels are called by name only. Nothing
is allocated, raised or received as a function.
"""

from numba import cfunc, njit

OPTIONS = {"error_model": "numpy"}


def kernel(function):
    """Compile a function for other kernels (and for tests) at its first call."""
    return njit(**OPTIONS)(function)


def view(function):
    """Compile a kernel that returns arrays, as views or in a record; always inlined, so that no reference is counted."""
    return njit(forceinline=True, **OPTIONS)(function)


def entry_point(signature, function):
    """Compile a function that takes numbers and pointers, to a `numba.CFunc`."""
    return cfunc(signature, **OPTIONS)(function)
