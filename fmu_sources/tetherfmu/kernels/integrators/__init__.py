"""Motion of the chain within a communication step: the adaptive Rosenbrock method and backward Euler with a fixed step.

Imports `equations` and `linear_algebra`.
"""
