"""Model description: variables with units, limits and enumerations, and the model structure, for FMI 2.

They complete PythonFMU's description; native FMUs for FMI 3 use the same `attributes` of a variable.
"""

from math import inf
from xml.etree.ElementTree import Element, SubElement

from ..runtime.outputs import OUTPUT
from ..wiring.variables import CALCULATED, INPUT, PARAMETER

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
# default display unit of each unit, as `Quantity.display`
DISPLAY = {"N": ("kN", 1e-3), "N/m": ("kN/m", 1e-3)}
_INITIAL = {**dict.fromkeys(CALCULATED, "calculated"), PARAMETER: "exact"}
# attributes of a ScalarVariable of FMI 2; all others belong to its type
_OF_A_SCALAR = ("name", "valueReference", "description", "causality", "variability", "initial")
_LARGEST_EXACT = 1e15  # a whole number of fewer than 16 digits is a double


def complete(root, table, constants=()):
    """Write units, types, variables and model structure of a table of variables into the description (modified).

    root : Element of the model description, with PythonFMU's ModelVariables and ModelStructure.  table : of
    `variables.Variable`.  constants : of `annotations`.
    """
    for name in ("ModelVariables", "ModelStructure"):
        root.remove(root.find(name))
    place = list(root).index(root.find("CoSimulation")) + 1
    for element in reversed(definitions(table)):
        root.insert(place, element)
    root.extend(annotations("VendorAnnotations", "Tool", "name", constants))
    root.append(variables(table))
    root.append(structure(table))


def annotations(tag, entry, key, constants):
    """Annotation about constants for users of the FMU, a list of one Element or none.

    tag, entry, key : of the annotations in a version of FMI.  constants : triples as in `wiring.Wiring`.
    """
    if not constants:
        return []
    element = Element(tag)
    own = SubElement(SubElement(element, entry, {key: "TetherFMU"}), "Constants")
    for name, _, value in constants:
        SubElement(own, "Constant", name=name, value=number_text(value))
    return [element]


def definitions(table):
    """UnitDefinitions and TypeDefinitions of a table of variables, a list; those that would be empty are not allowed."""
    return [element for element in (units(table), types(table)) if len(element)]


def number_text(value):
    """A number as text that reads back to the same bits."""
    return repr(int(value)) if float(value).is_integer() and abs(value) < _LARGEST_EXACT else repr(float(value))


def start_text(variable):
    """Start value of a variable as text."""
    if variable.kind == "Boolean":
        return "true" if variable.start else "false"
    return number_text(variable.start)


def variables(table):
    """ModelVariables of a table of variables."""
    element = Element("ModelVariables")
    element.extend(map(_variable, table))
    return element


def units(table):
    """UnitDefinitions for a table of variables."""
    element = Element("UnitDefinitions")
    for name in sorted({variable.quantity.unit for variable in table} - {""}):
        unit = SubElement(element, "Unit", name=name)
        SubElement(unit, "BaseUnit", base_units(name))
        shown = {display_of(variable.quantity) for variable in table if variable.quantity.unit == name} - {()}
        for display_name, factor in sorted(shown):
            SubElement(unit, "DisplayUnit", name=display_name, factor=repr(factor))
    return element


def base_units(unit):
    """Attributes of a BaseUnit: exponents of the base units of a unit, as texts by their names."""
    return {base: str(power) for base, power in known(unit)[1].items()}


def known(unit):
    """Entry of a unit in `UNITS`; ValueError if there is none."""
    if unit not in UNITS:
        raise ValueError(f"the unit {unit} has no quantity and no base units: add it to UNITS in fmi/model_description.py")
    return UNITS[unit]


def display_of(quantity):
    """Display unit and factor, as `Quantity.display`; () for none."""
    return quantity.display or DISPLAY.get(quantity.unit, ())


def types(table):
    """TypeDefinitions: the enumerations of a table of variables."""
    element = Element("TypeDefinitions")
    for name, variable in enumerations(table).items():
        simple = SubElement(element, "SimpleType", name=name)
        SubElement(simple, "Enumeration").extend(items(variable))
    return element


def type_name(variable):
    """Name of the type of an enumeration: the variable name without its line."""
    return variable.name.rpartition(".")[2]


def enumerations(table):
    """Names of the types of enumerations of a table of variables, and one variable of each: dict."""
    return {type_name(variable): variable for variable in table if variable.kind == "Enumeration"}


def items(variable):
    """The values of an enumeration: list of Item."""
    declared = variable.quantity
    return [
        Element("Item", name=name, value=str(value), description=declared.choices[name])
        for name, value in declared.numbers.items()
    ]


def attributes(name, reference, meaning, elements):
    """Attributes of a variable in a model description: dict for FMI 2 and FMI 3, in their order.

    name, reference, meaning : of the variable.  elements : `variables.Variable` of its elements, a scalar's is one; they
    differ in their start values only.
    """
    first = elements[0]
    declared, fixed = first.quantity, first.causality == PARAMETER
    found = {"name": name, "valueReference": str(reference), "description": meaning, "causality": first.causality}
    # calculated variables change in steps, counters are discrete
    found["variability"] = "fixed" if fixed else "continuous" if first.kind == "Real" else "discrete"
    if first.causality in _INITIAL:
        found["initial"] = _INITIAL[first.causality]
    if first.kind == "Enumeration":
        found["declaredType"] = type_name(first)
    if first.kind == "Real" and declared.unit:
        quantity, _, nominal = known(declared.unit)
        found |= {"quantity": quantity, "unit": declared.unit}
        if display_of(declared):
            found["displayUnit"] = display_of(declared)[0]
        if first.causality in (INPUT, *CALCULATED):
            found["nominal"] = repr(nominal)
    limits = {"min": declared.minimum, "max": declared.maximum}
    found |= {key: number_text(limit) for key, limit in limits.items() if abs(limit) < inf}
    if first.start is not None:
        found["start"] = " ".join(start_text(each) for each in elements)
    return found


def _variable(variable):
    found = attributes(variable.name, variable.place, variable.quantity.meaning, (variable,))
    scalar = Element("ScalarVariable", {key: text for key, text in found.items() if key in _OF_A_SCALAR})
    SubElement(scalar, variable.kind, {key: text for key, text in found.items() if key not in _OF_A_SCALAR})
    return scalar


def structure(table):
    """ModelStructure of a table of variables: its outputs, and their dependencies when initialization ends."""
    element, outputs, unknowns = Element("ModelStructure"), Element("Outputs"), Element("InitialUnknowns")
    positions = {variable.name: k for k, variable in enumerate(table, start=1)}
    for variable in table:
        if variable.causality == OUTPUT:
            index = str(positions[variable.name])
            SubElement(outputs, "Unknown", index=index, dependencies="")
            unknown = SubElement(unknowns, "Unknown", index=index)
            if variable.depends_on is not None:  # without the attribute it depends on anything
                unknown.set("dependencies", " ".join(map(str, sorted(positions[name] for name in variable.depends_on))))
    element.extend(each for each in (outputs, unknowns) if len(each))  # empty ones are not allowed
    return element
