"""Declarations of the tethers for the page, a dict for JSON, from the same sources as the FMU.

Parameters, inputs and outputs with units and limits, their places in the flat arrays, texts of statuses and warnings, the
variants, the flights and scenes, and the wing of the free kite.
"""

import csv
import tomllib
from dataclasses import fields
from math import inf
from pathlib import Path

from tetherfmu.console.colours import COLOUR, GROUND, REFERENCE
from tetherfmu.files import scene_files as files
from tetherfmu.files.flights import KINDS
from tetherfmu.files.toml_files import TABLE_OF_GROUND, record, value_of
from tetherfmu.files.winds import Wind
from tetherfmu.libraries.examples import EXAMPLES, example
from tetherfmu.runtime import __version__, inputs, outputs, parameters, plausibility, quantities, status
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.parameters import SCALED, Tether
from tetherfmu.runtime.quantities import Quantity
from tetherfmu.runtime.variants import TABLE, class_name, library_of
from tetherfmu.wiring.fmu import CONTROLS
from tetherfmu.wiring.variables import PARAMETERS, records_of

from . import own_flights

ASSETS = Path(__file__).with_name("assets")
with (ASSETS / "usual.csv").open(encoding="utf-8") as _file:
    USUAL = {row.pop("name"): sorted(map(float, row.values())) for row in csv.DictReader(_file)}
DEGREES = {"rad": ["deg", quantities.DEGREES[1]], "rad/s": ["deg/s", quantities.DEGREES[1]]}  # as people read angles
TITLES = {"reel": "pumping cycle", "logged": "log of a flight"}  # of scenes with a title that differs from their name
FIRST = ("figure_of_eight", "circle", "reel")  # scenes at the head of the list


def usual(name, start, declared):
    """Range of a slider: minimum, maximum and whether it is logarithmic, a list, within the allowed range.

    Without an entry in `USUAL`, from a tenth of the default to ten times the default.
    """
    lower, upper = USUAL.get(name) or sorted((0.1 * start, 10.0 * start))
    lower, upper = max(lower, declared.minimum), min(upper, declared.maximum)
    return [lower, upper, lower > 0.0 and upper / lower >= 50.0]


def described(name, start, declared, kind="Real"):
    """One quantity, a dict; missing limits are None, as JSON has no infinity."""
    found = {"name": name, "kind": kind, "unit": declared.unit, "meaning": declared.meaning}
    found["minimum"] = None if declared.minimum == -inf else declared.minimum
    found["maximum"] = None if declared.maximum == inf else declared.maximum
    found |= {"range": declared.range(), "start": start, "display": list(declared.display) or DEGREES.get(declared.unit)}
    if declared.choices:
        return found | {"choices": list(declared.choices), "meanings": list(declared.choices.values())}
    return found | {"usual": usual(name, start, declared)}


def of_record(kind, left_out=()):
    """The quantities of a record with defaults, a list of dicts."""
    declared = ((name, each) for name, each in quantities.quantities(kind) if name not in left_out)
    return [described(name, getattr(kind, name), each) for name, each in declared]


def of_parameters():
    """The parameters of all tethers in the order of the kernel `pack`, each with its group."""
    groups = {item.name: kind.__name__ for kind in records_of("dynamic_free") for item in fields(kind)}
    listed = (each for each in PARAMETERS if each.name in groups)
    return [described(each.name, each.start, each.quantity, each.kind) | {"group": groups[each.name]} for each in listed]


def of_inputs():
    """The inputs, each with its place in the array and its start."""
    found = []
    for each in inputs.INPUT_TABLE:
        declared = Quantity(each.unit, each.meaning, -at.LARGEST_INPUT, at.LARGEST_INPUT)
        own = {"place": inputs.PLACES[each.name], "start": list(each.start)}
        found.append(described(each.name, each.start[0], declared) | own)
    return found


def of_outputs():
    """The outputs, each with its place in the array."""
    found = []
    for each in outputs.OUTPUT_TABLE:
        declared = {"unit": each.quantity.unit, "meaning": each.quantity.meaning}
        found.append({"name": each.name, "kind": each.kind} | declared | {"place": outputs.PLACES[each.name]})
    return found


def of_variants():
    """The variants from coarse to fine."""
    found = []
    for each in TABLE:
        names = {"name": each.name, "class": class_name(each.name), "library": library_of(each.name)}
        kind = {"nodes": each.has_nodes, "waves": each.has_waves, "free": each.kite_is_free}
        found.append(names | kind | {"colour": COLOUR[each.name], "ignored": each.ignored, "meanings": each.meanings})
    return found


def of_arrays():
    """Places in the flat arrays that the page reads, see `runtime.layout`, and in the plan of one line."""
    wanted = ("INPUTS", "SHAPE", "LENGTH", "TORN_SEGMENT", "TORN_AT", "WARNINGS", "WARNED_VALUES", "WINCH_FRICTION")
    wanted += (
        "SHORTEST_LENGTH",
        "LEAST_LENGTH",
        "LONGEST_LENGTH",
        "RELATIVE_TOLERANCE",
        "FIXED_STEP",
        "NO_STOP",
        "ITERATION_BUDGET",
    )
    of_line = ("SEGMENTS", "START_POINT", "END_POINT", "SHAPE_POINTS")
    plan = {name: places.PLAN_HEADER + getattr(places, name) for name in of_line} | {"LINES": places.LINES}
    plan |= {name: getattr(places, name) for name in ("PARAMETERS_SIZE", "STATE_SIZE", "OUTPUTS_SIZE", "WORK_SIZE")}
    return {**{name: getattr(at, name) for name in wanted}, "PLAN": plan, "PLAN_SIZE": places.plan_size(1)}


def of_sentences():
    """Messages of statuses by code and of warnings by kind, with their constant values."""
    return {
        "status": {str(code): sentence for code, sentence in status.SENTENCES.items()},
        "limits": status.LIMITS,
        "warnings": [{"sentence": each, "facts": plausibility.facts(kind)} for kind, each in plausibility.SENTENCES.items()],
        "out_of_range": quantities.OUT_OF_RANGE,
        "not_whole": quantities.NOT_WHOLE,
        "doubts": [
            {"name": name, "side": side, "limit": limit, "sentence": sentence}
            for record in (parameters.Tether, parameters.Environment)
            for name, declared in quantities.quantities(record)
            for side, limit, sentence in quantities.doubts_in(name, declared)
        ],
    }


def of_flights():
    """The kinds of flights: descriptions and quantities; for a free kite also its wing and its controller."""
    found = {
        name: {"about": kind.__doc__.partition("\n")[0], "free": kind.kite_is_free, "quantities": of_record(kind)}
        for name, kind in KINDS.items()
    }
    for name, kind in own_flights.KINDS.items():
        found[name] = {"about": kind.__doc__, "free": name == "free", "quantities": of_record(kind)}
    wing, controller = example("fmus.aerodynamics").Wing, example("fmus.flight_controller").Flight
    of_wing = [name for name, _ in quantities.quantities(wing)]
    groups = ("Wing", of_record(wing)), ("Controller", of_record(controller, of_wing))  # both have the turn rate law
    found["free"]["quantities"] += [{**each, "group": group} for group, listed in groups for each in listed]
    return found


def scene_of(path):
    """A scene file for the page: its first comment, its duration and its differences from the defaults, in SI units."""
    text = path.read_text(encoding="utf-8")
    table = tomllib.loads(text)
    title, about = TITLES.get(path.stem, path.stem.replace("_", " ")), text.partition("\n")[0].removeprefix("# ")
    head = {"title": title, "about": about}
    if table["flight"]["kind"] == "series":
        return head | scene_of_log(path.parent / table["flight"]["file"], table)
    scene = files.read(table, path.parent, path.stem)

    def given(section, found, prefix=""):
        return {prefix + key: getattr(found, key) for key in table.get(section, {}) if key != "kind"}

    ground = TABLE_OF_GROUND(**{key: getattr(scene.ground, f"ground_{key}") for key in table.get("ground", {})})
    scaled = {name: getattr(scene.tether, name) for name in SCALED if "diameter" in table["tether"]}
    own = given("tether", scene.tether) | scaled | given("environment", scene.environment)
    flown = {"duration": scene.duration, "kind": table["flight"]["kind"], "flight": given("flight", scene.flight)}
    return head | flown | {"parameters": own | given("ground", ground, "ground_"), "wind": given("wind", scene.wind)}


def scene_of_log(path, table):
    """The flight of a log, which the page smooths itself, with the tether of the scene.  path : of the CSV file."""
    tether, duration = record(Tether, table["tether"], "tether"), value_of(files.Scene, "duration", table["duration"], "")
    parameters_of_log = {key: getattr(tether, key) for key in table["tether"]}
    flown = {"duration": duration, "kind": "log", "flight": {}, "parameters": parameters_of_log, "wind": {}}
    return flown | {"file": path.name, "log": path.read_text(encoding="utf-8")}


def of_scenes():
    """The scenes of the examples by name."""
    paths = {path.stem: path for path in sorted((EXAMPLES / "scenes").glob("*.toml"))}
    found = {name: scene_of(paths[name]) for name in (*FIRST, *(each for each in paths if each not in FIRST))}
    return found | own_flights.SCENES


def declarations():
    """All of it."""
    return {
        "version": __version__,
        "arrays": of_arrays(),
        "parameters": of_parameters(),
        "inputs": of_inputs(),
        "outputs": of_outputs(),
        "winch_inputs": CONTROLS,
        "variants": of_variants(),
        "sentences": of_sentences(),
        "flights": of_flights(),
        "scenes": of_scenes(),
        "wind": of_record(Wind),
        "wind_velocity": of_record(own_flights.WindVelocity),
        "hand": of_record(own_flights.Hand),
        "colours": {"ground": GROUND, "reference": REFERENCE},
    }
