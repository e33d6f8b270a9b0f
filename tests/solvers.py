"""Solvers of both kinds, and tests that run with each of them."""

import pytest

from tetherfmu import Solver

ADAPTIVE = Solver()
METHODS = ("second_order", "backward_euler")


def fixed(step, method):
    """Solver with fixed steps [s]."""
    return Solver(fixed_step=step, fixed_step_method=method)


def with_each_solver(step=0.01):
    """Let a test run with adaptive steps, and with fixed ones [s] of both methods."""
    silent = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")
    in_steps = [pytest.param(fixed(step, method), marks=silent, id=method) for method in METHODS]
    return pytest.mark.parametrize("solver", [pytest.param(ADAPTIVE, id="adaptive"), *in_steps])
