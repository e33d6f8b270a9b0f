"""Variables of FMI 3: the vectors of a table of variables, the shape and the wind at points as arrays."""

from typing import NamedTuple

COMPONENTS = 3  # of a vector


class Array(NamedTuple):
    """A variable of FMI 3; its value reference is that of its first element in FMI 2."""

    name: str
    reference: int
    dimensions: tuple  # () of a scalar
    variables: tuple  # `variables.Variable` of the elements, in their order


def arrays(wiring):
    """Variables of FMI 3 of a `wiring.fmu.Wiring`, in the order of its table: list of `Array`."""
    found = {}
    for variable, reference in zip(wiring.shown, wiring.shown_at, strict=True):
        found.setdefault(variable.name.partition("[")[0], []).append((variable, reference))
    made = []
    for name, elements in found.items():
        size = wiring.sizes.get(name, (COMPONENTS,)) if "[" in elements[0][0].name else ()
        made.append(Array(name, elements[0][1], size, tuple(variable for variable, _ in elements)))
    return made
