"""Complete PythonFMU's model description: variables with units, limits and enumerations, and the model structure."""

from xml.etree.ElementTree import Element, SubElement

BASE_UNITS = {
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "s": {"s": 1},
    "kg": {"kg": 1},
    "kg/m3": {"kg": 1, "m": -3},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.s": {"kg": 1, "m": 1, "s": -1},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "rad": {"rad": 1},
}
QUANTITIES = {
    "m": "Length",
    "m/s": "Velocity",
    "m/s2": "Acceleration",
    "s": "Time",
    "kg": "Mass",
    "kg/m3": "Density",
    "N": "Force",
    "N.s": "AxialDamping",
    "N/m": "TranslationalSpringConstant",
    "N.s/m": "TranslationalDampingConstant",
    "rad": "Angle",
}
NOMINAL = {"m": 100.0, "m/s": 10.0, "N": 100.0, "N/m": 1000.0}


def complete(root, table, references):
    """Write units, types, variables and model structure of a table of variables into the description (modified).

    root : Element of the model description, with PythonFMU's ModelVariables and ModelStructure.  table : of
    `interface.Variable`.  references : their value references.
    """
    for name in ("ModelVariables", "ModelStructure"):
        root.remove(root.find(name))
    place = list(root).index(root.find("CoSimulation")) + 1
    root.insert(place, _units(table))
    root.insert(place + 1, _types(table))
    listed = SubElement(root, "ModelVariables")
    for variable, reference in zip(table, references, strict=True):
        listed.append(_variable(variable, reference))
    root.append(_structure(table))


def number(value):
    """A number as text that reads back to the same bits."""
    return repr(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))


def _units(table):
    element = Element("UnitDefinitions")
    for name in sorted({variable.quantity.unit for variable in table} - {""}):
        unit = SubElement(element, "Unit", name=name)
        SubElement(unit, "BaseUnit", {base: str(power) for base, power in BASE_UNITS[name].items()})
        shown = {variable.quantity.display for variable in table if variable.quantity.unit == name} - {()}
        for display_name, factor in sorted(shown):
            SubElement(unit, "DisplayUnit", name=display_name, factor=repr(factor))
    return element


def _types(table):
    element = Element("TypeDefinitions")
    for variable in table:
        if variable.kind == "Enumeration":
            simple = SubElement(element, "SimpleType", name=variable.name)
            enumeration = SubElement(simple, "Enumeration")
            for value, name in enumerate(variable.quantity.choices, start=1):
                SubElement(enumeration, "Item", name=name, value=str(value))
    return element


def _variable(variable, reference):
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.quantity.meaning,
        "causality": variable.causality,
    }
    variability = "fixed" if variable.causality == "parameter" else "continuous"
    attributes["variability"] = variability if variable.kind == "Real" or variability == "fixed" else "discrete"
    if variable.causality == "output":
        attributes["initial"] = "calculated"
    elif variable.causality == "parameter":
        attributes["initial"] = "exact"
    scalar = Element("ScalarVariable", attributes)
    typed = SubElement(scalar, variable.kind)
    declared = variable.quantity
    if variable.kind == "Enumeration":
        typed.set("declaredType", variable.name)
    if variable.kind == "Real" and declared.unit:
        typed.set("quantity", QUANTITIES[declared.unit])
        typed.set("unit", declared.unit)
        if declared.display:
            typed.set("displayUnit", declared.display[0])
        if variable.causality != "parameter":
            typed.set("nominal", repr(NOMINAL.get(declared.unit, 1.0)))
    if abs(declared.minimum) < float("inf"):
        typed.set("min", number(declared.minimum))
    if abs(declared.maximum) < float("inf"):
        typed.set("max", number(declared.maximum))
    if variable.start is not None:
        typed.set("start", number(variable.start))
    return scalar


def _structure(table):
    element = Element("ModelStructure")
    outputs = SubElement(element, "Outputs")
    unknowns = SubElement(element, "InitialUnknowns")
    positions = {variable.name: k for k, variable in enumerate(table, start=1)}
    for variable in table:
        if variable.causality != "output":
            continue
        index = str(positions[variable.name])
        SubElement(outputs, "Unknown", index=index, dependencies="")
        dependencies = " ".join(str(place) for place in sorted(positions[name] for name in variable.depends_on))
        SubElement(unknowns, "Unknown", index=index, dependencies=dependencies)
    return element
