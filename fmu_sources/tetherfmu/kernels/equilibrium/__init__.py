"""Shapes in equilibrium: of a chain (Newton's method and its starts) and of a continuous elastic line.

Imports `algebra` and `chain`.
"""
