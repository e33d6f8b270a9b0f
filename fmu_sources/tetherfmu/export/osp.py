"""The interface as groups of variables for the Open Simulation Platform (OSP-IS): each end of the tether is one connection.

libcosim reads NAME_OspModelDescription.xml beside the FMU or beside the system structure, not inside the FMU.
"""

from xml.etree.ElementTree import Element, SubElement

from tetherfmu.wiring.system_variables import inputs_at

from .texts import xml_text

NAMESPACE = "https://open-simulation-platform.com/OspModelDescription/1.0.1"
KINDS = {"m/s": "LinearVelocity", "N": "Force", "m": "LinearDisplacement"}  # of groups, by the unit of their variables
WINCH = (*inputs_at("winch"), "winch_speed", "tether_length", "payout")  # variables that have a group of their own
GROUPS = {"reel_out_speed": "reel_out", "winch_force": "winch_pull", "winch_length": "winch"}  # groups with other names


def file_name(name):
    """Name of the file for an FMU, as libcosim looks for it."""
    return f"{name}_OspModelDescription.xml"


def model_description(table):
    """Text of the file of a tether.

    Two Generic groups, `kite` and `ground`, each with a Force, a LinearVelocity and a LinearDisplacement in this order; and
    the LinearVelocity group `wind` and the winch groups, `WINCH`.
    The force of a free kite end is its load. libcosim connects a group with one of the same structure: subgroups in the
    same order, with the same number of variables. Variables omitted from an FMU for one scene are omitted here.

    table : of `variables.Variable`.
    """
    force = "load" if any(variable.name == "kite_load[1]" for variable in table) else "force"
    return _text(table, (("kite", "kite_", force), ("ground", "ground_", "force")), (("", ""),))


def model_description_of_system(system, table):
    """Text of the file of a system: a Generic group for each point, as for the end of a tether, wind, winches.

    The force of a free point is its load.  system : `wiring.system.System`.  table : of `variables.Variable`.
    """
    ports = [(point.name, f"{point.name}.", "force" if point.is_driven else "load") for point in system.points]
    return _text(table, ports, [(f"{each.name}_", f"{each.name}.") for each in (*system.lines, *system.winches)])


def _text(table, ports, winches):
    """Text of a file; ports : arguments of `_port`.  winches : prefixes of their groups and variables."""
    units = {variable.name: variable.quantity.unit for variable in table}
    root = Element("OspModelDescription", xmlns=NAMESPACE, version="1.0")
    groups = SubElement(root, "VariableGroups")
    for port in ports:
        _port(groups, units, *port)
    if not any("wind_at[" in name for name in units):  # which replaces it, and has no group
        _vector(groups, "LinearVelocity", "wind", units, "wind_velocity")
    for group, prefix in winches:
        for name in (each for each in WINCH if f"{prefix}{each}" in units):
            element = SubElement(groups, KINDS[units[f"{prefix}{name}"]], name=f"{group}{GROUPS.get(name, name)}")
            SubElement(element, "Variable", ref=f"{prefix}{name}", unit=units[f"{prefix}{name}"])
    return xml_text(root)


def _port(groups, units, name, prefix, force):
    """Add the group of force, velocity and position of an end or a point (`groups` is modified), if the FMU has these.

    prefix : of the variable names.  force : the word for the force.
    """
    port = Element("Generic", name=name)
    for kind, what in (("Force", force), ("LinearVelocity", "velocity"), ("LinearDisplacement", "position")):
        _vector(port, kind, f"{name}_{what}", units, f"{prefix}{what}")
    if len(port):
        groups.append(port)


def _vector(parent, kind, group, units, vector):
    """Add a group of the three components of a vector, if the FMU has it (`parent` is modified)."""
    if f"{vector}[1]" in units:
        element = SubElement(parent, kind, name=group)
        for number, axis in enumerate("xyz", start=1):
            name = f"{vector}[{number}]"
            SubElement(element, "Variable", ref=name, unit=units[name], axis=axis)
