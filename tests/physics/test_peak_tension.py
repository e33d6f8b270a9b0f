"""`peak_tension`: the largest tension since the last communication point, also between two of them.

A mass m that falls freely by d and is caught by an undamped tether of stiffness k = EA/L pulls at most with
T = m g + sqrt((m g)^2 + 2 k m g d), half a period of sqrt(m/k) later.
"""

from math import pi, sqrt

import numpy as np
import pytest

from tetherfmu import Environment, Solver, Tether, TetherCatenary, TetherDynamicFree, TetherQuasiSteady, TetherStraight

MASS, FALL, LENGTH, EA, GRAVITY = 20.0, 1.0, 100.0, 614600.0, 9.81
LIGHT = {"density": 1.0, "diameter": 1e-3, "axial_stiffness": EA, "axial_damping": 0.0, "slack_stiffness_ratio": 0.0}
ROPE = Tether(segments=1, initial_length=LENGTH, **LIGHT)
VOID = Environment(air_density=0.0, gravity=GRAVITY)
WEIGHT, SPRING = MASS * GRAVITY, EA / LENGTH
PEAK = WEIGHT + sqrt(WEIGHT**2 + 2.0 * SPRING * WEIGHT * FALL)
PERIOD = 2.0 * pi * sqrt(MASS / SPRING)

pytestmark = pytest.mark.filterwarnings("ignore:density is")  # light tethers, in which waves run fast


def caught(step, **solver):
    """Outputs of a fall of a mass into its tether and back, in communication steps [s]."""
    model = TetherDynamicFree(ROPE, VOID, Solver(**solver), kite_mass=MASS)
    start = model.initialize(kite_position=(0.0, 0.0, FALL - LENGTH))
    assert start.peak_tension == start.max_tension
    return [model.step(step) for _ in range(round(1.0 / step))]


@pytest.mark.parametrize(("solver", "allowed"), [
    ({}, 0.02),  # internal steps of the default tolerance, of which none need be at the peak
    ({"relative_tolerance": 1e-7}, 1e-3),
    ({"fixed_step": 2e-3}, 1e-3),  # (2 pi 1 ms/period)^2/2 and the error of the method
])  # fmt: skip
@pytest.mark.parametrize("part", [0.31, 0.9])  # of a period
def test_a_snap_between_communication_points(solver, allowed, part):
    outputs = caught(part * PERIOD, **solver)
    peak = max(each.peak_tension for each in outputs)
    assert peak == pytest.approx(PEAK, rel=allowed)
    assert all(each.peak_tension >= each.max_tension for each in outputs)
    if part == 0.9:  # a snap that no communication point sees
        assert max(each.max_tension for each in outputs) < 0.7 * PEAK


def test_it_is_that_of_the_communication_points_of_the_same_steps():
    """Fixed steps of 5 ms, at each of which there is a communication point, or at every tenth."""
    every, tenth = (caught(step, fixed_step=5e-3) for step in (5e-3, 5e-2))
    each = np.reshape([out.max_tension for out in every], (-1, 10)).max(axis=1)
    np.testing.assert_allclose([out.peak_tension for out in tenth], each, rtol=1e-9)  # steps of 5 ms, up to rounding
    assert [out.peak_tension for out in every] == [out.max_tension for out in every]


@pytest.mark.parametrize("model", [TetherStraight, TetherCatenary, TetherQuasiSteady])
def test_without_waves(model):
    """The tension of the communication point; with a drum that swings in between, more."""
    tether = model(initial_length=499.0)
    tether.initialize()
    out = tether.step(0.1, reel_out_speed=1.0)
    assert out.peak_tension == out.max_tension
    drum = model(initial_length=499.0, winch_control="force", winch_mass=20.0)
    drum.initialize()
    start = drum.outputs()
    period = 2.0 * pi * sqrt(20.0 / start.kite_stiffness)  # of the drum on its tether, here from some 1230 to 770 N and back
    drum.step(0.5 * period, winch_force=1000.0)
    outputs = [drum.step(period, winch_force=1000.0) for _ in range(3)]
    assert all(each.max_tension < 0.7 * start.max_tension for each in outputs)
    assert all(each.peak_tension == pytest.approx(start.max_tension, rel=0.02) for each in outputs)
