"""What do fixed steps cost in accuracy and time? Both methods and the adaptive solver, in random scenes; printed as tables.

    python tests/benchmarks/fixed_steps.py --scenes 300
    python tests/benchmarks/fixed_steps.py --scenes 30 --fixed-steps 20 10 5 2 1 0.5 --tolerances 1e-2 1e-3 1e-4 1e-5

The scenes of `tolerance.py`, 60 of each of its five families, for 20 s with communication steps of 20 ms, against the
adaptive solver with a tolerance of 1e-9. Error: root mean square of the difference of the forces at both ends over that of
the forces; of the largest force: of the largest magnitude at an end after a communication step. Time: of the processor, with
that of the outputs. Left: steps of order 2 that were taken anew by backward Euler. 300 scenes take some ten minutes of a
core.
"""

import argparse
from itertools import chain, cycle, islice
from time import process_time

import numpy as np
import pandas as pd
from tolerance import KINDS, REFERENCE, SEGMENTS, STEP, UNWARNED, catch_warnings, difference

from tetherfmu.results import StepRefused
from tetherfmu.study.measuring.tables import circumstances, markdown

METHODS = ("second_order", "backward_euler")


def solvers(fixed_steps, tolerances):
    """Options of all solvers by method and step [ms] or tolerance."""
    fixed = {
        (method, f"{h:g} ms"): {"fixed_step": 1e-3 * h, "fixed_step_method": method}
        for method in METHODS
        for h in fixed_steps
    }
    return fixed | {("adaptive", f"{each:g}"): {"relative_tolerance": each} for each in tolerances}


def flown(scene, segments, duration, **solver):
    """Forces at both ends [N] every `STEP`, array (rows, 6), seconds of the processor, and counters of the solver."""
    model, start, inputs = scene
    rows = inputs(STEP, duration)
    with catch_warnings(**UNWARNED):
        tether = model(segments=segments, **solver)
        tether.initialize(**start)
        began = process_time()
        flight = tether.fly(rows, STEP, peaks=False)
        seconds = process_time() - began
    return np.hstack([flight.ground_force, flight.kite_force]), seconds, tether.counters


def largest(forces):
    """Largest magnitude [N] of the force at an end."""
    return np.linalg.norm(forces.reshape(-1, 3), axis=1).max()


def measured(kind, number, seed, duration, of_solvers):
    """Rows of one scene, one for each of `solvers`; none if the scene is refused."""
    random = np.random.default_rng((seed, number))
    scene, n = KINDS[kind](random), int(random.choice(SEGMENTS))
    rows = []
    try:
        right, _, _ = flown(scene, n, duration, relative_tolerance=REFERENCE)
        for (method, step), solver in of_solvers.items():
            forces, seconds, counters = flown(scene, n, duration, **solver)
            each = {"scene": number, "kind": kind, "segments": n, "method": method, "step or tolerance": step}
            each |= {"error": difference(forces, right), "largest": abs(largest(forces) / largest(right) - 1.0)}
            each |= {"seconds": seconds, **{name: counters[name] for name in ("steps", "rejections", "iterations")}}
            rows.append(each)
    except StepRefused:
        return []
    return rows


def summary(found):
    """Quantiles of the errors and work per step of each solver."""
    rows = []
    for (method, step), group in found.groupby(["method", "step or tolerance"], sort=False):
        error, steps = 100.0 * group["error"], group["steps"].sum()
        rows.append(
            {
                "method": method,
                "step or tolerance": step,
                "scenes within 1 %": 100.0 * (error < 1.0).mean(),
                "error: median [%]": error.median(),
                "95 % [%]": error.quantile(0.95),
                "largest force: 95 % [%]": 100.0 * group["largest"].quantile(0.95),
                "time of a step [us]": 1e6 * group["seconds"].sum() / steps,
                "time of a scene [ms]": 1e3 * group["seconds"].mean(),
                "iterations per step": group["iterations"].sum() / steps,
                "left or rejected [%]": 100.0 * group["rejections"].sum() / steps,
            }
        )
    return pd.DataFrame(rows)


def by_segments(found):
    """Median of the error [%] and time of a step [us] of each solver, a pair of columns for each number of segments."""
    sums = found.groupby(["method", "step or tolerance", "segments"], sort=False)
    values = pd.DataFrame({"error": 100.0 * sums["error"].median(), "us": 1e6 * sums["seconds"].sum() / sums["steps"].sum()})
    table = values.unstack("segments").swaplevel(axis=1).sort_index(axis=1)
    table.columns = [f"{n} segments: {what}" for n, what in table.columns]
    return table.reset_index()


def main():
    """Fly the scenes and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fixed-steps", type=float, nargs="+", default=[5.0, 1.0], help="[ms]")
    parser.add_argument("--tolerances", type=float, nargs="+", default=[1e-4], help="of the adaptive solver")
    parser.add_argument("--duration", type=float, default=20.0, help="of a scene [s]")
    options = parser.parse_args()
    kinds, all_solvers = islice(cycle(KINDS), options.scenes), solvers(options.fixed_steps, options.tolerances)
    rows = (measured(kind, k, options.seed, options.duration, all_solvers) for k, kind in enumerate(kinds))
    found = pd.DataFrame(list(chain.from_iterable(rows)))
    print(f"{circumstances()}\n\n{found.scene.nunique()} of {options.scenes} scenes, the others refused\n")
    print(markdown(summary(found)))
    found["within"] = 100.0 * (found.error < 0.01)
    table = found.pivot_table(index="kind", columns=["method", "step or tolerance"], values="within", sort=False)
    table.columns = [" ".join(each) for each in table.columns]
    print(f"\nScenes of a kind within 1 % [%]\n\n{markdown(table.reset_index())}")
    print(f"\nBy segments: median of the error [%], time of a step [us]\n\n{markdown(by_segments(found))}")


if __name__ == "__main__":
    main()
