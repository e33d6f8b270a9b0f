"""What long communication steps cost while reeling: error of the force on the kite, printed as a table.

    python tests/benchmarks/long_steps.py

The tether is the dynamic one with 20 segments, tolerance 1e-6, high above the ground; error: root mean square of the
difference from steps of 1 ms with linear reel-out speeds, over that of the force. (Held speeds are no reference: rope that
flows gains speed in their jumps only.) To be copied into docs/data/long_steps.csv of docs/models/theory.md, "Inputs within a
step".
"""

from dataclasses import replace

import numpy as np
from as_script import print_csv

from tetherfmu.files.scene_files import load
from tetherfmu.runtime.parameters import Ground
from tetherfmu.study.measuring.start import tether_at_start

SCENES = [replace(load(name), ground=Ground(ground_height=-100.0)) for name in ("reel", "landing")]
STEPS = (0.1, 0.05, 0.02, 0.01)  # [s]
FINE = 0.001  # [s]


def force(scene, step, held):
    """Force on the kite [N] at the output times, array (times, 3); held : whether speeds stay as they are during a step."""
    inputs = scene.inputs(step, exact=False)
    options = {"segments": 20, "input_continuation": "held" if held else "linear"}
    model = tether_at_start(scene, 1e-6, "dynamic", inputs[0], **options)
    return model.fly(inputs, step, every=round(scene.every / step)).kite_force


def main():
    """Print the table."""
    print_csv("scene", "reel_out_speed", "step_ms", "error_percent")
    for scene in SCENES:
        fine = force(scene, FINE, held=False)
        for name, held in (("held", True), ("linear", False)):
            for step in STEPS:
                error = np.sqrt(np.mean((force(scene, step, held) - fine) ** 2) / np.mean(fine**2))
                print_csv(scene.name, name, f"{1e3 * step:g}", f"{100 * error:.2g}")


if __name__ == "__main__":
    main()
