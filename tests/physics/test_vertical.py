"""A taut vertical tether at rest: tensions, node heights and end forces of the chain are exact.

Between its ends a distance h apart, with l0 = L/n and the half weight of a segment G = mu l0 g/2,

    T_s = EA (h/L - 1) + (2 s + 1 - n) G        segment s counted from the lower end
    z_i = sum over s < i of l0 (1 + T_s/EA)
    force on the upper end = EA (h/L - 1) + mu L g/2 downwards,  on the lower end EA (h/L - 1) - mu L g/2 upwards
"""

import numpy as np
import pytest

from mechanics import line_density
from tetherfmu import Tether, TetherDynamic

# positions round off at 500 m * 1e-16 and a segment of 0.25 m multiplies that by EA/l0 = 2.5e6 N/m
ROUNDING = 1e-6


@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
@pytest.mark.parametrize("n", [1, 2, 7, 50])
@pytest.mark.parametrize(("length", "distance"), [(100.0, 100.1), (500.0, 503.0), (12.5, 12.6)])
def test_tension_profile_and_elongation(up, n, length, distance):
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
