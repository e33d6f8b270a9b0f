"""What the tethers cost, as a page, a CSV file and a diagram."""

import importlib
import os
import tempfile
from pathlib import Path

import pandas as pd

from tetherfmu.console.progress import now
from tetherfmu.study.measuring.executors import progress_bar
from tetherfmu.study.measuring.scene_fmus import fmus_in
from tetherfmu.study.measuring.tables import circumstances, page

from .in_fmpy import host_table
from .kernels import kernel_table
from .races import draw, equal_errors, race
from .scenes import circle_scene, figure_of_eight_scene, release_scene

HERE = Path(__file__).parent
SAME_EQUATIONS = 1e-13  # difference of dy/dt by rounding, relative
QUICK_KERNELS = {"segments": (6, 20), "steps": 100, "repeats": 2}


def peer(module, package):
    """A module of this package that needs a peer, or None, said in one line."""
    try:
        return importlib.import_module(f"{__package__}.{module}")
    except ModuleNotFoundError:
        print(f"{package} is not installed: its rows are left out (pip install {package})")
        return None


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
    text = page("page.md.j2", HERE, tables=tables, figure=figure, slopes=slopes)
    (pages / "benchmarks.md").write_text(text, encoding="utf-8")
    with open(data / "benchmarks.csv", "w", newline="", encoding="utf-8") as file:
        pd.DataFrame(columns=["circumstances", circumstances()]).to_csv(file, index=False)
        for title, table in tables.items():
            table.set_axis([title] * len(table)).to_csv(file, index_label="table")
    return text


def run(options):
    """Measure, print and store; options : of `make_benchmarks.py`."""
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
        slopes = max(cvodes.largest_difference(scene) for scene in raced) if cvodes else None
        if cvodes and slopes > SAME_EQUATIONS:
            raise RuntimeError(f"dy/dt of the peer differs by {slopes:.1e} of the largest; it must have the same equations")
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
    print(write(tables, options.out, options.figure, slopes))
