"""Measure docs/data/fmus.csv and write the table of README.md from it: `python docs/make/make_fmu_table.py`.

Errors are those of the force on the kite, as docs/use/quality_of_advice.md defines them, with 20 segments, a communication
step of 20 ms and the default tolerance, against a reference that is refined until its own error is at most a tenth of the
smallest error of its scene. Costs are read from docs/data/benchmarks.csv, "FMUs in FMPy".
"""

import csv
import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
README, DATA = DOCS.parent / "README.md", DOCS / "data"
MEASURED, COSTS = DATA / "fmus.csv", DATA / "benchmarks.csv"
SCENES = {"reel": "taut, reeling", "figure_of_eight": "figure of eight", "circle": "slack circle"}
SEGMENTS, STEP, TOLERANCE, FIRST_REFERENCE, NAMES = 20, 0.02, 1e-4, 2e-5, ("kite_force",)
REFERENCE, CIRCUMSTANCES = "own error of the reference", "circumstances"  # rows of `MEASURED` beside the FMUs
NEEDED_FOR = {
    "TetherStraight": "tension of a taut tether",
    "TetherCatenary": "sag, rest, slow flight",
    "TetherQuasiSteady": "a flying kite, without waves",
    "TetherDynamic": "also waves, snap loads, slack",
    "TetherDynamicFree": "the same with the kite inside",
}


def measure():
    """Write the errors of the four tethers with driven ends in three scenes, and of their references, to `MEASURED`."""
    from tetherfmu.files.scene_files import load
    from tetherfmu.runtime.variants import BY_NAME, VARIANTS, class_name
    from tetherfmu.study.advice.configurations import measure
    from tetherfmu.study.measuring.errors import fine_enough, judging
    from tetherfmu.study.measuring.runs import Config
    from tetherfmu.study.measuring.tables import circumstances

    configs = [
        Config(each.name, SEGMENTS if each.has_nodes else 0, TOLERANCE if each.has_waves else 0.0, STEP)
        for each in map(BY_NAME.get, VARIANTS)
    ]
    columns = [["fmu", *map(class_name, VARIANTS), REFERENCE]]
    for name in SCENES:
        scene = load(DOCS.parent / "examples" / "scenes" / f"{name}.toml")
        errors = lambda flown, scene=scene: [measure(scene, each, flown).error(NAMES) for each in configs]  # noqa: E731
        reference, found = judging(scene, errors, NAMES, FIRST_REFERENCE)
        own = reference.own_error(NAMES)
        if not fine_enough(own, found):
            raise SystemExit(f"{name}: the reference ({own:.2g}) is not ten times finer than {min(found):.2g}")
        columns.append([name, *found, own])
    with MEASURED.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([*zip(*columns, strict=True), (CIRCUMSTANCES, circumstances())])


def costs():
    """Time of a communication step in FMPy [us] by FMU: inputs set, step, forces read."""
    with COSTS.open(encoding="utf-8", newline="") as file:
        return {row[1]: float(row[5]) for row in csv.reader(file) if row[0] == "FMUs in FMPy"}


def measured_on(path):
    """Date, processor and Python of a table of measurements."""
    with path.open(encoding="utf-8", newline="") as file:
        (text,) = (row[1] for row in csv.reader(file) if row[0] == CIRCUMSTANCES)
    return text.partition(", tetherfmu")[0].replace("(R)", "")


def table():
    """The table as Markdown, and what it was measured on."""
    spent = costs()
    with MEASURED.open(encoding="utf-8", newline="") as file:
        errors = {name: values for name, *values in list(csv.reader(file))[1:]}
    heads = " | ".join(f"error [%]: {scene}" for scene in SCENES.values())
    lines = [f"| file | use it for | time per step [µs] | {heads} |", "|---" * 6 + "|"]
    for name, purpose in NEEDED_FOR.items():
        cost = f"{spent[name]:.0f}" if name in spent else "-"
        found = [f"{100.0 * float(error):.2g}" for error in errors.get(name, ())] or ["-"] * len(SCENES)
        lines.append(f"| `{name}.fmu` | {purpose} | {cost} | " + " | ".join(found) + " |")
    return "\n".join(lines) + (
        f"\n\nTime: a step of 20 ms in FMPy ({measured_on(COSTS)}).\n"
        f"Error: force on the kite, {SEGMENTS} segments, against a reference whose own error is at most a tenth of the\n"
        f"smallest error (`python docs/make/make_fmu_table.py`, {measured_on(MEASURED)})."
    )


def with_table(text):
    """The README with the present table."""
    return re.sub(r"\| file \|.*?\n\nTime: .*?(?=\n\n)", lambda _: table(), text, flags=re.DOTALL)


if __name__ == "__main__":
    measure()
    README.write_text(with_table(README.read_text(encoding="utf-8")), encoding="utf-8")
    print(table())
