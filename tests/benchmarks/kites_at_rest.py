"""Random free kites and loads that start in equilibrium: how many are refused, and how well are the others balanced?

    python tests/benchmarks/kites_at_rest.py [--count N] [--seed S]

Tethers of 1 to 40 segments, 10 to 1000 m long, of 1e4 to 1e8 N, masses from 0.1 to 1000 kg, loads of up to three times the
weight in any direction, no wind in every third case and up to 30 m/s in the others, half of them with a profile. The search
begins anywhere within reach. Once without ground, once on a flat one somewhere below the winch. Wrong: forces, load, weight
and what the ground does that add up to more than 1e-9 of their size and 4 rounding errors of the last spring.
"""

import argparse
import warnings

import numpy as np

from tetherfmu import StepRefused, TetherDynamicFree

G, WINCH, SINK, FRICTION = 9.81, np.array((0.0, 0.0, 200.0)), 0.002, 0.5


def start(number, seed, with_ground):
    """Residual over what is allowed in a random case."""
    random = np.random.default_rng((seed, number))
    length, mass, n = 10.0 ** random.uniform(1.0, 3.0), 10.0 ** random.uniform(-1.0, 3.0), int(random.integers(1, 41))
    stiffness = 10.0 ** random.uniform(4.0, 8.0)
    load = random.uniform(0.0, 3.0) * mass * G * _direction(random)
    wind = (number % 3 > 0) * random.uniform(0.0, 30.0) * _direction(random) * (1.0, 1.0, 0.1)
    begin = WINCH + random.uniform(0.1, 1.1) * length * _direction(random)
    options = {"wind_profile": "logarithmic"} if number % 2 else {}
    height = WINCH[2] - random.uniform(0.1, 1.0) * length
    if with_ground:
        options |= {"ground_contact": "flat", "ground_height": height, "ground_sink": SINK, "ground_friction": FRICTION}
    kite = TetherDynamicFree(
        initial_length=length, segments=n, axial_stiffness=stiffness, kite_mass=mass, kite_start="equilibrium", **options
    )
    found = kite.initialize(begin, ground_position=WINCH, wind_velocity=wind, kite_load=load)
    total = found.kite_force + load - (0.0, 0.0, mass * G)
    depth = height - found.kite_position[2]
    if with_ground and depth > 0.0:
        pressure = (mass + found.kite_end_mass) * G * depth / SINK
        sideways = np.linalg.norm(total[:2])
        total[:2] *= max(0.0, 1.0 - FRICTION * pressure / max(sideways, 1e-300))
        total[2] += pressure
    rounding = 2.3e-16 * (np.linalg.norm(found.kite_position) + WINCH[2] + length / n) * stiffness * n / length
    size = np.linalg.norm(found.kite_force) + np.linalg.norm(load) + mass * G
    return np.linalg.norm(total) / (1e-9 * size + 4.0 * rounding)


def _direction(random):
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    for with_ground in (False, True):
        found, refused = {}, []
        for k in range(options.count):
            try:
                found[k] = start(k, options.seed, with_ground)
            except StepRefused:
                refused.append(k)
        wrong = [k for k, each in found.items() if not each <= 1.0]
        place = "on flat ground" if with_ground else "in the air"
        print(f"{options.count} kites {place}: {len(refused)} refused {refused}, {len(wrong)} wrong {wrong}")


if __name__ == "__main__":
    main()
