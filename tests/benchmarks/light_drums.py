"""Random drums of 0.01 to 100 masses of their rope, kites of 0.1 to 100, constant forces: does a wave grow?

    python tests/benchmarks/light_drums.py [--count N]

The scene of tests/physics/test_running_rope.py: 100 m upright, 0.4 s after a push of 2 ms. Prints the largest ratio of the
range of the tension in the later half to that in the first half, and how many drums gained energy or were refused.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "physics"))
from test_running_rope import light_drum, random_drum

from tetherfmu import StepRefused


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=500)
    count = parser.parse_args().count
    refused, gained, largest = 0, 0, 0.0
    for seed in range(count):
        try:
            ranges, energies = light_drum(**random_drum(seed))
        except StepRefused as problem:
            refused += 1
            print(f"seed {seed}: {problem}")
            continue
        gained += bool((np.diff(energies) >= 0.0).any())
        largest = max(largest, ranges[4:].max() / ranges[:4].max())
    print(f"{count} drums: {refused} refused, {gained} gained energy, the range grew to {largest:.2f} of itself at most")


if __name__ == "__main__":
    main()
