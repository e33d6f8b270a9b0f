"""The winch against formulas, and what it says when it is jammed."""

import math
from itertools import pairwise

import pytest

from example_fmus.example_slaves import Model

MASS = 7.84 / 0.1615**2  # of the drum at its radius [kg]
FREE = {"coulomb_friction": 0.0}


def test_force_control_reaches_its_speed_exponentially():
    """m ds/dt = T - F - c s: s = (T - F)/c (1 - exp(-c t/m)), whatever the steps."""
    winch = Model("Winch", control=2, ground_tension=1000.0, set_force=900.0, tether_length=300.0, **FREE)
    for step in (0.02, 0.5, 1.0, 0.48):
        winch.step(step)
    expected = 100.0 / 30.6 * (1.0 - math.exp(-30.6 * 2.0 / MASS))
    assert winch.get("reel_out_speed") == pytest.approx(expected, rel=1e-12)
    assert winch.get("motor_torque") == pytest.approx(900.0 * 0.1615, rel=1e-12)
    assert winch.get("power") == pytest.approx(1000.0 * expected, rel=1e-12)


def test_coulomb_friction_holds_a_small_pull():
    """A pull below the friction creeps: s/sqrt(s^2 + s0^2) = pull/friction; above it the rest accelerates."""
    winch = Model("Winch", control=2, ground_tension=61.0, tether_length=300.0, viscous_friction=0.0)
    for _ in range(2000):
        winch.step(0.02)
    assert winch.get("reel_out_speed") == pytest.approx(0.05 * math.tan(math.pi / 6.0), rel=1e-6)


def test_speed_control_keeps_to_its_acceleration():
    """From rest to 2 m/s with 4 m/s2; then less than 1 cm/s away by friction, c s/(G + c) + f/G."""
    winch = Model("Winch", ground_tension=2000.0, tether_length=300.0, set_speed=2.0)
    speeds = [0.0]
    for _ in range(100):
        winch.step(0.02)
        speeds.append(winch.get("reel_out_speed"))
    assert max(b - a for a, b in pairwise(speeds)) < 4.0 * 0.02 * 1.01
    assert speeds[20] < 1.6  # 0.4 s
    assert speeds[-1] == pytest.approx(2.0, abs=30.6 * 2.0 / 1e4 + 122.0 / 1e4 + 1e-3)
    assert winch.get("energy") == pytest.approx(2000.0 * sum([*speeds[1:-1], 0.5 * speeds[-1]]) * 0.02, rel=1e-9)


def test_torque_limit():
    """Tension beyond it turns the drum with the difference, whatever is wanted."""
    winch = Model("Winch", ground_tension=10_000.0, tether_length=300.0, viscous_friction=0.0, **FREE)
    winch.step(0.02)
    winch.step(0.02)
    assert winch.get("reel_out_speed") == pytest.approx((10_000.0 - 1300.0 / 0.1615) * 0.04 / MASS, rel=1e-9)


@pytest.mark.parametrize(
    ("speed", "length", "limit"), [(6.0, 380.0, "maximum_length (400 m)"), (-6.0, 80.0, "minimum_length (50 m)")]
)
def test_brakes_before_the_tether_ends(speed, length, limit):
    winch = Model("Winch", ground_tension=1500.0, tether_length=length, set_speed=speed, maximum_length=400.0)
    for _ in range(1500):
        assert winch.step(0.02)
        length += 0.02 * winch.get("reel_out_speed")
        winch.set(tether_length=length)
    assert 50.0 <= length <= 400.0
    assert min(length - 50.0, 400.0 - length) < 0.2
    assert winch.get("reel_out_speed") == pytest.approx(0.0, abs=0.05)
    assert winch.messages == [f"the winch brakes: tether_length comes to {limit}"]


@pytest.mark.parametrize("continuation", [1, 2, 3])
def test_a_jammed_winch_refuses_the_step_in_words(continuation):
    """It reels out, and has no torque to stop at the end."""
    winch = Model(
        "Winch", ground_tension=5000.0, tether_length=399.0, torque_limit=1.0, maximum_length=400.0, initial_speed=3.0,
        input_continuation=continuation,
    )  # fmt: skip
    length = 399.0
    while winch.step(0.02):
        length += 0.02 * winch.get("reel_out_speed")
        winch.set(tether_length=length)
        assert winch.time < 1.0
    assert 399.8 < length < 400.1  # a step is 7 cm
    assert "the winch is jammed: tether_length is" in winch.messages[-1]
    assert "at most maximum_length (400 m), and torque_limit (1 N.m) must be enough" in winch.messages[-1]
    before = winch.get("reel_out_speed")
    assert not winch.step(0.02)
    assert winch.get("reel_out_speed") == before


def test_wrong_limits_are_named():
    with pytest.raises(ValueError, match=r"minimum_length is 500\.0; it must be less than maximum_length"):
        Model("Winch", minimum_length=500.0, maximum_length=400.0)
