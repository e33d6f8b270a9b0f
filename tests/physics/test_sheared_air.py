"""The drag of the straight tether in air that changes with the height, against adaptive quadrature of the documented law.

    f(xi) = 1/2 rho cd d |w| w,   w = W - (W . e) e,   W = factor(z) wind - v(xi),   xi = 0 .. 1 along the chord c

Without gravity and slack, its ends feel c integral of (1 - xi) f and of xi f. The error is measured by the integral of |f|.
"""

import numpy as np
import pytest

from mechanics import loads_on_chord, wind_factor
from tetherfmu import Environment, Tether, TetherStraight
from tetherfmu.kernels.variants.sheared_air import FEWER_WEIGHTS, POINTS, WEIGHTS

SLACK = 1.01  # unstretched length over the chord
REFERENCE, ROUGHNESS = 6.0, 0.0002  # [m]
every_profile = pytest.mark.parametrize("profile", ["power_law", "logarithmic", "explog"])


def exact(ground, kite, velocity, wind, air):
    """`loads_on_chord` in an air, on intervals that get shorter towards z = 0 and towards points without cross-flow."""
    chord = kite - ground
    e = chord / np.linalg.norm(chord)

    def wind_at(xi):
        return wind_factor(np.array(ground[2] + xi * chord[2]), air) * wind

    fine = np.linspace(0.0, 1.0, 2001)
    relative = wind_factor(ground[2] + fine * chord[2], air)[:, None] * wind - fine[:, None] * velocity
    speeds = np.linalg.norm(relative - (relative @ e)[:, None] * e, axis=1)
    lulls = fine[1:-1][(speeds[:-2] > speeds[1:-1]) & (speeds[1:-1] <= speeds[2:])]
    heights = [0.0, ROUGHNESS, *(4.0**k for k in range(-6, 6))]
    cuts = [*lulls, *([(z - ground[2]) / chord[2] for z in heights] if chord[2] else [])]
    return loads_on_chord(ground, kite, velocity, wind_at, cuts, Tether(), air.air_density_scale_height)


def check(ground, kite, velocity, wind, profile, exponent=0.08163, scale_height=0.0):
    """Compare the forces of a slack tether without weight with the exact integrals: to 1e-6 of the integral of |f|."""
    ground, kite, velocity, wind = (np.array(each, float) for each in (ground, kite, velocity, wind))
    heights = {"wind_reference_height": REFERENCE, "surface_roughness": ROUGHNESS}
    profile = {"wind_profile": profile, "wind_exponent": exponent, "air_density_scale_height": scale_height}
    air, chord = Environment(gravity=0.0, **heights, **profile), np.linalg.norm(kite - ground)
    mean, moment, size = exact(ground, kite, velocity, wind, air)
    allowed = 1e-6 * chord * size
    tether = TetherStraight(Tether(initial_length=SLACK * chord), air)
    ends = {"ground_position": ground, "kite_position": kite, "kite_velocity": velocity, "ground_velocity": np.zeros(3)}
    outputs = tether.initialize(**ends, wind_velocity=wind)
    np.testing.assert_allclose(outputs.kite_force, chord * moment, rtol=0.0, atol=allowed)
    np.testing.assert_allclose(outputs.ground_force, chord * (mean - moment), rtol=0.0, atol=allowed)


@every_profile
@pytest.mark.parametrize("height", [-200.0, -20.0, -1e-4, 0.0, 1e-4, 0.03, 3.0, 100.0])
def test_at_rest(profile, height):
    """Five Gauss points were wrong by 0.2 % from z = 0, by 5 % across it (-20 m), by 10 % (-200 m)."""
    check((0.0, 0.0, height), (300.0, 0.0, height + 250.0), (0.0, 0.0, 0.0), (0.0, 8.0, 0.0), profile)


@every_profile
@pytest.mark.parametrize("height", [-20.0, 0.0])
@pytest.mark.parametrize("velocity", [(0.0, 40.0, 0.0), (-4.0, 9.0, 3.0), (0.0, 16.0, 0.0), (30.0, -5.0, 2.0)])
def test_in_flight(profile, height, velocity):
    """The third kite overtakes the wind: somewhere the cross-flow vanishes, where |w| w has a kink."""
    check((0.0, 0.0, height), (300.0, 0.0, 400.0), velocity, (0.0, 8.0, 0.0), profile)


@every_profile
def test_upside_down_and_level(profile):
    check((0.0, 0.0, 200.0), (60.0, 10.0, -30.0), (1.0, 2.0, 0.0), (5.0, 5.0, 0.0), profile)
    check((0.0, 0.0, 20.0), (60.0, 10.0, 20.0), (1.0, 2.0, 0.0), (5.0, 5.0, 0.0), profile)


@pytest.mark.parametrize("exponent", [0.0, 0.01, 0.3, 1.0, 2.0])
@pytest.mark.parametrize("profile", ["power_law", "explog"])
def test_exponents(profile, exponent):
    """With large ones the explog profile is 0 again above some height."""
    check((0.0, 0.0, -5.0), (30.0, 0.0, 40.0), (0.0, 0.5, 0.0), (0.0, 8.0, 0.0), profile, exponent)


@pytest.mark.parametrize("profile", ["uniform", "power_law", "logarithmic", "explog"])
def test_thin_air(profile):
    check((0.0, 0.0, -100.0), (300.0, 0.0, 4000.0), (0.0, 4.0, 0.0), (0.0, 8.0, 0.0), profile, scale_height=8550.0)


@pytest.mark.parametrize(("weights", "degree"), [(WEIGHTS, 23), (FEWER_WEIGHTS, 13)])
def test_the_rule_is_exact_for_polynomials(weights, degree):
    points, both = np.concatenate([-POINTS[:-1], POINTS]), np.concatenate([weights[:-1], weights])
    for power in range(degree + 1):
        assert both @ points**power == pytest.approx((1.0 + (-1.0) ** power) / (power + 1), rel=1e-15, abs=1e-15)
    assert abs(both @ points ** (degree + 1) - 2.0 / (degree + 2)) > 1e-9
