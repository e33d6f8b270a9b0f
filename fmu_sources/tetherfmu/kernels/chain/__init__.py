"""The laws of the tether: air, one segment, the chain of lumped masses, and their derivatives.

Each law is written here and nowhere else. Imports `algebra`.
"""
