"""Shapes in equilibrium: of a chain (Newton's method and its starts, tensions at its ends) and of a continuous elastic line.

Imports `equations` and `linear_algebra`.
"""
