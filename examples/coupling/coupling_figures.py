"""Figures of `coupling_limits.py`: errors, growth and limits of the ways of coupling, one colour for each way everywhere."""

import numpy as np
from matplotlib.figure import Figure

from coupling.ways_of_coupling import DRIVEN, WAYS
from tetherfmu.console.colours import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY_BLUE, VERMILLION
from tetherfmu.runtime.parameters import Tether

COLOURS = dict(zip(WAYS, (VERMILLION, BLACK, ORANGE, PURPLE, GREEN, SKY_BLUE, BLUE), strict=True))
STIFFNESS = Tether().axial_stiffness / Tether().initial_length  # of the tether of the growth figure [N/m]
GAP = 0.075  # between labels, of the height of an axis
MARKERS = dict(zip(WAYS, "spvD^oo", strict=True))


def spread(heights, gap):
    """Heights moved apart until no two are closer than `gap`, in the same order, at first below 1."""
    order = np.argsort(heights)
    places = np.minimum(np.sort(heights), 1.0 - gap * np.arange(len(heights))[::-1])
    for _ in range(100):
        close = np.flatnonzero(np.diff(places) < gap - 1e-9)
        if not len(close):
            break
        for k in close:
            push = 0.5 * (gap - places[k + 1] + places[k])
            places[k], places[k + 1] = places[k] - push, places[k + 1] + push
    moved = np.empty_like(places)
    moved[order] = places
    return moved


def label_lines(axis, ends):
    """Write names on the right of the axis, beside the ends of their lines; ends : name -> (x, y)."""
    to_axes = (axis.transData + axis.transAxes.inverted()).transform
    points = np.array([to_axes(end) for end in ends.values()])
    for (name, end), height in zip(ends.items(), spread(points[:, 1], GAP), strict=True):
        axis.annotate(
            name,
            end,
            (1.03, height),
            textcoords="axes fraction",
            va="center",
            color=COLOURS[name],
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": COLOURS[name], "linewidth": 0.6, "relpos": (0.0, 0.5)},
        )


def draw_errors(table):
    """Error of the tether force over the communication step, both axes logarithmic, a panel for each kite; up to 100 %."""
    table = table[table.error <= 1.0]
    figure = Figure(figsize=(11.0, 4.8))
    axes = figure.subplots(1, 2, sharey=True)
    figure.subplots_adjust(0.08, 0.13, 0.84, 0.9, wspace=0.12)
    for axis, (kite, mine) in zip(axes, table.groupby("kite", sort=False), strict=True):
        for way, curve in mine.groupby("way", sort=False):
            style = {"color": COLOURS[way], "marker": MARKERS[way], "linestyle": "--" if way == "free end, held" else "-"}
            axis.loglog(1e3 * curve.step, 100.0 * curve.error, markersize=4, **style)
        axis.set(title=kite, xlabel="communication step [ms]", ylim=(1e-4, 100.0))
        axis.set_xticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
        axis.grid(color="0.9")
        axis.axhline(0.5, color="0.6", linewidth=0.8, linestyle=":")
    slope_marks(axes[0])
    axes[0].set_ylabel("error of the tether force, rms [%]")
    axes[0].text(0.83, 0.45, "0.5 %", color="0.4", va="top", fontsize=9)
    free = "free end, held or linear:\nthe solver's own error"
    axes[0].text(9.5, 1.5e-3, free, color=COLOURS[WAYS[-1]], fontsize=9, va="top")
    last = table[table.kite == kite].groupby("way", sort=False).last()
    ends = {way: (1e3 * row.step, 100.0 * row.error) for way, row in last.iterrows()}
    for way, height in (("parallel, linear", 45.0), ("parallel", 10.0)):  # these end far from the edge
        if way in ends:
            leader = {"arrowstyle": "-", "color": COLOURS[way], "linewidth": 0.6, "relpos": (1.0, 0.5)}
            axes[1].annotate(
                way, ends.pop(way), (9.0, height), color=COLOURS[way], ha="right", va="center", arrowprops=leader
            )
    label_lines(axes[1], ends)
    return figure


def slope_marks(axis):
    """Short lines of the slopes 1 and 2, with their orders."""
    for start, order in ((4.0, 1), (0.02, 2)):
        steps = np.array([1.0, 2.0])
        axis.plot(steps, start * (steps / steps[0]) ** order, color="0.4", linewidth=1.0)
        axis.text(steps[0], 1.5 * start * 2.0**order, f"order {order}", color="0.4", fontsize=9)


def draw_growth(table):
    """Growth rate over the damping k h/2 that a force half a step late takes away: measured, theory, formula."""
    figure = Figure(figsize=(8.0, 4.8))
    axis = figure.subplots()
    figure.subplots_adjust(0.12, 0.12, 0.78, 0.86)
    ends = {}
    for way in DRIVEN:
        mine = table[table.way == way]
        x = 1e3 * mine.step
        axis.plot(x, mine.theory, "-", color=COLOURS[way])
        axis.plot(x, mine.formula, ":", color=COLOURS[way])
        axis.plot(x, mine.measured, MARKERS[way], color=COLOURS[way], markersize=5)
        ends[way] = x.iloc[-1], mine.theory.iloc[-1]
    axis.axhline(0.0, color="0.3", linewidth=0.8)
    axis.text(x.iloc[-1], 0.01, "grows", color="0.3", fontsize=9, ha="right")
    axis.set(xlabel="communication step h [ms]", ylabel="growth rate [1/s]", xlim=(0.0, None))
    half = 0.5e-3 * STIFFNESS
    axis.secondary_xaxis("top", functions=(lambda h: h * half, lambda d: d / half)).set_xlabel("k h/2 [N s/m]")
    label_lines(axis, ends)
    return figure


def draw_limits(table):
    """Largest stable communication step over the mass of the kite, a panel for each length; dotted: the rules."""
    panels = list(table.groupby("length"))
    figure = Figure(figsize=(12.0, 4.2))
    axes = np.atleast_1d(figure.subplots(1, len(panels), sharey=True))
    figure.subplots_adjust(0.07, 0.14, 0.86, 0.9, wspace=0.08)
    for axis, (length, mine) in zip(axes, panels, strict=True):
        ends = {}
        for way, curve in mine.groupby("way", sort=False):
            axis.loglog(
                curve.kite_mass, 1e3 * curve.largest_step, "-", color=COLOURS[way], marker=MARKERS[way], markersize=4
            )
            axis.loglog(
                curve.kite_mass, 1e3 * curve.safe_step, ":", color=COLOURS[way] if way.startswith("parallel") else "0.4"
            )
            ends[way] = curve.kite_mass.iloc[-1], 1e3 * curve.largest_step.iloc[-1]
        axis.set(title=f"{length:g} m", xlabel="kite [kg]", ylim=(1.0, 500.0))
        axis.set_xticks([1, 10, 100], ["1", "10", "100"])
        axis.set_yticks([1, 10, 100], ["1", "10", "100"])
        axis.grid(color="0.9")
    axes[0].set_ylabel("largest stable communication step [ms]")
    axes[-1].text(1.3, 1.15, "2 c/k", color=COLOURS[WAYS[0]], fontsize=9)
    axes[-1].text(14.0, 6.0, r"0.1 $\sqrt{M/k}$", color=COLOURS[WAYS[1]], fontsize=9)
    axes[-1].text(1.2, 75.0, r"0.2 $\sqrt{M/k}$", color="0.4", fontsize=9)
    label_lines(axes[-1], ends)
    return figure


DRAWN = {"errors": draw_errors, "growth": draw_growth, "limits": draw_limits}
