"""What long communication steps cost in a slack landing: error of the force on the kite, printed as a table.

    python tests/benchmarks/long_steps.py

The tether is the dynamic one with 20 segments, tolerance 1e-6, with the mean reel-out speed of each step as input; error:
root mean square of the difference from steps of 2 ms over that of the force. See docs/theory.md, "Driven ends".
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu.study.measuring.runs import Config, run
from tetherfmu.study.scenes.files import load

SCENE = load(Path(__file__).parents[2] / "examples" / "scenes" / "landing.toml")
STEPS = (0.1, 0.05, 0.02, 0.01)  # [s]
FINE = 0.002  # [s]
DAMPINGS = (1.0, 10.0)  # times that of the scene


def force(factor, step):
    """Force on the kite [N] at the output times, array (times, 3)."""
    tether = replace(SCENE.tether, axial_damping=factor * SCENE.tether.axial_damping)
    return run(replace(SCENE, tether=tether), Config("dynamic", 20, 1e-6, step), exact=True).flown.kite_force


def main():
    """Print the table."""
    print("| damping | " + " | ".join(f"{1e3 * step:g} ms" for step in STEPS) + " |")
    print("|---" * (len(STEPS) + 1) + "|")
    for factor in DAMPINGS:
        fine = force(factor, FINE)
        errors = [np.sqrt(np.mean((force(factor, step) - fine) ** 2) / np.mean(fine**2)) for step in STEPS]
        print(f"| {factor:g} times | " + " | ".join(f"{100 * error:.2g} %" for error in errors) + " |")


if __name__ == "__main__":
    main()
