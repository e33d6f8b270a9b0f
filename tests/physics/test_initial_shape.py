"""The three shapes at the start: straight, static equilibrium, and quasi-steady (turning with the kite).

With quasi-steady the dynamic tether starts as if it had always flown: settled is the force of the quasi-steady tether at the
same time, and that of the dynamic tether itself one whole turn later. A start from rest is off by several times the force.

Turning rigidly about the ground end with omega = r x u/r^2 and stretching with s = r . u/r^2, node i has the velocity
omega x r_i + s r_i and the acceleration omega x (omega x r_i). On a level circle without gravity and air the chain is
straight, with T_(i-1) = T_i + m_i omega^2 |r_i|.
"""

import numpy as np
import pytest

from mechanics import node_masses
from scenes import CIRCLE_TETHER, REVOLUTION, fly_circle
from tetherfmu import Environment, Solver, Tether, TetherDynamic, TetherQuasiSteady

KITE = np.array([60.0, 20.0, 70.0])


def test_straight():
    model = TetherDynamic(Tether(segments=7, initial_length=120.0), solver=Solver(initial_shape=3))
    speed = np.array([1.0, 2.0, 3.0])
    model.initialize(kite_position=KITE, kite_velocity=speed, ground_position=(5.0, 0.0, 0.0))
    part = np.linspace(0.0, 1.0, 8)[:, None]
    # rounding
    np.testing.assert_allclose(model.positions, (1 - part) * (5.0, 0.0, 0.0) + part * KITE, rtol=0, atol=1e-13)
    np.testing.assert_allclose(model.velocities, part * speed, rtol=0, atol=1e-14)


@pytest.mark.parametrize("omega", [0.5, 3.0])
def test_turning_without_gravity_and_air(omega):
    tether = Tether(segments=10, initial_length=50.0)
    model = TetherDynamic(tether, Environment(gravity=0.0, air_density=0.0), Solver(initial_shape=2))
    radius = 50.2
    out = model.initialize(kite_position=(radius, 0.0, 0.0), kite_velocity=(0.0, omega * radius, 0.0))
    x, v = model.positions, model.velocities
    np.testing.assert_allclose(v, omega * np.stack([-x[:, 1], x[:, 0], 0.0 * x[:, 0]], axis=1), rtol=0, atol=1e-10)
    np.testing.assert_allclose(x[:, 1:], 0.0, atol=1e-9)  # straight
    tension = 614600.0 * (np.diff(x[:, 0]) / 5.0 - 1.0)
    centripetal = node_masses(tether)[1:-1] * omega**2 * x[1:-1, 0]
    np.testing.assert_allclose(tension[:-1] - tension[1:], centripetal, rtol=0, atol=1e-7)  # 1e-14 m times EA/l0
    assert out.ground_tension - out.kite_tension == pytest.approx(np.sum(centripetal), abs=1e-7)


def test_quasi_steady_start_follows_a_stretching_line():
    model = TetherDynamic(Tether(segments=6, initial_length=92.0), solver=Solver(initial_shape=2))
    velocity = 2.0 * KITE / np.linalg.norm(KITE)
    model.initialize(kite_position=KITE, kite_velocity=velocity)
    rate = 2.0 / np.linalg.norm(KITE)
    np.testing.assert_allclose(model.velocities, rate * model.positions, rtol=0, atol=1e-12)  # rounding


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
