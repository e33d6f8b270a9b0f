"""The tables of a native FMU as a C header, made from the declarations that the PythonFMU slave runs with.

Places in the flat arrays, variables, parameters with their ranges, sentences: what the headers in `runtime/native` include.
"""

import re
from functools import partial

from tetherfmu.runtime import inputs, layout, parameters, plausibility, refusals, saved_state, status
from tetherfmu.runtime.variables import PARAMETER, input_names, parameters_at, references, wind_points_in
from tetherfmu.runtime.variants import BY_NAME, library_of

KINDS = {"Real": 1, "Integer": 2, "Enumeration": 4, "input": 8, "output": 16, "local": 16, "parameter": 32}
INDEPENDENT = 64  # the time
NUMBERS_IN_A_LINE = 12
_SIZES = ("parameters_size", "state_size")  # linear in the number of segments


def c_text(text):
    """A text as a C string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def count_of_values(table, shape_points):
    """Number of all values: inputs, outputs, parameters."""
    return parameters_at(shape_points, wind_points_in(table)) + _count_of_parameters(table)


def _count_of_parameters(table):
    return sum(variable.causality == PARAMETER for variable in table)


def header(variant, table, shape_points, widths, token):
    """Text of `tables.h` for one FMU.

    table : of `variables.Variable`.  token : guid of FMI 2, instantiation token of FMI 3.
    widths : of FMI 3, which has arrays and the time: dict of value reference to number of values; None for FMI 2.
    """
    return "\n".join(
        [
            "/* Made by export/native_tables.py. */",
            "#ifndef TABLES_H",
            "#define TABLES_H",
            *constants(variant, library_of(variant), token, BY_NAME[variant]),
            *_inputs(wind_points_in(table)),
            *_sizes(table, shape_points),
            *_parameters(table),
            *of_lines([""], ["PARAMETERS_AT + DIAMETER"], ["OUTPUTS_AT + AT_SLACK_SEGMENTS"]),
            forces([f"OUTPUTS_AT + AT_{end}_FORCE + {i}" for end in ("GROUND", "KITE") for i in range(3)]),
            *variable_texts(table, references(table, shape_points), widths, count_of_values(table, shape_points)),
            *sentence_texts(),
            "#endif",
            "",
        ]
    )


def c_enumeration(numbers):
    """A C enumeration of a dict of name to number."""
    return "enum { " + ", ".join(f"{name} = {value}" for name, value in numbers.items()) + " };"


def c_texts(name, texts):
    """An array of texts in C."""
    return f"static const char *const {name}[] = {{\n    " + ",\n    ".join(map(c_text, texts)) + "};"


def constants(variant, library, token, record=None):
    """Names of the layout with AT_ in front, and what this variant is; record : its `Variant`, None for a system."""
    places = {f"AT_{name}": value for name, value in vars(layout).items() if name.isupper() and isinstance(value, int)}
    fractions = {f"AT_{name}": value for name, value in vars(layout).items() if name.isupper() and isinstance(value, float)}
    defined = {
        **fractions,
        "DEFAULT_TOLERANCE": parameters.DEFAULT_TOLERANCE,
        "THICK": parameters.THICK,
        "SYSTEM": int(record is None),
        "FREE_KITE": int(record is not None and record.kite_is_free),
        "HAS_KINK": int(record is None or record.has_kink),
        "FAST_END_SPEED": inputs.FAST_END_SPEED,
        "FAST_WIND_SPEED": inputs.FAST_WIND_SPEED,
        "VARIANT": c_text(variant),
        "MAGIC": c_text(saved_state.MAGIC.decode()),
        "TOKEN": c_text(token),
        "KERNEL(verb)": f"{library}_##verb",
    }
    phases = ("BEFORE", "INITIALIZING", "STEPPING", "TERMINATED")
    kinds = {name.upper() if name != "parameter" else "PARAMETER_KIND": bit for name, bit in KINDS.items()}
    ranges = ",\n    ".join(f"{{{place}, {low!r}, {high!r}}}" for place, (low, high) in saved_state.STATE_RANGES.items())
    return [
        c_enumeration(places),
        *(f"#define {name} {value}" for name, value in defined.items()),
        f"typedef {c_enumeration({name: getattr(saved_state, name) for name in phases})[:-1]} Phase;",
        c_enumeration({**kinds, "INDEPENDENT": INDEPENDENT}),
        "static const struct { int place; double lowest, highest; } STATE_RANGE[] = {\n    " + ranges + "};",
    ]


def _inputs(wind_points):
    """Name and scale of each input by its place."""
    listed = (*inputs.INPUT_TABLE, *(wind_points * (inputs.WIND_AT,)))
    return [
        *scales(listed),
        c_texts("INPUT_NAME", input_names(wind_points)),
    ]


def scales(listed):
    """The scales of directional derivatives, and that of each of these inputs by its place."""
    numbers = [inputs.SCALES.index(each.scale) for each in listed for _ in range(each.size)]
    return [
        c_enumeration({f"SCALE_{name}": number for number, name in enumerate(inputs.SCALES)}),
        c_numbers("unsigned char INPUT_SCALE", numbers),
    ]


def _sizes(table, shape_points):
    """Sizes of the arrays; the linear ones are macros of the number of segments."""
    values = count_of_values(table, shape_points)
    points = wind_points_in(table)
    sizes = {"INPUTS": layout.inputs_size(points), "OUTPUTS_AT": layout.inputs_size(points), "WIND_POINTS": points}
    sizes |= {"PARAMETERS_AT": parameters_at(shape_points, points)}
    sizes |= {"PARAMETERS": _count_of_parameters(table), "SHAPE_POINTS": shape_points, "VALUES": values, "TIME": values}
    lines = [c_enumeration(sizes)]
    for name in _SIZES:
        size = partial(layout.state_size, wind_points=points) if name == "state_size" else getattr(layout, name)
        base = size(0)
        slope = size(1) - base
        lines.append(f"#define {name.upper()}(segments) ({base} + {slope} * (size_t)(segments))")
    return lines


def room_of_tether(kernels, wind_points):
    """`most_room` for a tether; kernels : `Kernels` of its library.  wind_points : number of them."""
    counts = range(1, layout.MAX_SEGMENTS + 1)
    states = [layout.state_size(n, wind_points) for n in counts]
    return most_room(states, [layout.parameters_size(n) + kernels.work_size(n) for n in counts])


def most_room(states, others):
    """Text that says how much room the arrays need at most; states, others : lengths with 1, 2, ... segments."""
    return "\n".join(
        [
            "#ifndef MAX_SEGMENTS",
            f"#define MAX_SEGMENTS {len(states)}",
            "#endif",
            _most("MOST_STATE", states),
            _most("MOST_OTHERS", others),
            "",
        ]
    )


def _most(name, sizes):
    """Definition of the smallest linear bound of sizes that has their growth between the first and the last."""
    slope = -(-(sizes[-1] - sizes[0]) // max(1, len(sizes) - 1))
    base = max(size - slope * n for n, size in enumerate(sizes, 1))
    return f"#define {name}(segments) ({base} + {slope} * (size_t)(segments))"


def _parameters(table):
    """Numbers of the parameters, their names and what is allowed."""
    listed = [variable for variable in table if variable.causality == PARAMETER]
    first = [each for each in listed if not each.name.endswith(("[2]", "[3]"))]
    numbers = {each.name.removesuffix("[1]").upper(): each.place for each in first}
    return [c_enumeration(numbers), *declared_texts(listed)]


def declared_texts(listed):
    """Names of the parameters, and what is allowed."""
    rows = [f"    {{{c_text(each.name)}, {c_text(each.quantity.range())}, {KINDS[each.kind]}}}" for each in listed]
    return [
        "typedef struct { const char *name, *range; int kind; } Parameter;",
        "static const Parameter PARAMETER[] = {\n" + ",\n".join(rows) + "};",
    ]


def of_lines(names, diameters, slack_segments):
    """Names of the lines, of which a tether has one without a name; texts of value references of what each line has."""
    return [
        c_enumeration({"LINES": len(names)}),
        c_texts("LINE_NAME", names),
        _references("DIAMETER_AT", diameters),
        _references("SLACK_SEGMENTS_AT", slack_segments),
    ]


def forces(references):
    """Value references of the forces whose smoothness counts in directional derivatives, texts."""
    return _references("FORCE_AT", references)


def _references(name, texts):
    """An array of value references in C."""
    return f"static const unsigned {name}[] = {{{', '.join(texts)}}};"


def variable_texts(table, at, widths, count):
    """Name, kind, width and start value by value reference, of which there are so many; last the time. at : of the table."""
    kinds, starts, names = [0] * count, [0.0] * count, [""] * count
    for reference, variable in zip(at, table, strict=True):
        starts[reference] = float(variable.start or 0.0)
        if widths is None or reference in widths:
            is_array = (widths or {}).get(reference, 1) > 1
            names[reference] = variable.name.partition("[")[0] if is_array else variable.name
            kinds[reference] = KINDS[variable.kind] | KINDS[variable.causality]
    wide = [(widths or {}).get(reference, 1) for reference in range(count)]
    return [
        c_texts("NAME", [*names, "" if widths is None else "time"]),
        c_numbers("unsigned char KIND", [*kinds, 0 if widths is None else KINDS["Real"] | INDEPENDENT]),
        c_numbers("unsigned short WIDTH", [*wide, 1]),
        c_numbers("double START", starts),
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
    """What an FMU says, and when; {name} and {name:format} are filled in by messages.c."""
    own = {name: value for name, value in vars(refusals).items() if name.isupper() and isinstance(value, str)}
    limits = {name: value for name, value in vars(refusals).items() if name.isupper() and isinstance(value, float)}
    own["THICK_DIAMETER"] = parameters.THICK_DIAMETER
    kernel = [_with(status.SENTENCES[code], status.LIMITS) for code in sorted(status.SENTENCES)]
    warnings = [_with(plausibility.SENTENCES[kind], plausibility.facts(kind)) for kind in sorted(plausibility.SENTENCES)]
    return [
        *(f"#define {name} {value!r}" for name, value in limits.items()),
        *(f"#define {name} {c_text(_with(sentence, {}))}" for name, sentence in own.items()),
        c_texts("KERNEL_SENTENCE", kernel),
        c_texts("WARNING_SENTENCE", warnings),
        c_texts("PHASE", refusals.PHASES),
    ]
