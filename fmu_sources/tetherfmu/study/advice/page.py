"""The page docs/how_much_tether.md: `python -m tetherfmu.study page --out docs`. Every number on it is measured here."""

from pathlib import Path

from tetherfmu.study.measuring.store import Store
from tetherfmu.study.measuring.tables import circumstances
from tetherfmu.study.scenes.files import load
from tetherfmu.study.scenes.random_scenes import SEED, random_scenes

from .advisor_check import NAMES, asking, at_all_levels, unseen
from .forecast import MARGIN
from .page_figures import draw_scenes, draw_sweeps
from .page_text import CLOSING, OPENING, scene_file_tables
from .scene_report import factor, percent, table
from .thresholds import LEVELS as THRESHOLD_LEVELS
from .thresholds import STRETCHES, read
from .tradeoff import LEVELS, cheapest, study

UNSEEN = 40


def scene_tables(results):
    """Lines: cheapest configurations and advice by level; `results` maps scenes to (reference, points, verdicts)."""
    rows, ratios, met = [], [], 0
    for scene, (_, points, verdicts) in results.items():
        for level, judged in zip(LEVELS, verdicts, strict=True):
            best = cheapest(points, level, NAMES)
            ratio = judged.cost / best.cost if best else float("nan")
            met += judged.met
            ratios += [ratio] if best else []
            found = (best.config.words(), percent(best.error(NAMES)), factor(best.cost)) if best else ("none", "-", "-")
            mine = (judged.config.words(), percent(judged.error), f"{ratio:.2g}" if best else "-")
            rows.append((scene.name, percent(level), *found, factor(best.host_cost) if best else "-", *mine))
    columns = ("scene", "allowed", "cheapest", "error", "x real time, kernel", "FMPy", "advised", "error", "cost ratio")
    told = f"The advice met the allowed error in {met} of {len(rows)} cases"
    return [*table(columns, rows), "", f"{told} and cost at most {max(ratios):.2g} times the cheapest."]


def reference_table(results):
    """Lines: how good the references are."""
    rows = []
    for scene, (reference, points, _) in results.items():
        space, time = (max(change[name] for name in NAMES) for change in (reference.space, reference.time))
        own = percent(reference.own_error(NAMES))
        rows.append((scene.name, reference.config.words(), percent(space), percent(time), own, str(len(points))))
    return table(("scene", "reference", "half the segments", "double step, 10 x tolerance", "together", "points"), rows)


def threshold_table():
    """Lines: thresholds of some tethers."""
    rows = []
    chosen = [("straight", 0), ("catenary", 0), ("quasi_steady", 4), ("quasi_steady", 11), ("quasi_steady", 32)]
    chosen.append(("dynamic", 32))
    values = {(r.group, r.stretch, r.variant, r.segments, r.level): r.value for r in read()}
    for group, stretch in [(g, s) for g in ("weight", "drag") for s in STRETCHES] + [("slack", 0.0), ("wave", 0.0)]:
        for variant, segments in chosen:
            found = [values.get((group, stretch, variant, segments, level)) for level in THRESHOLD_LEVELS]
            if None not in found:
                cells = ["never" if value == float("inf") else f"{value:.2g}" for value in found]
                rows.append((group, f"{stretch:g}" if stretch else "-", f"{variant} {segments or ''}".strip(), *cells))
    return table(("number", "stretch", "tether, segments", "0.1 %", "1 %", "10 %"), rows)


def unseen_table(verdicts):
    """Lines: the advice for unseen scenes."""
    judged = [each for each in verdicts if each]
    rows = []
    for each in judged:
        said = percent(each.expected) if each.claimed else f"not met, {percent(each.expected)}"
        right = "yes" if each.met else "no"
        fast = percent(each.fast_error), "yes" if each.fast_met else "no"
        rows.append((each.scene, percent(each.allowed), each.config.words(), said, percent(each.error), right, *fast))
    count, total = sum(each.met for each in judged), len(verdicts)
    fast = sum(each.fast_met for each in judged)
    silent = sum(each.claimed and not each.met for each in judged)
    columns = ("scene", "allowed", "advised", "told", "true", "met", "fast: true", "met")
    text = (
        f"The advised configuration met the allowed error in {count} of {total} scenes ({100 * count / total:.0f} %); "
        f"{silent} times it was told to be met and was not. The fast advice, from the numbers alone with "
        f"{percent(MARGIN)} of the allowed error used up, met it in {fast} ({100 * fast / total:.0f} %)."
    )
    return [text, "", *table(columns, rows)]


def page(results, verdicts, work_precision):
    """The page as Markdown."""
    lines = [OPENING, circumstances(), "", "## Which tether in which scene", ""]
    lines += [*scene_tables(results), "", "![Cost against error in each scene](figures/scenes.png)", ""]
    lines += ["## How good the references are", "", *reference_table(results), ""]
    lines += ["## Where each tether stops being enough", "", "![Error over each number](figures/thresholds.png)", ""]
    lines += [*threshold_table(), "", "## Scenes the advisor had not seen", ""]
    lines += [
        f"{UNSEEN} scenes at random, seed {SEED} (`tetherfmu.study.random_scenes`), 20 s each.",
        "",
        *unseen_table(verdicts),
        "",
    ]
    if work_precision:
        lines += ["## Work and precision", "", WORK_PRECISION, ""]
    return "\n".join([*lines, *scene_file_tables(), CLOSING])


WORK_PRECISION = """\
Our tether against CasADi + CVODES on two flights, 20 segments, drawn by `python -m tetherfmu.study benchmark --flights`;
[Benchmarks](benchmarks.md) says what is timed.

![Time against error of our tether and of CVODES](figures/work_precision_flights.png)"""


def make(scene_files, folder, store_folder, executor, progress):
    """Measure all and write the page and its figures to a folder; finished points are taken from the stores."""
    folder = Path(folder)
    scenes = [asking(load(path), 0.01) for path in scene_files]
    results = {}
    for scene in scenes:
        results[scene.name] = study(scene, Store(Path(store_folder) / scene.name), executor, progress(scene.name), repeats=1)
    jobs = {scene: executor.submit(at_all_levels, scene, results[scene.name][0]) for scene in scenes}
    others = [executor.submit(unseen, scene) for scene in random_scenes(UNSEEN)]
    done = {scene: (*results[scene.name], job.result()) for scene, job in progress("advice")(jobs.items(), len(jobs))}
    verdicts = [job.result() for job in progress("unseen scenes")(others, len(others))]
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    draw_scenes(done, NAMES, folder / "figures" / "scenes.png")
    draw_sweeps(folder / "figures" / "thresholds.png")
    text = page(done, verdicts, (folder / "figures" / "work_precision_flights.png").exists())
    (folder / "how_much_tether.md").write_text(text, encoding="utf-8")
