"""Heat maps of the stability map: one column per pair of axes, one row per quantity, a figure per group of variants."""

from math import pi, sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .flight import LINE_DENSITY

CELLS = 9  # along each axis
FEWEST = 3  # points that a cell needs to have a colour


class Axis(NamedTuple):
    """An axis: label, function of a point, bounds, whether it is logarithmic."""

    label: str
    value: object
    low: float
    high: float
    logarithmic: bool = True

    def edges(self):
        """Edges of the cells, in the unit of the axis."""
        spacing = np.geomspace if self.logarithmic else np.linspace
        return spacing(self.low, self.high, CELLS + 1)


def frequency(point):
    """Axial frequency of a node between two taut segments [Hz]: sqrt(4 k/m)/(2 pi) = sqrt(EA/mu)/(pi l0)."""
    return sqrt(point.axial_stiffness / LINE_DENSITY) / (pi * point.segment_length)


LENGTH = Axis("length [m]", lambda p: p.length, 1.0, 1e4)
SEGMENT = Axis("segment [m]", lambda p: p.segment_length, 0.01, 1000.0)
STIFFNESS = Axis("EA [N]", lambda p: p.axial_stiffness, 1e3, 1e9)
STEP = Axis("communication step [s]", lambda p: p.step, 1e-4, 1.0)
FIXED_STEP = Axis("fixed step [s]", lambda p: p.fixed_step, 1e-5, 1.0)
FREQUENCY = Axis("axial frequency [Hz]", frequency, 1.0, 1e6)
SLACK = Axis("slack [%]", lambda p: 100.0 * p.slack, -1.0, 90.0, False)
WIND = Axis("wind [m/s]", lambda p: p.wind, 0.0, 60.0, False)
PAIRS = ((LENGTH, STIFFNESS), (STEP, STIFFNESS), (SEGMENT, STEP), (SLACK, WIND))
FIXED_PAIRS = ((LENGTH, STIFFNESS), (FREQUENCY, FIXED_STEP), (SEGMENT, FIXED_STEP), (SLACK, WIND))


def converged(verdicts):
    """Share of converged points [%]."""
    return 100.0 * np.mean([v.verdict == "converged" for v in verdicts])


def refused(verdicts):
    """Share of refused points [%]."""
    return 100.0 * np.mean([v.verdict == "refused" for v in verdicts])


def held(verdicts):
    """Share of points that are converged or stable [%]."""
    return 100.0 * np.mean([v.verdict in ("converged", "stable") for v in verdicts])


def error(verdicts):
    """Median error [%] of the points that have one; nan where there is none."""
    errors = [v.error for v in verdicts if v.error is not None]
    return 100.0 * np.median(errors) if errors else np.nan


class Row(NamedTuple):
    """A row of heat maps: name, function of the verdicts of a cell, bounds of the colours, whether logarithmic, colours."""

    name: str
    quantity: object
    low: float
    high: float
    logarithmic: bool
    colours: str


CONVERGED = Row("converged [%]", converged, 0.0, 100.0, False, "viridis")
REFUSED = Row("refused [%]", refused, 0.0, 50.0, False, "magma_r")
HELD = Row("converged or\nstable [%]", held, 50.0, 100.0, False, "magma")
ERROR = Row("median difference from\nthe refinement [%]", error, 1e-3, 1e2, True, "viridis_r")
FIGURES = {
    "stability_dynamic": ("TetherDynamic, adaptive", ("dynamic",), PAIRS, (CONVERGED, REFUSED)),
    "stability_fixed_step": ("TetherDynamic, fixed step", ("dynamic fixed step",), FIXED_PAIRS, (CONVERGED, ERROR)),
    "stability_without_waves": (
        "TetherQuasiSteady, TetherCatenary, TetherStraight",
        ("quasi_steady", "catenary", "straight"),
        PAIRS,
        (CONVERGED, REFUSED),
    ),
}
COMPARED = (
    "dynamic (adaptive and fixed step) and quasi-steady",
    ("dynamic", "dynamic fixed step", "quasi_steady"),
    PAIRS,
    (HELD,),
)


def cells(results, across, up, quantity):
    """Array of a quantity over two axes, nan where there are fewer than `FEWEST` points."""
    places = [np.searchsorted(axis.edges(), [axis.value(p) for p, _ in results]) - 1 for axis in (across, up)]
    values = np.full((CELLS, CELLS), np.nan)
    for i in range(CELLS):
        for j in range(CELLS):
            chosen = [results[k][1] for k in np.flatnonzero((places[0] == i) & (places[1] == j))]
            if len(chosen) >= FEWEST:
                values[j, i] = quantity(chosen)
    return values


def draw(results, figure_of, path, when=""):
    """Write one of `FIGURES`, or `COMPARED` with a word about when, to a PNG file."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.colors import LogNorm, Normalize

    title, variants, pairs, rows = figure_of
    results = [(p, v) for p, v in results if p.variant in variants]
    figure, axes = plt.subplots(
        len(rows), len(pairs), figsize=(3.3 * len(pairs), 2.9 * len(rows)), squeeze=False, layout="constrained"
    )
    for line, row in zip(axes, rows, strict=True):
        norm = (LogNorm if row.logarithmic else Normalize)(row.low, row.high)
        for panel, (across, up) in zip(line, pairs, strict=True):
            panel.set_facecolor("0.9")
            values = cells(results, across, up, row.quantity)
            mesh = panel.pcolormesh(across.edges(), up.edges(), values, norm=norm, cmap=row.colours)
            panel.set_xscale("log" if across.logarithmic else "linear")
            panel.set_yscale("log" if up.logarithmic else "linear")
            panel.set_xlabel(across.label)
            panel.set_ylabel(up.label)
        figure.colorbar(mesh, ax=line, label=row.name, extend="both" if row.logarithmic else "neither", pad=0.01)
    figure.suptitle(f"{when}{title}: {len(results)} points; grey: fewer than {FEWEST} points")
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)
