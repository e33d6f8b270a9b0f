"""Reeling: the damper sees the strain rate, and masses follow the length.

A taut tether of strain epsilon lies along x without gravity and air; the kite leaves at v (1 + epsilon) while v is paid
out, so the strain stays. Node i moves at constant speed, all tensions are equal, and

    strain_rate:   T = EA epsilon
    stretch_rate:  T = EA epsilon + D/l0 dl/dt = EA epsilon + D v (1 + epsilon)/L     (a false 18.9 N at L = 50 m, v = 2 m/s)
"""

import numpy as np
import pytest

from mechanics import line_density
from tetherfmu import Environment, Solver, Tether, TetherDynamic

SPEED = 2.0
STRAIN = 1e-3
VOID = Environment(gravity=0.0, air_density=0.0)


def reel_out(damping_law, fixed_step=0.0):
    """Tensions (ground, kite, largest) over one second [N], and the lengths."""
    tether = Tether(segments=5, initial_length=50.0, damping_law=damping_law)
    # shape 2: the nodes start with the velocities of a uniform stretch
    model = TetherDynamic(tether, VOID, Solver(relative_tolerance=1e-8, initial_shape=2, fixed_step=fixed_step))
    velocity = (SPEED * (1.0 + STRAIN), 0.0, 0.0)
    out = [model.initialize((50.0 * (1.0 + STRAIN), 0.0, 0.0), velocity, reel_out_speed=SPEED)]
    for k in range(50):
        kite = ((50.0 + SPEED * 0.02 * k) * (1.0 + STRAIN), 0.0, 0.0)
        out.append(model.step(0.02, kite, velocity, reel_out_speed=SPEED))
    return np.array([(o.ground_tension, o.kite_tension, o.max_tension) for o in out]), [o.tether_length for o in out]


@pytest.mark.parametrize("fixed_step", [0.0, 0.02], ids=["adaptive", "fixed step"])
def test_no_false_damper_force(fixed_step):
    tension, length = reel_out(damping_law=1, fixed_step=fixed_step)
    np.testing.assert_allclose(length, 50.0 + SPEED * 0.02 * np.arange(51), rtol=1e-14)
    # linear motion is exact in both methods; rounding 7e-15 m times EA/l0 = 6e4 N/m, accumulated over 50 steps
    np.testing.assert_allclose(tension, 614600.0 * STRAIN, atol=1e-5)


def test_stretch_rate_law_adds_a_false_force():
    tension, length = reel_out(damping_law=2)
    false = 473.0 * SPEED * (1.0 + STRAIN) / np.array(length)
    assert false[0] == pytest.approx(18.9, abs=0.05)  # the number of the design
    np.testing.assert_allclose(tension - 614600.0 * STRAIN, np.outer(false, (1, 1, 1)), atol=1e-5)  # rounding, as above


@pytest.mark.parametrize(("speed", "length"), [(1.5, 53.0), (-4.0, 42.0)])
def test_mass_follows_length(speed, length):
    tether = Tether(segments=6, initial_length=50.0)
    model = TetherDynamic(tether)
    model.initialize(kite_position=(30.0, 0.0, 20.0))
    for _ in range(20):
        out = model.step(0.1, kite_position=(30.0, 0.0, 20.0), reel_out_speed=speed)
    assert out.tether_length == pytest.approx(length, rel=1e-14)  # rounding of 20 sums
    assert out.kite_end_mass == pytest.approx(line_density(tether) * length / 12.0, rel=1e-14)
