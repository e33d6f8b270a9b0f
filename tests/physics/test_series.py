"""Tethers in series and point masses at nodes.

series of springs:      (chord - L1 - L2) = T (L1/EA1 + L2/EA2)
mass m on light legs:   T1 e1 + T2 e2 = m g e_z; legs of 3 m and 4 m over a span of 5 m stand at a right angle,
                        so T1 = 4/5 m g and T2 = 3/5 m g
"""

import numpy as np
import pytest

from tetherfmu import Environment, Tether, TetherDynamic


def test_elongation_in_series():
    sections = [
        Tether(segments=3, initial_length=30.0, axial_stiffness=1e5, diameter=0.003),
        Tether(segments=2, initial_length=50.0, axial_stiffness=6e5, diameter=0.006, density=970.0),
    ]
    model = TetherDynamic(sections, Environment(gravity=0.0))
    out = model.initialize(kite_position=(81.0, 0.0, 0.0))
    compliance = 30.0 / 1e5 + 50.0 / 6e5
    tension = 1.0 / compliance
    # rounding: 1e-14 m in positions of 81 m times the stiffest segment, 2.4e4 N/m
    np.testing.assert_allclose((out.ground_tension, out.kite_tension), tension, atol=1e-8)
    assert out.kite_stiffness == pytest.approx(1.0 / compliance, rel=1e-13)
    assert model.positions[3, 0] == pytest.approx(30.0 * (1.0 + tension / 1e5), abs=1e-12)


@pytest.mark.parametrize("mass", [5.0, 80.0])
def test_point_mass_on_two_light_legs(mass):
    light = {"density": 1e-3, "diameter": 0.001, "axial_stiffness": 1e9}
    legs = [Tether(segments=3, initial_length=3.0, **light), Tether(segments=4, initial_length=4.0, **light)]
    model = TetherDynamic(legs, point_masses={3: mass})
    out = model.initialize(kite_position=(5.0, 0.0, 0.0))
    weight = mass * 9.81
    # strain 8e-7 of the stiff legs turns them by that; the legs' own weight is 4e-8 N: 1e-5 covers both
    assert out.ground_tension == pytest.approx(0.8 * weight, rel=1e-5)
    assert out.kite_tension == pytest.approx(0.6 * weight, rel=1e-5)
    np.testing.assert_allclose(model.positions[3], (3.0 * 0.6, 0.0, -3.0 * 0.8), atol=1e-5)
    np.testing.assert_allclose(out.ground_force, 0.8 * weight * np.array([0.6, 0.0, -0.8]), atol=1e-5 * weight)
