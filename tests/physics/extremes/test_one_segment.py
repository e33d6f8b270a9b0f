"""A tether of one segment: both ends driven, there is no free node, and everything is a formula.

    T = EA/L (l - L) + D/L (dl/dt - l/L dL/dt)                                             taut
    ground_force = T e + F - mu L g/2 e_z,   F = 1/4 rho cd d l |w| w

One end free: the pendulum's 2 pi sqrt(l/g). Along it: `test_kite_mass.py`.
"""

import numpy as np
import pytest

from mechanics import drag, line_density
from tetherfmu import Environment, Solver, Tether, TetherDynamic, TetherQuasiSteady

LENGTH = 100.0
ONE = Tether(segments=1, initial_length=LENGTH)


@pytest.mark.parametrize("fixed_step", [0.0, 0.02], ids=["adaptive", "fixed step"])
def test_driven_at_both_ends(fixed_step):
    model = TetherDynamic(ONE, solver=Solver(fixed_step=fixed_step))
    kite, velocity = np.array([60.0, 0.0, 80.5]), np.array([3.0, -5.0, 4.0])
    wind, reeling, count, step = np.array([9.0, 2.0, 1.0]), 3.0, 50, 0.02
    model.initialize(kite, velocity, wind_velocity=wind)
    for k in range(count):
        out = model.step(step, kite + velocity * k * step, velocity, reel_out_speed=reeling, wind_velocity=wind)
    kite = kite + velocity * count * step
    length, rest = np.linalg.norm(kite), LENGTH + reeling * count * step
    e = kite / length
    tension = ONE.axial_stiffness * (length / rest - 1.0) + ONE.axial_damping / rest * (
        e @ velocity - length / rest * reeling
    )
    half_drag = 0.5 * drag(np.array([0.0 * kite, kite]), np.array([0.0 * velocity, velocity]), wind, ONE, Environment())
    half_weight = np.array([0.0, 0.0, -0.5 * 9.81 * line_density(ONE) * rest])
    # rope that flows from the winch into half of the segment ("Rope that flows"), at both ends alike where there is one
    half_flow = -0.5 * line_density(ONE) * reeling * (velocity - reeling / rest * kite)
    assert model.counters["steps"] == 0  # no node is free: `room.does_any_move` in `moving_lines.advance`
    # rounding of a position near 100 m, 1e-14 m times EA/L, over 50 steps
    assert out.ground_tension == pytest.approx(tension, abs=1e-6)
    np.testing.assert_allclose(out.ground_force, tension * e + half_drag + half_weight + half_flow, rtol=0, atol=1e-6)
    np.testing.assert_allclose(out.kite_force, -tension * e + half_drag + half_weight + half_flow, rtol=0, atol=1e-6)


@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (20.0, 5.0, 0.0)], ids=str)
def test_quasi_steady_agrees_at_rest(wind):
    kite = (60.0, 0.0, 80.5)
    dynamic, quasi_steady = TetherDynamic(ONE), TetherQuasiSteady(ONE)
    expected = dynamic.initialize(kite, wind_velocity=wind)
    found = quasi_steady.initialize(kite, wind_velocity=wind)
    np.testing.assert_allclose(found.kite_force, expected.kite_force, rtol=1e-12)  # the same two nodes


def test_pendulum():
    tether = Tether(segments=1, initial_length=LENGTH, drag_coefficient=0.0)
    model = TetherDynamic(
        tether, solver=Solver(relative_tolerance=1e-8, initial_shape=3), free_ends=(False, True), point_masses={1: 5.0}
    )
    weight = 9.81 * (5.0 + 0.5 * line_density(tether) * LENGTH)
    length = LENGTH * (1.0 + weight / tether.axial_stiffness)
    angle = 0.01
    model.initialize((length * np.sin(angle), 0.0, -length * np.cos(angle)))
    quarter = 0.5 * np.pi * np.sqrt(length / 9.81) * (1.0 + angle**2 / 16.0)
    for _ in range(200):
        model.step(quarter / 200)
    # at the lowest point after a quarter; in units of the amplitude: solver 1e-8, spring and mass swing by angle^2/2
    assert model.positions[-1, 0] / (length * angle) == pytest.approx(0.0, abs=1e-4)
