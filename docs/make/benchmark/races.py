"""Races at equal achieved error: each solver at a ladder of tolerances, errors against the exact motion; their diagram.

The table of a race (DataFrame) has a row for each run of a solver at a tolerance: scene, segments, solver, tolerance, error
(root mean square distance of the nodes from the exact motion [m]), seconds (of the whole run), and steps (internal, accepted
and rejected, where they are known).
"""

from math import ceil
from statistics import median
from time import perf_counter

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from pictures import save
from tetherfmu.console.colours import BLACK, COLOUR, REFERENCE

from .reference import error, exact
from .scenes import STEP, at_start

OURS, WHOLE, RESTARTED = "TetherDynamic", "CVODES, one call", "CVODES, restarted"
COMPILED = ", compiled C"
DEFAULT = 1e-4  # tolerance
LADDERS = (  # tolerances of our tether, of CVODES in one call, of CVODES restarted
    (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9),
    (1e-4, 1e-6, 1e-8, 1e-11),
)
QUICK_LADDERS = LADDERS[0][::2], LADDERS[1][::3], LADDERS[2][:1]
COLUMNS = 2  # of panels of the diagram
IN_C = {"linestyle": "--", "markerfacecolor": "white"}
STYLES = {
    OURS: {"color": COLOUR["dynamic"], "marker": "o", "linewidth": 2.0},
    WHOLE: {"color": REFERENCE, "marker": "s"},
    WHOLE + COMPILED: {"color": REFERENCE, "marker": "s", **IN_C},
    RESTARTED: {"color": BLACK, "marker": "^"},
    RESTARTED + COMPILED: {"color": BLACK, "marker": "^", **IN_C},
}
TITLES = {"circle": "Circle", "figure of eight": "Figure of eight", "release": "Released tether"}


def interleaved(jobs, repeats, statistic=median, clock=perf_counter, shortest=0.0):
    """Median (or another statistic of the) time [s] of each job; each runs once before, untimed.

    The jobs take turns: all see the same load of the machine.

    jobs : dict of functions without arguments.  clock : function that gives the time [s].  shortest : a job that takes less
    [s] runs several times in each turn, so that what it finds in the caches of the processor is its own.
    Returns dict of times and dict of what the untimed calls returned.
    """
    results = {name: job() for name, job in jobs.items()}
    times = {name: [] for name in jobs}
    for _ in range(repeats):
        for name, job in jobs.items():
            started, runs = clock(), 0
            while runs == 0 or clock() - started < shortest:
                job()
                runs += 1
            times[name].append((clock() - started) / runs)
    return {name: statistic(each) for name, each in times.items()}, results


def our_run(scene, step, tolerance, counters):
    """Our dynamic tether as a function that returns what `exact` returns.

    The internal steps of the last call are put into `counters` under the solver and the tolerance.
    """
    model = at_start(scene, tolerance)
    start, first = model.get_state(), model.positions[None]
    inputs, every = scene.inputs(step), round(scene.every / step)
    free = slice(1, None if scene.end_is_free else -1)

    def run():
        model.set_state(start)
        flown = model.fly(inputs, step, every, peaks=False)
        counters[OURS, tolerance] = model.counters["steps"] + model.counters["rejections"]
        return np.concatenate([first, flown.positions])[:, free].reshape(len(scene.times), -1)

    return run


def race(scene, peers, quick, compiled_too):
    """Table of all solvers in a scene.

    peers : the module `cvodes`, or None.  compiled_too : whether CVODES also gets its equations as compiled C.
    """
    step, counters = scene.every if scene.end_is_free else STEP, {}
    ours, whole, restarted = QUICK_LADDERS if quick else LADDERS
    jobs = {(OURS, tolerance): our_run(scene, step, tolerance, counters) for tolerance in ours}
    if peers:
        for suffix in ("", COMPILED) if peers.COMPILER and compiled_too else ("",):
            jobs |= {(WHOLE + suffix, each): peers.whole_run(scene, each, bool(suffix)) for each in whole}
            if not scene.end_is_free:
                jobs |= {(RESTARTED + suffix, each): peers.restarted_run(scene, each, bool(suffix)) for each in restarted}
    expected = exact(scene)
    times, results = interleaved(jobs, 1 if quick else 3)
    about = scene.name, scene.tether.segments
    rows = [(*about, *run, error(results[run], expected), seconds, counters.get(run)) for run, seconds in times.items()]
    columns = ("scene", "segments", "solver", "tolerance", "error", "seconds", "steps")
    return pd.DataFrame(rows, columns=columns).astype({"steps": "Int64"})


def seconds_at(runs, wanted):
    """Time of a solver for a wanted error, between its runs on logarithmic axes; nan if none is as exact.

    Runs that a more exact one beats in time are left out; the cheapest of the others also stands for larger errors.
    """
    runs = runs.sort_values(["error", "seconds"])
    front = runs[runs.seconds <= runs.seconds.cummin()]
    if not wanted >= front.error.iloc[0]:
        return np.nan
    return float(np.exp(np.interp(np.log(wanted), np.log(front.error), np.log(front.seconds))))


def equal_errors(runs):
    """Table of how many times faster our tether is at errors that it reaches; in flights, that of its default tolerance."""
    rows = []
    for (scene, n), mine in runs.groupby(["scene", "segments"], sort=False):
        ours, others = mine[mine.solver == OURS], mine[mine.solver != OURS]
        errors = [e for e in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6) if ours.error.min() <= e]
        if scene != "release":
            errors = [ours.error[(ours.tolerance - DEFAULT).abs().idxmin()]]
        for each in errors:
            for solver, theirs in others.groupby("solver", sort=False):
                rows.append((scene, n, each, OURS, solver, 1e3 * seconds_at(ours, each), 1e3 * seconds_at(theirs, each)))
    table = pd.DataFrame(rows, columns=("scene", "segments", "error m", "TetherFMU", "peer", "TetherFMU ms", "peer ms"))
    return table.assign(ratio=table["peer ms"] / table["TetherFMU ms"]).dropna()


def draw(runs, path):
    """Write the work-precision diagram of a table of races to an SVG file (Path): time against error, a panel per scene."""
    panels = list(runs.groupby(["scene", "segments"], sort=False))
    rows, handles = ceil(len(panels) / COLUMNS), {}
    figure = Figure(figsize=(5.2 * COLUMNS, 4.0 * rows + 0.4), layout="constrained")
    for place, ((scene, n), mine) in enumerate(panels, 1):
        axis = figure.add_subplot(rows, COLUMNS, place)
        for solver, theirs in mine.sort_values("tolerance").groupby("solver", sort=False):
            handles[solver] = axis.loglog(theirs.error, 1e3 * theirs.seconds, markersize=5, **STYLES[solver])[0]
        for each in mine[(mine.solver == OURS) & (mine.tolerance == DEFAULT)].itertuples():
            point = each.error, 1e3 * each.seconds
            axis.plot(*point, "o", markersize=11, markerfacecolor="none", markeredgecolor="black")
            axis.annotate("default", point, (8, -4), textcoords="offset points", va="top", fontsize=9)
        axis.set_title(f"{TITLES[scene]}, {n} segments", fontsize=11)
        axis.set(xlabel="error of the node positions, rms [m]", axisbelow=True)
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.yaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.grid(which="major", color="0.9")
        axis.margins(0.12)
        axis.invert_xaxis()
    figure.supylabel("time for the run [ms]", fontsize=10)
    shown = {solver: handles[solver] for solver in STYLES if solver in handles}
    figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    save(figure, path)
