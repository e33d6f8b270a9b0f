"""Pictures of the stability map: over pairs of axes, a dot for each flight by its verdict, and below the median error."""

from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from tetherfmu.console.colours import BLACK, BLUE, ORANGE, SKY_BLUE

from .flight import FORBIDDEN

EDGES = 10  # of the cells along each axis
ERROR_LABEL = "median difference from\nthe refinement [%]"
FEWEST = 3  # points that a cell needs to have a colour
# by column of the results as `report.prepared` makes them: head in tables; name, unit and bands as a region; axis in maps;
# name where the largest is written
QUANTITIES = pd.read_csv(Path(__file__).with_name("quantities.csv"), index_col="name")
ENDS = {"length": "axial_stiffness"}, {"slack_percent": "wind"}
PAIRS = ENDS[0] | {"step": "axial_stiffness", "segment_length": "step"} | ENDS[1]
FIXED_PAIRS = ENDS[0] | {"frequency": "fixed_step", "segment_length": "fixed_step"} | ENDS[1]
DOTS = {  # of the verdicts, the rare ones on top; "wrong" stands for all of `FORBIDDEN`
    "stable": {"color": SKY_BLUE, "s": 5, "marker": "."},
    "converged": {"color": BLUE, "s": 5, "marker": "."},
    "refused": {"color": ORANGE, "s": 22, "marker": "v", "edgecolor": BLACK, "linewidth": 0.4},
    "wrong": {"color": BLACK, "s": 60, "marker": "X"},
}


def edges(axis):
    """Edges of the cells along an axis."""
    space = np.geomspace if QUANTITIES.scale[axis] == "log" else np.linspace
    return space(QUANTITIES.low[axis], QUANTITIES.high[axis], EDGES)


def draw_verdicts(figure, line, pairs, results):
    """A row of panels with a dot for each flight, and a legend with the numbers of flights."""
    for kind, style in DOTS.items():
        mine = results[results.verdict.isin(FORBIDDEN if kind == "wrong" else (kind,))]
        for panel, (x, y) in zip(line, pairs.items(), strict=True):
            panel.scatter(mine[x], mine[y], **style)
        line[0].scatter([], [], label=f"{kind}: {len(mine)}", **{**style, "s": 60})
    figure.legend(loc="outside lower center", ncols=len(DOTS), frameon=False)


def draw_cells(column, statistic, label, colours, norm, figure, line, pairs, results):
    """A row of heat maps of a statistic of a column [%], without colour where a cell has fewer than `FEWEST` points."""
    for panel, (x, y) in zip(line, pairs.items(), strict=True):
        places = [pd.cut(results[axis], edges(axis), include_lowest=True) for axis in (y, x)]
        groups = results[column].groupby(places, observed=False)
        shares = 100.0 * groups.agg(statistic).where(groups.size() >= FEWEST).unstack()
        mesh = panel.pcolormesh(edges(x), edges(y), shares, norm=norm, cmap=colours)
    figure.colorbar(mesh, ax=list(line), label=label, extend="both" if isinstance(norm, LogNorm) else "neither", pad=0.01)


draw_errors = partial(draw_cells, "error", "median", ERROR_LABEL, "viridis_r", LogNorm(1e-3, 1e2))
draw_held = partial(draw_cells, "held", "mean", "converged or\nstable [%]", "viridis", Normalize(50.0, 100.0))
FREE_KITE = "dynamic, free kite"
DYNAMIC, STATIC = ("dynamic, adaptive", "dynamic, fixed step"), ("quasi-steady", "catenary", "straight")
ROWS = (draw_verdicts, draw_errors)
FIGURES = {
    "dynamic": ("TetherDynamic, adaptive", DYNAMIC[:1], PAIRS, ROWS),
    "fixed_step": ("TetherDynamic, fixed step", DYNAMIC[1:], FIXED_PAIRS, ROWS),
    "without_waves": ("TetherQuasiSteady, TetherCatenary, TetherStraight", STATIC, PAIRS, ROWS),
}
COMPARED = ("dynamic (adaptive and fixed step) and quasi-steady", (*DYNAMIC, STATIC[0]), PAIRS, (draw_held,))


def draw(results, figure_of, path, when=""):
    """Write one of `FIGURES`, or `COMPARED` with a word about when, to a PNG file."""
    title, variants, pairs, rows = figure_of
    results = results[results.variant.isin(variants)]
    figure = Figure(figsize=(3.3 * len(pairs), 2.9 * len(rows) + 0.5), layout="constrained")
    axes = figure.subplots(len(rows), len(pairs), squeeze=False)
    for line, draw_row in zip(axes, rows, strict=True):
        draw_row(figure, line, pairs, results)
        for panel, (x, y) in zip(line, pairs.items(), strict=True):
            panel.set(xscale=QUANTITIES.scale[x], xlim=edges(x)[[0, -1]], xlabel=QUANTITIES.axis[x], facecolor="0.93")
            panel.set(yscale=QUANTITIES.scale[y], ylim=edges(y)[[0, -1]], ylabel=QUANTITIES.axis[y])
    figure.suptitle(f"{when}{title}: {len(results)} flights")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90, metadata={"Software": None})
