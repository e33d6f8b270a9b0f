"""The page of the stability map: tables by variant and by region, refusals, the worst points, and the heat maps."""

from collections import Counter
from itertools import pairwise
from math import inf, isnan
from pathlib import Path

import numpy as np

from tetherfmu.study.measuring.tables import Table, cell, circumstances

from .figure import COMPARED, FIGURES, draw
from .flight import AMPLIFICATION
from .points import VARIANTS, is_core
from .verdict import LONGEST_CALL, VERDICTS

HEAD = """# Stability

Where the tethers hold at the extremes of what an importer may ask for, and where they refuse. Random tethers fly a circle
around the ground station; each flight is judged against its own refinement (half communication and fixed step, a tenth of
the tolerance). Written by `python -m tetherfmu.study.stability`; every number is measured.
"""
MEANING = """Verdicts:

- converged: forces on both ends agree with the refinement within 1 % (root mean square, relative to the refined ones plus
  the weight of the tether).
- stable: bounded, but the difference is larger. Its median and 90th percentile stand in the tables.
- refused: with a sentence, at the start or in flight; the state of before is kept.
- wrong: an output is not finite, or a tension or the speed of a node is larger than the motion can explain (the bounds are
  in `study/stability_flight.py`). Must not be.
- crashed, hanging: the process died, or a call took longer than 2 s. Must not be.

"Stable" is not a fault of the solver alone. The communication step is part of the refinement: where the kite turns by up to
0.3 rad between two calls, a tether of EA = 1e8 N is pulled by whatever the extrapolated path is off. A straight start of a
slack tether buckles, and where each segment goes is chance.

A point is made again from its number: `python -m tetherfmu.study.stability --point NUMBER`. Axes and their distributions:
`study/stability_points.py`.
"""
BEFORE = """\
The same points with the kernels of an earlier version, judged by the criteria of today. What changed: CHANGELOG."""
TITLES = {
    "dynamic": "dynamic, adaptive",
    "dynamic fixed step": "dynamic, fixed step",
    "quasi_steady": "quasi-steady",
    "catenary": "catenary",
    "straight": "straight",
}
COLUMNS = ("points", *(f"{verdict} %" for verdict in VERDICTS[:3]), *VERDICTS[3:], "error, median %", "90th %")


def figures_of(results):
    """Cells of a row: number of points, shares of the first verdicts [%], numbers of the others, error quantiles [%]."""
    counts = Counter(verdict.verdict for _, verdict in results)
    total = len(results)
    shares = [100.0 * counts[name] / total if total else None for name in VERDICTS[:3]]
    errors = [inf if isnan(v.error) else 100.0 * v.error for _, v in results if v.error is not None]
    quantiles = [float(x) for x in np.quantile(errors, (0.5, 0.9))] if errors else [None, None]
    return [total, *shares, *(counts[name] for name in VERDICTS[3:]), *quantiles]


def by_variant(results, title, text):
    """Table with a row per variant and one for all."""
    rows = [[TITLES[name], *figures_of([(p, v) for p, v in results if p.variant == name])] for name in VARIANTS]
    return Table(title, text, ("variant", *COLUMNS), [*rows, ["all", *figures_of(results)]])


def _bands(name, value, limits, unit):
    """Pairs (label, condition) for the bands between some limits."""
    found = []
    for low, high in pairwise(limits):
        found.append((f"{name} {low:g} to {high:g} {unit}", lambda p, low=low, high=high: low <= value(p) < high))
    return found


REGIONS = (
    *_bands("segment", lambda p: p.segment_length, (0.01, 0.1, 1.0, 10.0, 1000.0), "m"),
    *_bands("EA", lambda p: p.axial_stiffness, (1e3, 1e5, 1e7, 1e8, 1e9), "N"),
    ("without damping", lambda p: p.axial_damping == 0.0),
    *_bands("damping", lambda p: p.axial_damping, (0.1, 10.0, 1e3, 1e5), "N s"),
    *_bands("slack", lambda p: 100.0 * p.slack, (-1.0, 0.0, 5.0, 30.0, 90.0), "%"),
    *_bands("communication step", lambda p: p.step, (1e-4, 1e-3, 0.01, 0.1, 1.0), "s"),
    *_bands("wind", lambda p: p.wind, (0.0, 20.0, 40.0, 60.0), "m/s"),
    *_bands("kite", lambda p: p.speed, (0.0, 30.0, 80.0, 150.0), "m/s"),
    ("start: static", lambda p: p.initial_shape == 1),
    ("start: quasi-steady", lambda p: p.initial_shape == 2),
    ("start: straight", lambda p: p.initial_shape == 3),
)
FIXED_STEPS = _bands("fixed step", lambda p: p.fixed_step, (1e-5, 1e-3, 5e-3, 0.02, 0.05, 0.2, 1.0), "s")


def by_region(results, variant, regions, title, text):
    """Table of one variant with a row per region."""
    mine = [(p, v) for p, v in results if p.variant == variant]
    rows = [[label, *figures_of([(p, v) for p, v in mine if condition(p)])] for label, condition in regions]
    return Table(title, text, ("region", *COLUMNS), rows)


def refusals(results):
    """Table of refusals by variant: when and with which sentence."""
    counts = Counter(
        (p.variant, v.refusal, "at the start" if v.calls == 0 else "in flight") for p, v in results if v.refusal
    )
    rows = [[TITLES[variant], refusal, when, count] for (variant, refusal, when), count in sorted(counts.items())]
    text = "Names of the sentences in `status.py`."
    return Table("Refusals", text, ("variant", "sentence", "when", "points"), rows)


def worst(results):
    """Table of the points with the largest tension over its bound, the largest error, and the longest call, per variant."""
    rows = []
    for what, value in (
        ("tension over its bound", lambda v: v.tension),
        ("speed over its bound", lambda v: v.speed),
        ("error", lambda v: v.error or 0.0),
        ("longest call [s]", lambda v: v.longest),
    ):
        for name in VARIANTS:
            mine = [(p, v) for p, v in results if p.variant == name]
            if mine:
                p, v = max(mine, key=lambda each: value(each[1]))
                facts = [p.number, p.segments, p.length, p.axial_stiffness, p.axial_damping, 100.0 * p.slack, p.step]
                rows.append([what, TITLES[name], f"{value(v):.2g}", v.verdict, *facts])
    text = (
        f"Bounds of tension and speed: see `study/stability_flight.py` (amplification {AMPLIFICATION:g}). "
        f"A call may take {LONGEST_CALL:g} s of the processor."
    )
    columns = (
        "largest",
        "variant",
        "value",
        "verdict",
        "point",
        "segments",
        "length m",
        "EA N",
        "damping N s",
        "slack %",
        "step s",
    )
    return Table("Worst points", text, columns, rows)


def common(results, before):
    """The points of both lists of (Point, Verdict): these points in the first, and in the second."""
    earlier = {p.number: (p, v) for p, v in before}
    mine = [(p, v) for p, v in results if earlier.get(p.number, (None,))[0] == p]
    return mine, [earlier[p.number] for p, _ in mine]


def compared(results, before):
    """Table of a version before and of now, by variant, on the points of both."""
    mine, earlier = common(results, before)
    rows = []
    for name in VARIANTS:
        for when, found in (("before", earlier), ("now", mine)):
            rows.append([f"{TITLES[name]}, {when}", *figures_of([(p, v) for p, v in found if p.variant == name])])
    rows += [["all, before", *figures_of(earlier)], ["all, now", *figures_of(mine)]]
    return Table("Before and now", BEFORE, ("variant", *COLUMNS), rows)


def tables(results, before):
    """All tables of the page; that of before and now only if there are results of before."""
    core = [(p, v) for p, v in results if is_core(p)]
    held = 100.0 * np.mean([v.verdict in ("converged", "stable") for _, v in core]) if core else 0.0
    return [
        by_variant(results, "All points", "The whole range of every axis."),
        by_variant(
            core,
            "Segments of 0.1 m and more, damped, EA up to 1e8 N",
            f"Converged or stable: {held:.1f} % of {len(core)} points.",
        ),
        refusals(results),
        *([compared(results, before)] if before else []),
        by_region(
            results, "dynamic", REGIONS, "Dynamic, adaptive, by region", "Each row: one axis in a band, all others free."
        ),
        by_region(
            results,
            "dynamic fixed step",
            (*FIXED_STEPS, *REGIONS),
            "Dynamic, fixed step, by region",
            "The error is that of the fixed step and of the communication step together.",
        ),
        worst(results),
    ]


def markdown(found, drawn):
    """The page of some tables and figures (paths as seen from the page)."""
    lines = [HEAD, circumstances(), "", MEANING]
    lines += [f"![{title}]({path})\n" for title, path in drawn.items()]
    for table in found:
        lines += [f"## {table.title}", "", table.text, ""]
        lines += ["| " + " | ".join(table.columns) + " |", "|" + "---|" * len(table.columns)]
        lines += ["| " + " | ".join(map(cell, row)) + " |" for row in table.rows]
        lines.append("")
    return "\n".join(lines)


def write(results, before, folder, figures):
    """Write stability.md, and its figures if asked for, to a folder; returns the summary as text.

    before : results of another version, or an empty list.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    drawn = {}
    for name, figure in FIGURES.items() if figures else ():
        drawn[f"{figure[0]}: heat maps"] = path = f"figures/{name}.png"
        draw(results, figure, folder / path)
    if before and figures:
        for when, found in zip(("before", "now"), reversed(common(results, before)), strict=True):
            drawn[f"Heat maps, {when}"] = path = f"figures/stability_{when}.png"
            draw(found, COMPARED, folder / path, f"{when}: ")
    found = tables(results, before)
    (folder / "stability.md").write_text(markdown(found, drawn), encoding="utf-8")
    return "\n".join(" ".join(map(cell, row)) for row in found[0].rows) + "\n" + found[1].text
