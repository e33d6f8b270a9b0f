"""What long communication steps cost: error of the force on the kite in a slack landing and while reeling, as two tables.

    python tests/benchmarks/long_steps.py

The tether is the dynamic one with 20 segments, tolerance 1e-6; error: root mean square of the difference from steps of 2 ms,
whose mean reel-out speeds are given, over that of the force. See docs/theory.md, "Driven ends" and "Inputs within a step".
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu.study.scenes.files import load
from tetherfmu.study.scenes.standard import tether_at_start

SCENES = Path(__file__).parents[2] / "examples" / "scenes"
LANDING, REEL = load(SCENES / "landing.toml"), load(SCENES / "reel.toml")
STEPS = (0.1, 0.05, 0.02, 0.01)  # [s]
FINE = 0.002  # [s]


def force(scene, step, exact, held):
    """Force on the kite [N] at the output times, array (times, 3).

    exact : whether the mean reel-out speeds of the steps are given.  held : whether they stay as they are during a step.
    """
    inputs = scene.inputs(step, exact)
    scene = replace(scene, tether=replace(scene.tether, segments=20))
    model = tether_at_start(scene, 1e-6, "dynamic", inputs[0], held)
    return model.fly(inputs, step, every=round(scene.every / step)).kite_force


def table(title, rows):
    """Print errors of runs, dict of name and (scene, exact, held), against runs of short steps."""
    print(f"| {title} | " + " | ".join(f"{1e3 * step:g} ms" for step in STEPS) + " |")
    print("|---" * (len(STEPS) + 1) + "|")
    for name, (scene, *how) in rows.items():
        fine = force(scene, FINE, True, True)
        errors = [np.sqrt(np.mean((force(scene, step, *how) - fine) ** 2) / np.mean(fine**2)) for step in STEPS]
        print(f"| {name} | " + " | ".join(f"{100 * error:.2g} %" for error in errors) + " |")


def main():
    """Print the tables."""
    damped = replace(LANDING, tether=replace(LANDING.tether, axial_damping=10.0 * LANDING.tether.axial_damping))
    table("damping in the landing", {"default": (LANDING, True, True), "ten times": (damped, True, True)})
    table("reel-out speed", {"held": (REEL, False, True), "linear": (REEL, False, False)})


if __name__ == "__main__":
    main()
