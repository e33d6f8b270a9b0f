"""Selection of the variables of an FMU, in groups, and their displayed order. Value references stay as in the full FMU.

An omitted variable keeps its start value: a constant.
"""

from dataclasses import replace

from .variables import PARAMETER

# of variables, by name; each variable of a table has one of them
GROUPS = {
    "motion": "the ends, free points and loads",
    "forces": "forces and tensions",
    "breaking": "breaking and letting go",
    "tether": "material and segments",
    "winch": "winch and length",
    "wind": "wind, air and gravity",
    "ground": "ground",
    "geometry": "angles, sag and slack",
    "shape": "points on the tether",
    "coupling": "stiffness, damping and mass at the kite end, for couplings",
    "solver": "solver and start",
}
# parameters that a newcomer sets first, and first in the list
FIRST = (
    *("initial_length", "diameter", "density", "axial_stiffness", "axial_damping", "drag_coefficient", "segments"),
    *("kite_mass", "mass", "winch_control", "ground_contact", "air_density", "relative_tolerance"),
)


def own_name(name):
    """Name of a variable without its point or line, and without the index of an element."""
    return name.partition("[")[0].rpartition(".")[2]


def in_order(table):
    """The variables of a table in the order of a model description: parameters by group, `FIRST` before the others."""
    groups = (*GROUPS, "")

    def place(variable):
        if variable.causality != PARAMETER:
            return (0,)
        own = own_name(variable.name)
        return (1, FIRST.index(own)) if own in FIRST else (2, groups.index(variable.group))

    return tuple(sorted(table, key=place))


def shown(table, left_out):
    """The table of an FMU that omits some variables, on which no output depends; left_out : their names."""
    kept = (each for each in table if each.name not in left_out)
    return in_order(
        each if each.depends_on is None else replace(each, depends_on=tuple(n for n in each.depends_on if n not in left_out))
        for each in kept
    )


def with_starts(table, starts):
    """A table with other start values; starts : pairs (name, number)."""
    given = dict(starts)
    return tuple(replace(each, start=given[each.name]) if each.name in given else each for each in table)
