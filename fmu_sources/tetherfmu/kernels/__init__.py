"""The physics and its numerics: kernels on flat arrays, compiled by numba.

Shells call only `entry_points`. Imports numpy, numba, the standard library and, from `runtime`, the
layout of the arrays and the status codes.
"""
