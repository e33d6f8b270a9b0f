"""The page docs/how_much_tether.md: `python -m tetherfmu.study page --out docs`. Every number on it is measured here."""

from dataclasses import fields
from pathlib import Path

from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.measuring.errors import worst
from tetherfmu.study.measuring.store import Store
from tetherfmu.study.measuring.tables import page
from tetherfmu.study.scenes.files import OUTPUTS, Scene, Wanted, Wind, load
from tetherfmu.study.scenes.flights import KINDS
from tetherfmu.study.scenes.random_scenes import SEED, random_scenes
from tetherfmu.study.scenes.units import spellings

from .advisor_check import NAMES, asking, at_all_levels, unseen
from .figures import draw_scenes, draw_sweeps
from .forecast import MARGIN
from .thresholds import read
from .tradeoff import LEVELS, cheapest, study

TEMPLATE = Path(__file__).with_name("page.md.j2")
UNSEEN = 40
SHOWN = ("straight", "catenary", "quasi_steady 4", "quasi_steady 11", "quasi_steady 32", "dynamic 32")  # tethers, segments


def threshold_rows():
    """Thresholds of some tethers: texts of the three levels by (group, stretch, tether and segments)."""
    table = read()
    tethers = (table.variant + " " + table.segments.astype(str)).str.removesuffix(" 0")
    table = table.assign(tether=tethers, text=table.value.map("{:.2g}".format).replace("inf", "never"))
    return table[tethers.isin(SHOWN)].groupby(["group", "stretch", "tether"], sort=False).text.apply(list)


def keys_of(record, section, leave_out=()):
    """Rows of a table of keys: every quantity of a record with its units, default and range."""
    defaults = {item.name: item.default for item in fields(record)}
    return [
        (
            f"`{section}.{name}`" if section else f"`{name}`",
            spellings(declared.unit).replace("no unit", "-"),
            f"{defaults[name]:.4g}",
            declared.range(),
            declared.meaning,
        )
        for name, declared in quantities(record)
        if name not in leave_out
    ]


def scene_file_keys():
    """Rows of the table of the keys of a scene file, from the declarations; those of its flight are apart."""
    velocity = ("`wind.velocity`", "m/s, km/h, kn", "[0, 0, 0]", "each from -200 to 200 m/s", "mean wind, x, y, z")
    outputs = ("`wanted.outputs`", "-", '["kite_force"]', "some of " + ", ".join(OUTPUTS), "what the allowed error is for")
    tether = [*keys_of(Scene, ""), *keys_of(Tether, "tether", ("segments",)), *keys_of(Environment, "environment")]
    return [*tether, velocity, *keys_of(Wind, "wind"), outputs, *keys_of(Wanted, "wanted")]


def declared():
    """What the page says that is not measured for it."""
    flights = {kind: (flight.__doc__, keys_of(flight, "flight")) for kind, flight in KINDS.items()}
    return {"thresholds": threshold_rows(), "keys": scene_file_keys(), "flights": flights}


def how_much_tether(results, unseen_verdicts, work_precision):
    """The page as Markdown; `results` maps scenes to (reference, table of points, verdicts on the advice by level)."""
    cases = [
        (scene, level, cheapest(points, level), verdict)
        for scene, (_, points, verdicts) in results.items()
        for level, verdict in zip(LEVELS, verdicts, strict=True)
    ]
    return page(
        TEMPLATE,
        **declared(),
        results=results,
        names=NAMES,
        worst=worst,
        cases=cases,
        met=sum(verdict.met for *_, verdict in cases),
        dearest=max(verdict.point.cost / best.cost for *_, best, verdict in cases if best is not None),
        unseen=unseen_verdicts,
        seed=SEED,
        margin=MARGIN,
        work_precision=work_precision,
    )


def make(scene_files, folder, store_folder, executor, progress):
    """Measure all and write the page and its figures to a folder; finished points are taken from the stores."""
    folder = Path(folder)
    figures = folder / "figures"
    scenes = [asking(load(path), 0.01) for path in scene_files]
    stores = [(scene, Store(Path(store_folder) / scene.name)) for scene in scenes]
    studied = [study(scene, store, executor, progress(scene.name), repeats=1) for scene, store in stores]
    references = [reference for reference, _ in studied]
    known, others = executor.map(at_all_levels, scenes, references), executor.map(unseen, random_scenes(UNSEEN))
    advice = progress("advice")(known, len(scenes))
    results = {scene: (*found, verdicts) for scene, found, verdicts in zip(scenes, studied, advice, strict=True)}
    others = list(progress("unseen scenes")(others, UNSEEN))
    figures.mkdir(parents=True, exist_ok=True)
    draw_scenes(results, NAMES, figures / "scenes.png")
    draw_sweeps(figures / "thresholds.png")
    text = how_much_tether(results, others, (figures / "work_precision_flights.png").exists())
    (folder / "how_much_tether.md").write_text(text, encoding="utf-8")
