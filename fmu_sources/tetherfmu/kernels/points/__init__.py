"""What couples lines in a step: the equations of all lines and free points at once, with the drums of their winches.

Imports `line`, `equations` and `linear_algebra`.
"""
