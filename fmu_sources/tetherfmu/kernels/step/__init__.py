"""Common code of all variants around a start or a step: transaction, plausibility, outputs, power balance.

Imports `equations` and `linear_algebra`.
"""
