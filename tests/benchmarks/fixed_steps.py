"""What do fixed steps cost in accuracy and time? Both methods and the adaptive solver, in random scenes; printed as tables.

    python tests/benchmarks/fixed_steps.py --scenes 300
    python tests/benchmarks/fixed_steps.py --scenes 300 --winch force
    python tests/benchmarks/fixed_steps.py --scenes 50 --fixed-steps 20 10 5 2 1 0.5 --tolerances 1e-2 1e-3 1e-4 1e-5 \
        --figure fixed_steps.png

The scenes of `tolerance.py`, 60 of each of its five families, for 20 s with communication steps of 20 ms, against the
adaptive solver with a tolerance of 1e-9. Error: root mean square of the difference of the forces at both ends over that of
the forces; of the largest force: of the largest magnitude at an end after a communication step. Time: of the processor, with
that of the outputs. Left: steps of order 2 that were taken anew by backward Euler. 300 scenes take some ten minutes of a
core.

With `--winch force` the winch of each scene is told a force that swings by 30 % around the tension at the start. Its drum
has no mass in half of the scenes, else 5 to 500 kg; friction in half; and at 2 to 10 m/s its damper makes up for that force.
"""

from itertools import chain, cycle, islice
from time import process_time

import numpy as np
import pandas as pd
from as_script import options
from matplotlib.figure import Figure
from tolerance import KINDS, REFERENCE, SEGMENTS, STEP, UNWARNED, catch_warnings, difference

from tetherfmu.console.colours import BLUE, ORANGE, VERMILLION
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring.tables import circumstances, markdown

METHODS = ("second_order", "backward_euler")
STYLES = {"second_order": (VERMILLION, "o"), "backward_euler": (ORANGE, "s"), "adaptive": (BLUE, "^")}
SWING = 0.3  # of the force of a winch


def solvers(fixed_steps, tolerances):
    """Options of all solvers by method and step [ms] or tolerance."""
    fixed = {
        (method, f"{h:g} ms"): {"fixed_step": 1e-3 * h, "fixed_step_method": method}
        for method in METHODS
        for h in fixed_steps
    }
    return fixed | {("adaptive", f"{each:g}"): {"relative_tolerance": each} for each in tolerances}


def by_force(scene, segments, random):
    """The same scene with a winch that is told a force."""
    model, start, inputs = scene
    with catch_warnings(**UNWARNED):
        pull = max(1.0, model(segments=segments).initialize(**start).ground_tension)
    drum = {"winch_control": "force", "winch_mass": random.choice((0.0, 10.0 ** random.uniform(0.7, 2.7)))}
    drum |= {"winch_damping": pull / random.uniform(2.0, 10.0), "winch_friction": random.choice((0.0, 0.02 * pull))}
    rate = random.uniform(0.5, 3.0)

    def told(step, duration):
        rows = inputs(step, duration)
        rows[:, at.WINCH_FORCE] = pull * (1.0 + SWING * np.sin(rate * step * np.arange(len(rows))))
        return rows

    return lambda **solver: model(**drum, **solver), start, told


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


def measured(kind, number, given, of_solvers):
    """Rows of one scene, one for each of `solvers`; none if the scene is refused."""
    random = np.random.default_rng((given.seed, number))
    scene, n = KINDS[kind](random), int(random.choice(SEGMENTS))
    rows = []
    try:
        scene = by_force(scene, n, random) if given.winch == "force" else scene
        right, _, _ = flown(scene, n, given.duration, relative_tolerance=REFERENCE)
    except StepRefused:
        return []
    for (method, step), solver in of_solvers.items():
        each = {"scene": number, "kind": kind, "segments": n, "method": method, "step or tolerance": step}
        try:
            forces, seconds, counters = flown(scene, n, given.duration, **solver)
            each |= {"error": difference(forces, right), "largest": abs(largest(forces) / largest(right) - 1.0)}
            each |= {"seconds": seconds, **{name: counters[name] for name in ("steps", "rejections", "iterations")}}
        except StepRefused:
            each |= {"error": np.inf, "largest": np.inf, "refused": 1}
        rows.append(each)
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
                "refused": group["refused"].sum(),
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


def draw(table, path):
    """Work-precision lines: both errors of `summary` over the time of a scene."""
    figure = Figure(figsize=(8.0, 3.8), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    for axis, column in zip(panels, ("error: median [%]", "largest force: 95 % [%]"), strict=True):
        for method, lines in table.groupby("method", sort=False):
            colour, marker = STYLES[method]
            axis.loglog(lines["time of a scene [ms]"], lines[column], color=colour, marker=marker, label=method)
            for k, (_, line) in enumerate(lines.iterrows()):
                place = (line["time of a scene [ms]"], line[column])
                style = {"textcoords": "offset points", "fontsize": 7, "color": colour}
                if method == "adaptive":  # close together: to both sides
                    style["ha"] = ("right", "left")[k % 2]
                axis.annotate(line["step or tolerance"], place, (-5, 2) if style.get("ha") == "right" else (5, 3), **style)
        axis.set(xlabel="processor time of a scene of 20 s [ms]", ylabel=column)
        axis.margins(x=0.2)
        axis.grid(alpha=0.3)
    panels[0].legend(frameon=False)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def main():
    """Fly the scenes, print the tables and draw the figure."""
    steps = {"fixed_steps": [5.0, 1.0], "tolerances": [1e-4]}  # [ms], of the adaptive solver
    given = options(__doc__, scenes=300, seed=1, duration=20.0, winch=("speed", "force"), figure="", **steps)
    kinds, all_solvers = islice(cycle(KINDS), given.scenes), solvers(given.fixed_steps, given.tolerances)
    rows = (measured(kind, k, given, all_solvers) for k, kind in enumerate(kinds))
    found = pd.DataFrame(list(chain.from_iterable(rows)), columns=COLUMNS)
    print(f"{circumstances()}\n\n{found.scene.nunique()} of {given.scenes} scenes, the others refused\n")
    print(markdown(summary(found)))
    found["within"] = 100.0 * (found.error < 0.01)
    table = found.pivot_table(index="kind", columns=["method", "step or tolerance"], values="within", sort=False)
    table.columns = [" ".join(each) for each in table.columns]
    print(f"\nScenes of a kind within 1 % [%]\n\n{markdown(table.reset_index())}")
    print(f"\nBy segments: median of the error [%], time of a step [us]\n\n{markdown(by_segments(found))}")
    if given.figure:
        draw(summary(found), given.figure)


COLUMNS = [
    *("scene", "kind", "segments", "method", "step or tolerance", "error", "largest"),
    *("seconds", "steps", "rejections", "iterations", "refused"),
]

if __name__ == "__main__":
    main()
