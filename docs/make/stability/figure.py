"""Picture of the stability map: the share of flights that converge, over each quantity, from the table by region."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from pictures import save
from tetherfmu.console.colours import GREEN, VERMILLION

# by column of the results as `report.prepared` makes them: head in tables; name, unit and bands as a region;
# name where the largest is written
QUANTITIES = pd.read_csv(Path(__file__).with_name("quantities.csv"), index_col="name")
REGIONS = QUANTITIES.dropna(subset="bands")
FREE_KITE = "dynamic, free kite"
DYNAMIC, STATIC = ("dynamic, adaptive", "dynamic, fixed step"), ("quasi-steady", "catenary", "straight")
STYLES = dict(zip(DYNAMIC, ({"color": VERMILLION, "marker": "o"}, {"color": GREEN, "marker": "s"}), strict=True))
UNDAMPED = "damping 0 to 0.1 N s"  # where the damping is 0, as points have none below 0.1 N s but that


def bands(region):
    """Dict of the bands of one of `REGIONS`: name of the band -> its limits."""
    limits = [float(limit) for limit in region.bands.split()]
    return {f"{region.region} {a:g} to {b:g} {region.unit}": (a, b) for a, b in pairwise(limits)}


def shares(table, variant, names):
    """Share of the flights of a variant in all maps that converge [%], by region; none where there was no flight."""
    mine = table[table.variant == variant]
    converged = (mine["converged %"] * mine.points).groupby(mine.region).sum()
    return (converged / mine.points.groupby(mine.region).sum()).reindex(names)


def words(number):
    """Text of a number on an axis: powers of ten from 1e4 on and below 1e-2."""
    is_short = number <= 0.0 or 1e-2 <= number < 1e4
    return f"{number:g}" if is_short else f"{number:.0e}".replace("e+0", "e").replace("e-0", "e-")


def draw(table, path):
    """Write a panel for each of `REGIONS` to an SVG file. table : of `report.regions`."""
    figure = Figure(figsize=(9.6, 5.2), layout="constrained")
    panels = figure.subplots(2, 4, sharey=True)
    for panel, region in zip(panels.flat, REGIONS.itertuples(), strict=True):
        limits = bands(region)
        names = ["without damping" if name == UNDAMPED else name for name in limits]
        for variant, style in STYLES.items():
            panel.plot(np.arange(len(names)) + 0.5, shares(table, variant, names), **style)
        edges = sorted({limit for band in limits.values() for limit in band})
        panel.set_xticks(range(len(edges)), map(words, edges), fontsize="small")
        panel.set(xlabel=f"{region.region} [{region.unit}]", xlim=(0, len(names)), ylim=(0.0, 100.0))
        panel.grid(axis="y", color="0.85")
    for panel in panels[:, 0]:
        panel.set_ylabel("converged flights [%]")
    figure.legend(panels[0, 1].lines, DYNAMIC, loc="outside upper center", ncols=2, frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    save(figure, path)
