"""What a status of the kernels says about a system of tethers: the sentence, with the name of the line, point or input."""

from . import layout as at
from . import status
from . import system_layout as places
from .instance import facts_of
from .system_variables import input_name
from .variables import INPUT_NAMES


def sentence(result, step, arrays, lines, free, at_start=False):
    """What a status says about a step [s].

    arrays : has `plan`, `inputs`, `parameters` and `state` of `system_layout.py`.  lines : have `name`, `start` and `end`.
    free : names of the free points in their order.  at_start : whether the lines have the lengths of their start.
    """
    about, place = int(arrays.plan[places.STATUS_LINE]), status.index(result)
    if status.code(result) == status.NO_EQUILIBRIUM_OF_POINT:
        return status.sentence(result, name=free[place])
    if about == places.ALL_LINES and status.code(result) == status.INPUT_NOT_FINITE:
        first = places.inputs_size(len(lines), place)
        load = [float(each) for each in arrays.inputs[first : first + 3]]
        return status.sentence(result, name=f"{free[place]}.load", value=load)
    k = max(about, 0)
    row = arrays.plan[places.PLAN_HEADER + places.LINE_NUMBERS * k :]
    inputs = arrays.inputs[at.INPUTS * k : at.INPUTS * (k + 1)]
    parameters = arrays.parameters[row[places.PARAMETERS_AT] :]
    length = parameters[at.INITIAL_LENGTH] if at_start else arrays.state[row[places.STATE_AT] + at.LENGTH]
    name = input_name(INPUT_NAMES[place], lines[k]) if place < at.INPUTS else ""
    value = inputs[place] if place < at.INPUTS else 0.0
    counts = arrays.plan[places.PLAN_HEADER + places.SEGMENTS :: places.LINE_NUMBERS]
    facts = facts_of(inputs, parameters, length, int(sum(counts)) if about == places.ALL_LINES else row[places.SEGMENTS])
    said = status.sentence(result, name=name, value=value, step=step, **facts)
    return said if about == places.ALL_LINES else f"the line {lines[k].name}: {said}"
