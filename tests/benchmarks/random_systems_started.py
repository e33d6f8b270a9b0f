"""Random systems of tethers whose free points are found: how many are refused, and how well are the others balanced?

    python tests/benchmarks/random_systems_started.py [--count N] [--seed S] [--ground]

Systems as in tests/random_systems.py: up to 12 points, 20 lines and 160 segments of the default 4 mm tether, 1 % taut to
30 % slack, loads, wind; every fifth free point without a mass. Every second system has no load, every third no wind,
and with --ground flat ground is under all. No free point has a position. Wrong: a number not finite, or forces, load,
weight and what the ground does to a free point that add up to more than 1e-9 of the largest force of a line. The ground
presses with m g (depth/ground_sink) on the point with its half segments, and holds it by friction.
"""

import warnings
from collections import Counter
from time import perf_counter

import numpy as np
from as_script import options, quantiles

from random_systems import random_network
from tetherfmu import Ground, StepRefused, TetherSystem

BALANCED = 1e-9  # residual over the largest force of a line at its ends


def residual(network, number, ground):
    """Largest sum of forces at a free point over the largest force of a line; the free points are found."""
    loads = network.loads if number % 2 else {}
    wind = network.wind if number % 3 else (0.0, 0.0, 0.0)
    system = TetherSystem(network.points, network.lines, network.environment, ground=ground)
    still = {point.name: (0.0, 0.0, 0.0) for point in network.points}
    free = {point.name: None for point in network.points if not point.is_driven}
    outputs = system.initialize(wind, positions=free, velocities=still, loads=loads)
    largest = max(max(np.linalg.norm(each.ground_force), np.linalg.norm(each.kite_force)) for each in outputs.lines.values())
    left = [_left(network, ground, outputs, point, loads) for point in network.points if not point.is_driven]
    return max(left) / largest


def _left(network, ground, outputs, point, loads):
    """Size of the sum of all forces on a free point [N]."""
    gravity, found = network.environment.gravity, outputs.points[point.name]
    total = found.force + loads.get(point.name, 0.0) - np.array((0.0, 0.0, gravity * point.mass))
    depth = ground.ground_height - found.position[2] if ground.ground_contact == 2 else 0.0
    if depth > 0.0:
        tethers = [line.tether for line in network.lines if point.name in (line.start, line.end)]
        mass = point.mass + sum(0.5 * each.mass_per_length * each.initial_length / each.segments for each in tethers)
        pressure = mass * gravity * depth / ground.ground_sink
        sideways = np.linalg.norm(total[:2])
        total[:2] *= max(0.0, 1.0 - ground.ground_friction * pressure / max(sideways, 1e-300))
        total[2] += pressure
    return np.linalg.norm(total)


def main():
    given = options(__doc__, count=2000, seed=1, ground=False)
    ground = Ground(ground_contact="flat" if given.ground else "none")
    warnings.simplefilter("ignore")
    refused, found, seconds = Counter(), {}, []
    for k in range(given.count):
        network = random_network(np.random.default_rng((given.seed, k)))
        began = perf_counter()
        try:
            found[k] = residual(network, k, ground)
        except StepRefused as problem:
            refused[str(problem)] += 1
            print(f"{k} refused: {problem}", flush=True)
        seconds.append(perf_counter() - began)
    wrong = [k for k, each in found.items() if not each <= BALANCED]
    print(f"{given.count} systems: {sum(refused.values())} refused, {len(wrong)} wrong {wrong}")
    numbers = quantiles([*found.values()], "11.2g")
    print(f"residual: median, 90 %, 99 %, largest {numbers}; seconds {np.mean(seconds):.3g}, at most {max(seconds):.3g}")


if __name__ == "__main__":
    main()
