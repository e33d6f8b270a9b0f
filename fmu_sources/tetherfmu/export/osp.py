"""The interface as groups of variables for the Open Simulation Platform (OSP-IS): each end of the tether is one connection.

libcosim reads NAME_OspModelDescription.xml beside the FMU or beside the system structure, not inside the FMU.
"""

from xml.etree.ElementTree import Element, SubElement

from .xml_text import xml_text

NAMESPACE = "https://open-simulation-platform.com/OspModelDescription/1.0.1"


def file_name(name):
    """Name of the file for an FMU, as libcosim looks for it."""
    return f"{name}_OspModelDescription.xml"


def model_description(table):
    """Text of the file.

    Two Generic groups, `kite` and `ground`, each with a Force, a LinearVelocity and a LinearDisplacement in this order; and
    the LinearVelocity groups `wind` and `reel_out`, the Force group `winch_pull` and the LinearDisplacement group `winch`.
    The force of a free kite end is its load. libcosim connects a group with one of the same make: groups in groups in the
    same order, with the same number of variables. What an FMU for one scene goes without is left out.

    table : of `variables.Variable`.
    """
    units = {variable.name: variable.quantity.unit for variable in table}
    root = Element("OspModelDescription", xmlns=NAMESPACE, version="1.0")
    groups = SubElement(root, "VariableGroups")
    for end, force in (("kite", "load" if "kite_load[1]" in units else "force"), ("ground", "force")):
        port = Element("Generic", name=end)
        for kind, what in (("Force", force), ("LinearVelocity", "velocity"), ("LinearDisplacement", "position")):
            _vector(port, kind, f"{end}_{what}", units, f"{end}_{what}")
        if len(port):
            groups.append(port)
    if "wind_at[1,1]" not in units:  # which replaces it, and has no group
        _vector(groups, "LinearVelocity", "wind", units, "wind_velocity")
    for kind, group, name in (
        ("LinearVelocity", "reel_out", "reel_out_speed"),
        ("Force", "winch_pull", "winch_force"),
        ("LinearDisplacement", "winch", "winch_length"),
    ):
        if name in units:
            SubElement(SubElement(groups, kind, name=group), "Variable", ref=name, unit=units[name])
    return xml_text(root)


def _vector(parent, kind, group, units, vector):
    """Add a group of the three components of a vector, if the FMU has it (`parent` is modified)."""
    if f"{vector}[1]" in units:
        element = SubElement(parent, kind, name=group)
        for number, axis in enumerate("xyz", start=1):
            name = f"{vector}[{number}]"
            SubElement(element, "Variable", ref=name, unit=units[name], axis=axis)
