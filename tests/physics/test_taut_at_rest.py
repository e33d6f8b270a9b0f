"""Taut chains at rest, exact: tethers in series, point masses at nodes, a vertical tether.

series of springs:      (chord - L1 - L2) = T (L1/EA1 + L2/EA2)
mass m on light legs:   T1 e1 + T2 e2 = m g e_z; legs of 3 m and 4 m over a span of 5 m stand at a right angle,
                        so T1 = 4/5 m g and T2 = 3/5 m g
vertical:               between its ends a distance h apart, with l0 = L/n and the half weight of a segment G = mu l0 g/2,
                        T_s = EA (h/L - 1) + (2 s + 1 - n) G, segment s counted from the lower end, z_i = sum over s < i of
                        l0 (1 + T_s/EA), forces on the ends EA (h/L - 1) +- mu L g/2
"""

import numpy as np
import pytest

from mechanics import line_density
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


# positions round off at 500 m * 1e-16 and a segment of 0.25 m multiplies that by EA/l0 = 2.5e6 N/m
ROUNDING = 1e-6


@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
@pytest.mark.parametrize("n", [1, 2, 7, 50])
@pytest.mark.parametrize(("length", "distance"), [(100.0, 100.1), (500.0, 503.0), (12.5, 12.6)])
def test_a_vertical_tether(up, n, length, distance):
    tether = Tether(segments=n, initial_length=length)
    model = TetherDynamic(tether)
    outputs = model.initialize(kite_position=(0.0, 0.0, up * distance))
    half_weight = line_density(tether) * length / n * 9.81 / 2.0
    mean = 614600.0 * (distance / length - 1.0)
    tension = mean + (2 * np.arange(n) + 1 - n) * half_weight
    lowest = min(0.0, up * distance)
    height = lowest + np.concatenate(([0.0], np.cumsum(length / n * (1.0 + tension / 614600.0))))
    upper, lower = -mean - n * half_weight, mean - n * half_weight
    ends = (lower, upper) if up > 0 else (upper, lower)
    np.testing.assert_allclose(model.positions[:, 2], height if up > 0 else height[::-1], atol=1e-11)
    np.testing.assert_allclose(model.positions[:, :2], 0.0, atol=1e-9)  # no force acts sideways
    np.testing.assert_allclose((outputs.ground_force[2], outputs.kite_force[2]), ends, atol=ROUNDING)
    assert outputs.max_tension == pytest.approx(tension[-1], abs=ROUNDING)
    assert outputs.kite_tension == pytest.approx(tension[-1 if up > 0 else 0], abs=ROUNDING)
    assert outputs.slack_segments == 0
