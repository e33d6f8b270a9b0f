"""A load on a crane: dropped it pulls twice as hard as at rest; falls add up."""

import numpy as np
import pytest

from tetherfmu import TetherDynamic, TetherDynamicFree, tether_of

LOAD, LENGTH, GRAVITY, STEP = 500.0, 80.0, 9.81, 0.02  # kg, m, m/s2, s
WIRE = tether_of("steel", 0.012, initial_length=LENGTH)
WEIGHT = (LOAD + WIRE.mass_per_length * LENGTH) * GRAVITY  # of load and wire [N]


def tensions(hanging, duration):
    """Largest tension [N] after each step of a crane that stands still, its load let go `hanging` [m] below the tip."""
    crane = TetherDynamicFree(WIRE, kite_mass=LOAD)
    crane.initialize(ground_position=(0.0, 0.0, 100.0), kite_position=(0.0, 0.0, 100.0 - hanging))
    return np.array([crane.step(STEP).max_tension for _ in range(round(duration / STEP))])


def test_a_load_that_starts_on_an_unstretched_wire_pulls_twice_as_hard():
    """Energy: a weight that is put on a spring without mass goes down twice its static stretch, so T = 2 m g.

    The wire has 9 % of the mass of the load, and its damper takes energy: 5 %.
    """
    assert tensions(LENGTH, 1.0).max() == pytest.approx(2.0 * WEIGHT, rel=0.05)


def test_several_falls_are_one_tether_of_their_sum():
    """n falls side by side: n times stiffness, damping, mass and drag; each end force is n times that of one fall."""
    falls = 4
    names = ("axial_stiffness", "axial_damping", "density", "drag_coefficient")
    together = {name: falls * getattr(WIRE, name) for name in names}
    forces = []
    for more in ({}, together):
        tether = TetherDynamic(WIRE, **more)
        tether.initialize((30.0, 0.0, 20.05), ground_position=(30.0, 0.0, 100.0), wind_velocity=(0.0, 15.0, 0.0))
        outputs = [tether.step(STEP, (30.0 + 1.0 * STEP * k, 0.0, 20.05), (1.0, 0.0, 0.0)) for k in range(100)]
        forces.append(np.array([each.kite_force for each in outputs]))
    # the steps are chosen by relative errors of positions, which are the same: rounding, grown by the stiffness
    np.testing.assert_allclose(forces[1], falls * forces[0], rtol=0.0, atol=1e-6 * np.abs(forces[1]).max())
