"""Random systems of tethers: how many are refused, and how far is the default tolerance from a tight one?

    python tests/benchmarks/random_systems_flown.py [--count N] [--seed S]

Systems as in tests/random_systems.py: up to 12 points, 20 lines and 160 segments of the default 4 mm tether, 1 % taut to
30 % slack, loads, wind, driven points at constant velocity; every fifth free point without a mass of its own. Each flies
50 steps of 20 ms, then again with a relative tolerance of 1e-7. Wrong: a number that is not finite, or forces on the points
that differ by more than 1 % (root mean square, of the largest force).
"""

import argparse
import sys
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from random_systems import fly, random_network, started
from tetherfmu import Solver, StepRefused

STEPS, STEP = 50, 0.02
TIGHT = Solver(relative_tolerance=1e-7)
WRONG = 0.01


def differences(network):
    """Largest difference of positions [m], and of forces on points (rms, of the largest force), default against tight."""
    flown, tight = (fly(network, started(network, solver), STEPS, STEP) for solver in (Solver(), TIGHT))
    positions = max(np.abs(flown.positions[name] - tight.positions[name]).max() for name in flown.positions)
    forces = [np.array([each.points[name].force for name in each.points]) for each in (flown, tight)]
    return positions, np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) / np.abs(forces[1]).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    refused, found = Counter(), []
    for k in range(options.count):
        try:
            found.append(differences(random_network(np.random.default_rng((options.seed, k)))))
        except StepRefused as problem:
            refused[str(problem)] += 1
    found = np.array(found)
    wrong = int(np.sum(~np.isfinite(found).all(axis=1) | (found[:, 1] > WRONG)))
    print(f"{options.count} systems: {sum(refused.values())} refused, {wrong} wrong")
    for problem, count in refused.most_common():
        print(f"  {count} x {problem}")
    print("difference of              median       90 %       99 %    largest")
    for name, column, unit in (("positions", 0, 1e3), ("forces", 1, 1e2)):
        numbers = "".join(f"{unit * each:11.4f}" for each in np.quantile(found[:, column], (0.5, 0.9, 0.99, 1.0)))
        print(f"{name:10s} {'[mm]' if column == 0 else '[%]':10s}{numbers}")


if __name__ == "__main__":
    main()
