"""Figures: cost against error of a scene, and its wind."""

import numpy as np
from matplotlib.figure import Figure

from tetherfmu.console.colours import BLUE, COLOUR, VERMILLION
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.measuring.errors import FINER

from .configurations import LEVELS, front


def draw_points(axis, points, size):
    """Cost against error of all points, a colour for each variant, and their front as a line; returns the front."""
    for variant in VARIANTS:
        mine = points[(points.variant == variant) & np.isfinite(points.error)]
        style = {"color": COLOUR[variant], "markersize": size, "alpha": 0.6, "label": variant.replace("_", "-")}
        axis.loglog(100.0 * mine.error, 1e6 * mine.cost, ".", **style)
    best = front(points)
    axis.step(100.0 * best.error, 1e6 * best.cost, "k-", where="post", linewidth=1.0)
    return best


def draw(points, own_error, scene, path):
    """The Pareto figure: cost against error, the front as a line, grey where the reference is not ten times finer."""
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axis = figure.subplots()
    best = draw_points(axis, points, 5)
    left, right = 100.0 * min(0.5 * own_error, best.error.min()), 100.0 * FINER * own_error
    axis.axvspan(left, right, color="0.85", linewidth=0.0, label="reference not ten times finer")
    for level in LEVELS:
        axis.axvline(100.0 * level, color="0.8", linewidth=0.8, zorder=0)
    axis.invert_xaxis()
    names = ", ".join(scene.wanted.outputs)
    axis.set(xlabel=f"error of {names} [%]", ylabel="kernel time per simulated second [µs]", title=scene.name)
    axis.legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=100, metadata={"Software": None})


def draw_wind(scene, path):
    """Wind of a box over time: speed at the kite, mean along the tether, and between its slowest and fastest point."""
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    axis, wind = figure.subplots(), scene.wind_at(scene.every)
    speed, mean = np.linalg.norm(wind, axis=2), np.linalg.norm(np.trapezoid(wind, axis=1), axis=1) / (scene.wind_points - 1)
    time = scene.every * np.arange(len(wind))
    axis.fill_between(time, speed.min(axis=1), speed.max(axis=1), color="0.85", linewidth=0.0, label="all points")
    axis.plot(time, mean, color=BLUE, label="mean along the tether")
    axis.plot(time, speed[:, -1], color=VERMILLION, label="at the kite")
    axis.set(xlabel="time [s]", ylabel="wind speed [m/s]", title=scene.name, ylim=(0.0, 1.25 * speed.max()))
    axis.legend(frameon=False, fontsize=8, ncols=3, loc="upper left")
    figure.savefig(path, dpi=100, metadata={"Software": None})
