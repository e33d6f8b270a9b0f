"""The table of FMI variables, built from the declarations. One table for every tether.

Inputs are declared in `inputs`, outputs in `outputs`, parameters in the records of `parameters`; `variants` selects those
of a tether. The value reference of a variable is its place in `Instance.values`: first the `inputs` array, then
the `outputs` array, then the parameters. The motion of a free kite end is an output at the place of the input of
other tethers, so that all have the same value references.
"""

from dataclasses import dataclass, fields, replace
from functools import lru_cache

from ..runtime import inputs, outputs
from ..runtime import layout as at
from ..runtime.dependencies import depends_on
from ..runtime.inputs import DRIVEN_KITE, INPUT_TABLE, WIND_AT, WITHOUT_EFFECT, components, inputs_of, wind_at_names
from ..runtime.instance import RunningLine
from ..runtime.outputs import ARRAY_ORDER, LOCAL, OUTPUT, POINTS, SCALAR, VECTOR
from ..runtime.parameters import RECORDS, Environment, FreeKite, Ground, Solver, Tether, Winch
from ..runtime.quantities import Quantity, quantities
from ..runtime.variants import BY_NAME

INPUT, PARAMETER = "input", "parameter"
CALCULATED = (OUTPUT, LOCAL)  # by the tether


@dataclass(frozen=True)
class Variable:
    """One FMI variable."""

    name: str
    causality: str  # INPUT, OUTPUT, LOCAL or PARAMETER
    kind: str  # "Real", "Integer", "Enumeration" or "Boolean"
    quantity: Quantity
    place: int  # its value reference; in `parameters_of` its number
    start: float | None = None  # of inputs and parameters
    depends_on: tuple | None = None  # names of the dependencies of an output when initialization ends; None: anything
    group: str = ""  # see `wiring/selection.py`


# group of the quantities of a record, see `wiring/selection.py`
GROUP_OF = {
    Tether: "tether",
    Environment: "wind",
    Solver: "solver",
    Winch: "winch",
    Ground: "ground",
    FreeKite: "motion",
}
IGNORED_WITH_WIND_AT = "(ignored: the wind is that of wind_at)"
INPUT_NAMES = tuple(name for each in INPUT_TABLE for name in components(each.name, each.size))  # by their places


def line_of_tether(shape_points, wind_points=0):
    """The `instance.RunningLine` of a tether alone."""
    return RunningLine("", INPUT_NAMES + wind_at_names(wind_points), shape_points, wind_points)


def elements(name, meaning, shape, shape_points):
    """Pairs of FMI name and meaning: of a scalar, of vector components, or of all points of the shape."""
    if shape == SCALAR:
        return [(name, meaning)]
    if shape == VECTOR:
        return [(each, f"{meaning}, {axis}") for each, axis in zip(components(name, 3), "xyz", strict=True)]
    rest = meaning.removeprefix("points")
    return [
        (f"{name}[{k},{i}]", f"point {k} of {shape_points}{rest}, {axis}")
        for k in range(1, shape_points + 1)
        for i, axis in enumerate("xyz", start=1)
    ]


def _input_elements(each):
    return elements(each.name, each.meaning, VECTOR if each.size > 1 else SCALAR, 0)


def _input_variables(variant, wind_points):
    for each in inputs_of(variant.kite_is_free):
        place = inputs.PLACES[each.name]
        if wind_points and each.name in WITHOUT_EFFECT:
            each = replace(each, meaning=f"{each.meaning} {IGNORED_WITH_WIND_AT}")
        for i, (name, meaning) in enumerate(_input_elements(each)):
            yield Variable(name, INPUT, each.kind, Quantity(each.unit, meaning), place + i, each.start[i], group=each.group)
    for i, (name, meaning) in enumerate(elements(WIND_AT.name, WIND_AT.meaning, POINTS, wind_points)):
        quantity = Quantity(WIND_AT.unit, meaning)
        yield Variable(name, INPUT, "Real", quantity, at.INPUTS + i, WIND_AT.start[i % 3], group=WIND_AT.group)


def _output_variables(variant, shape_points, wind_points):
    """An input of this tether is not an output of it."""
    given = {each.name for each in inputs_of(variant.kite_is_free)}
    for output in ARRAY_ORDER:
        if output.name in given:
            continue
        place = at.inputs_size(wind_points) + outputs.PLACES[output.name]
        meaning = variant.meanings.get(output.name, output.quantity.meaning)
        for i, (name, text) in enumerate(elements(output.name, meaning, output.shape, shape_points)):
            quantity = replace(output.quantity, meaning=text)
            causality = output.causality(wind_points)
            known = depends_on(variant, output, name, shape_points, wind_points) if causality == OUTPUT else None
            yield Variable(name, causality, output.kind, quantity, place + i, depends_on=known, group=output.group)


def names_of(table, causality):
    """Names of the variables of a causality in a table of `variables`, in their order."""
    return [variable.name for variable in table if variable.causality == causality]


def records_of(variant):
    """Records with the parameters of a variant."""
    return (*RECORDS, FreeKite) if BY_NAME[variant].kite_is_free else RECORDS


def parameters_of(record_classes, starts=None):
    """Variables of the quantities of records, numbered from 0; starts : dict name to start value, where it is no default."""
    variables = []
    for record in record_classes:
        defaults = {item.name: item.default for item in fields(record)}
        for name, declared in quantities(record):
            kind = "Enumeration" if declared.choices else "Integer" if isinstance(defaults[name], int) else "Real"
            start = (starts or {}).get(name, defaults[name])
            variables.append(
                Variable(name, PARAMETER, kind, declared, len(variables), start, group=GROUP_OF.get(record, ""))
            )
    return variables


def without_effect(variable, has_wind_points, name=None):
    """The `Variable`, documented as without effect if wind points replace it; name : of its vector."""
    if not has_wind_points or (name or variable.name) not in WITHOUT_EFFECT:
        return variable
    meaning = f"{variable.quantity.meaning} {IGNORED_WITH_WIND_AT}"
    return replace(variable, quantity=replace(variable.quantity, meaning=meaning))


def _parameter_variables(variant, starts, wind_points=0):
    variables = []
    for each in parameters_of(records_of(variant.name), starts):
        each = without_effect(each, wind_points)
        if each.name in variant.ignored:
            meaning = f"{each.quantity.meaning} (ignored: {variant.ignored[each.name]})"
            each = replace(each, quantity=replace(each.quantity, meaning=meaning))
        variables.append(each)
    if variant.kite_is_free:
        for each in (each for each in INPUT_TABLE if each.of == DRIVEN_KITE):
            at_start = replace(each, name=f"initial_{each.name}", meaning=f"{each.meaning} at the start")
            for (name, meaning), start in zip(_input_elements(at_start), each.start, strict=True):
                declared = Quantity(each.unit, meaning, -at.LARGEST_INPUT, at.LARGEST_INPUT)
                first = starts.get(name, start)
                variables.append(Variable(name, PARAMETER, "Real", declared, len(variables), first, group=each.group))
    return variables


# quantities of any tether, a free kite last, in the order of the kernel `pack`
PARAMETERS = tuple(_parameter_variables(BY_NAME["dynamic_free"], {}))
PARAMETERS_WITHOUT_KITE = len(parameters_of(RECORDS))  # how many of them are not about a free kite


@lru_cache
def variables(variant, shape_points, starts=(), wind_points=0):
    """The table of all variables, a tuple: inputs, outputs and local ones, parameters.

    variant : one of `variants.EVERY_VARIANT`.  shape_points : number of points of the output `shape`.
    starts : pairs (input or parameter, start value) that replace defaults.  wind_points : number of points of the input
    `wind_at`.
    """
    tether, first, begin = BY_NAME[variant], dict(starts), at.inputs_size(wind_points) + at.outputs_size(shape_points)
    given = [replace(each, start=first.get(each.name, each.start)) for each in _input_variables(tether, wind_points)]
    fixed = [replace(each, place=begin + each.place) for each in _parameter_variables(tether, first, wind_points)]
    return (*given, *_output_variables(tether, shape_points, wind_points), *fixed)


def table_of(variant, options):
    """The table of a tether with these build options: `segments`, `shape_points`, and if there are any `wind_points` and
    `starts`.
    """
    starts = (("segments", options["segments"]), *map(tuple, options.get("starts", ())))
    return variables(variant, options["shape_points"], starts, options.get("wind_points", 0))
