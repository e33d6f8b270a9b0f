"""A tether with two free ends falls like a stone without air, and at its terminal velocity in air.

no air:                x(t) = x0 + v0 t - g t^2/2 e_z
horizontal, in air:    v_z(t) = -v_t tanh(g t/v_t),   v_t = sqrt(2 mu g/(rho cd d))
"""

import numpy as np
import pytest

from mechanics import line_density
from tetherfmu import Environment, Solver, Tether, TetherDynamic

FREE = {"free_ends": (True, True)}
TETHER = Tether(segments=8, initial_length=40.0)
STRAIGHT = Solver(initial_shape=3)
ALONG_X = {"ground_position": (0.0, 0.0, 100.0), "kite_position": (40.0, 0.0, 100.0)}


@pytest.mark.parametrize("gravity", [9.81, 1.62])
@pytest.mark.parametrize("velocity", [(0.0, 0.0, 0.0), (3.0, -2.0, 10.0)])
def test_free_fall_is_a_parabola(gravity, velocity):
    model = TetherDynamic(TETHER, Environment(air_density=0.0, gravity=gravity), STRAIGHT, **FREE)
    kite = np.array([24.0, 0.0, 132.0])
    model.initialize(kite, velocity, ground_position=(0.0, 0.0, 100.0), ground_velocity=velocity)
    start = model.positions
    for _ in range(100):
        model.step(0.02)
    fallen = 2.0 * np.array(velocity) - (0.0, 0.0, 0.5 * gravity * 2.0**2)
    # a method of order 4 is exact on parabolas; what is left is rounding: 1e-14 m times EA/l0 accelerates m = 0.05 kg
    np.testing.assert_allclose(model.positions, start + fallen, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("diameter", "drag_coefficient", "air_density"), [(0.004, 0.958, 1.225), (0.01, 1.2, 0.9)])
def test_horizontal_tether_reaches_terminal_velocity(diameter, drag_coefficient, air_density):
    tether = Tether(segments=8, initial_length=40.0, diameter=diameter, drag_coefficient=drag_coefficient)
    model = TetherDynamic(
        tether, Environment(air_density=air_density), Solver(initial_shape=3, relative_tolerance=1e-6), **FREE
    )
    model.initialize(**ALONG_X)
    terminal = np.sqrt(2.0 * line_density(tether) * 9.81 / (air_density * drag_coefficient * diameter))
    for k in range(400):
        model.step(0.02)
        expected = -terminal * np.tanh(9.81 * 0.02 * (k + 1) / terminal)
        # each step may err by 1e-6 of the terminal speed; drag forgets errors within v_t/(2 g), about 25 steps
        np.testing.assert_allclose(model.velocities[:, 2], expected, rtol=0, atol=2e-5 * terminal)
    np.testing.assert_allclose(model.velocities[:, 2], -terminal, rtol=1e-6)  # 8 s: tanh = 1 - 1e-6 or closer
