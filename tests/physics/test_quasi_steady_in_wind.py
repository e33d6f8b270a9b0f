"""The quasi-steady tether in wind differs from the dynamic one along a turn, and the less the slower the kite turns.

Its nodes turn rigidly with the kite, those of the dynamic one also move against that while drag and weight change their
directions along the turn: a difference of first and second order in the rate.
"""

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, circle
from tetherfmu import TetherDynamic, TetherQuasiSteady
from tetherfmu.runtime import layout as at

STEP = 0.02
RATES = (0.05, 0.025, 0.0125)  # [rad/s]
TABLE = (1.41, 0.46, 0.11)  # [%], in docs/models/theory.md, "Validity"


@pytest.fixture(scope="module")
def forces():
    """Force on the kite [N] along the second turn by rate, of both tethers: arrays (2, steps)."""
    found = {}
    for rate in RATES:
        steps = round(2.0 * np.pi / rate / STEP)
        inputs = np.zeros((2 * steps, at.INPUTS))
        for k, row in enumerate(inputs):
            row[at.KITE_POSITION : at.GROUND_POSITION] = np.concatenate(circle(k * STEP, rate))
        inputs[:, at.WIND_VELOCITY] = 8.0
        flown = []
        for kind in (TetherDynamic, TetherQuasiSteady):
            tether = kind(CIRCLE_TETHER, initial_shape="quasi_steady")
            tether.initialize(*circle(0.0, rate), wind_velocity=(8.0, 0.0, 0.0))
            flown.append(np.linalg.norm(tether.fly(inputs, STEP).kite_force[steps:], axis=1))
        found[rate] = np.array(flown)
    return found


def missing(found, part):
    """How much the mean force of the quasi-steady tether is below that of the dynamic one in a part of the turn [%]."""
    dynamic, quasi_steady = found[:, part].mean(axis=1)
    return 100.0 * (1.0 - quasi_steady / dynamic)


def test_the_difference_in_the_second_half_falls_faster_than_the_rate(forces):
    half = [missing(found, slice(found.shape[1] // 2, None)) for found in forces.values()]
    assert half == pytest.approx(TABLE, abs=0.01)
    assert half[0] / half[1] > 2.5
    assert half[1] / half[2] > 2.5


def test_over_a_whole_turn_little_is_left(forces):
    """The halves are wrong to either side."""
    for found in forces.values():
        assert abs(missing(found, slice(None))) < 0.2
