"""Wind and air density at a height, the laws of the tether (docs/models/theory.md, "Air"), without a compiler."""

from math import exp, log

from tetherfmu.runtime.layout import EXPLOG, LOGARITHMIC, POWER_LAW, UNIFORM


def power_law(height, air):
    """(z/h)^alpha, 0 at and below z = 0. height z [m], air : parameters of `Environment`."""
    return (height / air.wind_reference_height) ** air.wind_exponent if height > 0.0 else 0.0


def logarithmic(height, air):
    """ln(z/z0)/ln(h/z0), 0 at and below z0."""
    roughness = air.surface_roughness
    return log(height / roughness) / log(air.wind_reference_height / roughness) if height > roughness else 0.0


def wind_factor(height, air):
    """Wind at a height [m] over wind at the reference height [-], never negative; ValueError for an unknown law."""
    profile = air.wind_profile
    if profile == UNIFORM:
        return 1.0
    if profile == POWER_LAW:
        return power_law(height, air)
    if profile == LOGARITHMIC:
        return logarithmic(height, air)
    if profile == EXPLOG:
        return max(0.0, 2.0 * logarithmic(height, air) - power_law(height, air))
    raise ValueError(f"wind_profile is {profile}, a law that examples/fmus/air.py does not know")


def density(height, air):
    """Air density at a height [m]: rho exp(-z/H), uniform for H = 0 [kg/m3]."""
    scale = air.air_density_scale_height
    return air.air_density * exp(-height / scale) if scale > 0.0 else air.air_density
