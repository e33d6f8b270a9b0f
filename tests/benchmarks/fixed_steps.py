"""What do fixed steps cost in accuracy and time? Both methods and the adaptive solver, in random scenes; printed as tables.

    python tests/benchmarks/fixed_steps.py --scenes 300

The scenes of `tolerance.py`, 60 of each of its five families, for 20 s with communication steps of 20 ms, against the
adaptive solver with a tolerance of 1e-9. Error: root mean square of the difference of the forces at both ends over that of
the forces; of the largest force: of the largest magnitude at an end after a communication step. Time: of the processor, with
that of the outputs. Left: steps of order 2 that were taken anew by backward Euler. 300 scenes take some ten minutes of a
core.
"""

import argparse
from itertools import cycle, islice
from time import process_time

import numpy as np
import pandas as pd
from tolerance import KINDS, REFERENCE, SEGMENTS, STEP, UNWARNED, catch_warnings, difference

from tetherfmu.results import StepRefused
from tetherfmu.study.measuring.tables import circumstances, markdown

FIXED_STEPS = (5e-3, 1e-3)  # [s]
METHODS = ("second_order", "backward_euler")
SOLVERS = {
    **{
        (method, f"{1e3 * h:g} ms"): {"fixed_step": h, "fixed_step_method": method}
        for h in FIXED_STEPS
        for method in METHODS
    },
    ("adaptive", "1e-4"): {},
}


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


def measured(kind, number, seed, duration):
    """Rows of one scene, one for each solver; none if the scene is refused."""
    random = np.random.default_rng((seed, number))
    scene, n = KINDS[kind](random), int(random.choice(SEGMENTS))
    rows = []
    try:
        right, _, _ = flown(scene, n, duration, relative_tolerance=REFERENCE)
        for (method, step), solver in SOLVERS.items():
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


def main():
    """Fly the scenes and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--duration", type=float, default=20.0, help="of a scene [s]")
    options = parser.parse_args()
    kinds = islice(cycle(KINDS), options.scenes)
    found = pd.DataFrame(
        [row for number, kind in enumerate(kinds) for row in measured(kind, number, options.seed, options.duration)]
    )
    print(f"{circumstances()}\n\n{found.scene.nunique()} of {options.scenes} scenes, the others refused\n")
    print(markdown(summary(found)))
    found["within"] = 100.0 * (found.error < 0.01)
    table = found.pivot_table(index="kind", columns=["method", "step or tolerance"], values="within", sort=False)
    table.columns = [" ".join(each) for each in table.columns]
    print(f"\nScenes of a kind within 1 % [%]\n\n{markdown(table.reset_index())}")


if __name__ == "__main__":
    main()
