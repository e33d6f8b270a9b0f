"""What is known by positions only (`winch_length`, ends with derived velocities): jumps, stairs and smooth motion.

A jump is made good within one step, without a way beyond it; stairs give a monotone motion; smooth motion is extrapolated to
second order, so it is no further off than its third derivative times the cube of the step.
"""

import numpy as np
import pytest

from tetherfmu import TetherDynamic, TetherQuasiSteady, TetherStraight

pytestmark = pytest.mark.filterwarnings("ignore:the winch runs")
STEP = 0.02
both = pytest.mark.parametrize("continuation", ["linear", "held"])
ROUNDING = 1e-11  # [m] of 500 m


def lengths(model, inputs, **options):
    """Unstretched length [m] at the end of each step of a winch that follows these."""
    tether = model(winch_control="length", initial_length=inputs[0], **options)
    tether.initialize(winch_length=inputs[0])
    return np.array([tether.step(STEP, winch_length=each).tether_length for each in inputs])


@both
@pytest.mark.parametrize("model", [TetherStraight, TetherQuasiSteady, TetherDynamic])
def test_a_jump_is_made_good_at_once(model, continuation):
    inputs = [505.0] * 4 + [504.0] * 4
    np.testing.assert_allclose(lengths(model, inputs, input_continuation=continuation), inputs, rtol=0, atol=ROUNDING)


@both
def test_a_jump_of_an_end(continuation):
    tether = TetherQuasiSteady(end_velocities="derived", input_continuation=continuation)
    tether.initialize()
    for x in [300.0] * 4 + [301.0] * 4:
        out = tether.step(STEP, kite_position=(x, 0.0, 400.0))
        assert out.kite_position.tolist() == pytest.approx([x, 0.0, 400.0], abs=ROUNDING)


def test_force_after_a_jump_is_that_of_the_new_length():
    tether = TetherQuasiSteady(winch_control="length", initial_length=505.0)
    tether.initialize(winch_length=505.0)
    pulls = [tether.step(STEP, winch_length=each).max_tension for each in [505.0] * 4 + [500.0] * 4]
    assert max(pulls) == pytest.approx(TetherQuasiSteady(initial_length=500.0).initialize().max_tension, rel=1e-6)


@both
def test_stairs_are_monotone(continuation):
    random = np.random.default_rng(7)
    for _ in range(100):
        jumps = random.exponential(0.3, 40) * random.integers(0, 2, 40)
        jumps[1::2] = jumps[:3] = 0.0  # a step of rest, at least, between two
        found = lengths(TetherStraight, 505.0 - np.cumsum(jumps), input_continuation=continuation)
        assert np.all(np.diff(found) <= ROUNDING)


@pytest.mark.parametrize("speed", [0.05, 0.5, 2.0])
@both
def test_an_encoder(speed, continuation):
    """Of 10 mm: the length is monotone, and off by less than what it moves in a step and 10 mm."""
    time, quantum = STEP * np.arange(300), 0.01
    found = lengths(
        TetherStraight, 502.0 + quantum * np.floor(speed * time / quantum + 1e-9), input_continuation=continuation
    )
    assert np.all(np.diff(found[3:]) >= -ROUNDING)
    assert np.abs(found - 502.0 - speed * (time + STEP))[3:].max() < quantum + speed * STEP


def test_smooth_motion_is_not_limited():
    """A sine that turns round, slow and fast: off by less than the cube of the step times its third derivative."""
    for rate in (0.5, 3.0):
        time = STEP * np.arange(400)
        found = lengths(TetherStraight, 505.0 + 2.0 * np.sin(rate * time))
        off = np.abs(found - 505.0 - 2.0 * np.sin(rate * (time + STEP)))[4:]
        # where it bends from one side to the other the curvature changes its sign: then it is the second derivative there
        assert off.max() < 1.5 * 2.0 * (rate * STEP) ** 3
