"""The native FMU of a system: where its variables stand, for the tables in C, and its terminals."""

from tetherfmu.fmi import system_maps, system_variables
from tetherfmu.runtime import inputs, outputs
from tetherfmu.runtime.inputs import WIND_AT, components
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.variables import INPUT, PARAMETER

from .arrays import COMPONENTS
from .description_fmi3 import TERMINALS, WIND, buses
from .tables import Wiring, given_plan


def wiring_of(structure, table):
    """`tables.Wiring` of a system: the value reference of a variable is its place in the table."""
    own = {each.name: each.place for each in table}
    sizes = {f"{line.name}.shape": (line.shape_points, COMPONENTS) for line in structure.lines}
    sizes |= {f"{line.name}.{WIND_AT.name}": (line.wind_points, COMPONENTS) for line in structure.lines}
    lines, names = system_maps.lines_of(structure), [line.name for line in structure.lines]
    given, fixed = (sum(each.causality == kind for each in table) for kind in (INPUT, PARAMETER))
    quantities = [system_maps.quantities_of_line(line, own) for line in structure.lines]
    of_lines = {"DIAMETER_AT": "diameter", "SLACK_SEGMENTS_AT": "slack_segments"}
    carried = [[own[f"{point}.mass"] if point else -1 for point in points] for points in system_maps.carried(structure)]
    return Wiring(
        structure.hash,
        SYSTEM,
        None,
        table,
        [each.place for each in table],
        (given, len(table) - fixed, len(table)),
        lines,
        given_plan(lines, structure.free, structure.band),
        [[(name, -1 if at is None else at, default) for name, at, default in row] for row in quantities],
        {table_in_c: [own[f"{name}.{what}"] for name in names] for table_in_c, what in of_lines.items()},
        [own[name] for name in _forces(structure)],
        sizes,
        system_maps.inputs_of(structure, own),
        [(reference, place) for reference, those in system_maps.outputs_of(structure, own) for place in those],
        system_maps.free_ends(structure, own),
        system_maps.starts_of(structure, own),
        [table[own[name]] for name in system_maps.unpacked(structure)],
        carried,
        structure.free,
    )


def _forces(structure):
    """Names of the forces that lines have at their ends, and of those on driven points."""
    for point in structure.points:
        if not point.is_free:
            yield from components(f"{point.name}.force", 3)
    for line in structure.lines:
        yield from (f"{line.name}.tension_from", f"{line.name}.tension_to")


def terminals(structure):
    """Text of terminalsAndIcons.xml: points, each a bus of position, velocity and force or load; winches of lines; wind."""
    # the wind at its points along each line, or that which all lines share
    member = WIND_AT.terminal.partition(".")[2]
    winds = [
        (f"{line.name}.{WIND}", f"the wind along {line.name}", [(member, f"{line.name}.{WIND_AT.name}")])
        for line in structure.lines
        if line.wind_points
    ]
    shared = [inputs.BY_NAME[each] for each in system_variables.GIVEN_TO_ALL]
    shared = (WIND, TERMINALS[WIND], [(each.terminal.partition(".")[2], each.name) for each in shared])
    return buses((*map(_bus_of_point, structure.points), *map(_bus_of_winch, structure.lines), *(winds or [shared])))


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
