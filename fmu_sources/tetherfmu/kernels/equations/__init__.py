"""The equations of the tether: boundary conditions of a step, air, one segment, node loads, their sum and derivatives.

Each law is written here and nowhere else. Imports `linear_algebra`.
"""
