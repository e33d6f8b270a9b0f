"""The native FMU of a system: its tables as a C header, its terminals, where its variables stand."""

from array import array

from tetherfmu.runtime import inputs, layout, outputs, status, system_layout, system_maps, system_variables
from tetherfmu.runtime.inputs import INPUT_TABLE, components
from tetherfmu.runtime.instance import address
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.system_maps import quantities_of_line
from tetherfmu.runtime.variables import INPUT, INPUT_NAMES, PARAMETER

from .native_arrays import Places
from .native_description_fmi3 import TERMINALS, WIND, buses
from .native_tables import (
    c_enumeration,
    c_numbers,
    c_texts,
    constants,
    declared_texts,
    forces,
    most_room,
    of_lines,
    scales,
    sentence_texts,
    variable_texts,
)


def places_of(structure, table):
    """`Places` of the variables of a system: the value reference of a variable is its place in the table."""
    sizes = {f"{line.name}.shape": (line.shape_points, 3) for line in structure.lines}
    return Places([each.place for each in table], sizes, len(table))


def header(structure, table, widths, token):
    """Text of `tables.h`; the arguments are those of `native_tables.header`, with the `Structure` of the system."""
    names = [line.name for line in structure.lines]
    references = {each.name: each.place for each in table}
    return "\n".join(
        [
            "/* Made by export/native_system.py. */",
            "#ifndef TABLES_H",
            "#define TABLES_H",
            *constants(structure.hash, SYSTEM, token),
            *_sizes(structure, table),
            c_texts("INPUT_NAME", [each.name for each in table if each.causality == INPUT]),
            *declared_texts([each for each in table if each.causality == PARAMETER]),
            *of_lines(names, *(_of_each_line(names, own, references) for own in ("diameter", "slack_segments"))),
            forces([str(references[name]) for name in _forces(structure)]),
            *scales(INPUT_TABLE),
            *variable_texts(table, [each.place for each in table], widths, len(table)),
            *_maps(structure, table, references),
            *_quantities(structure, references),
            *sentence_texts(),
            "#endif",
            "",
        ]
    )


def _of_each_line(names, own, references):
    """Texts of the value references of a variable that each of the named lines has."""
    return [str(references[f"{name}.{own}"]) for name in names]


def _forces(structure):
    """Names of the forces that lines have at their ends, and of those on driven points."""
    for point in structure.points:
        if not point.is_free:
            yield from components(f"{point.name}.force", 3)
    for line in structure.lines:
        yield from (f"{line.name}.tension_from", f"{line.name}.tension_to")


def _sizes(structure, table):
    """Sizes of the arrays, places in the plan, statuses that the shell looks at."""
    given, fixed = (sum(each.causality == kind for each in table) for kind in (INPUT, PARAMETER))
    lines = len(structure.lines)
    sizes = {"INPUTS": given, "OUTPUTS_AT": given, "PARAMETERS_AT": len(table) - fixed}
    sizes |= {"PARAMETERS": fixed, "VALUES": len(table), "TIME": len(table)}
    plan = {
        f"PLAN_{name.removeprefix('PLAN_')}": value
        for name, value in vars(system_layout).items()
        if name.isupper() and name != "INPUTS"
    }
    wanted = ("INPUT_NOT_FINITE", "PARAMETER_OUT_OF_RANGE", "PARAMETER_NOT_WHOLE", "NO_EQUILIBRIUM_OF_POINT")
    codes = {name: getattr(status, name) for name in wanted}
    slope = layout.state_size(1) - layout.state_size(0)
    return [
        c_enumeration(sizes | {"PLAN_SIZE": system_layout.plan_size(lines)} | plan),
        c_enumeration(codes),
        f"#define STATE_SIZE(segments) ({lines * layout.state_size(0)} + {slope} * (size_t)(segments))",
    ]


def _table(name, members, rows):
    """An array of structures of integers; without rows it has one of zeros, which nobody reads."""
    cells = ",\n    ".join("{" + ", ".join(map(str, row)) + "}" for row in rows) or "{0}"
    return f"static const struct {{ int {', '.join(members)}; }} {name}[] = {{\n    {cells}}};"


def _maps(structure, table, references):
    """What `system_maps` says of inputs, outputs, motion and masses, and the plan as it is given."""
    found = [(reference, place) for reference, those in system_maps.outputs_of(structure, references) for place in those]
    motion = system_maps.free_ends(structure, references)
    starts = system_maps.starts_of(structure, references)
    checks = [table[references[name]] for name in system_maps.unpacked(structure)]
    rows = ",\n    ".join(f"{{{each.place}, {', '.join(map(repr, limits_of(each.quantity)))}}}" for each in checks)
    names = [[system_variables.input_name(name, line) for name in INPUT_NAMES] for line in structure.lines]
    given = system_maps.plan_of(structure)
    plan = [given.get(place, 0) for place in range(system_layout.plan_size(len(structure.lines)))]
    masses = [
        [references[f"{point}.mass"] if point else -1 for point in points] for points in system_maps.carried(structure)
    ]
    return [
        _table("INPUT_FROM", ("place", "reference"), system_maps.inputs_of(structure, references)),
        _table("OUTPUT_FROM", ("reference", "place"), found),
        c_enumeration({"MOTIONS": len(motion), "CHECKS": len(checks), "STARTS": len(starts)}),
        _table("START_FROM", ("place", "reference"), starts),
        _table("MOTION", ("reference", "line", "is_end", "component"), motion),
        "static const struct { int reference; double lowest, highest; } CHECK[] = {\n    "
        + (rows or "{0, 0.0, 0.0}")
        + "};",
        c_numbers("int64_t GIVEN_PLAN", plan),
        f"static const int CARRIED[][2] = {{{', '.join(f'{{{a}, {b}}}' for a, b in masses)}}};",
        c_texts("FREE_POINT_NAME", structure.free or ("",)),
        f"static const char *const LINE_INPUT_NAME[][{len(INPUT_NAMES)}] = {{\n    "
        + ",\n    ".join("{" + ", ".join(f'"{name}"' for name in row) + "}" for row in names)
        + "};",
    ]


def room_of(structure, kernels):
    """`most_room` for a system, of which all lines have as many segments; kernels : `SystemKernels`."""
    lines, given = len(structure.lines), system_maps.plan_of(structure)
    sizes = [getattr(system_layout, f"{name}_SIZE") for name in ("PARAMETERS", "INPUTS", "OUTPUTS", "WORK")]
    states, others = [], []
    for n in range(1, layout.MAX_SEGMENTS + 1):
        plan = array("q", [given.get(place, 0) for place in range(system_layout.plan_size(lines))])
        for k in range(lines):
            plan[system_layout.PLAN_HEADER + system_layout.LINE_NUMBERS * k + system_layout.SEGMENTS] = n
        kernels.complete(address(plan))
        states.append(plan[system_layout.STATE_SIZE])
        others.append(sum(plan[place] for place in sizes))
    return most_room(states, others)


def limits_of(quantity):
    """Smallest and largest number that a quantity allows, those of an enumeration without gaps; all here are finite."""
    if quantity.choices:
        return 1.0, float(len(quantity.choices))
    return float(quantity.minimum), float(quantity.maximum)


def _quantities(structure, references):
    """Of each line where the quantities stand that the kernel `pack` takes, and the defaults of those without a variable."""
    listed = [quantities_of_line(line, references) for line in structure.lines]
    rows = ",\n    ".join("{" + ", ".join(str(-1 if ref is None else ref) for _, ref, _ in row) + "}" for row in listed)
    wanted = (
        "segments",
        "initial_length",
        "surface_roughness",
        "wind_reference_height",
        "shortest_length",
        "longest_length",
    )
    numbers = {f"QUANTITY_{name.upper()}": [each[0] for each in listed[0]].index(name) for name in wanted}
    return [
        c_enumeration({"QUANTITIES": len(listed[0]), **numbers}),
        f"static const int QUANTITY_FROM[][{len(listed[0])}] = {{\n    {rows}}};",
        c_numbers("double QUANTITY_DEFAULT", [float(default) for _, _, default in listed[0]]),
    ]


def terminals(structure):
    """Text of terminalsAndIcons.xml: points, each a bus of position, velocity and force or load; winches of lines; wind."""
    return buses((*map(_bus_of_point, structure.points), *map(_bus_of_winch, structure.lines), _bus_of_wind()))


def _bus_of_point(point):
    """Name, description and members of the terminal of a point."""
    members = ("position", "velocity", "load" if point.is_free else "force")
    kind = "free" if point.is_free else "driven"
    return point.name, f"{point.name}, a {kind} point", [(each, f"{point.name}.{each}") for each in members]


def _bus_of_winch(line):
    """The same of the winch of a line, whose name it has."""
    declared = [(each, inputs.BY_NAME[each].terminal) for each in system_variables.GIVEN]
    declared += [(own, outputs.BY_NAME[each].terminal) for each, own in system_variables.OF_A_LINE.items()]
    members = [(terminal.partition(".")[2], f"{line.name}.{own}") for own, terminal in declared if terminal]
    return line.name, f"the winch of {line.name} at {line.start}", members


def _bus_of_wind():
    """The same of the wind, which all lines share."""
    listed = [inputs.BY_NAME[each] for each in system_variables.GIVEN_TO_ALL]
    return WIND, TERMINALS[WIND], [(each.terminal.partition(".")[2], each.name) for each in listed]
