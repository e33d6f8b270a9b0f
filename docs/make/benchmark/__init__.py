"""Races of kernels and FMUs against independent solvers. Imports `measuring`."""
