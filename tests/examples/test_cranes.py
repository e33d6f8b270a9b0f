"""Winches that are told a force: a crane over a ship that heaves, and a hoist; against balances of forces and of work."""

import re
from functools import cache
from importlib import import_module

import numpy as np
import pytest

from cranes import constant_tension, hoisting, set_down
from manual import page
from running import assert_is_drawn

GRAVITY, WIRE = 9.81, hoisting.WIRE
for each in (constant_tension, hoisting, set_down):
    each.fly = cache(each.fly)  # once for what is tested and what is printed


@pytest.mark.parametrize("friction", [0.0, 400.0])
def test_without_mass_the_tension_is_the_force_and_the_friction(friction):
    """With 1e-9 of it: a drum without mass does nothing else."""
    off = np.abs(constant_tension.fly((0.0, friction)) - constant_tension.FORCE)
    assert off.max() <= friction + 1e-9 * constant_tension.FORCE
    assert off.max() >= friction - 1e-9 * constant_tension.FORCE


@pytest.mark.parametrize("drum", [(3000.0, 500.0), (1000.0, 100.0), (2000.0, 0.0)])
def test_a_drum_holds_the_tension_within_friction_and_inertia(drum):
    """At least what turns it when it follows the deck, at most with the undamped bounce of one that breaks away.

    While the heave grows its acceleration is up to 5 % larger: |d2/dt2 (t/P) sin wt| <= w^2 sqrt(1 + 1/pi^2).
    """
    off = np.abs(constant_tension.fly(drum) - constant_tension.FORCE)
    following, bouncing = constant_tension.bounds(*drum)
    assert 0.95 * following < off.max() < 1.05 * bouncing


def test_a_winch_that_holds_its_length_has_the_stiffness_of_the_wire():
    """EA/L times the heave more than at rest; where the wire snaps taut it bounces, by less than a tenth."""
    tension = constant_tension.fly(None)
    stiffness = constant_tension.tether_of("steel", 0.016).axial_stiffness / constant_tension.DEPTH
    most = constant_tension.FORCE + stiffness * constant_tension.HEAVE
    assert most < tension.max() < 1.1 * most
    assert tension.min() < 0.0  # and then it is slack


def test_the_load_is_lifted_and_held():
    time, height, speed, torque, _ = hoisting.fly()
    shorter = (hoisting.LOAD + WIRE.mass_per_length * 50.0) * GRAVITY * hoisting.LIFT / WIRE.axial_stiffness  # its stretch
    rest = height[time > hoisting.DURATION - 5.0]  # some periods of the bounce
    assert rest.mean() - height[0] == pytest.approx(hoisting.LIFT + shorter, abs=0.005)  # 2 mm, and the bounce
    off = time > 25.0
    assert not torque[off].any()
    assert not speed[off].any()  # not by a rounding error: it is held
    assert (hoisting.LOAD + WIRE.mass_per_length * hoisting.LENGTH) * GRAVITY < hoisting.FRICTION  # which holds it


def test_the_work_of_the_motor_lifts_and_rubs():
    """Load, friction, and the wire.

    What is left, the energy of the stretch twice, is T^2 LIFT/EA, 4e-4 of it.
    """
    _, height, speed, torque, _ = hoisting.fly()
    left = hoisting.LENGTH - hoisting.LIFT
    wire = 0.5 * WIRE.mass_per_length * GRAVITY * (hoisting.LENGTH**2 - left**2)
    lifting = hoisting.LOAD * GRAVITY * (height[-1] - height[0]) + wire
    assert hoisting.work(speed, torque) == pytest.approx(lifting + hoisting.FRICTION * hoisting.LIFT, rel=1e-3)


def test_the_tension_is_that_of_a_load_on_a_spring():
    """At most twice the acceleration of the drum, the largest of which is seen from step to step."""
    _, _, speed, torque, tension = hoisting.fly()
    mass = hoisting.LOAD + WIRE.mass_per_length * hoisting.LENGTH
    faster = np.diff(speed)[:-1].max() / hoisting.STEP
    assert mass * GRAVITY < tension.max() < mass * (GRAVITY + 2.0 * faster)
    assert np.abs(torque).max() < hoisting.TORQUE


@pytest.mark.parametrize("speed", set_down.SPEEDS)
def test_taking_up_a_load_pulls_as_a_mass_on_a_spring(speed):
    """Off by the wave in the wire at most; and by 1 %, damping for a quarter of a period: exp(-0.01 pi/2) = 0.984."""
    time, height, tension, _ = set_down.fly(speed)
    lifted = time > set_down.TAKE_UP
    bounce = speed * np.sqrt(set_down.STIFFNESS * set_down.LOAD)
    assert tension[lifted].max() == pytest.approx(set_down.expected(speed), abs=set_down.wave(speed) + 0.016 * bounce)
    assert tension[~lifted].max() < 1.1 * (set_down.WEIGHT + set_down.OF_WIRE)  # starts to sink with 0.5 m/s2, twice that
    assert height[lifted][-1] > 0.1


def test_the_deck_carries_the_load():
    """All of it, with a segment of wire that still sways; 2 mm deep, the depth at rest."""
    time, height, _, carried = set_down.fly(0.1)
    standing = (time > 9.0) & (time < set_down.TAKE_UP)
    np.testing.assert_allclose(carried[standing], set_down.WEIGHT, atol=set_down.OF_WIRE / set_down.SEGMENTS)
    np.testing.assert_allclose(height[standing], -set_down.DECK.ground_sink, atol=1e-4)
    # after the impact at 0.25 m/s: a z^2/2 = v z/c, c = 2/sqrt(g s), so z <= sqrt(v s sqrt(s/g))
    depth = np.sqrt(set_down.LOWERING * 0.002 * np.sqrt(0.002 / GRAVITY))
    assert -height.min() < 0.002 + 1.2 * depth  # the load bounces on its wire, too


@pytest.mark.parametrize(
    ("name", "words", "numbers"),
    [
        ("constant_tension", "no drum: at most 20000 N", 3),
        ("hoisting", "turns at 0 m/s", 2),
        ("set_down", "of load and wire", 4),
    ],
)
def test_prints_and_draws(tmp_path, capsys, name, words, numbers):
    """numbers : rows or figures that are printed and stand on the page."""
    import_module(f"cranes.{name}").main(["--out", str(tmp_path)])
    said = capsys.readouterr().out
    assert words in said
    lines = re.findall(r"at (\S+ m/s): at most (\d+ N), by the formula (\d+ N) \+- (\d+ N)", said)
    alone = re.findall(r"off by (\d+ N)|work of the motor ([\d.]+ kJ)|to the load ([\d.]+ kJ)", said)
    assert len(lines) + len(alone) == numbers
    for line in lines:
        assert "| {} | {} | {} ± {} |".format(*line) in page("use/cranes_and_drones")
    for number in alone:
        assert "".join(number) in page("use/cranes_and_drones")
    assert_is_drawn(tmp_path / f"{name}.png")
