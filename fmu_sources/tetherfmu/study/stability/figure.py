"""Heat maps of the stability map: one column per pair of axes, one row per quantity, a figure per group of variants."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from scipy.stats import binned_statistic_2d

from .flight import LINE_DENSITY

EDGES = 10  # of the cells along each axis
FEWEST = 3  # points that a cell needs to have a colour


class Axis(NamedTuple):
    """An axis: label, function of the results, edges of the cells, scale."""

    label: str
    values: object
    edges: np.ndarray
    scale: str = "log"


def frequency(results):
    """Axial frequency of a node between two taut segments [Hz]: sqrt(4 k/m)/(2 pi) = sqrt(EA/mu)/(pi l0)."""
    return np.sqrt(results.axial_stiffness / LINE_DENSITY) / (np.pi * results.length / results.segments)


LENGTH = Axis("length [m]", lambda r: r.length, np.geomspace(1.0, 1e4, EDGES))
SEGMENT = Axis("segment [m]", lambda r: r.length / r.segments, np.geomspace(0.01, 1000.0, EDGES))
STIFFNESS = Axis("EA [N]", lambda r: r.axial_stiffness, np.geomspace(1e3, 1e9, EDGES))
STEP = Axis("communication step [s]", lambda r: r.step, np.geomspace(1e-4, 1.0, EDGES))
FIXED_STEP = Axis("fixed step [s]", lambda r: r.fixed_step, np.geomspace(1e-5, 1.0, EDGES))
FREQUENCY = Axis("axial frequency [Hz]", frequency, np.geomspace(1.0, 1e6, EDGES))
SLACK = Axis("slack [%]", lambda r: 100.0 * r.slack, np.linspace(-1.0, 90.0, EDGES), "linear")
WIND = Axis("wind [m/s]", lambda r: r.wind, np.linspace(0.0, 60.0, EDGES), "linear")
PAIRS = ((LENGTH, STIFFNESS), (STEP, STIFFNESS), (SEGMENT, STEP), (SLACK, WIND))
FIXED_PAIRS = ((LENGTH, STIFFNESS), (FREQUENCY, FIXED_STEP), (SEGMENT, FIXED_STEP), (SLACK, WIND))


class Row(NamedTuple):
    """A row of heat maps: name, function of the results in a cell, colours and their bounds."""

    name: str
    quantity: object
    colours: str
    norm: Normalize


def share(*verdicts):
    """Function of the results in a cell: share of these verdicts [%]."""
    return lambda results: 100.0 * results.verdict.isin(verdicts).mean()


CONVERGED = Row("converged [%]", share("converged"), "viridis", Normalize(0.0, 100.0))
REFUSED = Row("refused [%]", share("refused"), "magma_r", Normalize(0.0, 50.0))
HELD = Row("converged or\nstable [%]", share("converged", "stable"), "magma", Normalize(50.0, 100.0))
ERROR = Row(
    "median difference from\nthe refinement [%]",
    lambda results: 100.0 * results.error.median(),
    "viridis_r",
    LogNorm(1e-3, 1e2),
)
FIGURES = {
    "stability_dynamic": ("TetherDynamic, adaptive", ("dynamic",), PAIRS, (CONVERGED, REFUSED)),
    "stability_fixed_step": ("TetherDynamic, fixed step", ("dynamic_fixed_step",), FIXED_PAIRS, (CONVERGED, ERROR)),
    "stability_without_waves": (
        "TetherQuasiSteady, TetherCatenary, TetherStraight",
        ("quasi_steady", "catenary", "straight"),
        PAIRS,
        (CONVERGED, REFUSED),
    ),
}
COMPARED = (
    "dynamic (adaptive and fixed step) and quasi-steady",
    ("dynamic", "dynamic_fixed_step", "quasi_steady"),
    PAIRS,
    (HELD,),
)


def cells(results, across, up, quantity):
    """Array of a quantity over two axes, nan where there are fewer than `FEWEST` points."""

    def of_cell(rows):
        return quantity(results.iloc[rows.astype(int)]) if len(rows) >= FEWEST else np.nan

    numbers, edges = np.arange(float(len(results))), (up.edges, across.edges)
    return binned_statistic_2d(up.values(results), across.values(results), numbers, of_cell, edges).statistic


def draw(results, figure_of, path, when=""):
    """Write one of `FIGURES`, or `COMPARED` with a word about when, to a PNG file."""
    title, variants, pairs, rows = figure_of
    results = results[results.variant.isin(variants)]
    figure = Figure(figsize=(3.3 * len(pairs), 2.9 * len(rows)), layout="constrained")
    axes = figure.subplots(len(rows), len(pairs), squeeze=False)
    for line, row in zip(axes, rows, strict=True):
        for panel, (across, up) in zip(line, pairs, strict=True):
            values = cells(results, across, up, row.quantity)
            mesh = panel.pcolormesh(across.edges, up.edges, values, norm=row.norm, cmap=row.colours)
            panel.set(facecolor="0.9", xscale=across.scale, yscale=up.scale, xlabel=across.label, ylabel=up.label)
        figure.colorbar(mesh, ax=line, label=row.name, extend="both" if row is ERROR else "neither", pad=0.01)
    figure.suptitle(f"{when}{title}: {len(results)} points; grey: fewer than {FEWEST} points")
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=90, metadata={"Software": None})
