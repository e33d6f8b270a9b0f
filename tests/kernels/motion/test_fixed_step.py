"""Fixed steps converge with their order to the adaptive result, and are exactly those that were asked for."""

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, fly_circle
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Solver

COMMUNICATION = 0.02


def circle_forces(solver):
    """Forces on both ends from t = 10 s to 20 s, every 20 ms."""
    _, outputs = fly_circle(TetherDynamic(CIRCLE_TETHER, solver=solver), COMMUNICATION, 20.0)
    return np.array([np.concatenate((out.ground_force, out.kite_force)) for out in outputs[500:]])


@pytest.fixture(scope="module")
def exact():
    """Forces of the adaptive solver."""
    return circle_forces(Solver(relative_tolerance=1e-9, initial_shape=2))


@pytest.mark.parametrize(
    ("method", "expected", "largest"),
    [("backward_euler", 1.0, 3e-3), ("second_order", 2.0, 6e-4)],
)
def test_order_on_a_smooth_flight(exact, method, expected, largest):
    """The slope of log error over log step; error [N] with the longest one, of forces of 10 to 100 N."""
    error = []
    steps = np.array((0.02, 0.01, 0.005, 0.0025))
    for fixed_step in steps:
        forces = circle_forces(Solver(fixed_step=fixed_step, fixed_step_method=method, initial_shape=2))
        error.append(np.sqrt(np.mean((forces - exact) ** 2)))
    order = np.polyfit(np.log(steps), np.log(error), 1)[0]
    assert order == pytest.approx(expected, abs=0.1)  # observed 0.97; 2.01
    assert error[0] < largest  # observed 1.4e-3; 2.6e-4


@pytest.mark.parametrize("fixed_step", [0.02, 0.01, 0.005, 0.0025])
def test_takes_exactly_these_steps(fixed_step):
    model = TetherDynamic(CIRCLE_TETHER, solver=Solver(fixed_step=fixed_step))
    fly_circle(model, COMMUNICATION, 1.0)
    assert model.counters["steps"] == round(1.0 / fixed_step)
    assert model.counters["rejections"] == 0
