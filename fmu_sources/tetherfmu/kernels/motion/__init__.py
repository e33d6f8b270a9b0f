"""Motion within a communication step, each driver once: adaptive steps, fixed steps, a drum at a tether in equilibrium.

Imports `points`, `line`, `equations` and `linear_algebra`.
"""
