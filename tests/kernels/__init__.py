"""Tests of the kernels, in the rooms of the package; a package, because they share `chain_problem` and `late_code`."""

from late_code import make_code_late

make_code_late()
