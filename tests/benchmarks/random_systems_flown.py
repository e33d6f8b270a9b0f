"""Random systems of tethers: how many are refused, and how far is the default tolerance from a tight one?

    python tests/benchmarks/random_systems_flown.py [--count N] [--seed S] [--ground]

Systems as in tests/random_systems.py: up to 12 points, 20 lines and 160 segments of the default 4 mm tether, 1 % taut to
30 % slack, loads, wind, driven points at constant velocity; every fifth free point without a mass of its own. Each flies
50 steps of 20 ms, then again with a relative tolerance of 1e-7. Wrong: a number that is not finite, or forces on the points
that differ by more than 1 % (root mean square, of the largest force).

With --ground flat ground is under all, every second system has no load, every third no wind, and the free points are found
at rest first, as by `random_systems_started.py`: many lie there. Each then flies 10 steps. Refused starts are counted apart.
"""

import warnings
from collections import Counter

import numpy as np
from as_script import options, quantiles

from random_systems import DEFAULT, fly, random_network, started
from tetherfmu import Ground, Solver, StepRefused, TetherSystem

STEPS, STEPS_ON_GROUND, STEP = 50, 10, 0.02
TIGHT = Solver(relative_tolerance=1e-7)
WRONG = 0.01


def found_on_ground(network, solver):
    """System of a network on flat ground with all free points found at rest; the driven ones move on from there."""
    system = TetherSystem(network.points, network.lines, network.environment, solver, ground=Ground(ground_contact="flat"))
    free = {point.name: None for point in network.points if not point.is_driven}
    still = {name: (0.0, 0.0, 0.0) for name in free}
    system.initialize(network.wind, positions=free, velocities=still, loads=network.loads)
    return system


def differences(network, systems, steps):
    """Largest difference of positions [m], and of forces on points (rms, of the largest force), default against tight.

    systems : that of the network at the default tolerance, and a tight one.
    """
    flown, tight = (fly(network, system, steps, STEP) for system in systems)
    positions = max(np.abs(flown.positions[name] - tight.positions[name]).max() for name in flown.positions)
    forces = [np.array([each.points[name].force for name in each.points]) for each in (flown, tight)]
    return positions, np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) / np.abs(forces[1]).max()


def main():
    given = options(__doc__, count=2000, seed=1, ground=False)
    warnings.simplefilter("ignore")
    start, steps = (found_on_ground, STEPS_ON_GROUND) if given.ground else (started, STEPS)
    unfound, refused, found = 0, Counter(), {}
    for k in range(given.count):
        network = random_network(np.random.default_rng((given.seed, k)))
        if given.ground:
            network.loads = network.loads if k % 2 else {}
            network.wind = network.wind if k % 3 else np.zeros(3)
        try:
            systems = [start(network, solver) for solver in (DEFAULT, TIGHT)]
        except StepRefused:
            unfound += 1
            continue
        try:
            found[k] = differences(network, systems, steps)
        except StepRefused as problem:
            refused[str(problem)] += 1
    numbers, found = np.array(list(found)), np.array(list(found.values()))
    wrong = numbers[~np.isfinite(found).all(axis=1) | (found[:, 1] > WRONG)]
    counts = f"{unfound} starts and {sum(refused.values())} flights refused, {len(wrong)} wrong {wrong}"
    print(f"{given.count} systems: {counts}")
    for problem, count in refused.most_common():
        print(f"  {count} x {problem}")
    print("difference of              median       90 %       99 %    largest")
    for name, column, unit in (("positions", 0, 1e3), ("forces", 1, 1e2)):
        print(f"{name:10s} {'[mm]' if column == 0 else '[%]':10s}{quantiles(unit * found[:, column], '11.4f')}")


if __name__ == "__main__":
    main()
