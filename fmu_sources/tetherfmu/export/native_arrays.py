"""Variables of FMI 3: the vectors of a table of variables, the shape and the wind at points as arrays."""

from typing import NamedTuple

from tetherfmu.runtime.inputs import WIND_AT
from tetherfmu.runtime.variables import references, wind_points_in

COMPONENTS = 3  # of a vector


class Array(NamedTuple):
    """A variable of FMI 3; its value reference is that of its first element in FMI 2."""

    name: str
    reference: int
    dimensions: tuple  # () of a scalar
    variables: tuple  # `variables.Variable` of the elements, in their order


def arrays(table, shape_points):
    """Variables of FMI 3 for a table of `variables.Variable`, in its order: list of `Array`."""
    found = {}
    for variable, reference in zip(table, references(table, shape_points), strict=True):
        found.setdefault(variable.name.partition("[")[0], []).append((variable, reference))
    dimensions = {"shape": (shape_points, COMPONENTS), WIND_AT.name: (wind_points_in(table), COMPONENTS)}
    made = []
    for name, elements in found.items():
        size = dimensions.get(name, (COMPONENTS,)) if "[" in elements[0][0].name else ()
        made.append(Array(name, elements[0][1], size, tuple(variable for variable, _ in elements)))
    return made
