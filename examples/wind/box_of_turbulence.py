"""A box of turbulence to try things with: isotropic, with the spectrum of von Karman, periodic. Helper of `turbulence.py`.

    E(k) ~ k^4 (1 + (k L)^2)^(-17/6),   u(k) ~ i k x n(k) (1 + (k L)^2)^(-17/12),   n white noise

so the field is free of divergence. Sources: of the spectrum von Karman, PNAS 34 (1948); of the way to make a field of it
Mann, Probabilistic Engineering Mechanics 13 (1998), without shear. It is no model of the atmosphere, whose eddies are
stretched by the shear and blocked by the ground: for a study take a box of TurbSim or of a Mann generator.
"""

import numpy as np

POINTS, SPACING = (256, 48, 96), (5.0, 5.0, 5.0)  # along, across, up [m]: 1280 m, 240 m, 480 m
LENGTH = 40.0  # L of the spectrum [m]


def velocity(deviation, seed=1, points=POINTS, spacing=SPACING, length=LENGTH):
    """Velocities [m/s], array (along, across, up, 3) of 32-bit numbers, the first of which have a deviation [m/s].

    points : even numbers.
    """
    noise = np.random.default_rng(seed).standard_normal((3, *points))
    waves = np.fft.rfftn(noise, axes=(1, 2, 3))
    last = 2.0 * np.pi * np.fft.rfftfreq(points[2], spacing[2])
    others = [2.0 * np.pi * np.fft.fftfreq(count, step) for count, step in zip(points[:2], spacing[:2], strict=True)]
    k = np.array(np.meshgrid(*others, last, indexing="ij"))
    field = 1j * np.cross(k, waves, axis=0) * (1.0 + length**2 * (k**2).sum(axis=0)) ** (-17.0 / 12.0)
    field[:, points[0] // 2] = field[:, :, points[1] // 2] = field[..., -1] = 0.0  # the shortest waves, which have no sign
    found = np.fft.irfftn(field, s=points, axes=(1, 2, 3))
    return np.moveaxis(found * deviation / found[0].std(), 0, -1).astype(np.float32)


def write(file, deviation, seed=1):
    """Write a box to an .npz file, as the FMU TurbulentWind reads it."""
    np.savez(file, velocity=velocity(deviation, seed), spacing=SPACING)
