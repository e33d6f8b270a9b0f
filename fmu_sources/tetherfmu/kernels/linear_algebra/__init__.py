"""Small linear algebra: three-vectors and 3x3 matrices in registers, two of them at once, block tridiagonal systems.

Knows nothing of tethers. The only package that knows LLVM.
"""
