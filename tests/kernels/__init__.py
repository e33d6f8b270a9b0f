"""Tests of the kernels, in the rooms of the package; a package, because they share `chain_problem` and `late_code`."""

from late_code import make_code_late
from tetherfmu.libraries.ready import fitting_way

if fitting_way() == "fast":  # the internals of the installed numba are known
    make_code_late()
