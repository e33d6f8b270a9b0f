"""Variables of FMI 3: the vectors of a table of variables, the shape and the wind at points as arrays."""

from typing import NamedTuple

COMPONENTS = 3  # of a vector


class Array(NamedTuple):
    """A variable of FMI 3; its value reference is that of its first FMI 2 element."""

    name: str
    reference: int
    dimensions: tuple  # () of a scalar
    variables: tuple  # `variables.Variable` of the elements, in their order


def arrays(wiring):
    """Variables of FMI 3 of a `wiring.fmu.Wiring`, in the order of its table: list of `Array`."""
    found = {}
    for variable in wiring.shown:
        found.setdefault(variable.name.partition("[")[0], []).append(variable)
    return [Array(name, elements[0].place, dimensions_of(elements), tuple(elements)) for name, elements in found.items()]


def dimensions_of(elements):
    """Dimensions of a variable: none for a scalar; for a vector its number of elements; for vectors at points also these."""
    first, count = elements[0].name, len(elements)
    if not first.endswith("]"):
        return ()
    return (count // COMPONENTS, COMPONENTS) if "," in first else (count,)
