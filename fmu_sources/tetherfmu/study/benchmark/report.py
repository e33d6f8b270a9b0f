"""The command `python -m tetherfmu.study benchmark`: what the tethers cost, as a page, a CSV file and a diagram."""

import importlib
import os
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.console.progress import now
from tetherfmu.study.measuring.executors import progress_bar
from tetherfmu.study.measuring.tables import circumstances, page
from tetherfmu.study.measuring.through_fmpy import fmus_in, measured
from tetherfmu.study.scenes.standard import circle_scene, figure_of_eight_scene, release_scene

from .kernels import kernel_table
from .races import draw, equal_errors, race

QUICK_KERNELS = {"segments": (6, 20), "steps": 100, "repeats": 2}


def peer(module, package):
    """A module of this package that needs a peer, or None, said in one line."""
    try:
        return importlib.import_module(f"{__package__}.{module}")
    except ModuleNotFoundError:
        print(f"{package} is not installed: its rows are left out (pip install {package})")
        return None


def host_table(paths, quick):
    """Cost of the FMUs in FMPy, and their start-up time: the least of all rounds, in which they take turns."""
    steps, rounds = (100, 1) if quick else (3000, 5)
    found = [{name: measured(path, steps, 1) for name, path in paths.items()} for _ in range(rounds)]
    rows = []
    for name in paths:
        start, *costs = np.min([each[name] for each in found], axis=0)
        rows.append((name, *(1e6 * cost for cost in costs), 1e6 * sum(costs), 1e3 * start))
    return pd.DataFrame(rows, columns=("FMU", "set us", "step us", "get us", "together us", "start ms"))


def scenes(quick, flights):
    """The scenes of the races."""
    if quick and not flights:
        return [circle_scene(20, 2.0), figure_of_eight_scene(20, 1.0), release_scene(10, 0.5)]
    releases = [] if flights else [release_scene(10), release_scene(40)]
    return [circle_scene(20), figure_of_eight_scene(20), *releases]


def write(tables, folder, figure, slopes):
    """Write measurements/benchmarks.md and data/benchmarks.csv in a folder (Path); returns the page."""
    pages, data = folder / "measurements", folder / "data"
    for each in (pages, data):
        each.mkdir(parents=True, exist_ok=True)
    figure = Path(os.path.relpath(figure, pages)).as_posix() if figure else None
    text = page("benchmark/page.md.j2", tables=tables, figure=figure, slopes=slopes)
    (pages / "benchmarks.md").write_text(text, encoding="utf-8")
    with open(data / "benchmarks.csv", "w", newline="", encoding="utf-8") as file:
        pd.DataFrame(columns=["circumstances", circumstances()]).to_csv(file, index=False)
        for title, table in tables.items():
            table.set_axis([title] * len(table)).to_csv(file, index_label="table")
    return text


def run(options):
    """Measure, print and store."""
    tables, quick, flights = {}, options.quick, options.flights
    cvodes = None if options.no_peers else peer("cvodes", "casadi")
    moordyn = None if options.no_peers or flights else peer("moordyn_line", "moordyn")
    with tempfile.TemporaryDirectory() as temporary:
        paths = fmus_in(options.fmus or temporary)
        if not flights:
            now("measuring kernels and FMUs")
            tables["Kernels"] = kernel_table(**(QUICK_KERNELS if quick else {}))
            tables["FMUs in FMPy"] = host_table(paths, quick)
        raced = scenes(quick, flights)
        compiled = not (quick or flights)
        runs = pd.concat([race(scene, cvodes, quick, compiled) for scene in progress_bar(raced, len(raced), "races")])
        shown = {"error": "error m", "seconds": "ms", "steps": "internal steps"}
        tables["Work and precision"] = runs.assign(seconds=1e3 * runs.seconds).rename(columns=shown)
        if cvodes:
            tables["At equal error"] = equal_errors(runs)
        if moordyn:
            now("racing MoorDyn")
            tables["MoorDyn"] = moordyn.moordyn_table(quick)
    if options.figure:
        draw(runs, options.figure)
    slopes = max(cvodes.largest_difference(scene) for scene in raced) if cvodes else None
    print(write(tables, options.out, options.figure, slopes))
