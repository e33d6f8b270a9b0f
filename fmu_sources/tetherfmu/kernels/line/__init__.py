"""One line in a step, and its drum: stages of the Rosenbrock method and of fixed steps, contact, errors.

Imports `equations` and `linear_algebra`.
"""
