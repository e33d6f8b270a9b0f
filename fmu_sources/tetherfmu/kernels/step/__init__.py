"""What every variant does around its own part of a start or a step: the transaction, plausibility, outputs, power balance.

Imports `equations` and `linear_algebra`.
"""
