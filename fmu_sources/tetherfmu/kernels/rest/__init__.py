"""Equilibrium: chains (Newton's method, its starts, end tensions), a continuous elastic line, free points.

Imports `step`, `equations` and `linear_algebra`.
"""
