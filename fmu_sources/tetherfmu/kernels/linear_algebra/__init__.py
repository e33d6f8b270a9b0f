"""Small linear algebra: three-vectors and 3x3 matrices in registers, also two at once, and block tridiagonal systems.

Independent of tethers. Only this package uses LLVM.
"""
