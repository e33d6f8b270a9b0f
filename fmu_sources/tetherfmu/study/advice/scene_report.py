"""The report of a scene: CSV of all points, Pareto figure, one page in Markdown and HTML."""

from pathlib import Path

import pandas as pd
from markdown import markdown

from tetherfmu.files.scene_files import OUTPUTS, flown_from, load_for_advice
from tetherfmu.study.measuring.errors import worst
from tetherfmu.study.measuring.executors import executor_of
from tetherfmu.study.measuring.runs import Config
from tetherfmu.study.measuring.store import POINTS, Store, keeping
from tetherfmu.study.measuring.tables import page

from .configurations import LEVELS, cheapest, study
from .scene_figures import draw, draw_wind

COLUMNS = [*Config._fields, *OUTPUTS, "calls", "work", "seconds", "cost", "host_cost", "refused"]  # of points.csv
HEADS = {"step": "step_s", "seconds": "kernel_s_per_s", "cost": "cost_s_per_s", "host_cost": "with_fmpy_estimated_s_per_s"}


def write_csv(points, reference, path):
    """All points; errors that are smaller than ten times the reference's own are not known better than that."""
    own = {name: reference.space[name] + reference.time[name] for name in OUTPUTS}
    work = {"calls": reference.run.calls, "work": reference.run.work, "refused": "reference: bounds of its own errors"}
    table = pd.concat([pd.DataFrame([reference.config._asdict() | own | work]), points])[COLUMNS].rename(columns=HEADS)
    table.to_csv(path, index=False, float_format="%.3g", lineterminator="\r\n")


def body(text):
    """HTML from Markdown."""
    return markdown(text, extensions=["tables", "fenced_code"])


def html(title, text):
    """A page of HTML from Markdown."""
    return page("advice/scene.html.j2", title=title, body=body(text))


def write(scene, reference, points, best, folder):
    """Write points.csv, figures, report.md and report.html to a folder (Path); returns the page as Markdown.

    best : maps levels of error to the cheapest points.
    """
    write_csv(points, reference, folder / "points.csv")
    draw(points, reference.own_error(scene.wanted.outputs), scene, folder / "pareto.png")
    if scene.wind_points:
        draw_wind(scene, folder / "wind.png")
    most_exact = {variant: mine.loc[mine.error.idxmin()] for variant, mine in points.groupby("variant", sort=False)}
    facts = {"scene": scene, "reference": reference, "worst": worst, "most_exact": most_exact}
    text = page("advice/scene.md.j2", cheapest=best, **facts)
    (folder / "report.md").write_text(text, encoding="utf-8")
    (folder / "report.html").write_text(html(scene.name, text), encoding="utf-8")
    return text


def run(options):
    """Study the scene of a file, write and print the report."""
    scene = load_for_advice(options.scene, options.settings)
    store = Store((options.out or Path("study") / scene.name) / POINTS)
    with flown_from(options.scene), keeping(), executor_of(options.dask, options.processes) as executor:
        reference, points = study(scene, store, executor)
    best = {level: cheapest(points, level) for level in sorted({*LEVELS, scene.wanted.allowed_error}, reverse=True)}
    print(write(scene, reference, points, best, store.folder))
