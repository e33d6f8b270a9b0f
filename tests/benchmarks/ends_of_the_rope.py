"""Fixed and adaptive steps where the rope ends: how many scenes make energy, and how many are refused?

    python tests/benchmarks/ends_of_the_rope.py

All scenes of `tests/ends_of_ropes.py`, 24 loads at a sheave, 24 at a drum, 48 winches that let go, with adaptive steps and
with fixed steps of 1, 5 and 10 ms of both methods. A scene gains if it makes more energy than 1 % of its work; a load that
falls freely has 9.81 m/s after 1 s.
"""

import sys
import warnings
from itertools import product
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from ends_of_ropes import DRUMS, FREE, SHEAVES, at_a_drum, at_a_free_winch, at_a_sheave
from tetherfmu import Solver, StepRefused
from tetherfmu.study.measuring.tables import circumstances

KINDS = {"sheave": (at_a_sheave, SHEAVES), "drum": (at_a_drum, DRUMS), "free winch": (at_a_free_winch, FREE)}
SOLVERS = {"adaptive": Solver()} | {
    f"{method}, {size * 1e3:g} ms": Solver(fixed_step=size, fixed_step_method=method)
    for method, size in product(("second_order", "backward_euler"), (0.001, 0.005, 0.01))
}
GAINS = 0.01


def main():
    warnings.simplefilter("ignore")
    print(circumstances())
    for (name, (fly, scenes)), (steps, solver) in product(KINDS.items(), SOLVERS.items()):
        found, refused = [], 0
        for scene in scenes:
            try:
                result = fly(*scene, solver)
            except StepRefused:
                refused += 1
            else:
                found.append(result if isinstance(result, tuple) else (result, 0.0))
        gained = [each[0] for each in found]
        counts = f"{sum(each > GAINS for each in gained)} of {len(scenes)} gain, {refused} refused"
        fastest = f", fastest {max(speed for _, speed in found):.4g} m/s" if name == "free winch" else ""
        print(f"{name:10s} {steps:22s} {counts}; largest gain {max(gained):.1e} of the work{fastest}")


if __name__ == "__main__":
    main()
