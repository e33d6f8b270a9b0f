"""Complete PythonFMU's model description: variables with units, limits and enumerations, and the model structure."""

from math import inf
from xml.etree.ElementTree import Element, SubElement

UNITS = {  # quantity, exponents of the base units, nominal value of an input or output
    "m": ("Length", {"m": 1}, 100.0),
    "m/s": ("Velocity", {"m": 1, "s": -1}, 10.0),
    "m/s2": ("Acceleration", {"m": 1, "s": -2}, 1.0),
    "s": ("Time", {"s": 1}, 1.0),
    "kg": ("Mass", {"kg": 1}, 1.0),
    "kg/m3": ("Density", {"kg": 1, "m": -3}, 1.0),
    "N": ("Force", {"kg": 1, "m": 1, "s": -2}, 100.0),
    "N.s": ("AxialDamping", {"kg": 1, "m": 1, "s": -1}, 1.0),
    "N/m": ("TranslationalSpringConstant", {"kg": 1, "s": -2}, 1000.0),
    "N.s/m": ("TranslationalDampingConstant", {"kg": 1, "s": -1}, 1.0),
    "rad": ("Angle", {"rad": 1}, 1.0),
    "rad/s": ("AngularVelocity", {"rad": 1, "s": -1}, 1.0),
    "rad/m": ("Curvature", {"rad": 1, "m": -1}, 0.1),
    "1/s": ("Rate", {"s": -1}, 1.0),
    "m2": ("Area", {"m": 2}, 10.0),
    "kg.m2": ("MomentOfInertia", {"kg": 1, "m": 2}, 1.0),
    "N.m": ("Torque", {"kg": 1, "m": 2, "s": -2}, 100.0),
    "N.s2/m2": ("TensionOverSquaredSpeed", {"kg": 1, "m": -1}, 100.0),
    "W": ("Power", {"kg": 1, "m": 2, "s": -3}, 1000.0),
    "J": ("Energy", {"kg": 1, "m": 2, "s": -2}, 1e5),
}
INITIAL = {"output": "calculated", "parameter": "exact"}


def complete(root, table, references):
    """Write units, types, variables and model structure of a table of variables into the description (modified).

    root : Element of the model description, with PythonFMU's ModelVariables and ModelStructure.  table : of
    `variables.Variable`.  references : their value references.
    """
    for name in ("ModelVariables", "ModelStructure"):
        root.remove(root.find(name))
    place = list(root).index(root.find("CoSimulation")) + 1
    root.insert(place, units(table))
    root.insert(place + 1, types(table))
    root.append(variables(table, references))
    root.append(structure(table))


def number_text(value):
    """A number as text that reads back to the same bits."""
    return repr(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))


def variables(table, references):
    """ModelVariables of a table of variables with these value references."""
    element = Element("ModelVariables")
    for variable, reference in zip(table, references, strict=True):
        element.append(_variable(variable, reference))
    return element


def units(table):
    """UnitDefinitions of what a table of variables needs."""
    element = Element("UnitDefinitions")
    for name in sorted({variable.quantity.unit for variable in table} - {""}):
        unit = SubElement(element, "Unit", name=name)
        SubElement(unit, "BaseUnit", {base: str(power) for base, power in UNITS[name][1].items()})
        shown = {variable.quantity.display for variable in table if variable.quantity.unit == name} - {()}
        for display_name, factor in sorted(shown):
            SubElement(unit, "DisplayUnit", name=display_name, factor=repr(factor))
    return element


def types(table):
    """TypeDefinitions: the enumerations of a table of variables."""
    element = Element("TypeDefinitions")
    for variable in table:
        if variable.kind == "Enumeration":
            simple = SubElement(element, "SimpleType", name=variable.name)
            enumeration = SubElement(simple, "Enumeration")
            for value, name in enumerate(variable.quantity.choices, start=1):
                SubElement(enumeration, "Item", name=name, value=str(value))
    return element


def variability(variable):
    """Variability of a variable: outputs change in steps, those that count are discrete."""
    if variable.causality == "parameter":
        return "fixed"
    return "continuous" if variable.kind == "Real" else "discrete"


def _variable(variable, reference):
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.quantity.meaning,
        "causality": variable.causality,
        "variability": variability(variable),
    }
    if variable.causality in INITIAL:
        attributes["initial"] = INITIAL[variable.causality]
    scalar = Element("ScalarVariable", attributes)
    typed = SubElement(scalar, variable.kind)
    declared = variable.quantity
    if variable.kind == "Enumeration":
        typed.set("declaredType", variable.name)
    if variable.kind == "Real" and declared.unit:
        quantity, _, nominal = UNITS[declared.unit]
        typed.set("quantity", quantity)
        typed.set("unit", declared.unit)
        if declared.display:
            typed.set("displayUnit", declared.display[0])
        if variable.causality != "parameter":
            typed.set("nominal", repr(nominal))
    for name, value in (("min", declared.minimum), ("max", declared.maximum), ("start", variable.start)):
        if value is not None and abs(value) < inf:
            typed.set(name, number_text(value))
    return scalar


def structure(table):
    """ModelStructure of a table of variables: its outputs, and what they depend on when initialization ends."""
    element = Element("ModelStructure")
    outputs = SubElement(element, "Outputs")
    unknowns = SubElement(element, "InitialUnknowns")
    positions = {variable.name: k for k, variable in enumerate(table, start=1)}
    for variable in table:
        if variable.causality == "output":
            index = str(positions[variable.name])
            places = sorted(positions[name] for name in variable.depends_on)
            SubElement(outputs, "Unknown", index=index, dependencies="")
            SubElement(unknowns, "Unknown", index=index, dependencies=" ".join(map(str, places)))
    return element
