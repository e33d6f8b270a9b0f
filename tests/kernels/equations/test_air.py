"""Wind and density at a height z follow their formulas.

power law f = (z/h)^alpha,  log f = ln(z/z0)/ln(h/z0),  explog f = log + (log - power), all 0 at z <= 0, never negative
density rho(z) = rho exp(-z/H), H = 0: uniform
"""

from math import exp

import numpy as np
import pytest

import mechanics
from kernels.packed import packed
from tetherfmu import Environment, Tether
from tetherfmu.kernels.equations.air import air_density, is_known, wind_factor
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.quantities import quantities

HEIGHTS = [0.5, 6.0, 10.0, 200.0, 3000.0]
REFERENCE, ALPHA, ROUGHNESS = 10.0, 0.14, 0.03


PROFILES = [1, 2, 3, 4]


def air(profile=1, scale_height=0.0):
    heights = {"wind_reference_height": REFERENCE, "surface_roughness": ROUGHNESS, "air_density_scale_height": scale_height}
    return Environment(wind_profile=profile, wind_exponent=ALPHA, **heights)


def parameters(*of_air):
    return packed(Tether(), air(*of_air))


@pytest.mark.parametrize("z", [*HEIGHTS, REFERENCE, 1e-3, 0.0, -1e-9, -5.0, -1e4])
@pytest.mark.parametrize("profile", PROFILES)
def test_wind_formula(profile, z):
    """Of `mechanics.wind_factor`, to rounding; at the reference height it is the input, below the ground there is none."""
    factor, slope = wind_factor(z, parameters(profile))
    assert factor == pytest.approx(float(mechanics.wind_factor(np.array(z), air(profile))), rel=1e-14)
    if z == REFERENCE:
        assert factor == pytest.approx(1.0, rel=1e-14)
    if z <= 0.0 and profile > 1:
        assert (factor, slope) == (0.0, 0.0)


def test_all_laws_that_can_be_chosen_are_known_and_no_other():
    """One that is declared and written nowhere else is no calm in silence: its factor is NaN, and `pack` refuses it."""
    known = dict(quantities(Environment))["wind_profile"].numbers.values()
    assert list(known) == PROFILES
    assert [law for law in (at.AT_NODES, 0, *known, max(known) + 1) if is_known(law)] == list(known)
    unknown = parameters()
    unknown[at.WIND_PROFILE] = max(known) + 1
    assert np.isnan(wind_factor(REFERENCE, unknown)).all()
    said = status.sentence(status.UNKNOWN_WIND_LAW, name="wind_profile", value=5)
    assert said == "wind_profile is 5, which is not a wind law: see kernels/equations/air.py"


@pytest.mark.parametrize("profile", [2, 3, 4])
def test_factor_is_never_negative(profile):
    heights = np.concatenate((np.linspace(-1.0, 1.0, 401), np.geomspace(1e-12, 1e5, 400)))
    values = [wind_factor(z, parameters(profile))[0] for z in heights]
    assert min(values) >= 0.0
    assert np.all(np.isfinite(values))


@pytest.mark.parametrize("z", HEIGHTS[1:])
@pytest.mark.parametrize("profile", PROFILES)
def test_slope_of_the_wind(profile, z):
    p = parameters(profile)
    d = 1e-4 * z
    difference = (wind_factor(z + d, p)[0] - wind_factor(z - d, p)[0]) / (2.0 * d)
    # the central difference errs by d^2 f'''/6 = 1e-8 of the slope
    assert wind_factor(z, p)[1] == pytest.approx(difference, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("z", [-100.0, 0.0, *HEIGHTS])
def test_density(z):
    value, slope = air_density(z, parameters(1, 8550.0))
    assert value == pytest.approx(1.225 * exp(-z / 8550.0), rel=1e-14)
    assert slope == pytest.approx(-value / 8550.0, rel=1e-14)
    assert air_density(z, parameters()) == (1.225, 0.0)
