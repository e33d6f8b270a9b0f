"""Figures of the page docs/how_much_tether.md."""

import csv

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt

from .scene_report import COLORS, NAMES, draw_points
from .thresholds import LEVELS, SWEEPS

LABELS = {
    "weight": "weight / tension",
    "drag": "drag / tension",
    "slack": "slack, length / distance - 1",
    "wave": "wave time times rate of the force",
}
SHOWN = ("0", "4", "11", "32")  # segments of the curves
LINES = {"0": "-", "4": ":", "11": "--", "32": "-"}
STRETCH = ("0.001", "0.0")  # of the curves: a middle one


def draw_scenes(results, names, path):
    """Small Pareto figures, one for each scene; `results` as `page.scene_tables` has them."""
    columns = 4
    rows = -(-len(results) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(12, 2.9 * rows), sharex=True, sharey=True, layout="constrained")
    for axis in axes.flat[len(results) :]:
        axis.set_visible(False)
    for axis, (scene, (reference, points, _)) in zip(axes.flat, results.items(), strict=False):
        draw_points(axis, points, names, 3)
        axis.axvspan(1e-4, 100.0 * reference.own_error(names), color="0.85", linewidth=0.0, label="error of the reference")
        axis.set_title(scene.name.replace("_", " "), fontsize=10)
        axis.set_xlim(200.0, 0.005)
        axis.tick_params(labelbottom=True)
    figure.supxlabel("error of the force on the kite [%]", fontsize=10)
    figure.supylabel("kernel time per simulated second [µs]", fontsize=10)
    legend = {"loc": "outside upper center", "ncols": 5, "frameon": False, "fontsize": 9, "markerscale": 3.0}
    figure.legend(*axes.flat[0].get_legend_handles_labels(), **legend)
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)


def sweep_curves():
    """Points of the sweeps that are shown: dict of (group, variant, segments) to lists of numbers and errors [%]."""
    found = {}
    with open(SWEEPS, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["segments"] in SHOWN and row["stretch"] in STRETCH and float(row["error"]) < 10.0:
                key = row["group"], row["variant"], row["segments"]
                x, y = found.setdefault(key, ([], []))
                x.append(float(row["value"]))
                y.append(max(100.0 * float(row["error"]), 1e-3))
    return found


def draw_sweeps(path):
    """Error over each number, one panel for each."""
    figure, axes = plt.subplots(1, len(LABELS), figsize=(12, 3.4), sharey=True, layout="constrained")
    curves, handles = sweep_curves(), {}
    for axis, (group, label) in zip(axes, LABELS.items(), strict=True):
        for (each, variant, segments), (x, y) in curves.items():
            if each == group:
                name = NAMES[variant] + (f", {segments} segments" if segments != "0" else "")
                (handles[name],) = axis.loglog(x, y, LINES[segments], color=COLORS[variant], linewidth=1.3)
        for level in LEVELS:
            axis.axhline(100.0 * level, color="0.8", linewidth=0.8, zorder=0)
        axis.set_xlabel(label + (" (stretch 0.001)" if group in ("weight", "drag") else ""), fontsize=9)
        axis.set_ylim(5e-3, 200.0)
    axes[0].set_ylabel("error of the force on the kite [%]", fontsize=9)
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=6, frameon=False, fontsize=9)
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)
