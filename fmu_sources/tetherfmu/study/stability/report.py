"""The page of the stability map: tables by variant and by region, refusals, the worst points, and the heat maps."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.study.measuring.tables import markdown, page

from .figure import COMPARED, FIGURES, draw
from .flight import AMPLIFICATION
from .points import MapPoint
from .verdict import LONGEST_CALL, VERDICTS

PAGE = Path(__file__).with_name("page.md.j2")
NAMES = {
    "dynamic": "dynamic, adaptive",
    "dynamic_fixed_step": "dynamic, fixed step",
    "quasi_steady": "quasi-steady",
    "catenary": "catenary",
    "straight": "straight",
}
STARTS = {1: "start: static", 2: "start: quasi-steady", 3: "start: straight"}
WORST = {
    "tension_ratio": "tension over its bound",
    "speed_ratio": "speed over its bound",
    "error": "error",
    "longest": "longest call [s]",
}


def prepared(results):
    """Results with what the tables are grouped by: variants for people and verdicts in order, derived lengths and slack."""
    return results.assign(
        variant=pd.Categorical(results.variant.map(NAMES), NAMES.values()),
        verdict=pd.Categorical(results.verdict, VERDICTS),
        segment_length=results.length / results.segments,
        slack_percent=100.0 * results.slack,
    )


def counted(results, labels):
    """A row for each label of the points: their number, shares or numbers of the verdicts, error quantiles [%]."""
    verdicts = pd.get_dummies(results.verdict).groupby(labels, observed=False)
    errors = 100.0 * results.error.groupby(labels, observed=False).quantile([0.5, 0.9]).unstack()
    return pd.concat(
        [
            verdicts.size().rename("points"),
            100.0 * verdicts.mean().iloc[:, :3].add_suffix(" %"),
            verdicts.sum().iloc[:, 3:],
            errors.set_axis(["error, median %", "90th %"], axis=1),
        ],
        axis=1,
    )


def by_label(results, name, *labellings):
    """Table of `counted` with the rows of each labelling below each other; the column of labels has a name."""
    tables = [counted(results, labels) for labels in labellings]
    return pd.concat(tables).rename_axis(name).reset_index()


def by_variant(results):
    """Table with a row per variant and one for all."""
    return by_label(results, "variant", results.variant, pd.Categorical(["all"] * len(results)))


def bands(name, values, limits, unit):
    """Label of the band between some limits in which each value lies."""
    return pd.cut(values, limits, right=False, labels=[f"{name} {a:g} to {b:g} {unit}" for a, b in pairwise(limits)])


def regions(results):
    """The labels of the regions, one axis after the other."""
    damping = bands("damping", results.axial_damping, (0.0, 0.1, 10.0, 1e3, 1e5), "N s")
    return (
        bands("segment", results.segment_length, (0.01, 0.1, 1.0, 10.0, 1000.0), "m"),
        bands("EA", results.axial_stiffness, (1e3, 1e5, 1e7, 1e8, 1e9), "N"),
        damping.cat.rename_categories({"damping 0 to 0.1 N s": "without damping"}),
        bands("slack", results.slack_percent, (-1.0, 0.0, 5.0, 30.0, 90.0), "%"),
        bands("communication step", results.step, (1e-4, 1e-3, 0.01, 0.1, 1.0), "s"),
        bands("wind", results.wind, (0.0, 20.0, 40.0, 60.0), "m/s"),
        bands("kite", results.speed, (0.0, 30.0, 80.0, 150.0), "m/s"),
        pd.Categorical(results.initial_shape.map(STARTS), STARTS.values()),
    )


def by_region(results, variant):
    """Table of one variant with a row per region."""
    mine = results[results.variant == NAMES[variant]]
    fixed_steps = bands("fixed step", mine.fixed_step, (1e-5, 1e-3, 5e-3, 0.02, 0.05, 0.2, 1.0), "s")
    return by_label(mine, "region", *([fixed_steps] if variant == "dynamic_fixed_step" else []), *regions(mine))


def refusals(results):
    """Table of refusals by variant: when and with which sentence."""
    refused = results[results.refusal != ""]
    when = np.where(refused.calls == 0, "at the start", "in flight")
    rows = refused.assign(when=when).groupby(["variant", "refusal", "when"], observed=True).size()
    return rows.rename("points").reset_index().rename(columns={"refusal": "sentence"})


def worst(results):
    """Table of the points with the largest tension over its bound, the largest error, and the longest call, per variant."""
    tables = []
    for column, name in WORST.items():
        values = results[column].fillna(0.0)
        rows = results.loc[values.groupby(results.variant, observed=True).idxmax()]
        facts = {
            "largest": name,
            "variant": rows.variant,
            "value": values[rows.index].map("{:.2g}".format),
            "verdict": rows.verdict,
            "point": rows.number,
            "segments": rows.segments,
            "length m": rows.length,
            "EA N": rows.axial_stiffness,
            "damping N s": rows.axial_damping,
            "slack %": rows.slack_percent,
            "step s": rows.step,
        }
        tables.append(pd.DataFrame(facts))
    return pd.concat(tables)


def common(results, before):
    """The points that are in both tables of results: these points in the first, and in the second."""
    points = list(MapPoint._fields)
    before = before.drop_duplicates(points, keep="last")
    return results.merge(before[points]), before.merge(results[points])


def compared(results, before):
    """Table of a version before and of now, by variant, on the points of both (tables of results)."""
    now, earlier = common(results, before)
    both = prepared(pd.concat([earlier.assign(when="before"), now.assign(when="now")], ignore_index=True))
    variants, every = (
        pd.Categorical(names + ", " + both.when, [f"{name}, {when}" for name in ordered for when in ("before", "now")])
        for names, ordered in ((both.variant.astype(str), NAMES.values()), ("all", ["all"]))
    )
    return by_label(both, "variant", variants, every)


def figures(results, before, folder):
    """Draw the heat maps into a folder; returns their paths, as seen from it, by title."""
    drawn = {}
    for name, figure in FIGURES.items():
        drawn[f"{figure[0]}: heat maps"] = path = f"figures/{name}.png"
        draw(results, figure, folder / path)
    if len(before):
        for when, found in zip(("before", "now"), reversed(common(results, before)), strict=True):
            drawn[f"Heat maps, {when}"] = path = f"figures/stability_{when}.png"
            draw(found, COMPARED, folder / path, f"{when}: ")
    return drawn


def write(results, before, folder, with_figures):
    """Write stability.md, and its figures if asked for, to a folder; returns the summary as text.

    results, before : tables of results, of now and of another version (which may be empty).
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    all_points = prepared(results)
    core = all_points.query("segment_length >= 0.1 and axial_damping > 0.0 and axial_stiffness <= 1e8")  # 97 % must hold
    overview = by_variant(all_points)
    held = 100.0 * core.verdict.isin(("converged", "stable")).mean()
    text = page(
        PAGE,
        figures=figures(results, before, folder) if with_figures else {},
        all_points=overview,
        core=by_variant(core),
        core_points=len(core),
        held=held,
        refusals=refusals(all_points),
        compared=compared(results, before) if len(before) else None,
        dynamic=by_region(all_points, "dynamic"),
        fixed_step=by_region(all_points, "dynamic_fixed_step"),
        worst=worst(all_points),
        amplification=AMPLIFICATION,
        longest_call=LONGEST_CALL,
    )
    (folder / "stability.md").write_text(text, encoding="utf-8")
    return f"{markdown(overview)}\nConverged or stable: {held:.1f} % of {len(core)} points."
