"""The interface as groups of variables for the Open Simulation Platform (OSP-IS): each end of the tether is one connection.

libcosim reads NAME_OspModelDescription.xml beside the FMU or beside the system structure, not inside the FMU.
"""

from xml.etree.ElementTree import Element, SubElement

from .texts import xml_text

NAMESPACE = "https://open-simulation-platform.com/OspModelDescription/1.0.1"
WINCH = (  # kind and name of a group, and its variable
    ("LinearVelocity", "reel_out", "reel_out_speed"),
    ("Force", "winch_pull", "winch_force"),
    ("LinearDisplacement", "winch", "winch_length"),
    ("LinearVelocity", "winch_speed", "winch_speed"),
    ("LinearDisplacement", "tether_length", "tether_length"),
)


def file_name(name):
    """Name of the file for an FMU, as libcosim looks for it."""
    return f"{name}_OspModelDescription.xml"


def model_description(table):
    """Text of the file.

    Two Generic groups, `kite` and `ground`, each with a Force, a LinearVelocity and a LinearDisplacement in this order; and
    the LinearVelocity group `wind` and those of the winch, `WINCH`.
    The force of a free kite end is its load. libcosim connects a group with one of the same make: groups in groups in the
    same order, with the same number of variables. What an FMU for one scene goes without is left out.

    table : of `variables.Variable`.
    """
    units = {variable.name: variable.quantity.unit for variable in table}
    root, groups = _root()
    for end, force in (("kite", "load" if "kite_load[1]" in units else "force"), ("ground", "force")):
        _port(groups, end, units, f"{end}_", force)
    if "wind_at[1,1]" not in units:  # which replaces it, and has no group
        _vector(groups, "LinearVelocity", "wind", units, "wind_velocity")
    _winch(groups, units)
    return xml_text(root)


def model_description_of_system(structure, table):
    """Text of the file of a system: a Generic group for each point, as for the end of a tether, wind, winches of lines.

    The force of a free point is its load.  structure : `system_variables.Structure`.  table : of `variables.Variable`.
    """
    units = {variable.name: variable.quantity.unit for variable in table}
    root, groups = _root()
    for point in structure.points:
        _port(groups, point.name, units, f"{point.name}.", "load" if point.is_free else "force")
    if not structure.has_wind_points:
        _vector(groups, "LinearVelocity", "wind", units, "wind_velocity")
    for line in structure.lines:
        _winch(groups, units, f"{line.name}_", f"{line.name}.")
    return xml_text(root)


def _root():
    """The root of a file, and its element of groups."""
    root = Element("OspModelDescription", xmlns=NAMESPACE, version="1.0")
    return root, SubElement(root, "VariableGroups")


def _port(groups, name, units, prefix, force):
    """Add the group of force, velocity and position of an end or a point (`groups` is modified), unless the FMU has none.

    prefix : before these words in the names of the variables.  force : the word for the force.
    """
    port = Element("Generic", name=name)
    for kind, what in (("Force", force), ("LinearVelocity", "velocity"), ("LinearDisplacement", "position")):
        _vector(port, kind, f"{name}_{what}", units, f"{prefix}{what}")
    if len(port):
        groups.append(port)


def _winch(groups, units, group_prefix="", prefix=""):
    """Add the groups of a winch, of the variables that the FMU has (`groups` is modified).

    group_prefix, prefix : before the names of groups and variables.
    """
    for kind, group, name in WINCH:
        if f"{prefix}{name}" in units:
            element = SubElement(groups, kind, name=f"{group_prefix}{group}")
            SubElement(element, "Variable", ref=f"{prefix}{name}", unit=units[f"{prefix}{name}"])


def _vector(parent, kind, group, units, vector):
    """Add a group of the three components of a vector, if the FMU has it (`parent` is modified)."""
    if f"{vector}[1]" in units:
        element = SubElement(parent, kind, name=group)
        for number, axis in enumerate("xyz", start=1):
            name = f"{vector}[{number}]"
            SubElement(element, "Variable", ref=name, unit=units[name], axis=axis)
