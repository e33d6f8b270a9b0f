"""Motion of the chain within a communication step: the adaptive Rosenbrock method and backward Euler with a fixed step.

Imports `algebra`, `chain` and, of `communication`, what drives the ends.
"""
