"""What long communication steps cost while reeling: error of the force on the kite, printed as a table.

    python tests/benchmarks/long_steps.py

The tether is the dynamic one with 20 segments, tolerance 1e-6, high above the ground; error: root mean square of the
difference from steps of 2 ms, whose mean reel-out speeds are given, over that of the force. See docs/models/theory.md,
"Inputs within a step".
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu.runtime.parameters import Ground
from tetherfmu.study.scenes.files import load
from tetherfmu.study.scenes.start import tether_at_start

FOLDER = Path(__file__).parents[2] / "examples" / "scenes"
SCENES = [replace(load(FOLDER / f"{name}.toml"), ground=Ground(ground_height=-100.0)) for name in ("reel", "landing")]
STEPS = (0.1, 0.05, 0.02, 0.01)  # [s]
FINE = 0.002  # [s]


def force(scene, step, exact, held):
    """Force on the kite [N] at the output times, array (times, 3).

    exact : whether the mean reel-out speeds of the steps are given.  held : whether they stay as they are during a step.
    """
    inputs = scene.inputs(step, exact)
    options = {"segments": 20, "input_continuation": "held" if held else "linear"}
    model = tether_at_start(scene, 1e-6, "dynamic", inputs[0], **options)
    return model.fly(inputs, step, every=round(scene.every / step)).kite_force


def main():
    """Print the table."""
    print("| scene | reel-out speed | " + " | ".join(f"{1e3 * step:g} ms" for step in STEPS) + " |")
    print("|---" * (len(STEPS) + 2) + "|")
    for scene in SCENES:
        fine = force(scene, FINE, True, True)
        for name, held in (("held", True), ("linear", False)):
            errors = [np.sqrt(np.mean((force(scene, step, False, held) - fine) ** 2) / np.mean(fine**2)) for step in STEPS]
            print(f"| {scene.name} | {name} | " + " | ".join(f"{100 * error:.2g} %" for error in errors) + " |")


if __name__ == "__main__":
    main()
