"""With initial_shape = quasi_steady the dynamic tether starts as if it had always flown.

Settled force: of the quasi-steady tether at the same time; and of the dynamic tether itself one whole turn later, at the
same place. A start from rest is off by several times the force.
"""

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, REVOLUTION, fly_circle
from tetherfmu.python.models import TetherDynamic, TetherQuasiSteady
from tetherfmu.runtime.parameters import Solver

STEPS = 6283  # of a turn, 20 ms
STEP = REVOLUTION / STEPS
SECOND = 50


def magnitudes(outputs):
    """|ground_force| and |kite_force| [N] in the first second of `outputs`."""
    return np.array([[np.linalg.norm(each.ground_force), np.linalg.norm(each.kite_force)] for each in outputs[:SECOND]])


def flight(model, initial_shape, turns, wind):
    tether = model(CIRCLE_TETHER, solver=Solver(initial_shape=initial_shape))
    return fly_circle(tether, STEP, turns * REVOLUTION + 1.0, wind)[1]


@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (8.0, 0.0, 0.0)])
def test_first_second_has_the_quasi_steady_force(wind):
    start = magnitudes(flight(TetherDynamic, 2, 0, wind))
    settled = magnitudes(flight(TetherQuasiSteady, 2, 0, wind))
    assert np.abs(start / settled - 1.0).max() < 0.01  # the bar; 0.2 % without wind, 0.7 % in 8 m/s
    jump = magnitudes(flight(TetherDynamic, 1, 0, wind)) / settled - 1.0
    assert np.abs(jump).max() > 1.0


@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0)])
def test_first_second_comes_again_after_a_turn(wind):
    outputs = flight(TetherDynamic, 2, 1, wind)
    start, settled = magnitudes(outputs), magnitudes(outputs[STEPS:])
    assert np.abs(start / settled - 1.0).max() < 0.01  # the bar; 0.7 %
