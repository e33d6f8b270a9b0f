"""Tests of the kernels, in the rooms of the package; a package, because they share `chain_problem`."""
