"""A winch that is told a length: the unstretched length follows it, in every tether.

What is known by positions only, as ends with derived velocities are, makes a jump good within one step and not beyond it;
stairs give a monotone motion; smooth motion is extrapolated to second order. Steps of any size: `test_varying_steps.py`.
"""

import numpy as np
import pytest

from solvers import MODELS
from tetherfmu import (
    StepRefused,
    TetherCatenary,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
    TetherStraight,
    inputs_along,
)

EVERY = (*MODELS, TetherDynamicFree)
ROUNDING = 1e-11  # [m] of 500 m
both = pytest.mark.parametrize("continuation", ["linear", "held"])
MEAN, SWING, RATE = 505.0, 2.0, 0.5  # [m], [m], [rad/s]


def told(time):
    """Length [m] that the winch should have paid out."""
    return MEAN + SWING * np.sin(RATE * time)


def speed_told(time):
    return SWING * RATE * np.cos(RATE * time)


def started(model, **options):
    """A tether on its winch, whose kite stays."""
    tether = model(winch_control="length", segments=5, **options)
    tether.initialize(wind_velocity=(8.0, 0.0, 0.0), winch_length=told(0.0), reel_out_speed=speed_told(0.0))
    return tether


def errors(model, step):
    """Largest errors of the length [m] and of its rate [m/s] in 10 s."""
    tether, found = started(model), []
    for k in range(round(10.0 / step)):
        outputs, end = tether.step(step, winch_length=told(k * step)), (k + 1) * step
        found.append((abs(outputs.tether_length - told(end)), abs(outputs.winch_speed - speed_told(end))))
    return np.max(found, axis=0)


@pytest.mark.parametrize("model", EVERY)
def test_length_is_third_order_in_the_step_and_its_rate_second(model):
    coarse, fine = errors(model, 0.1), errors(model, 0.05)
    assert coarse[0] / fine[0] == pytest.approx(8.0, rel=0.02)
    assert coarse[1] / fine[1] == pytest.approx(4.0, rel=0.02)
    # the length goes on from the last three values: h^3 times the third derivative of the length times 1 + 1/... at most
    assert coarse[0] < 1.1 * 0.1**3 * SWING * RATE**3


@pytest.mark.parametrize("model", EVERY)
def test_a_jump_is_no_jump_of_the_length(model):
    """0.3 m more at once: the length and its rate go on from where they are, and the difference is made good in a step."""
    step = 0.1
    tether, within = (model(winch_control="length", segments=5) for _ in range(2))
    tether.initialize()
    tether.step(step, winch_length=MEAN)
    before = tether.step(step)
    assert (before.tether_length, before.winch_speed) == (MEAN, 0.0)
    within.set_state(tether.get_state())
    tether.step(step, winch_length=MEAN + 0.3)
    assert tether.step(step).tether_length == pytest.approx(MEAN + 0.3, abs=1e-12)
    moved = within.step(1e-3 * step, winch_length=MEAN + 0.3).tether_length - MEAN  # after a thousandth of that step
    assert 0.0 < moved < 1e-5 * 0.3  # 3 (t/h)^2 of it


@pytest.mark.parametrize("model", EVERY)
def test_start(model):
    """With the length that is told, or with initial_length where none is."""
    tether = model(winch_control="length", segments=5, initial_length=510.0)
    assert tether.initialize().tether_length == 510.0
    assert tether.initialize(winch_length=507.0).tether_length == 507.0


@pytest.mark.parametrize("model", EVERY)
def test_a_length_that_has_never_been_set_is_the_initial_one(model):
    """Start values alone hold it; the steps are those of a twin that is told initial_length, bit for bit."""
    silent, twin = (model(winch_control="length", segments=5, initial_length=510.0) for _ in range(2))
    silent.initialize()
    twin.initialize(winch_length=510.0)
    for length in (None, None, 510.01, 510.03):
        first = silent.step(0.05, **({} if length is None else {"winch_length": length}))
        second = twin.step(0.05, winch_length=length or 510.0)
        assert (first.tether_length, first.winch_speed) == (second.tether_length, second.winch_speed)
        np.testing.assert_array_equal(first.kite_force, second.kite_force)
    with pytest.raises(StepRefused, match=r"the winch_length 0\.0 m"):
        silent.step(0.05, winch_length=0.0)


@pytest.mark.parametrize("model", EVERY)
def test_first_step_goes_on_with_the_reel_out_speed(model):
    tether = model(winch_control="length", segments=5)
    tether.initialize(winch_length=MEAN, reel_out_speed=2.0)
    assert tether.step(0.1).tether_length == pytest.approx(MEAN + 0.2, abs=1e-12)


@pytest.mark.parametrize("model", EVERY)
@pytest.mark.parametrize("length", [0.0, -1.0, 0.04])
def test_too_short_a_length_is_refused_and_the_state_kept(model, length):
    tether = model(winch_control="length", segments=5)
    tether.initialize(winch_length=MEAN)
    before = tether.get_state()
    if model not in (TetherCatenary, TetherStraight) or length <= 0.0:  # these have no segments that are too short
        with pytest.raises(
            StepRefused, match=f"the winch_length {length} m over a step of 0.1 s would leave segments shorter"
        ):
            tether.step(0.1, winch_length=length)
        np.testing.assert_array_equal(tether.get_state(), before)
    assert tether.step(0.1, winch_length=MEAN).tether_length == MEAN


@pytest.mark.parametrize("model", EVERY)
def test_an_input_that_does_not_control_the_winch(model):
    """Refused by name; in the rows of a flight told once, and nothing else."""
    given = {"reel_out_speed": 0.5, "winch_force": 300.0, "winch_length": 505.0}
    for control, own in (("speed", "reel_out_speed"), ("force", "winch_force"), ("length", "winch_length")):
        for name, value in given.items():
            if name == own:
                continue
            tether = model(segments=5, winch_control=control)
            tether.initialize()
            with pytest.raises(
                ValueError, match=rf"{name} is {value} and has no effect: winch_control is \d; it must be \d"
            ):
                tether.step(0.05, **{name: value})
            one, other = (inputs_along(5, 0.05, **{own: given[own]}, **more) for more in ({}, {name: value}))
            state = tether.get_state()
            silent = tether.fly(one, 0.05).outputs
            assert not any("has no effect" in each for each in tether.implausible)
            tether.set_state(state)
            np.testing.assert_array_equal(tether.fly(other, 0.05).outputs, silent)
            assert [each for each in tether.implausible if "has no effect" in each] == [
                f"{name} is {value:g} and has no effect: winch_control is not {list(given).index(name) + 1} "
                f"({name.removeprefix('winch_').replace('reel_out_', '')})"
            ]


# --- jumps and stairs


def lengths(model, inputs, **options):
    """Unstretched length [m] at the end of each step of a winch that follows these."""
    tether = model(winch_control="length", initial_length=inputs[0], **options)
    tether.initialize(winch_length=inputs[0])
    return np.array([tether.step(0.02, winch_length=each).tether_length for each in inputs])


@pytest.mark.filterwarnings("ignore:the winch runs")
@both
@pytest.mark.parametrize("model", [TetherStraight, TetherQuasiSteady, TetherDynamic])
def test_a_jump_is_made_good_at_once(model, continuation):
    inputs = [505.0] * 4 + [504.0] * 4
    np.testing.assert_allclose(lengths(model, inputs, input_continuation=continuation), inputs, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("model", MODELS[1:])
def test_force_after_a_jump_is_that_of_the_new_length(model):
    """From its first step on, and never more; of a dynamic tether: `test_sections.py`."""
    tether = model(winch_control="length", initial_length=505.0)
    tether.initialize(winch_length=505.0)
    pulls = [tether.step(0.02, winch_length=each).max_tension for each in [505.0] * 4 + [500.0] * 4]
    expected = [model(initial_length=each).initialize().max_tension for each in (505.0, 500.0)]
    np.testing.assert_allclose(pulls, np.repeat(expected, 4), rtol=1e-6)


@both
def test_a_jump_of_an_end(continuation):
    tether = TetherQuasiSteady(end_velocities="derived", input_continuation=continuation)
    tether.initialize()
    for x in [300.0] * 4 + [301.0] * 4:
        out = tether.step(0.02, kite_position=(x, 0.0, 400.0))
        assert out.kite_position.tolist() == pytest.approx([x, 0.0, 400.0], abs=ROUNDING)


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
    time, quantum = 0.02 * np.arange(300), 0.01
    found = lengths(
        TetherStraight, 502.0 + quantum * np.floor(speed * time / quantum + 1e-9), input_continuation=continuation
    )
    assert np.all(np.diff(found[3:]) >= -ROUNDING)
    assert np.abs(found - 502.0 - speed * (time + 0.02))[3:].max() < quantum + speed * 0.02
