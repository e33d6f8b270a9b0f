"""Coupling of lines in a step: joint equations of all lines and free points, with the drums of their winches.

Imports `line`, `equations` and `linear_algebra`.
"""
