"""Figures of the page: cost against error of several scenes, error over each dimensionless number, the decision chart."""

from math import ceil

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pictures import save
from tetherfmu.console.colours import COLOUR
from tetherfmu.runtime.variants import class_name
from tetherfmu.study.advice.reasons import LEVELS, TABLE
from tetherfmu.study.advice.scene_figures import draw_points
from tetherfmu.study.measuring.errors import FINER

from .thresholds import SWEEPS

LABELS = {
    "weight": "weight / tension (stretch 0.001)",
    "drag": "drag / tension (stretch 0.001)",
    "slack": "slack, length / distance - 1",
    "wave": "wave time times rate of the force",
}
LINES = {0: "-", 4: ":", 11: "--", 32: "-"}  # by the segments of the curves that are shown
STRETCHES = (0.001, 0.0)  # of the curves that are shown: a middle one
CHART_LEVEL = 0.01  # error for which the decision chart is drawn
COLUMNS, LETTERS = 2, 12  # of small figures, and their font size [pt]: wide letters, because pages show figures smaller
PALE = ("straight", "dynamic_free")  # white letters are hard to read on their colours
NEARLY_BLACK = "#181008"  # of letters that are dark on a dark theme, too


def draw_scenes(results, names, path):
    """Small Pareto figures, one for each scene; `results` as `page.page` has them."""
    rows, axis = ceil(len(results) / COLUMNS), None
    figure = Figure(figsize=(8.6, 3.0 * rows + 1.0), layout="constrained")
    for place, (scene, (reference, points, _)) in enumerate(results.items()):
        axis = figure.add_subplot(rows, COLUMNS, place + 1, sharex=axis, sharey=axis)
        draw_points(axis, points, 4)
        own = 100.0 * FINER * reference.own_error(names)
        axis.axvspan(1e-4, own, color="0.85", linewidth=0.0, label="reference not ten times finer")
        axis.set_title(scene.name.replace("_", " "), fontsize=LETTERS + 1)
        axis.set_xlim(200.0, 0.005)
        axis.tick_params(labelleft=place % COLUMNS == 0, labelsize=LETTERS)
    figure.supxlabel("error of the force on the kite [%]", fontsize=LETTERS + 1)
    figure.supylabel("kernel time per simulated second [µs]", fontsize=LETTERS + 1)
    legend = {"loc": "outside upper center", "ncols": 3, "frameon": False, "fontsize": LETTERS, "markerscale": 3.0}
    figure.legend(*axis.get_legend_handles_labels(), **legend)
    save(figure, path)


def draw_sweeps(path):
    """Error over each number, one panel for each."""
    figure = Figure(figsize=(8.6, 7.4), layout="constrained")
    axes, handles, points = figure.subplots(2, COLUMNS, sharey=True).ravel(), {}, pd.read_csv(SWEEPS)
    shown = points[points.segments.isin(LINES) & points.stretch.isin(STRETCHES) & (points.error < 10.0)]
    for axis, (group, label) in zip(axes, LABELS.items(), strict=True):
        for (variant, segments), curve in shown[shown.group == group].groupby(["variant", "segments"], sort=False):
            name = variant.replace("_", "-") + (f", {segments} segments" if segments else "")
            style = {"color": COLOUR[variant], "linestyle": LINES[segments], "linewidth": 1.3}
            (handles[name],) = axis.loglog(curve.value, 100.0 * curve.error, **style)
        axis.axhline(100.0 * CHART_LEVEL, color="0.2", linestyle="-.", linewidth=1.6, zorder=0)
        place = {"xycoords": ("axes fraction", "data"), "xytext": (3, 3), "textcoords": "offset points"}
        axis.annotate(f"{100.0 * CHART_LEVEL:g} %", (0.0, 100.0 * CHART_LEVEL), fontsize=LETTERS, **place)
        axis.set_xlabel(label, fontsize=LETTERS)
        axis.tick_params(labelsize=LETTERS)
        axis.grid(alpha=0.25)
        axis.set_ylim(100.0 * LEVELS[0], 200.0)  # what the references are fine enough for
    figure.supylabel("error of the force on the kite [%]", fontsize=LETTERS)
    legend = {"loc": "outside lower center", "ncols": COLUMNS, "frameon": False, "fontsize": LETTERS}
    figure.legend(handles.values(), handles.keys(), **legend)
    save(figure, path)


def questions():
    """The decision chart: (question, answer that leaves it, variant that it leaves to), and the variant at its end."""
    table = pd.read_csv(TABLE)
    rows = table[np.isclose(table.level, CHART_LEVEL) & table.stretch.isin(STRETCHES) & table.segments.isin((0, 32))]
    most = rows.set_index(["group", "variant"]).value  # number up to which a tether is enough
    loads, wave = min(most["weight", "straight"], most["drag", "straight"]), most["wave", "catenary"]
    return (
        ("Is the far end a mass that moves freely,\nsuch as a kite, drone or crane load?", "yes", "dynamic_free"),
        (f"Is the tether pulled taut, with weight and\ndrag below {100 * loads:.1f} % of the tension?", "yes", "straight"),
        (f"Does its force F change slowly:\nwave_time · rms(dF/dt) / rms(F) < {wave:.2g}?", "no", "dynamic"),
        (f"Is the drag more than {100 * most['drag', 'catenary']:.0f} % of the tension?", "yes", "quasi_steady"),
    ), "catenary"


def draw_chart(path):
    """The decision chart: questions from the top, answers below them to the right, narrow enough to be read on a phone."""
    asked, last = questions()
    figure = Figure(figsize=(4.4, 1.5 * len(asked) + 0.5), layout="constrained")
    axis = figure.subplots()
    style = {"ha": "center", "va": "center", "fontsize": 11}
    arrow = {"arrowstyle": "-|>", "color": "0.3", "lw": 1.3}
    way = arrow | {"connectionstyle": "angle,angleA=-90,angleB=180"}
    for row, (question, leaves, variant) in enumerate(asked):
        stays = "no" if leaves == "yes" else "yes"
        lines = asked[row + 1][0].count("\n") + 1 if row + 1 < len(asked) else 1  # in the next box, which the arrow ends at
        axis.annotate("", (0.16, -row - 0.94 + 0.065 * lines), (0.16, -row), arrowprops=arrow)
        axis.text(0.145, -row - 0.52, stays, ha="right", va="center", fontsize=11)
        axis.annotate("", (0.5, -row - 0.5), (0.36, -row), arrowprops=way)
        axis.text(0.345, -row - 0.4, leaves, ha="right", va="center", fontsize=11)
        axis.text(0.5, -row, question, bbox={"boxstyle": "round,pad=0.6", "fc": "0.95", "ec": "0.5"}, **style)
        draw_answer(axis, 0.54, -row - 0.5, variant)
    draw_answer(axis, 0.05, -len(asked), last)
    axis.set(xlim=(0.0, 1.0), ylim=(-len(asked) - 0.2, 0.3))
    axis.axis("off")
    save(figure, path)


def draw_answer(axis, x, y, variant):
    """A box with the name of the FMU of a variant, which begins at x."""
    box = {"boxstyle": "round,pad=0.6", "fc": COLOUR[variant], "ec": "none"}
    letters = NEARLY_BLACK if variant in PALE else "white"
    axis.text(x, y, class_name(variant), color=letters, weight="bold", fontsize=12, ha="left", va="center", bbox=box)
