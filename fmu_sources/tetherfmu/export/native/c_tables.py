"""The tables of a native FMU as a C header, generated from the declarations of the PythonFMU slave.

Places in the flat arrays, variables, parameters with their ranges, sentences, for the headers in `runtime/native`.
"""

import re
from itertools import accumulate

from tetherfmu.runtime import inputs, layout, parameters, plan_layout, plausibility, polygons, refusals, saved_state, status
from tetherfmu.runtime.instance import OF_ALL_LINES, Instance, address
from tetherfmu.wiring.fmu import FORCES
from tetherfmu.wiring.selection import own_name
from tetherfmu.wiring.variables import PARAMETER

from .arrays_fmi3 import arrays

KINDS = {"Real": 1, "Integer": 2, "Enumeration": 4, "input": 8, "output": 16, "local": 16, "parameter": 32}
KINDS |= {"Boolean": 128}  # not 64
INDEPENDENT = 64  # the time
NUMBERS_IN_A_LINE = 12
STATUSES = ("INPUT_NOT_FINITE", "PARAMETER_OUT_OF_RANGE", "PARAMETER_NOT_WHOLE", "NO_EQUILIBRIUM_OF_POINT")  # looked at
QUANTITIES = (  # that sentences on parameters may ask for
    *("segments", "initial_length", "surface_roughness", "wind_reference_height"),
    *("shortest_length", "longest_length"),
)


def header(wiring, fmi, token):
    """Text of `tables.h` for a `wiring.fmu.Wiring`.

    token : guid of FMI 2, instantiation token of FMI 3, which has arrays and the time.
    """
    widths = {array.reference: len(array.variables) for array in arrays(wiring)} if fmi == 3 else None
    listed = [variable for variable in wiring.table if variable.causality == PARAMETER]
    variables = variable_texts(wiring.shown, widths, wiring.ends[2])
    parts = *_constants(wiring, token), *_sizes(wiring), *_inputs(wiring), *_parameters(wiring, listed), *_lines(wiring)
    parts = *parts, *_maps(wiring), *variables, *_starts(wiring), *sentence_texts()
    head = "/* Made by export/native/c_tables.py. */", "#ifndef TABLES_H", "#define TABLES_H"
    return "\n".join([*head, *parts, "#endif", ""])


def c_text(text):
    """A text as a C string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def c_enumeration(numbers):
    """A C enumeration of a dict of name to number."""
    return "enum { " + ", ".join(f"{name} = {value}" for name, value in numbers.items()) + " };"


def c_texts(name, texts):
    """An array of texts in C."""
    return f"static const char *const {name}[] = {{\n    " + ",\n    ".join(map(c_text, texts)) + "};"


def c_rows(declared, rows, size=None, empty=""):
    """An array in C of rows of texts; declared : type and name.  size : of rows that are arrays.  empty : without rows."""
    width = "" if size is None else f"[{size}]"
    cells = ",\n    ".join(f"{{{', '.join(row)}}}" for row in rows)
    return f"static const {declared}[]{width} = {{\n    {cells or empty}}};"


def _constants(wiring, token):
    """Names of the layout with the prefix AT_, of the plan with PLAN_, and properties of this FMU."""
    places = {f"AT_{name}": value for name, value in vars(layout).items() if name.isupper() and isinstance(value, int)}
    fractions = {f"AT_{name}": value for name, value in vars(layout).items() if name.isupper() and isinstance(value, float)}
    plan = {name: value for name, value in vars(plan_layout).items() if name.isupper()}
    record = wiring.record
    defined = {
        **fractions,
        "DEFAULT_TOLERANCE": parameters.DEFAULT_TOLERANCE,
        **{f"POLYGON_{name}": getattr(polygons, name) for name in ("CORNERS", "JUDGED", "ROUNDING", "BENT", "ALIKE")},
        "DIRECT": int(wiring.is_direct),
        "FREE_KITE": int(record is not None and record.kite_is_free),
        "HAS_KINK": int(record is None or record.has_kink),
        "FAST_END_SPEED": inputs.FAST_END_SPEED,
        "FAST_WIND_SPEED": inputs.FAST_WIND_SPEED,
        "VARIANT": c_text(wiring.name),
        "MAGIC": c_text(saved_state.MAGIC.decode()),
        "TOKEN": c_text(token),
        "KERNEL(verb)": f"{wiring.library}_##verb",
    }
    phases = ("BEFORE", "INITIALIZING", "STEPPING", "TERMINATED")
    kinds = {name.upper() if name != "parameter" else "PARAMETER_KIND": bit for name, bit in KINDS.items()}
    ranges = ((str(place), *map(repr, limits)) for place, limits in saved_state.STATE_RANGES.items())
    return [
        c_enumeration(places),
        c_enumeration({f"PLAN_{name.removeprefix('PLAN_')}": value for name, value in plan.items()}),
        c_enumeration({name: getattr(status, name) for name in STATUSES}),
        *(f"#define {name} {value}" for name, value in defined.items()),
        f"typedef {c_enumeration({name: getattr(saved_state, name) for name in phases})[:-1]} Phase;",
        c_enumeration({**kinds, "INDEPENDENT": INDEPENDENT}),
        c_rows("struct { int place; double lowest, highest; } STATE_RANGE", ranges),
    ]


def _sizes(wiring):
    """Sizes of the arrays; the size of the state is a macro of the number of segments in all lines."""
    given, end, values = wiring.ends
    sizes = {"INPUTS": given, "OUTPUTS_AT": given, "PARAMETERS_AT": end, "PARAMETERS": values - end, "VALUES": values}
    sizes |= {"TIME": values, "LINES": len(wiring.lines), "FREE_POINTS": len(wiring.free)}
    sizes |= {"INPUTS_OF_A_LINE": len(wiring.running[0].inputs)}
    empty = sum(layout.state_size(0, line.wind_points) for line in wiring.running)
    slope = layout.state_size(1) - layout.state_size(0)
    return [
        c_enumeration(sizes | {"PLAN_SIZE": plan_layout.plan_size(len(wiring.lines))}),
        f"#define STATE_SIZE(segments) ({empty} + {slope} * (size_t)(segments))",
    ]


def _inputs(wiring):
    """Name of each input of the FMU by its place; of each line names and scales of its inputs."""
    listed = (*inputs.INPUT_TABLE, *(wiring.running[0].wind_points * (inputs.WIND_AT,)))
    numbers = [inputs.SCALES.index(each.scale) for each in listed for _ in range(each.size)]
    names = [line.inputs for line in wiring.running]
    own = {each.place: each.name for each in wiring.table}
    if wiring.is_direct:
        own |= dict(enumerate(names[0]))  # also quantities of other tethers
    return [
        c_enumeration({f"SCALE_{name}": number for number, name in enumerate(inputs.SCALES)}),
        c_numbers("unsigned char INPUT_SCALE", numbers),
        c_texts("INPUT_NAME", [own[place] for place in range(wiring.ends[0])]),
        *_words(wiring),
        c_rows("char *const LINE_INPUT_NAME", (map(c_text, row) for row in names), len(names[0])),
    ]


def _words(wiring):
    """Pairs of texts that are others in sentences about all lines (first) and about each of them; an empty one ends them."""
    rows = [OF_ALL_LINES if any(line.name for line in wiring.running) else (), *(line.words for line in wiring.running)]
    listed = [[*(text for pair in row for text in pair), ""] for row in rows]
    ends = list(accumulate(map(len, listed), initial=0))
    return c_texts("WORDS", [text for row in listed for text in row]), c_numbers("int WORDS_AT", ends[:-1])


def room_of(kernels, wiring):
    """Text with the maximum room for the arrays of lines with equal numbers of segments."""
    beside = [plan_layout.PARAMETERS_SIZE, plan_layout.WORK_SIZE]
    if not wiring.is_direct:  # inputs and outputs of the lines differ from those of the FMU
        beside += [plan_layout.INPUTS_SIZE, plan_layout.OUTPUTS_SIZE]
    states, others = [], []
    for n in range(1, layout.MAX_SEGMENTS + 1):
        plan = _given_plan(wiring)
        for row in range(plan_layout.PLAN_HEADER, len(plan), plan_layout.LINE_NUMBERS):
            plan[row + plan_layout.SEGMENTS] = n
        kernels.complete(address(plan))
        states.append(plan[plan_layout.STATE_SIZE])
        others.append(sum(plan[place] for place in beside))
    return most_room(states, others)


def _given_plan(wiring):
    """The given part of the plan of lines, without their segments, an array."""
    return Instance(None, wiring.running, wiring.free, wiring.band).plan


def most_room(states, others):
    """Text with the maximum room for the arrays; states, others : lengths with 1, 2, ... segments."""
    head = "#ifndef MAX_SEGMENTS", f"#define MAX_SEGMENTS {len(states)}", "#endif"
    return "\n".join([*head, _most("MOST_STATE", states), _most("MOST_OTHERS", others), ""])


def _most(name, sizes):
    """Definition of the smallest linear bound of sizes that has their growth between the first and the last."""
    slope = -(-(sizes[-1] - sizes[0]) // max(1, len(sizes) - 1))
    base = max(size - slope * n for n, size in enumerate(sizes, 1))
    return f"#define {name}(segments) ({base} + {slope} * (size_t)(segments))"


def _parameters(wiring, listed):
    """Names and allowed ranges of the parameters; for each line the places of its quantities for the kernel `pack`."""
    rows = ((c_text(each.name), c_text(each.quantity.range()), str(KINDS[each.kind])) for each in listed)
    doubts = ((str(place), repr(side), repr(limit), c_text(said)) for place, side, limit, said in wiring.doubtful)
    first = wiring.lines[0].quantities
    names = [name for name, _, _ in first]
    numbers = {f"QUANTITY_{name.upper()}": names.index(name) for name in QUANTITIES}
    if wiring.record and wiring.record.kite_is_free:
        numbers["INITIAL_KITE_POSITION"] = names.index("initial_kite_position[1]")
    places = ([str(place) for _, place, _ in each.quantities] for each in wiring.lines)
    defaults = ([repr(float(default)) for *_, default in each.quantities] for each in wiring.lines)
    return [
        "typedef struct { const char *name, *range; int kind; } Parameter;",
        c_rows("Parameter PARAMETER", rows),
        "typedef struct { unsigned reference; double side, limit; const char *sentence; } Doubt;",
        c_rows("Doubt DOUBT", doubts),
        c_enumeration({"QUANTITIES": len(first), **numbers}),
        c_rows("int QUANTITY_FROM", places, len(first)),
        c_rows("double QUANTITY_DEFAULT", defaults, len(first)),
    ]


def _lines(wiring):
    """Names of the lines, value references of their variables, and of forces."""
    own = {each.name: each.place for each in wiring.table}
    prefixes = (f"{line.name.partition('[')[0]}." if line.name else "" for line in wiring.running)  # also of a portion
    slack, forces = (f"{prefix}slack_segments" for prefix in prefixes), (name for name in own if own_name(name) in FORCES)
    own = {"SLACK_SEGMENTS_AT": [own[name] for name in slack], "FORCE_AT": [own[name] for name in forces]}
    return [
        c_texts("LINE_NAME", [line.name for line in wiring.running]),
        *(c_numbers(f"unsigned {name}", references) for name, references in own.items()),
    ]


def _table(name, members, rows):
    """An array of structures of integers; without rows it has one of zeros, which nobody reads."""
    return c_rows(f"struct {{ int {', '.join(members)}; }} {name}", (map(str, row) for row in rows), empty="{0}")


def _maps(wiring):
    """Places of inputs, outputs, motion and masses in the arrays of the kernels, and the given plan."""
    outputs = [(reference, place) for reference, places in wiring.outputs for place in places]
    counts = {"INPUTS_FROM": wiring.inputs, "OUTPUTS_FROM": outputs, "MOTIONS": wiring.motion}
    counts |= {"HOLDERS": wiring.holders}
    counts |= {"STARTS": wiring.starts, "CHECKS": wiring.checked, "HELD_TERMS": wiring.held, "TURNED_TERMS": wiring.turned}
    limits = ((str(each.place), *map(repr, limits_of(each.quantity))) for each in wiring.checked)
    masses = ", ".join(f"{{{a}, {b}}}" for a, b in (each.carried for each in wiring.lines))
    return [
        c_enumeration({name: len(listed) for name, listed in counts.items()}),
        _table("INPUT_FROM", ("place", "reference", "line", "own"), wiring.inputs),
        _table("OUTPUT_FROM", ("reference", "place"), outputs),
        _table("MOTION", ("reference", "line", "is_end", "component"), wiring.motion),
        _table("START_FROM", ("place", "reference"), wiring.starts),
        _table("HELD", ("place", "reference", "line", "own"), [row[:4] for row in wiring.held]),
        c_numbers("double HELD_FACTOR", [row[4] for row in wiring.held] or [0.0]),
        _table("HOLDER", ("line", "place"), [row[:2] for row in wiring.holders]),
        c_numbers("double HOLDER_NUMBER", [row[2] for row in wiring.holders] or [0.0]),
        _table("TURNED", ("reference", "place", "less"), [(row[0], row[1], row[3]) for row in wiring.turned]),
        c_numbers("double TURNED_FACTOR", [row[2] for row in wiring.turned] or [0.0]),
        c_rows("struct { int reference; double lowest, highest; } CHECK", limits, empty="{0, 0.0, 0.0}"),
        f"static const int CARRIED[][2] = {{{masses}}};",
        _table("SHEAVE", ("kind", "portion", "mass", "friction", "efficiency"), [each.sheave for each in wiring.lines]),
        c_texts("FREE_POINT_NAME", wiring.free or ("",)),
        c_numbers("int64_t GIVEN_PLAN", _given_plan(wiring)),
    ]


def limits_of(quantity):
    """Smallest and largest allowed number of a quantity; enumerations have no gaps; all are finite."""
    if quantity.choices:
        return 1.0, float(len(quantity.choices))
    return float(quantity.minimum), float(quantity.maximum)


def variable_texts(table, widths, count):
    """Name, kind and width of each value reference; the time is last."""
    kinds, names = [0] * count, [""] * count
    for variable in table:
        reference = variable.place
        if widths is None or reference in widths:
            is_array = (widths or {}).get(reference, 1) > 1
            names[reference] = variable.name.partition("[")[0] if is_array else variable.name
            kinds[reference] = KINDS[variable.kind] | KINDS[variable.causality]
    wide = [(widths or {}).get(reference, 1) for reference in range(count)]
    return [
        c_texts("NAME", [*names, "" if widths is None else "time"]),
        c_numbers("unsigned char KIND", [*kinds, 0 if widths is None else KINDS["Real"] | INDEPENDENT]),
        c_numbers("unsigned short WIDTH", [*wide, 1]),
    ]


def _starts(wiring):
    """Start value by value reference, and the references of those that nobody can set."""
    starts = [0.0] * wiring.ends[2]
    for variable in wiring.table:
        starts[variable.place] = float(variable.start or 0.0)
    constants = ((str(place), c_text(name)) for name, place, _ in wiring.constants)
    return [
        c_numbers("double START", starts),
        c_rows("struct { unsigned reference; const char *name; } CONSTANT", constants, empty='{0, ""}'),
        c_enumeration({"CONSTANTS": len(wiring.constants)}),
    ]


def c_numbers(name, numbers):
    """An array of numbers in C; name : with their type in front."""
    starts = range(0, len(numbers), NUMBERS_IN_A_LINE)
    lines = [", ".join(map(repr, numbers[i : i + NUMBERS_IN_A_LINE])) for i in starts]
    return f"static const {name}[] = {{\n    " + ",\n    ".join(lines) + "};"


def _with(sentence, known):
    """A sentence with the numbers that are known now; `!r` of Python is how the C code writes numbers anyway."""

    def filled(match):
        return match[0].format(**known) if match[1] in known else match[0]

    return re.sub(r"\{(\w+)[^}]*\}", filled, sentence).replace("!r}", "}")


def sentence_texts():
    """Messages of an FMU and their conditions; messages.c fills in {name} and {name:format}."""
    own = {name: value for name, value in vars(refusals).items() if name.isupper() and isinstance(value, str)}
    limits = {name: value for name, value in vars(refusals).items() if name.isupper() and isinstance(value, float)}
    kernel = [_with(status.SENTENCES[code], status.LIMITS) for code in sorted(status.SENTENCES)]
    warnings = [_with(plausibility.SENTENCES[kind], plausibility.facts(kind)) for kind in sorted(plausibility.SENTENCES)]
    return [
        *(f"#define {name} {value!r}" for name, value in limits.items()),
        *(f"#define {name} {c_text(_with(sentence, {}))}" for name, sentence in own.items()),
        f"#define POLYGON {c_text(_with(polygons.SENTENCE, {}))}",
        c_texts("KERNEL_SENTENCE", kernel),
        c_texts("WARNING_SENTENCE", warnings),
        c_texts("PHASE", refusals.PHASES),
    ]
