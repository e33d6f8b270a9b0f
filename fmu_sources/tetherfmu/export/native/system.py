"""The terminals of a system in FMI 3."""

from tetherfmu.fmi import system_variables
from tetherfmu.runtime import inputs, outputs
from tetherfmu.runtime.inputs import WIND_AT

from .description_fmi3 import TERMINALS, WIND, buses


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
