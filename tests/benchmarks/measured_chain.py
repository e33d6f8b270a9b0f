"""A chain that was measured in a tank (`reference/README.md`, Bergdahl et al.), and what the tethers make of it.

    python tests/benchmarks/measured_chain.py > docs/data/measured_chain.csv

Air takes the place of the water: it has the density of water, and gravity is such that the chain has the weight it has under
water. The added mass, 3.8 of the displaced water across the chain, acts in all directions; there is no drag along it. No
number is fitted. The axial damping is a choice: it was not measured.
"""

import warnings

import numpy as np
from as_script import REFERENCE, print_csv

from tetherfmu import PlausibilityWarning, TetherCatenary, TetherDynamic, TetherQuasiSteady, inputs_along

LINE_DENSITY, DIAMETER, WEIGHT = 0.0818, 2.2e-3, 0.6993  # dry [kg/m], nominal [m], under water [N/m]
STEEL, WATER, ADDED = 7800.0, 1000.0, 3.8  # [kg/m3], [kg/m3], coefficient
STEP, CYCLES, COUNTED = 0.01, 8, 4  # s; the radius grows in the first three of the cycles, the last ones count
SCENE = {
    "initial_length": 33.0,
    "diameter": DIAMETER,
    "axial_stiffness": 1e4,
    "drag_coefficient": 2.5,
    "air_density": WATER,
    "ground_contact": "flat",
    "ground_friction": 0.3,
}
DYNAMIC = {"segments": 40, "axial_damping": 20.0}
TETHERS = {
    "dynamic": (TetherDynamic, DYNAMIC),
    "dynamic, fixed steps of 10 ms": (TetherDynamic, {**DYNAMIC, "fixed_step": STEP}),
    "dynamic, 80 segments": (TetherDynamic, {**DYNAMIC, "segments": 80}),
    "dynamic, no added mass": (TetherDynamic, {**DYNAMIC, "added": 0.0}),
    "dynamic, axial damping 5 N s": (TetherDynamic, {**DYNAMIC, "axial_damping": 5.0}),
    "dynamic, drag coefficient 2": (TetherDynamic, {**DYNAMIC, "drag_coefficient": 2.0}),
    "dynamic, drag coefficient 3": (TetherDynamic, {**DYNAMIC, "drag_coefficient": 3.0}),
    "dynamic, friction 0.6": (TetherDynamic, {**DYNAMIC, "ground_friction": 0.6}),
    "dynamic, 5 mm longer": (TetherDynamic, {**DYNAMIC, "initial_length": 33.005}),
    "dynamic, 5 mm shorter": (TetherDynamic, {**DYNAMIC, "initial_length": 32.995}),
    "quasi-steady": (TetherQuasiSteady, {"segments": 40}),
    "catenary": (TetherCatenary, {}),
}


def largest_force(kind, period, radius, added=ADDED, **more):
    """Mean over the cycles that count of the largest force [N] on the upper end, which moves on a circle."""
    mass = LINE_DENSITY + added * WATER * LINE_DENSITY / STEEL
    density = mass / (0.25 * np.pi * DIAMETER**2)
    tether = kind(**{**SCENE, **more}, density=density, gravity=WEIGHT / mass)
    turn, rows, grown = 2.0 * np.pi / period, round(period / STEP), 3.0 * period
    time = STEP * np.arange(CYCLES * rows)
    size, growing = radius * np.minimum(1.0, time / grown), np.where(time < grown, radius / grown, 0.0)
    out, up, still = np.sin(turn * time), np.cos(turn * time), 0.0 * time
    place = np.stack([32.554 + size * out, still, 3.3 + size * up], axis=1)
    speed = np.stack([growing * out + size * turn * up, still, growing * up - size * turn * out], axis=1)
    tether.initialize(place[0], speed[0])
    flown = tether.fly(inputs_along(len(time), STEP, place, kite_velocity=speed), STEP)
    pulled = np.linalg.norm(flown.kite_force, axis=1).reshape(CYCLES, rows)
    return np.mean(pulled[-COUNTED:].max(axis=1))


def errors(name):
    """Computed less measured forces of all conditions [N]; name : of one of `TETHERS`."""
    kind, more = TETHERS[name]
    periods, radii, forces = np.loadtxt(REFERENCE / "bergdahl_chain.csv", delimiter=",", skiprows=1, unpack=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlausibilityWarning)  # of air as dense as water
        return np.array([largest_force(kind, *each, **more) for each in zip(periods, radii, strict=True)]) - forces


def main():
    """Print a row for each tether."""
    print_csv("tether", "root mean square [N]", "mean [N]", "largest [N]")
    for name in TETHERS:
        found = errors(name)
        print_csv(name, *(f"{each:.3g}" for each in (np.sqrt(np.mean(found**2)), found.mean(), np.abs(found).max())))


if __name__ == "__main__":
    main()
