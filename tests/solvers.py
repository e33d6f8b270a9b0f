"""Solvers of both kinds and all models, tests that run with each of them, and the work that fixed steps may take."""

import numpy as np
import pytest

from tetherfmu import Solver, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight

ADAPTIVE = Solver()
MODELS = (TetherDynamic, TetherQuasiSteady, TetherCatenary, TetherStraight)
every_model = pytest.mark.parametrize("model", MODELS, ids=lambda model: model.variant)
METHODS = ("second_order", "backward_euler")


def fixed(step, method):
    """Solver with fixed steps [s]."""
    return Solver(fixed_step=step, fixed_step_method=method)


def with_each_solver(step=0.01):
    """Let a test run with adaptive steps, and with fixed ones [s] of both methods."""
    silent = pytest.mark.filterwarnings("ignore:.*backward Euler")  # which is asked for
    in_steps = [pytest.param(fixed(step, method), marks=silent, id=method) for method in METHODS]
    return pytest.mark.parametrize("solver", [pytest.param(ADAPTIVE, id="adaptive"), *in_steps])


def bounded_flight(system, step, inputs):
    """The last outputs of 20 steps [s] of a system in fixed steps: all numbers are finite, the work of each is bounded.

    inputs : function of the time [s] that returns the arguments of a step.
    """
    for k in range(20):
        before = system.counters["iterations"]
        outputs = system.step(step, **inputs(step * k))
        limit = next(iter(outputs.lines.values())).solver_iteration_limit
        assert system.counters["iterations"] - before <= limit == system.most_factorizations
    assert all(np.isfinite(each).all() for each in system.positions.values())
    return outputs
