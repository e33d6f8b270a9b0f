"""Measure docs/data/fmus.csv and write the table of README.md from it: `python docs/make/make_fmu_table.py`.

Errors are those of the force on the kite, as docs/use/quality_of_advice.md defines them, with 20 segments, a communication
step of 20 ms and the default tolerance, against a reference that is refined until it is exact to 0.1 % or better. Costs are
read from docs/data/benchmarks.csv, "FMUs in FMPy".
"""

import csv
import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
README, DATA = DOCS.parent / "README.md", DOCS / "data"
MEASURED, COSTS = DATA / "fmus.csv", DATA / "benchmarks.csv"
SCENES = {"reel": "taut, reeling", "figure_of_eight": "figure of eight", "circle": "slack circle"}
SEGMENTS, STEP, TOLERANCE, OWN_ERROR, NAMES = 20, 0.02, 1e-4, 1e-3, ("kite_force",)
NEEDED_FOR = {
    "TetherStraight": "tension of a taut tether",
    "TetherCatenary": "sag, rest, slow flight",
    "TetherQuasiSteady": "a flying kite, without waves",
    "TetherDynamic": "also waves, snap loads, slack",
    "TetherDynamicFree": "the same with the kite inside",
}


def measure():
    """Write the errors of the four tethers with driven ends in three scenes to `MEASURED`."""
    from tetherfmu.runtime.variants import VARIANTS, class_name
    from tetherfmu.study.advice.tradeoff import measure
    from tetherfmu.study.measuring.errors import converged
    from tetherfmu.study.measuring.runs import Config
    from tetherfmu.study.scenes.files import load

    rows = {variant: [class_name(variant)] for variant in VARIANTS}
    for name in SCENES:
        scene = load(DOCS.parent / "examples" / "scenes" / f"{name}.toml")
        reference = converged(scene, OWN_ERROR, NAMES)
        for variant in VARIANTS:
            chain, dynamic = variant in ("quasi_steady", "dynamic"), variant == "dynamic"
            config = Config(variant, SEGMENTS if chain else 0, TOLERANCE if dynamic else 0.0, STEP)
            rows[variant].append(measure(scene, config, reference.run.flown).error(NAMES))
    with MEASURED.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([["fmu", *SCENES], *rows.values()])


def costs():
    """Time of a communication step in FMPy [us] by FMU: inputs set, step, forces read."""
    with COSTS.open(encoding="utf-8", newline="") as file:
        return {row[1]: float(row[5]) for row in csv.reader(file) if row[0] == "FMUs in FMPy"}


def circumstances():
    """Date, processor and Python of the costs."""
    text = COSTS.read_text(encoding="utf-8").splitlines()[0].partition(",")[2].strip('"')
    return text.partition(", tetherfmu")[0].replace("(R)", "")


def table():
    """The table as Markdown, and what it was measured on."""
    spent = costs()
    with MEASURED.open(encoding="utf-8", newline="") as file:
        errors = {name: values for name, *values in list(csv.reader(file))[1:]}
    heads = " | ".join(f"{scene} [%]" for scene in SCENES.values())
    lines = [f"| file | use it for | time per step [µs] | {heads} |", "|---" * 6 + "|"]
    for name, purpose in NEEDED_FOR.items():
        cost = f"{spent[name]:.0f}" if name in spent else "-"
        found = [f"{100.0 * float(error):.2g}" for error in errors.get(name, ())] or ["-"] * len(SCENES)
        lines.append(f"| `{name}.fmu` | {purpose} | {cost} | " + " | ".join(found) + " |")
    return "\n".join(lines) + (
        f"\n\nTime: a step of 20 ms in FMPy ({circumstances()}). Error: force on the kite, {SEGMENTS} segments\n"
        "(`python docs/make/make_fmu_table.py`)."
    )


def with_table(text):
    """The README with the present table."""
    return re.sub(r"\| file \|.*?\n\nTime: .*?(?=\n\n)", lambda _: table(), text, flags=re.DOTALL)


if __name__ == "__main__":
    measure()
    README.write_text(with_table(README.read_text(encoding="utf-8")), encoding="utf-8")
    print(table())
