"""Wind and air density at a height.

    uniform      f = 1
    power law    f = (z/h)^alpha
    logarithmic  f = ln(z/z0) / ln(h/z0)
    explog       f = log + (log - power)
    density      rho(z) = rho exp(-z/H),  H = 0: rho(z) = rho

z [m] above z = 0, h reference height [m], z0 surface roughness [m]. The factor f on the reference wind is never
negative. Theory: docs/models/theory.md, "Air".

Equilibrium searches may add a calm layer of thickness c > 0, in which the factor is proportional to the height:
f(z) = f(c) z/c.
"""

from math import exp, log, nan

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..linear_algebra.pairs import lanewise

_LOWEST = 1e-3  # part of h below which the power-law slope is constant: it is infinite at z = 0


@kernel
def power_law(height, parameters):
    """Factor of the power law [-] and its slope [1/m] at a height [m]."""
    reference = parameters[at.WIND_REFERENCE_HEIGHT]
    if height <= 0.0:
        return 0.0, 0.0
    exponent = parameters[at.WIND_EXPONENT]
    factor = (height / reference) ** exponent
    layer = parameters[at.CALM_LAYER]
    return factor, exponent * factor / max(height, layer if layer > 0.0 else _LOWEST * reference)


@kernel
def logarithmic(height, parameters):
    """Factor of the logarithmic law [-] and its slope [1/m] at a height [m]."""
    roughness = parameters[at.SURFACE_ROUGHNESS]
    if height <= roughness:
        return 0.0, 0.0
    at_reference = log(parameters[at.WIND_REFERENCE_HEIGHT] / roughness)
    return log(height / roughness) / at_reference, 1.0 / (at_reference * height)


@kernel
def is_sheared(profile):
    """Whether the wind of this law varies with the height."""
    return profile == at.POWER_LAW or profile == at.LOGARITHMIC or profile == at.EXPLOG


@kernel
def is_known(profile):
    """Whether this file defines the law."""
    return profile == at.UNIFORM or is_sheared(profile)


@kernel
def factor_by_law(height, parameters):
    """Wind at a height [m] over wind at the reference height [-], and its slope [1/m], without a calm layer.

    NaN for an unknown law.
    """
    profile = parameters[at.WIND_PROFILE]
    if profile == at.POWER_LAW:
        return power_law(height, parameters)
    if profile == at.LOGARITHMIC:
        return logarithmic(height, parameters)
    if profile == at.EXPLOG:
        power, power_slope = power_law(height, parameters)
        logarithm, logarithm_slope = logarithmic(height, parameters)
        if 2.0 * logarithm <= power:
            return 0.0, 0.0
        return 2.0 * logarithm - power, 2.0 * logarithm_slope - power_slope
    if profile == at.UNIFORM or profile == at.AT_NODES:
        return 1.0, 0.0
    return nan, nan


@kernel
def wind_factor(height, parameters):
    """Wind at a height [m] over wind at the reference height [-], and its slope [1/m]."""
    layer = parameters[at.CALM_LAYER]
    if layer <= 0.0 or height >= layer:
        return factor_by_law(height, parameters)
    if height <= 0.0:
        return 0.0, 0.0
    above, _ = factor_by_law(layer, parameters)
    return above * height / layer, above / layer


@kernel
def air_density(height, parameters):
    """Air density at a height [m]: [kg/m3], and its slope [kg/m4]."""
    density = parameters[at.AIR_DENSITY]
    scale_height = parameters[at.AIR_DENSITY_SCALE_HEIGHT]
    if scale_height <= 0.0:
        return density, 0.0
    density *= exp(-height / scale_height)
    return density, -density / scale_height


@kernel
def is_uniform(parameters):
    """Whether wind and density are the same everywhere (`varying_air` is then not needed)."""
    return parameters[at.WIND_PROFILE] == at.UNIFORM and parameters[at.AIR_DENSITY_SCALE_HEIGHT] <= 0.0


@lanewise
def varying_air(height, parameters):
    """Wind factor [-] and density [kg/m3] at a height [m] and their slopes [1/m], [kg/m4]; pairs for a pair of heights."""
    factor, wind_slope = wind_factor(height, parameters)
    density, density_slope = air_density(height, parameters)
    return factor, density, wind_slope, density_slope


@lanewise
def varying_density(height, parameters):
    """Density [kg/m3] at a height [m] and its slope [kg/m4]; pairs for a pair of heights."""
    return air_density(height, parameters)
