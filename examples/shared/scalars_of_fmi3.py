"""An FMU for FMI 3 with the calls of FMI 2: each element of a vector is a variable of its own. Helper of the examples."""

from collections import Counter
from copy import copy
from itertools import product
from math import prod
from typing import NamedTuple

from fmpy.fmi3 import FMU3Slave

# in FMI 2; variables of others are left out
TYPES = {"Float64": "Real", "Int32": "Integer", "Enumeration": "Enumeration", "Boolean": "Boolean"}


class Element(NamedTuple):
    """What stands for the value reference of a scalar: a place in a variable of FMI 3."""

    array: int  # value reference of the variable
    size: int  # how many values it has
    place: int
    kind: str  # type in FMI 3


def scalars(variables):
    """Variables of FMI 2 for those of a model description of FMI 3, by FMPy: kite_position[1], ... for kite_position."""
    found = []
    for variable in variables:
        if variable.type not in TYPES:
            continue
        size = prod(variable.shape)
        for place, indices in enumerate(product(*(range(1, count + 1) for count in variable.shape))):
            scalar = copy(variable)
            scalar.name = f"{variable.name}[{','.join(map(str, indices))}]" if indices else variable.name
            scalar.valueReference = Element(variable.valueReference, size, place, variable.type)
            scalar.type = TYPES[variable.type]
            found.append(scalar)
    return found


class ScalarsOfFmi3(FMU3Slave):
    """FMPy's instance with those calls of `FMU2Slave` that the examples use; value references are `Element`."""

    def setupExperiment(self, startTime):
        """Remember the start time for `enterInitializationMode`, which has it in FMI 3."""
        self.start_time = startTime

    def enterInitializationMode(self):
        """Enter initialization mode."""
        super().enterInitializationMode(startTime=self.start_time)

    def getReal(self, references):
        """Values of elements; each variable is read once."""
        places, size = {}, 0
        for each in references:
            if each.array not in places:
                places[each.array] = size
                size += each.size
        values = self.getFloat64(list(places), size)
        return [values[places[each.array] + each.place] for each in references]

    def setReal(self, references, values):
        """Set elements; the other elements of their variables stay as they are."""
        found, given = {}, Counter(each.array for each in references)
        for each in references:
            if each.array not in found:
                whole = given[each.array] == each.size
                found[each.array] = [0.0] * each.size if whole else self.getFloat64([each.array], each.size)
        for each, value in zip(references, values, strict=True):
            found[each.array][each.place] = value
        self.setFloat64(list(found), [value for array in found.values() for value in array])

    def getBoolean(self, references):
        """Truth values, which are scalars."""
        return super().getBoolean([each.array for each in references])

    def getInteger(self, references):
        """Integers, which are scalars."""
        return self.getInt32([each.array for each in references])

    def setBoolean(self, references, values):
        """Set truth values, which are scalars."""
        super().setBoolean([each.array for each in references], values)

    def setInteger(self, references, values):
        """Set integers and enumerations, which are scalars."""
        for each, value in zip(references, values, strict=True):
            put = self.setInt64 if each.kind == "Enumeration" else self.setInt32
            put([each.array], [value])
