"""Random points are judged, and their page is written.

The page, stability.md, has tables by variant, refusals, the worst points, heat maps and the extreme scenarios with a known
answer (extremes.md.j2), which are not measured here. The table by region is a CSV file.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.models import TetherDynamicFree
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Winch
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.measuring.store import keeping
from tetherfmu.study.measuring.tables import markdown, page
from tetherfmu.study.scenes.start import MODELS

from .figure import COMPARED, DYNAMIC, FIGURES, FREE_KITE, QUANTITIES, STATIC, draw
from .flight import AMPLIFICATION, FORBIDDEN, HELD, LINE_DENSITY, LONGEST_CALL, VERDICTS, judge, judge_all, read
from .points import VARIANTS, VARIANTS_ON_GROUND, MapPoint, point
from .requests import POSSIBLE, REQUESTS, request

QUICK = 60  # points
STARTS = ("start: static", "start: quasi-steady", "start: straight")  # of `initial_shape` 1, 2, 3
WORST = QUANTITIES.worst.dropna().to_dict()
ON_GROUND = dict(zip(VARIANTS_ON_GROUND, (*DYNAMIC, FREE_KITE, *STATIC[:2]), strict=True))  # names for people
OVER = dict(zip(VARIANTS, (*DYNAMIC, *STATIC), strict=True))
FACTS = QUANTITIES.column.dropna().to_dict()  # heads of the table of the worst
CORE = "segments of 0.1 m and more, damped, EA up to 1e8 N"
REGIONS = QUANTITIES.dropna(subset="bands")
CONTROLS = dict(zip((at.WINCH_BY_SPEED, at.WINCH_BY_FORCE, at.WINCH_BY_LENGTH), ("speed", "force", "length"), strict=True))


def prepared(results):
    """Results with variants, starts and verdicts in order and named for people, and with what follows from a point.

    frequency : of a node between two taut segments, axially [Hz]: sqrt(4 k/m)/(2 pi) = sqrt(EA/mu)/(pi l0).
    """
    names = ON_GROUND if results.ground.any() else OVER
    return results.assign(
        variant=pd.Categorical(results.variant.map(names), [*names.values()]),
        verdict=pd.Categorical(results.verdict, VERDICTS),
        held=results.verdict.isin(HELD),
        start=pd.Categorical(results.initial_shape, (1, 2, 3)).rename_categories(STARTS),
        segment_length=results.length / results.segments,
        slack_percent=100.0 * results.slack,
        frequency=np.sqrt(results.axial_stiffness / LINE_DENSITY) / (np.pi * results.length / results.segments),
    )


def asked(results):
    """What each point asks for: Categorical of `REQUESTS`."""
    points = results[list(MapPoint._fields)].itertuples(index=False, name=None)
    return pd.Categorical([request(MapPoint(*each)) for each in points], REQUESTS)


def kinds(*tables):
    """Results of several maps in one table; `winch` and `ground` say which map a point is of."""
    whole = pd.concat([table for table in tables if len(table)], ignore_index=True)
    return whole.assign(
        winch=pd.Categorical(whole.control.map(CONTROLS), [*CONTROLS.values()]),
        ground=pd.Categorical(np.where(whole.ground, "flat", "none"), ("none", "flat")),
        asks=asked(whole),
    )


def by_map(whole):
    """Table with a row for each winch and ground of `kinds`: verdicts, and refusals of points that ask for what can be."""
    rows = []
    for (winch, ground), mine in whole.groupby(["winch", "ground"], observed=True):
        shares = mine.verdict.value_counts(normalize=True)
        can = mine[mine.asks == POSSIBLE]
        rows.append(
            {"winch control": winch, "ground": ground, "points": len(mine)}
            | {f"{verdict} %": 100.0 * shares.get(verdict, 0.0) for verdict in VERDICTS[:3]}
            | {verdict: int((mine.verdict == verdict).sum()) for verdict in FORBIDDEN}
            | {"given up %": 100.0 * (mine.unresolved & mine.verdict.isin(HELD)).mean()}
            | {"possible": len(can), "refused of these %": 100.0 * (can.verdict == "refused").mean()}
        )
    return pd.DataFrame(rows)


def by_request(whole):
    """Table with a row for each of `REQUESTS`: how many points ask for it, and how many of these are refused in each map."""
    maps = {f"{winch}, ground {ground}": mine for (winch, ground), mine in whole.groupby(["winch", "ground"], observed=True)}
    rows = []
    for words in REQUESTS:
        those = {name: mine[mine.asks == words] for name, mine in maps.items()}
        counts = {name: f"{(mine.verdict == 'refused').sum()} of {len(mine)}" for name, mine in those.items()}
        rows.append({"asks for": words} | counts)
    return pd.DataFrame(rows)


def refusals_by_map(whole):
    """Table of refusals of all maps by their sentence, and when: a column for each winch and ground."""
    refused = whole[whole.refusal != ""]
    when = np.where(refused.calls == 0, "at the start", "in flight")
    names = refused.winch.astype(str) + ", ground " + refused.ground.astype(str)
    rows = [
        refused.variant.map(OVER | ON_GROUND),
        refused.refusal.rename("sentence"),
        pd.Series(when, refused.index, name="when"),
    ]
    return pd.crosstab(rows, names).reset_index()


def counted(results, name, *labellings):
    """Points, verdicts and quantiles of the error [%]: a row for each label, of one labelling after the other."""
    tables = []
    for labels in labellings:
        verdicts = pd.get_dummies(results.verdict).groupby(labels, observed=False)
        errors = 100.0 * results.error.groupby(labels, observed=False).quantile([0.5, 0.9]).unstack()
        shares, numbers = 100.0 * verdicts.mean().iloc[:, :3].add_suffix(" %"), verdicts.sum().iloc[:, 3:]
        errors = errors.set_axis(["error, median %", "90th %"], axis=1)
        tables.append(pd.concat([verdicts.size().rename("points"), shares, numbers, errors], axis=1))
    return pd.concat(tables).rename_axis(name).reset_index()


def by_variant(results):
    """Table with a row per variant and one for all."""
    return counted(results, "variant", results.variant, pd.Categorical(["all"] * len(results)))


def by_region(results, variant):
    """Table of one variant with a row per band of each of the regions, and per start."""
    mine, bands = results[results.variant == variant], []
    for each in REGIONS.drop([] if variant == "dynamic, fixed step" else "fixed_step").itertuples():
        limits = [float(limit) for limit in each.bands.split()]
        labels = [f"{each.region} {a:g} to {b:g} {each.unit}" for a, b in pairwise(limits)]
        bands.append(pd.cut(mine[each.Index], limits, right=False, labels=labels))
    return counted(mine, "region", *bands, mine.start).replace({"region": {"damping 0 to 0.1 N s": "without damping"}})


def worst(results):
    """Table of the points with the largest of each of `WORST`, per variant."""
    facts = results.rename(columns=WORST).melt(["variant", *FACTS], [*WORST.values()], "largest")
    facts["largest"] = pd.Categorical(facts.largest, [*WORST.values()])
    values = facts.value.fillna(0.0)
    rows = facts.loc[values.groupby([facts.largest, facts.variant], observed=True).idxmax()]
    rows["value"] = values[rows.index].map("{:.2g}".format)
    return rows[["largest", "variant", "value", *FACTS]].rename(columns=FACTS)


def common(results, before):
    """The points that are in both tables of results, as found before, and now; prepared."""
    points = list(MapPoint._fields)
    before = before.drop_duplicates(points, keep="last")
    return {"before": prepared(before.merge(results[points])), "now": prepared(results.merge(before[points]))}


def compared(both):
    """Table of a version before and of now, by variant, on the points of `common`."""
    tables = {when: by_variant(found) for when, found in both.items()}
    named = [table.assign(variant=table.variant + f", {when}") for when, table in tables.items()]
    return pd.concat(named).sort_index(kind="stable")


def figures(results, fixed, both, folder):
    """Draw the heat maps into figures/ of a folder; returns their paths there, by title. fixed : of `with_fixed_steps`."""
    path = "figures/stability_{}.png".format
    for name, figure in FIGURES.items():
        draw(fixed if name == "fixed_step" else results, figure, folder / path(name))
    for when, found in both.items():
        draw(found, COMPARED, folder / path(when), f"{when}: ")
    titles = {f"{figure[0]}: verdicts, and differences from the refinement": path(name) for name, figure in FIGURES.items()}
    return titles | {f"Heat maps, {when}": path(when) for when in both}


def prepared_again(whole):
    """Results of all maps of `kinds` as `prepared` makes them, with `of_map` in words."""
    names = whole.winch.astype(str) + ", ground " + whole.ground.astype(str)
    return prepared(whole.assign(of_map=names, ground=whole.ground == "flat"))


def with_fixed_steps(whole):
    """Results of all maps of `kinds` that are of dynamic tethers with fixed steps, prepared."""
    every = prepared_again(whole)
    return every[every.variant == DYNAMIC[1]]


def by_map_and_core(results):
    """Table of verdicts with a row for each map, one for all, and one for those that must be held."""
    of_core = pd.Categorical(np.where(results.index.isin(core_of(results).index), CORE, None), [CORE])
    return counted(results, "flights of", results.of_map, pd.Categorical(["all"] * len(results)), of_core)


def core_of(results):
    """Prepared results of tethers of which 97 % must be held."""
    return results.query("segment_length >= 0.1 and axial_damping > 0.0 and axial_stiffness <= 1e8")


def forbidden(whole):
    """Table of the points that none may be, in all maps of `kinds`."""
    every = prepared_again(whole)
    bad = every[every.verdict.isin(FORBIDDEN)]
    return bad[["of_map", "variant", "verdict", *(each for each in FACTS if each != "verdict"), "longest"]].rename(
        columns=FACTS | {"of_map": "map", "longest": "longest call [s]"}
    )


def regions(whole):
    """Table of the verdicts by region in all maps of `kinds`: of the dynamic tethers, a row for each map and region."""
    tables = {}
    for (winch, ground), mine in whole.groupby(["winch", "ground"], observed=True):
        points = prepared(mine.assign(ground=ground == "flat"))
        tables |= {(winch, ground, name): by_region(points, name) for name in DYNAMIC}
    names = ["winch", "ground", "variant"]
    return pd.concat(tables, names=names).reset_index(names)


def write(results, before, also, folder, with_figures, others=()):
    """Write the page, the table by region, and if asked for the figures, to a folder (Path); returns the summary as text.

    results, before, also : tables of results, of now, of another version and of another seed (which may both be empty).
    others : tables of results with other winches and grounds.
    """
    pages, data = folder / "measurements", folder / "data"
    for each in (pages, data):
        each.mkdir(parents=True, exist_ok=True)
    points, both = prepared(results), common(results, before) if len(before) else {}
    core = core_of(points)
    held = f"{100.0 * core.held.mean():.1f} % of {len(core)} points are converged or stable."
    tables = {"by_variant": by_variant, "worst": worst, "compared": compared}
    bounds = {"amplification": AMPLIFICATION, "longest_call": LONGEST_CALL}
    whole = kinds(results, *others)
    fixed = with_fixed_steps(whole)
    drawn = figures(points, fixed, both, folder) if with_figures else {}
    found = {"points": points, "core": core, "held": held, "both": both, "also": prepared(also) if len(also) else None}
    found |= {"whole": whole, "fixed": fixed, "fixed_by_map": by_map_and_core(fixed), "failed": forbidden(whole)}
    found |= {"maps": by_map(whole), "requests": by_request(whole), "all_refusals": refusals_by_map(whole)}
    text = page("page.md.j2", Path(__file__).parent, figures=drawn, **found, **tables, **bounds)
    (pages / "stability.md").write_text(text, encoding="utf-8")
    regions(whole).to_csv(data / "stability_by_region.csv", index=False, float_format="%.3g")
    return f"{markdown(by_variant(points))}\n{held}"


def run(options):
    """Judge all points and write their page, or judge one and print it; returns 1 if a point is what none may be.

    options : of `make_stability.py`.
    """
    control = dict(quantities(Winch))["winch_control"].numbers[options.control]
    if options.point is not None:
        chosen = point(options.seed, options.point, control, options.ground)
        for name, value in (chosen._asdict() | judge(chosen)._asdict()).items():
            print(f"{name:20} {value}")
        return 0
    numbers = range(QUICK if options.quick else options.points)
    points = [point(options.seed, number, control, options.ground) for number in numbers]
    for model in (*MODELS.values(), TetherDynamicFree):
        model()  # compiles, so that not each process has to
    name = f"stability_{options.seed}" + ("" if options.control == "speed" else f"_{options.control}")
    name += "_ground" if options.ground else ""
    file = options.results or options.out / f"{name}.jsonl"
    with keeping():
        results = judge_all(points, file, options.processes, options.dask)
    before, also = (read(file) if file else results[:0] for file in (options.before, options.also))
    others = [read(each) for each in options.others]
    print(write(results, before, also, options.out, with_figures=not options.quick, others=others))
    bad = results[results.verdict.isin(FORBIDDEN)]
    for number, verdict in zip(bad.number[:20], bad.verdict, strict=False):
        print(f"point {number}: {verdict}", file=sys.stderr)
    return 1 if len(bad) else 0
