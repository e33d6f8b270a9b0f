"""The pages docs/use/how_much_tether.md and quality_of_advice.md and their tables; also, how often the advice holds."""

from dataclasses import replace
from pathlib import Path
from time import process_time

import pandas as pd

from tetherfmu.files.scene_files import load
from tetherfmu.records.problems import StepRefused
from tetherfmu.study.advice.configurations import LEVELS, REFERENCE_ERROR, cheapest, measure, study
from tetherfmu.study.advice.reasons import TABLE
from tetherfmu.study.advice.scene_advice import BUDGET, FAST_BUDGET, advise
from tetherfmu.study.measuring.errors import judging, worst
from tetherfmu.study.measuring.executors import executor_of, progress_bar
from tetherfmu.study.measuring.store import POINTS, Store, keeping
from tetherfmu.study.measuring.tables import factor, known, page, percent

from .figures import draw_chart, draw_scenes, draw_sweeps
from .random_scenes import random_scenes

TEMPLATES = Path(__file__).parent
NAMES = ("kite_force",)
UNSEEN = 40
BY_SCENE = (  # columns of the table of the cheapest tethers and the advised ones
    "scene",
    "allowed",
    "cheapest",
    "error",
    "times real time, kernel",
    "times real time, FMPy",
    "advised",
    "error of the advised",
    "cost ratio",
)
BY_REFERENCE = ("scene", "reference", "half the segments", "double step, 10 x tolerance", "together", "points")
SHOWN = ("straight", "catenary", "quasi_steady 4", "quasi_steady 11", "quasi_steady 32", "dynamic 32")  # tethers, segments


def asking(scene, allowed):
    """The scene, asking for the force on the kite within an allowed error."""
    return replace(scene, wanted=replace(scene.wanted, outputs=NAMES, allowed_error=allowed))


def advised(scene, budget):
    """The advice for the force on the kite within a budget [s], and the time that it took [s]."""
    began = process_time()
    return advise(scene, budget), process_time() - began


def verdict(scene, advice, seconds, error, own):
    """What is true of an advice with an error that a reference found, whose own error is `own`: a dict of texts and numbers.

    `met`, `wrong`: the allowed error was said to be met, and is, even if the reference errs, or may not be. `inside`: the
    error lies within the two that were said.
    """
    said = {"seconds": seconds, "advised": advice.point.config.words(), "cost": advice.point.cost, "claimed": advice.met}
    said |= {"least": advice.least, "expected": advice.expected, "tried": len(advice.points), "error": error}
    allowed, inside = error + own <= scene.wanted.allowed_error, advice.least - own <= error <= advice.expected + own
    return said | {"met": advice.met and allowed, "wrong": advice.met and not allowed, "inside": inside}


def judged(scene, reference=None):
    """`verdict` on the advice and, as `fast`, on the fast advice; with the scene and what is allowed.

    reference : by default one that is ten times finer than the errors of both, where there is one.
    """
    advices = [advised(scene, budget) for budget in (BUDGET, FAST_BUDGET)]
    errors = lambda flown: [measure(scene, advice.point.config, flown).error(NAMES) for advice, _ in advices]  # noqa: E731
    if reference is None:
        reference, found = judging(scene, errors, NAMES, min(REFERENCE_ERROR, 0.1 * scene.wanted.allowed_error))
    else:
        found = errors(reference.run.flown)
    own = reference.own_error(NAMES)
    slow, fast = (verdict(scene, *advice, error, own) for advice, error in zip(advices, found, strict=True))
    return {"scene": scene.name, "allowed": scene.wanted.allowed_error, "own_error": own, **slow, "fast": fast}


def summary(verdicts):
    """Table of what became of both advices; `verdicts` are as of `judged`."""
    rows = {"advice": pd.DataFrame(verdicts), "fast advice": pd.DataFrame([each["fast"] for each in verdicts])}
    return pd.DataFrame(
        {
            "": name,
            "claimed as met": table.claimed.sum(),
            "and was not": table.wrong.sum(),
            "true error as predicted": f"{table.inside.sum()} ({table.inside.mean():.0%})",
            "processor time [s]: median": f"{table.seconds.median():.2f}",
            "longest": f"{table.seconds.max():.2f}",
            "most configurations tried": table.tried.max(),
        }
        for name, table in rows.items()
    )


def unseen(scene):
    """`judged` in a scene with the error that it asks for; None if no reference can be flown."""
    try:
        return judged(scene)
    except StepRefused:
        return None


def at_all_levels(scene, reference):
    """`judged` in a scene for each of the levels of the trade-off study."""
    return [judged(asking(scene, level), reference) for level in LEVELS]


def limits():
    """Table of where each tether ceases to be adequate: a row for each number and tether, a column for each error."""
    table = pd.read_csv(TABLE).astype({"stretch": str}).replace({"stretch": {"0.0": "-"}})
    tethers = (table.variant + " " + table.segments.astype(str)).str.removesuffix(" 0")
    table = table.assign(tether=tethers, text=table.value.map("{:.2g}".format).replace("inf", "never"))
    shown = table[tethers.isin(SHOWN)].assign(error=table.level.map("{:.1%}".format))
    keys = {"index": ["group", "stretch", "tether"], "columns": "error", "values": "text", "sort": False}
    return shown.pivot_table(aggfunc="first", **keys).reset_index()


def by_reference(results):
    """Table of how good the references are; `results` are as of `write`."""
    rows = []
    for scene, (reference, points, _) in results.items():
        errors = worst(reference.space, NAMES), worst(reference.time, NAMES), reference.own_error(NAMES)
        rows.append((scene.name, reference.config.words(), *map(percent, errors), len(points)))
    return pd.DataFrame(rows, columns=BY_REFERENCE)


def choice():
    """Text of docs/use/how_much_tether.md; its figures are measured, its words are not."""
    return page("choose.md.j2", TEMPLATES, budget=BUDGET, fast_budget=FAST_BUDGET)


def by_scene(cases):
    """Table of the cheapest tether and the advised one; `cases` are scene, allowed error, point or None, and verdict."""
    rows = []
    for scene, level, best, verdict in cases:
        found, own = ("none", "-", "-", "-"), verdict["own_error"]
        if best is not None:
            found = best.config.words(), known(best.error, own), factor(best.cost), factor(best.host_cost)
        ratio = f"{verdict['cost'] / best.cost:.2g}" if best is not None else "-"
        rows.append((scene.name, percent(level), *found, verdict["advised"], known(verdict["error"], own), ratio))
    return pd.DataFrame(rows, columns=BY_SCENE)


def by_unseen(verdicts):
    """Table of what the advisor said of scenes and what is true; `verdicts` are as of `judged`."""
    rows = []
    for each in verdicts:
        row = {"scene": each["scene"], "allowed": percent(each["allowed"])}
        for way, said in (("", each), ("fast: ", each["fast"])):
            met = "yes" if said["met"] else "no" if said["wrong"] else "not claimed"
            predicted = f"{percent(said['least'])} to {percent(said['expected'])}"
            found = {
                "advised": said["advised"],
                "predicted": predicted,
                "true": known(said["error"], each["own_error"]),
                "met": met,
            }
            row |= {way + name: text for name, text in found.items()}
        rows.append(row)
    return pd.DataFrame(rows)


def write(results, verdicts, folder):
    """Write the pages and their tables to a folder (Path).

    results : maps scenes to (reference, table of points, verdicts on the advice by level).  verdicts : on unseen scenes,
    None where no reference could be flown.
    """
    cases = [
        (scene, level, cheapest(points, level), verdict)
        for scene, (_, points, verdicts) in results.items()
        for level, verdict in zip(LEVELS, verdicts, strict=True)
    ]
    dearest = max(verdict["cost"] / best.cost for *_, best, verdict in cases if best is not None)
    unseen = [each for each in verdicts if each]
    facts = {"cases": cases, "dearest": dearest, "unseen": unseen, "summary": summary}
    pages, data = folder / "use", folder / "data"
    for each in (pages, data):
        each.mkdir(parents=True, exist_ok=True)
    (pages / "how_much_tether.md").write_text(choice(), encoding="utf-8")
    (pages / "quality_of_advice.md").write_text(page("quality.md.j2", TEMPLATES, **facts), encoding="utf-8")
    tables = {"by_scene": by_scene(cases), "unseen": by_unseen(unseen), "references": by_reference(results)}
    for name, table in (tables | {"thresholds": limits()}).items():
        table.to_csv(data / f"advice_{name}.csv", index=False)


def run(options):
    """Measure all and write the pages and their figures; options : of `make_how_much_tether.py`."""
    scenes, figures = [asking(load(path), 0.01) for path in options.scenes], options.out / "figures"
    stores = [Store(options.store / scene.name / POINTS) for scene in scenes]
    with keeping(), executor_of() as executor:
        studied = [study(scene, store, executor, repeats=1) for scene, store in zip(scenes, stores, strict=True)]
        references = [reference for reference, _ in studied]
        known, others = executor.map(at_all_levels, scenes, references), executor.map(unseen, random_scenes(UNSEEN))
        advice = progress_bar(known, len(scenes), "advice")
        results = {scene: (*found, verdicts) for scene, found, verdicts in zip(scenes, studied, advice, strict=True)}
        others = list(progress_bar(others, UNSEEN, "unseen scenes"))
    figures.mkdir(parents=True, exist_ok=True)
    draw_scenes(results, NAMES, figures / "scenes.svg")
    draw_sweeps(figures / "thresholds.svg")
    draw_chart(figures / "decision.svg")
    write(results, others, options.out)
