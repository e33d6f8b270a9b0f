"""Independent numpy formulas that several physics tests compare with: masses, drag, energy of a uniform chain."""

from itertools import pairwise

import numpy as np
from scipy.integrate import quad


def line_density(tether):
    """Mass per unstretched length mu = density pi d^2/4 [kg/m]."""
    return tether.density * np.pi * tether.diameter**2 / 4.0


def node_masses(tether, length=None):
    """Node masses [kg] of a tether of unstretched length `length` [m]: mu l0, half of it at the ends."""
    n = tether.segments
    mass = np.full(n + 1, line_density(tether) * (length or tether.initial_length) / n)
    mass[[0, -1]] *= 0.5
    return mass


def wind_factor(z, air):
    """Wind at the heights z [m] over the wind at the reference height [-]."""
    if air.wind_profile == 1:
        return np.ones_like(z)
    h, z0, alpha = air.wind_reference_height, air.surface_roughness, air.wind_exponent
    with np.errstate(all="ignore"):
        power = np.where(z > 0.0, np.abs(z / h) ** alpha, 0.0)
        log = np.where(z > z0, np.log(np.abs(z) / z0) / np.log(h / z0), 0.0)
    return {2: power, 3: log, 4: np.maximum(2.0 * log - power, 0.0)}[air.wind_profile]


def air_velocities(positions, wind, air):
    """Wind at the segments (n, 3) [m/s]: one wind times its profile, or the means of winds at the nodes (n + 1, 3)."""
    wind = np.asarray(wind)
    if wind.ndim == 2:
        return 0.5 * (wind[1:] + wind[:-1])
    return wind_factor(0.5 * (positions[1:, 2] + positions[:-1, 2]), air)[:, None] * wind


def drags(positions, velocities, wind, tether, air):
    """Drag 1/2 rho cd d l |w| w (n, 3) [N] of all segments; w: apparent wind across it, wind: see `air_velocities`."""
    r = np.diff(positions, axis=0)
    length = np.linalg.norm(r, axis=1)[:, None]
    e = r / length
    height = 0.5 * (positions[1:, 2] + positions[:-1, 2])
    scale_height = air.air_density_scale_height
    density = air.air_density * (np.exp(-height / scale_height) if scale_height else np.ones_like(height))
    relative = air_velocities(positions, wind, air) - 0.5 * (velocities[1:] + velocities[:-1])
    w = relative - np.sum(relative * e, axis=1)[:, None] * e
    width = tether.drag_coefficient * tether.diameter
    return 0.5 * density[:, None] * width * length * np.linalg.norm(w, axis=1)[:, None] * w


def drag(positions, velocities, wind, tether, air):
    """Sum of the `drags` of all segments [N]."""
    return np.sum(drags(positions, velocities, wind, tether, air), axis=0)


def loads_on_chord(ground, kite, kite_velocity, wind_at, cuts, tether, scale_height=0.0):
    """Integrals of f, xi f and |f| along the chord, xi = 0 .. 1, by QUADPACK on the intervals between the cuts [N/m].

    f = 1/2 rho cd d |w| w, w the wind_at(xi) [m/s] less xi times the velocity of the kite, across the chord.
    """
    chord = kite - ground
    e, cuts = chord / np.linalg.norm(chord), np.unique([0.0, 1.0, *(xi for xi in cuts if 0.0 < xi < 1.0)])

    def load(xi):
        relative = wind_at(xi) - xi * kite_velocity
        w = relative - (relative @ e) * e
        density = 1.225 * np.exp(-(ground[2] + xi * chord[2]) / scale_height) if scale_height else 1.225
        return 0.5 * density * tether.drag_coefficient * tether.diameter * np.linalg.norm(w) * w

    def integral(function):
        return sum(quad(function, *ends, epsabs=1e-13, epsrel=1e-11, limit=400)[0] for ends in pairwise(cuts))

    mean = np.array([integral(lambda xi, i=i: load(xi)[i]) for i in range(3)])
    moment = np.array([integral(lambda xi, i=i: xi * load(xi)[i]) for i in range(3)])
    return mean, moment, integral(lambda xi: np.linalg.norm(load(xi)))


def energy(positions, velocities, tether, gravity=9.81):
    """Kinetic + elastic + gravitational energy of the chain [J]."""
    mass = node_masses(tether)
    rest = tether.initial_length / tether.segments
    stretch = np.linalg.norm(np.diff(positions, axis=0), axis=1) - rest
    stiffness = tether.axial_stiffness / rest * np.where(stretch > 0.0, 1.0, tether.slack_stiffness_ratio)
    kinetic = 0.5 * mass @ np.sum(velocities**2, axis=1)
    return kinetic + 0.5 * stiffness @ stretch**2 + gravity * mass @ positions[:, 2]


def pluck(model, **inputs):
    """Start a tether anew where it is, its inner nodes with a sideways speed [m/s]."""
    part = np.pi * np.linspace(0.0, 1.0, model.segments + 1)
    sideways = np.column_stack([0.0 * part, 5.0 * np.sin(part), 2.5 * np.sin(2.0 * part)])
    model.initialize(positions=model.positions, velocities=model.velocities + sideways, **inputs)
