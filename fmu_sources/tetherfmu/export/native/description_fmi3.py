"""Model description of a native FMU for FMI 3.0, with vectors as arrays, and its terminals."""

from xml.etree.ElementTree import Element, SubElement

from tetherfmu.fmi.model_description import annotations, attributes, enumerations, items, units
from tetherfmu.runtime.inputs import BY_NAME as INPUTS
from tetherfmu.runtime.inputs import WIND_AT, WITHOUT_EFFECT, inputs_of
from tetherfmu.runtime.outputs import BY_NAME as OUTPUTS
from tetherfmu.runtime.outputs import OUTPUT, OUTPUT_TABLE
from tetherfmu.runtime.quantities import Quantity
from tetherfmu.wiring.system_variables import GIVEN, GIVEN_TO_ALL, OF_A_LINE, TURNED
from tetherfmu.wiring.variables import INPUT, Variable

from ..documents import meaning
from ..texts import xml_text
from .arrays_fmi3 import Array, arrays
from .description import categories, experiment, facts

CAPABILITIES = {
    "needsExecutionTool": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "providesDirectionalDerivatives": "true",
    "providesIntermediateUpdate": "false",
    "mightReturnEarlyFromDoStep": "false",
    "hasEventMode": "false",
}
TYPES = {"Real": "Float64", "Integer": "Int32", "Enumeration": "Enumeration", "Boolean": "Boolean"}
TIME = Variable("time", "independent", "Real", Quantity("s", "simulation time"), 0)
WIND = "wind"
TERMINALS = {
    "kite": "the kite end of the tether",
    "ground": "the ground end of the tether",
    "winch": "the winch at the ground end",
    WIND: "the wind along the tether",
}


def text(model, token, sources=()):
    """Text of modelDescription.xml; arguments as for `description.text`.

    sources : unused, FMI 3 has a separate file for them.
    """
    table = model.wiring.shown
    root = Element("fmiModelDescription", fmiVersion="3.0", instantiationToken=token, **facts(model))
    SubElement(root, "CoSimulation", modelIdentifier=model.name, **CAPABILITIES)
    root.append(units((*table, TIME)))
    if found := enumerations(table):
        types = SubElement(root, "TypeDefinitions")
        for name, variable in found.items():
            SubElement(types, "EnumerationType", name=name).extend(items(variable))
    root.append(categories())
    root.append(experiment(*model.times))
    listed = arrays(model.wiring)
    variables = SubElement(root, "ModelVariables")
    for array in (*listed, Array(TIME.name, model.wiring.ends[2], (), (TIME,))):
        variables.append(_variable(array))
    root.append(_structure(listed))
    root.extend(annotations("Annotations", "Annotation", "type", model.wiring.constants))
    return xml_text(root)


def terminals(table):
    """Text of terminalsAndIcons.xml: the ends of the tether, each a bus of position, velocity and force; winch and wind."""
    known = {variable.name.partition("[")[0] for variable in table if variable.causality in (INPUT, OUTPUT)}
    if WIND_AT.name in known:
        known -= set(WITHOUT_EFFECT)
    # motion, then force, then inputs of a free kite end only
    declared = (*inputs_of(kite_is_free=False), WIND_AT, *OUTPUT_TABLE, *inputs_of(kite_is_free=True))
    named = {tuple(each.terminal.split(".")): each.name for each in declared if each.terminal and each.name in known}
    return _buses(
        (terminal, about, [(member, name) for (where, member), name in named.items() if where == terminal])
        for terminal, about in TERMINALS.items()
    )


def terminals_of_system(system, table):
    """Text of terminalsAndIcons.xml: points, each a bus of position, velocity and force or load; winches of lines; wind.

    table : of the variables that the FMU has.
    """
    known = {variable.name.partition("[")[0] for variable in table}
    # the wind at its points along each line, or that which all lines share
    member = WIND_AT.terminal.partition(".")[2]
    winds = [
        (f"{line.name}.{WIND}", f"the wind along {line.name}", [(member, f"{line.name}.{WIND_AT.name}")])
        for line in system.lines
        if system.wind_points
    ]
    shared = (WIND, TERMINALS[WIND], [(INPUTS[name].terminal.partition(".")[2], name) for name in GIVEN_TO_ALL])
    winches = (*map(_bus_of_winch, system.lines), *map(_bus_of_shared_winch, system.winches))
    listed = (*map(_bus_of_point, system.points), *winches, *(winds or [shared]))
    return _buses((*words, [each for each in members if each[1] in known]) for *words, members in listed)


def _bus_of_point(point):
    """Name, description and members of the terminal of a point."""
    members = ("position", "velocity", "force" if point.is_driven else "load")
    kind = "driven" if point.is_driven else "free"
    return point.name, f"{point.name}, a {kind} point", [(each, f"{point.name}.{each}") for each in members]


def _bus_of_winch(line):
    """Bus of the winch of a line, with the name of the line."""
    declared = [(each, INPUTS[each].terminal) for each in GIVEN]
    declared += [(own, OUTPUTS[each].terminal) for each, own in OF_A_LINE.items()]
    members = [(terminal.partition(".")[2], f"{line.name}.{own}") for own, terminal in declared if terminal]
    return line.name, f"the winch of {line.name} at {line.start}", members


def _bus_of_shared_winch(winch):
    """Bus of a shared winch."""
    members = [(INPUTS[winch.input].terminal.partition(".")[2], f"{winch.name}.{winch.input}")]
    members += [(own, f"{winch.name}.{own}") for own in TURNED]
    return winch.name, f"the winch {winch.name} of {', '.join(winch.lines)}", members


def _buses(listed):
    """Text of terminalsAndIcons.xml for terminals: triples of name, description, pairs (name of a member, variable)."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    terminals = SubElement(root, "Terminals")
    for name, about, members in listed:
        if members:
            terminal = SubElement(terminals, "Terminal", name=name, matchingRule="bus", description=about)
            for member, variable in members:
                names = {"variableName": variable, "memberName": member}
                SubElement(terminal, "TerminalMemberVariable", names, variableKind="signal")
    return xml_text(root)


def _variable(array):
    of_it = attributes(array.name, array.reference, meaning(array.variables), array.variables)
    element = Element(TYPES[array.variables[0].kind], of_it)
    for size in array.dimensions:
        SubElement(element, "Dimension", start=str(size))
    return element


def _structure(listed):
    """ModelStructure: outputs, and their dependencies when initialization ends: for an array those of its elements."""
    element = Element("ModelStructure")
    references = {variable.name: array.reference for array in listed for variable in array.variables}
    outputs = [array for array in listed if array.variables[0].causality == OUTPUT]
    for array in outputs:
        SubElement(element, "Output", valueReference=str(array.reference), dependencies="")
    for array in outputs:
        unknown = SubElement(element, "InitialUnknown", valueReference=str(array.reference))
        known = [variable.depends_on for variable in array.variables]
        if None not in known:  # without the attribute it depends on anything
            places = sorted({references[name] for names in known for name in names})
            unknown.set("dependencies", " ".join(map(str, places)))
    return element
