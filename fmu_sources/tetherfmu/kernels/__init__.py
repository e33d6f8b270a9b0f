"""The physics and its numerics: kernels on flat arrays, compiled by numba.

`entry_points` are the only functions that shells call. Imports numpy, numba, the standard library and, of `runtime`, the
layout of the arrays and the status codes.
"""
