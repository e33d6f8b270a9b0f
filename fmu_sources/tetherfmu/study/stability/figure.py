"""Heat maps of the stability map: one column per pair of axes, one row per quantity, a figure per group of variants."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from scipy.stats import binned_statistic_2d

EDGES = 10  # of the cells along each axis
FEWEST = 3  # points that a cell needs to have a colour
# by column of the results as `report.prepared` makes them: head in tables; name, unit and bands as a region; axis in maps;
# name where the largest is told
QUANTITIES = pd.read_csv(Path(__file__).with_name("quantities.csv"), index_col="name")
ENDS = {"length": "axial_stiffness"}, {"slack_percent": "wind"}
PAIRS = ENDS[0] | {"step": "axial_stiffness", "segment_length": "step"} | ENDS[1]
FIXED_PAIRS = ENDS[0] | {"frequency": "fixed_step", "segment_length": "fixed_step"} | ENDS[1]


class Row(NamedTuple):
    """A row of heat maps."""

    label: str
    verdicts: tuple  # whose share it shows; empty: it shows the median of the error
    colours: str
    norm: Normalize


CONVERGED = Row("converged [%]", ("converged",), "viridis", Normalize(0.0, 100.0))
REFUSED = Row("refused [%]", ("refused",), "magma_r", Normalize(0.0, 50.0))
HELD = Row("converged or\nstable [%]", ("converged", "stable"), "magma", Normalize(50.0, 100.0))
ERROR = Row("median difference from\nthe refinement [%]", (), "viridis_r", LogNorm(1e-3, 1e2))
DYNAMIC, STATIC = ("dynamic, adaptive", "dynamic, fixed step"), ("quasi-steady", "catenary", "straight")
FIGURES = {
    "dynamic": ("TetherDynamic, adaptive", DYNAMIC[:1], PAIRS, (CONVERGED, REFUSED)),
    "fixed_step": ("TetherDynamic, fixed step", DYNAMIC[1:], FIXED_PAIRS, (CONVERGED, ERROR)),
    "without_waves": ("TetherQuasiSteady, TetherCatenary, TetherStraight", STATIC, PAIRS, (CONVERGED, REFUSED)),
}
COMPARED = ("dynamic (adaptive and fixed step) and quasi-steady", (*DYNAMIC, STATIC[0]), PAIRS, (HELD,))


def edges(axis):
    """Edges of the cells along an axis."""
    space = np.geomspace if QUANTITIES.scale[axis] == "log" else np.linspace
    return space(QUANTITIES.low[axis], QUANTITIES.high[axis], EDGES)


def cells(results, row, up, across):
    """Array of the quantity of a row [%] over two axes, nan where there are fewer than `FEWEST` points."""
    values = results.verdict.isin(row.verdicts) if row.verdicts else results.error

    def of_cell(places):
        found = values.iloc[places.astype(int)]
        return np.nan if len(found) < FEWEST else 100.0 * (found.mean() if row.verdicts else found.median())

    places = np.arange(float(len(results)))  # scipy takes finite numbers only, and an error may be infinite
    return binned_statistic_2d(results[up], results[across], places, of_cell, [edges(up), edges(across)]).statistic


def draw(results, figure_of, path, when=""):
    """Write one of `FIGURES`, or `COMPARED` with a word about when, to a PNG file."""
    title, variants, pairs, rows = figure_of
    results = results[results.variant.isin(variants)]
    figure = Figure(figsize=(3.3 * len(pairs), 2.9 * len(rows)), layout="constrained")
    axes = figure.subplots(len(rows), len(pairs), squeeze=False)
    for line, row in zip(axes, rows, strict=True):
        for panel, (x, y) in zip(line, pairs.items(), strict=True):
            mesh = panel.pcolormesh(edges(x), edges(y), cells(results, row, y, x), norm=row.norm, cmap=row.colours)
            scales = {"xscale": QUANTITIES.scale[x], "yscale": QUANTITIES.scale[y]}
            panel.set(facecolor="0.9", **scales, xlabel=QUANTITIES.axis[x], ylabel=QUANTITIES.axis[y])
        figure.colorbar(mesh, ax=line, label=row.label, extend="both" if row is ERROR else "neither", pad=0.01)
    figure.suptitle(f"{when}{title}: {len(results)} points; grey: fewer than {FEWEST} points")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90, metadata={"Software": None})
