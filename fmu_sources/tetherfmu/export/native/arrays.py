"""Variables of FMI 3: the vectors of a table of variables, the shape and the wind at points as arrays."""

from typing import NamedTuple

from tetherfmu.runtime.inputs import WIND_AT
from tetherfmu.runtime.variables import references, wind_points_in

from .tables import count_of_values

COMPONENTS = 3  # of a vector


class Array(NamedTuple):
    """A variable of FMI 3; its value reference is that of its first element in FMI 2."""

    name: str
    reference: int
    dimensions: tuple  # () of a scalar
    variables: tuple  # `variables.Variable` of the elements, in their order


class Places(NamedTuple):
    """Where the variables of an FMU stand."""

    references: list  # value references of a table of variables
    sizes: dict  # dimensions of arrays that are no vectors, by name
    count: int  # of all values; in FMI 3 the value reference of the time


def places_of(table, shape_points):
    """`Places` of the variables of a tether."""
    sizes = {"shape": (shape_points, COMPONENTS), WIND_AT.name: (wind_points_in(table), COMPONENTS)}
    return Places(references(table, shape_points), sizes, count_of_values(table, shape_points))


def arrays(table, shape_points):
    """Variables of FMI 3 for a table of `variables.Variable` of a tether, in its order: list of `Array`."""
    return arrays_at(table, places_of(table, shape_points))


def arrays_at(table, places):
    """As `arrays`, for variables with these `Places`."""
    found = {}
    for variable, reference in zip(table, places.references, strict=True):
        found.setdefault(variable.name.partition("[")[0], []).append((variable, reference))
    made = []
    for name, elements in found.items():
        size = places.sizes.get(name, (COMPONENTS,)) if "[" in elements[0][0].name else ()
        made.append(Array(name, elements[0][1], size, tuple(variable for variable, _ in elements)))
    return made
