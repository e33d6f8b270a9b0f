"""Figures: cost against error of a scene or of several, and the error over each dimensionless number."""

import numpy as np
from matplotlib.figure import Figure

from tetherfmu.runtime.variants import VARIANTS

from .thresholds import LEVELS as THRESHOLD_LEVELS
from .thresholds import SWEEPS, read
from .tradeoff import LEVELS, front

COLORS = dict(zip(VARIANTS, ("C7", "C2", "C1", "C0"), strict=True))
LABELS = {
    "weight": "weight / tension (stretch 0.001)",
    "drag": "drag / tension (stretch 0.001)",
    "slack": "slack, length / distance - 1",
    "wave": "wave time times rate of the force",
}
LINES = {0: "-", 4: ":", 11: "--", 32: "-"}  # by the segments of the curves that are shown
STRETCHES = (0.001, 0.0)  # of the curves that are shown: a middle one
COLUMNS = 4  # of small figures


def draw_points(axis, points, size):
    """Cost against error of all points, a color for each variant, and their front as a line; returns the front."""
    for variant in VARIANTS:
        mine = points[(points.variant == variant) & np.isfinite(points.error)]
        style = {"color": COLORS[variant], "markersize": size, "alpha": 0.6, "label": variant.replace("_", "-")}
        axis.loglog(100.0 * mine.error, 1e6 * mine.cost, ".", **style)
    best = front(points)
    axis.step(100.0 * best.error, 1e6 * best.cost, "k-", where="post", linewidth=1.0)
    return best


def draw(points, own_error, scene, path):
    """The Pareto figure: cost against error, the front as a line, the reference's own error as a grey band."""
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axis = figure.subplots()
    best = draw_points(axis, points, 5)
    left = 100.0 * min(0.5 * own_error, best.error.min())
    axis.axvspan(left, 100.0 * own_error, color="0.85", linewidth=0.0, label="reference's own error")
    for level in LEVELS:
        axis.axvline(100.0 * level, color="0.8", linewidth=0.8, zorder=0)
    axis.invert_xaxis()
    names = ", ".join(scene.wanted.outputs)
    axis.set(xlabel=f"error of {names} [%]", ylabel="kernel time per simulated second [µs]", title=scene.name)
    axis.legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=100, metadata={"Software": None})


def draw_scenes(results, names, path):
    """Small Pareto figures, one for each scene; `results` as `page.page` has them."""
    rows = -(-len(results) // COLUMNS)
    figure = Figure(figsize=(12, 2.9 * rows), layout="constrained")
    axes = figure.subplots(rows, COLUMNS, sharex=True, sharey=True).flat
    for axis in axes[len(results) :]:
        axis.set_visible(False)
    for axis, (scene, (reference, points, _)) in zip(axes, results.items(), strict=False):
        draw_points(axis, points, 3)
        axis.axvspan(1e-4, 100.0 * reference.own_error(names), color="0.85", linewidth=0.0, label="error of the reference")
        axis.set_title(scene.name.replace("_", " "), fontsize=10)
        axis.set_xlim(200.0, 0.005)
        axis.tick_params(labelbottom=True)
    figure.supxlabel("error of the force on the kite [%]", fontsize=10)
    figure.supylabel("kernel time per simulated second [µs]", fontsize=10)
    legend = {"loc": "outside upper center", "ncols": 5, "frameon": False, "fontsize": 9, "markerscale": 3.0}
    figure.legend(*axes[0].get_legend_handles_labels(), **legend)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def draw_sweeps(path):
    """Error over each number, one panel for each."""
    figure = Figure(figsize=(12, 3.4), layout="constrained")
    axes, handles, points = figure.subplots(1, len(LABELS), sharey=True), {}, read(SWEEPS)
    shown = points[points.segments.isin(LINES) & points.stretch.isin(STRETCHES) & (points.error < 10.0)]
    for axis, (group, label) in zip(axes, LABELS.items(), strict=True):
        for (variant, segments), curve in shown[shown.group == group].groupby(["variant", "segments"], sort=False):
            name = variant.replace("_", "-") + (f", {segments} segments" if segments else "")
            style = {"color": COLORS[variant], "linestyle": LINES[segments], "linewidth": 1.3}
            (handles[name],) = axis.loglog(curve.value, (100.0 * curve.error).clip(lower=1e-3), **style)
        for level in THRESHOLD_LEVELS:
            axis.axhline(100.0 * level, color="0.8", linewidth=0.8, zorder=0)
        axis.set_xlabel(label, fontsize=9)
        axis.set_ylim(5e-3, 200.0)
    axes[0].set_ylabel("error of the force on the kite [%]", fontsize=9)
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=6, frameon=False, fontsize=9)
    figure.savefig(path, dpi=90, metadata={"Software": None})
