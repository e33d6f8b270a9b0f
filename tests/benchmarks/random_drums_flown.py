"""Random systems with winches by force, speed and length in fixed steps: how many are refused, how many are wrong?

    python tests/benchmarks/random_drums_flown.py [--count N] [--seed S]

Systems as in tests/random_drums.py: up to 12 points and 20 lines, half of them with drums, with and without mass, damping,
friction and stops.

equations   without air and damping, 20 steps of backward Euler of 2, 10 or 50 ms. Wrong: a number that is not finite, or a
            step that was not divided leaves more than 1e-5 of the largest force of the equations of its nodes and drums
second order  the same systems with steps of order 2. Wrong: not finite, or more iterations than solver_iteration_limit
accuracy    with air and damping, 0.5 s with steps of 5 and of 1 ms of order 2: forces on the points against the adaptive
            solver at 1e-6, root mean square, of the largest force
"""

import warnings
from collections import Counter

import numpy as np
from as_script import options, quantiles

from random_drums import left, random_drums, started, step
from solvers import fixed
from tetherfmu import Solver, StepRefused

WRONG = 1e-5
STEPS, SIZES = 20, (0.002, 0.01, 0.05)
FLIGHT, STEP = 25, 0.02


def equations(rng):
    """Whether it is right, and the parts of the equations that were left."""
    network, told = random_drums(rng)
    h = float(rng.choice(SIZES))
    system = started(network, told, fixed(h, "backward_euler"))
    found = [max(each) for each in (left(network, told, system, k, h) for k in range(STEPS)) if each is not None]
    return is_finite(system) and max(found, default=0.0) <= WRONG, found


def second_order(rng):
    """Whether it is right, and the iterations of all steps."""
    network, told = random_drums(rng)
    h = float(rng.choice(SIZES))
    system = started(network, told, fixed(h, "second_order"))
    found = []
    for k in range(STEPS):
        before = system.counters["iterations"]
        outputs = step(network, told, system, k, h)
        found.append(system.counters["iterations"] - before)
    return is_finite(system) and max(found) <= outputs.solver_iteration_limit, found


def accuracy(rng):
    """Whether all is finite, and the errors of the forces with both steps."""
    network, told = random_drums(rng, bare=False)
    solvers = Solver(relative_tolerance=1e-6), fixed(0.005, "second_order"), fixed(0.001, "second_order")
    forces = [flight(network, told, solver) for solver in solvers]
    largest = np.abs(forces[0]).max()
    return np.isfinite(forces).all(), [np.sqrt(np.mean((each - forces[0]) ** 2)) / largest for each in forces[1:]]


def flight(network, told, solver):
    """Forces on all points [N] after each communication step."""
    system = started(network, told, solver)
    rows = [step(network, told, system, k, STEP) for k in range(FLIGHT)]
    return np.array([[point.force for point in row.points.values()] for row in rows])


def is_finite(system):
    """Whether all positions and velocities are finite."""
    return all(np.isfinite(each).all() for each in (*system.positions.values(), *system.velocities.values()))


def main():
    given = options(__doc__, count=2000, seed=1)
    warnings.simplefilter("ignore")
    for study in (equations, second_order, accuracy):
        refused, wrong, found = Counter(), [], []
        for k in range(given.count):
            try:
                is_right, numbers = study(np.random.default_rng((given.seed, k)))
                found.append(numbers)
                wrong += [] if is_right else [k]
            except StepRefused as problem:
                refused[str(problem)[:90]] += 1
        print(f"{study.__name__}: {given.count} systems, {sum(refused.values())} refused, {len(wrong)} wrong {wrong}")
        for problem, count in refused.most_common():
            print(f"  {count} x {problem}")
        columns = np.array(found).T if study is accuracy else [np.concatenate(found)]
        for column in columns:
            within = f"within 0.01: {np.mean(np.less(column, 0.01)):.3f}"
            print(f"  median, 90 %, 99 %, largest {quantiles(column)}; {within}", flush=True)


if __name__ == "__main__":
    main()
