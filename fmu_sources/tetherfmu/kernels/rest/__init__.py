"""What is at rest: a chain (Newton's method, its starts, tensions at its ends), a continuous elastic line, free points.

Imports `step`, `equations` and `linear_algebra`.
"""
