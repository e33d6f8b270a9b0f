"""A tether that hangs below z = 0, where the wind begins, follows its kite: no step is refused, each is in balance.

A dropped kite comes down and in with 42 to 80 m of slack, some 180 to 150 m from its station, or comes down beside it; wind
by a power law that has three quarters of its reference value at 1 mm already. Now and then a segment is just where the wind
begins. By `balance.py`, from the node positions x alone, the forces of each inner node must vanish, but for a segment whose
mean height is in the thinnest layer: its two nodes may lack what that segment feels with all of the wind there.
"""

import numpy as np
import pytest

from balance import residual, rounding, turning
from mechanics import drags
from tetherfmu import Environment, StepRefused, Tether, TetherQuasiSteady, tether_of
from tetherfmu.kernels.rest import compressed_segments, homotopy, newton, solve

STEP, START, STEPS = 0.1, 0.3, 60
AIR = Environment(wind_profile="power_law", wind_reference_height=100.0, wind_exponent=0.023)
WIND, VELOCITY = np.array([7.7, -1.2, 0.0]), np.array([-2.9, 0.0, -4.8])

PAIR = 2 * newton.MOST_ITERATIONS  # of Newton's method, with stiffnesses and with compliances
SEARCH = PAIR + 2 * newton.MOST_PSEUDO_STEPS
EITHER_SIGN = compressed_segments.MOST_TRIALS * newton.MOST_PSEUDO_STEPS
# warm; steps 1 to 5; 6; 7; 8; 9
MOST_WORK = newton.MOST_ITERATIONS + 2 * SEARCH
MOST_WORK += len(solve.LEVELS) * 2 * SEARCH + homotopy.MOST_LEVELS * PAIR
MOST_WORK += EITHER_SIGN
MOST_WORK += len(solve.STRAINS) * (2 * SEARCH + homotopy.MOST_LEVELS * SEARCH)
MOST_WORK += 2 * SEARCH + EITHER_SIGN + homotopy.MOST_LEVELS * SEARCH


def fall(segments):
    """The model after the start and after each step of the fall."""
    model = None
    for k in range(STEPS):
        time = START + STEP * k
        kite, length = (97.0, -5.4, 161.0) + VELOCITY * time, 231.3 - 0.9 * time
        if model is None:
            tether = tether_of("dyneema_sk75", 0.0135, drag_coefficient=1.1, segments=segments)
            model = TetherQuasiSteady(tether, AIR)
            slack = length / np.linalg.norm(kite) - 1.0
            model.initialize(kite, VELOCITY, wind_velocity=WIND, slack=slack)
        before = model.counters["iterations"]
        outputs = model.step(STEP, kite, VELOCITY, wind_velocity=WIND, tether_length=length)
        yield model, outputs, model.counters["iterations"] - before


def as_flown(model, outputs):
    """The tether with its present length, for `balance`."""
    tether: Tether = model._records[0][0]
    return tether_of(
        "dyneema_sk75", tether.diameter, drag_coefficient=1.1, segments=model.segments, initial_length=outputs.tether_length
    )


def unbalanced(x, velocity, tether):
    """Largest force [N] that an inner node lacks beyond what is allowed; and whether a segment is in the thinnest layer."""
    missing, tensions = residual(x, velocity, WIND, tether, AIR)
    height = 0.5 * (x[1:, 2] + x[:-1, 2])
    inside = (height > 0.0) & (height < homotopy.THINNEST)
    felt = 0.5 * np.linalg.norm(drags(x, turning(x, velocity)[0], WIND, tether, AIR), axis=1) * inside
    lacking = np.linalg.norm(missing, axis=1) - felt[1:] - felt[:-1] - rounding(x, tensions, tether)
    return np.max(lacking), inside.any()


@pytest.mark.parametrize("segments", [10, 20, 30])  # without step 9 two steps of each are refused
def test_falls_into_air_without_wind(segments):
    steps, in_layer = 0, 0
    for model, outputs, work in fall(segments):
        lacking, is_inside = unbalanced(model.positions, VELOCITY, as_flown(model, outputs))
        assert lacking <= 0.0
        assert work <= MOST_WORK
        steps, in_layer = steps + 1, in_layer + is_inside
    assert steps == STEPS
    assert in_layer <= 3


def test_comes_down_beside_its_station():
    """180 m of slack: one of these 40 steps is refused; a rounding error decides in some."""
    velocity, step, refused = np.array([0.1, 0.1, -2.0]), 0.04, 0
    model = TetherQuasiSteady(Tether(segments=20, initial_length=196.0), AIR)
    for k in range(41):
        kite, length = (14.8, 1.3, 4.0) + velocity * step * k, 196.0 - 0.5 * step * k
        if k == 0:
            model.initialize(kite, velocity, wind_velocity=WIND)
            continue
        before = model.counters["iterations"]
        try:
            outputs = model.step(step, kite, velocity, wind_velocity=WIND, tether_length=length)
        except StepRefused:
            refused += 1
            continue
        assert model.counters["iterations"] - before <= MOST_WORK
        tether = Tether(segments=20, initial_length=outputs.tether_length)
        assert unbalanced(model.positions, velocity, tether)[0] <= 0.0
    assert refused <= 6
