"""Random points are judged, and their page is written.

The page, stability.md, has tables by variant and by map, the share of converged flights as a figure, and the extreme
scenarios with a known answer (extremes.md.j2), which are not measured here. Other tables are CSV files.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.python.models import TetherDynamicFree
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Winch
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.measuring.start import MODELS
from tetherfmu.study.measuring.store import keeping
from tetherfmu.study.measuring.tables import markdown, page

from .figure import DYNAMIC, FREE_KITE, QUANTITIES, REGIONS, STATIC, UNDAMPED, bands, draw
from .flight import FORBIDDEN, HELD, LONGEST_CALL, VERDICTS, judge, judge_all, read
from .points import SLACK_RATIO, VARIANTS, VARIANTS_ON_GROUND, MapPoint, point
from .requests import POSSIBLE, REQUESTS, request

QUICK = 60  # points
STARTS = ("start: static", "start: quasi-steady", "start: straight")  # of `initial_shape` 1, 2, 3
WORST = QUANTITIES.worst.dropna().to_dict()
ON_GROUND = dict(zip(VARIANTS_ON_GROUND, (*DYNAMIC, FREE_KITE, *STATIC[:2]), strict=True))  # names for people
OVER = dict(zip(VARIANTS, (*DYNAMIC, *STATIC), strict=True))
COMPRESSED = {key: name for key, name in (OVER | ON_GROUND).items() if name not in STATIC[1:]}  # segments may be slack
FACTS = QUANTITIES.column.dropna().to_dict()  # heads of the table of the worst
CORE = "segments of 0.1 m and more, damped, EA up to 1e8 N"
MAP = ["winch", "ground", "slack_ratio"]  # columns of `kinds` that say which map a point is of
CONTROLS = dict(zip((at.WINCH_BY_SPEED, at.WINCH_BY_FORCE, at.WINCH_BY_LENGTH), ("speed", "force", "length"), strict=True))


def prepared(results):
    """Results with variants, starts and verdicts in order and named for people, and with what follows from a point."""
    names = ON_GROUND if results.ground.any() else OVER
    return results.assign(
        variant=pd.Categorical(results.variant.map(names), [*names.values()]),
        verdict=pd.Categorical(results.verdict, VERDICTS),
        held=results.verdict.isin(HELD),
        start=pd.Categorical(results.initial_shape, (1, 2, 3)).rename_categories(STARTS),
        segment_length=results.length / results.segments,
        slack_percent=100.0 * results.slack,
    )


def asked(results):
    """What each point asks for: Categorical of `REQUESTS`."""
    points = results[list(MapPoint._fields)].itertuples(index=False, name=None)
    return pd.Categorical([request(MapPoint(*each)) for each in points], REQUESTS)


def kinds(*tables):
    """Results of several maps in one table; `winch`, `ground` and `slack_ratio` say which map a point is of (`MAP`)."""
    whole = pd.concat([table for table in tables if len(table)], ignore_index=True)
    ratios = whole.slack_stiffness_ratio
    return whole.assign(
        winch=pd.Categorical(whole.control.map(CONTROLS), [*CONTROLS.values()]),
        ground=pd.Categorical(np.where(whole.ground, "flat", "none"), ("none", "flat")),
        slack_ratio=pd.Categorical(ratios, sorted(ratios.unique(), reverse=True)),
        asks=asked(whole),
    )


def maps(whole):
    """Pairs of a map in `whole`, of `kinds`, and its results: (winch, ground, slack ratio), table."""
    return whole.groupby(MAP, observed=True)


def name_of_map(winch, ground, slack_ratio):
    """Name of a map: the slack ratio only where it is not the default."""
    return f"{winch}, ground {ground}" + ("" if slack_ratio == SLACK_RATIO else f", slack ratio {slack_ratio:g}")


def names_of_maps(whole):
    """Name of the map of each point, array."""
    return np.array([name_of_map(*each) for each in whole[MAP].itertuples(index=False, name=None)])


def by_map(whole):
    """Table with a row for each map of `kinds`: verdicts, and refusals of points that ask for what can be."""
    rows = []
    for (winch, ground, slack_ratio), mine in maps(whole):
        shares = mine.verdict.value_counts(normalize=True)
        can = mine[mine.asks == POSSIBLE]
        rows.append(
            {"winch control": winch, "ground": ground, "slack ratio": slack_ratio, "points": len(mine)}
            | {f"{verdict} %": 100.0 * shares.get(verdict, 0.0) for verdict in VERDICTS[:3]}
            | {verdict: int((mine.verdict == verdict).sum()) for verdict in FORBIDDEN}
            | {"given up %": 100.0 * (mine.unresolved & mine.verdict.isin(HELD)).mean()}
            | {"possible": len(can), "refused of these %": 100.0 * (can.verdict == "refused").mean()}
        )
    return pd.DataFrame(rows)


def with_each_ratio(whole):
    """Results of `kinds` of the points that each of its slack ratios has been flown with."""
    same = whole.groupby(["seed", "number", "control", "ground"], observed=True).slack_ratio
    return whole[same.transform("nunique") == whole.slack_ratio.nunique()]


def by_slack_ratio(whole):
    """Table of the verdicts on `with_each_ratio`: rows for each variant that knows slack segments, and for all of these."""
    chosen = with_each_ratio(whole[whole.variant.isin(COMPRESSED)])
    names = pd.Categorical(chosen.variant.map(COMPRESSED), [*COMPRESSED.values()])
    every = prepared_again(chosen).assign(variant=names)
    tables = {ratio: by_variant(mine) for ratio, mine in every.groupby("slack_ratio", observed=True)}
    both = pd.concat(tables, names=["slack ratio", "row"]).sort_index(level="row", sort_remaining=False, kind="stable")
    return both.reset_index("slack ratio").set_index("variant").reset_index()


def side_by_side(table):
    """Shares of `by_slack_ratio` that converge or are refused, with a row for each variant."""
    rows, ratios = table.groupby("variant", sort=False), table["slack ratio"].unique()
    shares = {
        f"{name}, ratio {ratio:g}": table[table["slack ratio"] == ratio].set_index("variant")[name]
        for name in ("converged %", "refused %")
        for ratio in ratios
    }
    return pd.DataFrame({"points": rows.points.first(), **shares}).reset_index()


def by_request(whole):
    """Table with a row for each of `REQUESTS`: how many points ask for it, and how many of these are refused in each map."""
    rows = []
    for words in REQUESTS:
        those = {name_of_map(*each): mine[mine.asks == words] for each, mine in maps(whole)}
        counts = {name: f"{(mine.verdict == 'refused').sum()} of {len(mine)}" for name, mine in those.items()}
        rows.append({"asks for": words} | counts)
    return pd.DataFrame(rows)


def refusals_by_map(whole):
    """Table of refusals of all maps by their sentence, and when: a column for each map."""
    refused = whole[whole.refusal != ""]
    when = np.where(refused.calls == 0, "at the start", "in flight")
    rows = [
        refused.variant.map(OVER | ON_GROUND),
        refused.refusal.rename("sentence"),
        pd.Series(when, refused.index, name="when"),
    ]
    return pd.crosstab(rows, names_of_maps(refused)).reset_index()


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
    mine, labellings = results[results.variant == variant], []
    for each in REGIONS.drop([] if variant == "dynamic, fixed step" else "fixed_step").itertuples():
        labels = bands(each)
        limits = sorted({limit for band in labels.values() for limit in band})
        labellings.append(pd.cut(mine[each.Index], limits, right=False, labels=[*labels]))
    return counted(mine, "region", *labellings, mine.start).replace({"region": {UNDAMPED: "without damping"}})


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


def prepared_again(whole):
    """Results of all maps of `kinds` as `prepared` makes them, with `of_map` in words."""
    return prepared(whole.assign(of_map=names_of_maps(whole), ground=whole.ground == "flat"))


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
    for each, mine in maps(whole):
        points = prepared(mine.assign(ground=mine.ground == "flat"))
        tables |= {(*each, name): by_region(points, name) for name in DYNAMIC}
    names = [*MAP, "variant"]
    return pd.concat(tables, names=names).reset_index(names)


def write(results, folder, with_figure, others=()):
    """Write the page, its CSV files, and if asked for the figure, to a folder (Path); returns the summary as text.

    others : tables of results with other winches, grounds and slack ratios.
    """
    pages, data = folder / "measurements", folder / "data"
    for each in (pages, data):
        each.mkdir(parents=True, exist_ok=True)
    points, whole = prepared(results), kinds(results, *others)
    core, fixed = core_of(points), with_fixed_steps(whole)
    held = f"{100.0 * core.held.mean():.1f} % of {len(core)} flights are converged or bounded."
    files = {"by_region": regions(whole), "by_map": by_map(whole), "refusals": refusals_by_map(whole)}
    files |= {"requests": by_request(whole), "fixed_steps": by_map_and_core(fixed), "worst": worst(points)}
    if whole.slack_ratio.nunique() > 1:
        files["slack_ratios"] = by_slack_ratio(whole)
    for name, table in files.items():
        table.to_csv(data / f"stability_{name}.csv", index=False, float_format="%.3g")
    if with_figure:
        draw(files["by_region"], folder / "figures" / "stability.svg")
    found = {"points": points, "variants": by_variant(points), "held": held, "whole": whole, "fixed": fixed}
    ratios = side_by_side(files["slack_ratios"]) if "slack_ratios" in files else None
    found |= {"ratios": ratios, "compared": with_each_ratio(whole), "maps": files["by_map"], "failed": forbidden(whole)}
    found |= {"longest_call": LONGEST_CALL, "with_figure": with_figure}
    (pages / "stability.md").write_text(page("page.md.j2", Path(__file__).parent, **found), encoding="utf-8")
    return f"{markdown(found['variants'])}\n{held}"


def run(options):
    """Judge all points and write their page, or judge one and print it; returns 1 if a point is what none may be.

    options : of `make_stability.py`.
    """
    if options.redraw:
        draw(pd.read_csv(options.out / "data" / "stability_by_region.csv"), options.out / "figures" / "stability.svg")
        return 0
    control = dict(quantities(Winch))["winch_control"].numbers[options.control]
    if options.point is not None:
        chosen = point(options.seed, options.point, control, options.ground, options.slack_ratio)
        for name, value in (chosen._asdict() | judge(chosen)._asdict()).items():
            print(f"{name:20} {value}")
        return 0
    numbers = range(QUICK if options.quick else options.points)
    points = [point(options.seed, number, control, options.ground, options.slack_ratio) for number in numbers]
    for model in (*MODELS.values(), TetherDynamicFree):
        model()  # compiles, so that not each process has to
    name = f"stability_{options.seed}" + ("" if options.control == "speed" else f"_{options.control}")
    name += "_ground" if options.ground else ""
    name += "" if options.slack_ratio == SLACK_RATIO else f"_{options.slack_ratio:g}"
    file = options.results or options.out / f"{name}.jsonl"
    with keeping():
        results = judge_all(points, file, options.processes, options.dask)
    others = [read(each) for each in options.others]
    print(write(results, options.out, with_figure=not options.quick, others=others))
    if options.before:
        print(markdown(compared(common(results, read(options.before)))))
    bad = results[results.verdict.isin(FORBIDDEN)]
    for number, verdict in zip(bad.number[:20], bad.verdict, strict=False):
        print(f"point {number}: {verdict}", file=sys.stderr)
    return 1 if len(bad) else 0
