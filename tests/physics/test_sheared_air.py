"""The drag of the straight tether in air that changes with the height, against adaptive quadrature of the documented law.

    f(xi) = 1/2 rho cd d |w| w,   w = W - (W . e) e,   W = factor(z) wind - v(xi),   xi = 0 .. 1 along the chord c

Without gravity and slack, its ends feel c integral of (1 - xi) f and of xi f. The error is measured by the integral of |f|.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from tetherfmu import Environment, Tether, TetherStraight
from tetherfmu.kernels.variants.sheared_air import FEWER_WEIGHTS, POINTS, WEIGHTS

SLACK = 1.01  # unstretched length over the chord
REFERENCE, ROUGHNESS = 6.0, 0.0002  # [m]
PROFILES = {"uniform": 1, "power_law": 2, "logarithmic": 3, "explog": 4}
every_profile = pytest.mark.parametrize("profile", ["power_law", "logarithmic", "explog"])


def factor(z, profile, exponent):
    """Wind over that at the reference height [-] at a height [m]."""
    power = (z / REFERENCE) ** exponent if z > 0.0 else 0.0
    logarithm = np.log(z / ROUGHNESS) / np.log(REFERENCE / ROUGHNESS) if z > ROUGHNESS else 0.0
    return {"uniform": 1.0, "power_law": power, "logarithmic": logarithm, "explog": max(0.0, 2.0 * logarithm - power)}[
        profile
    ]


def exact(ground, kite, velocity, wind, profile, exponent, scale_height):
    """Integrals of f, xi f and |f| along the chord [N/m], by QUADPACK on intervals that get shorter towards z = 0.

    Towards a point without cross-flow too. ground at rest, kite: positions [m]; velocity of the kite [m/s].
    """
    tether, chord = Tether(), kite - ground
    e = chord / np.linalg.norm(chord)

    def flow(xi):
        relative = factor(ground[2] + xi * chord[2], profile, exponent) * wind - xi * velocity
        return relative - (relative @ e) * e

    def load(xi):
        w = flow(xi)
        density = 1.225 * np.exp(-(ground[2] + xi * chord[2]) / scale_height) if scale_height else 1.225
        return 0.5 * density * tether.drag_coefficient * tether.diameter * np.linalg.norm(w) * w

    fine = np.linspace(0.0, 1.0, 2001)
    speeds = np.array([np.linalg.norm(flow(xi)) for xi in fine])
    lulls = [xi for xi, *near in zip(fine[1:], speeds, speeds[1:], speeds[2:], strict=False) if near[0] > near[1] <= near[2]]
    heights = [0.0, ROUGHNESS, *(4.0**k for k in range(-6, 6))]
    cuts = [*lulls, *([(z - ground[2]) / chord[2] for z in heights] if chord[2] else [])]
    cuts = np.unique([0.0, 1.0, *(xi for xi in cuts if 0.0 < xi < 1.0)])

    def integral(function):
        return sum(quad(function, *ends, epsabs=1e-13, epsrel=1e-11, limit=400)[0] for ends in pairwise(cuts))

    mean = np.array([integral(lambda xi, i=i: load(xi)[i]) for i in range(3)])
    moment = np.array([integral(lambda xi, i=i: xi * load(xi)[i]) for i in range(3)])
    return mean, moment, integral(lambda xi: np.linalg.norm(load(xi)))


def drags(ground, kite, velocity, wind, profile, exponent, scale_height):
    """Forces of a tether on its ends [N], slack and without weight."""
    air = Environment(
        gravity=0.0,
        wind_profile=PROFILES[profile],
        wind_exponent=exponent,
        air_density_scale_height=scale_height,
        wind_reference_height=REFERENCE,
        surface_roughness=ROUGHNESS,
    )
    tether = TetherStraight(Tether(initial_length=SLACK * np.linalg.norm(kite - ground)), air)
    outputs = tether.initialize(
        ground_position=ground, kite_position=kite, kite_velocity=velocity, ground_velocity=np.zeros(3), wind_velocity=wind
    )
    return outputs.ground_force, outputs.kite_force


def check(ground, kite, velocity, wind, profile, exponent=0.08163, scale_height=0.0):
    """Compare with the exact integrals: to 1e-6 of the integral of |f|."""
    scene = (*(np.array(each, float) for each in (ground, kite, velocity, wind)), profile, exponent, scale_height)
    chord = np.linalg.norm(scene[1] - scene[0])
    mean, moment, size = exact(*scene)
    allowed = 1e-6 * chord * size
    ground_force, kite_force = drags(*scene)
    np.testing.assert_allclose(kite_force, chord * moment, rtol=0.0, atol=allowed)
    np.testing.assert_allclose(ground_force, chord * (mean - moment), rtol=0.0, atol=allowed)


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


@pytest.mark.parametrize("profile", PROFILES)
def test_thin_air(profile):
    check((0.0, 0.0, -100.0), (300.0, 0.0, 4000.0), (0.0, 4.0, 0.0), (0.0, 8.0, 0.0), profile, scale_height=8550.0)


@pytest.mark.parametrize(("weights", "degree"), [(WEIGHTS, 23), (FEWER_WEIGHTS, 13)])
def test_the_rule_is_exact_for_polynomials(weights, degree):
    points, both = np.concatenate([-POINTS[:-1], POINTS]), np.concatenate([weights[:-1], weights])
    for power in range(degree + 1):
        assert both @ points**power == pytest.approx((1.0 + (-1.0) ** power) / (power + 1), rel=1e-15, abs=1e-15)
    assert abs(both @ points ** (degree + 1) - 2.0 / (degree + 2)) > 1e-9
