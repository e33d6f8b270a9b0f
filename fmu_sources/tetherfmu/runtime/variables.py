"""The table of FMI variables, made from the records. One table for every tether.

A variable lives at one place of the flat arrays (`layout.py`), which has its name: an input, an output, or a parameter of a
record. Its value reference is its place in `Instance.values`. The motion of a free kite end is an output; it stands where it
is an input in the other tethers, so that all have the same value references.
"""

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import degrees, pi

from . import layout as at
from .dependencies import depends_on
from .parameters import Environment, FreeKite, Solver, Tether
from .quantities import Quantity, checked, quantities
from .variants import FREE

INPUT, OUTPUT, PARAMETER = "input", "output", "parameter"
RECORDS = (Tether, Environment, Solver)
KITE_AT_START = (300.0, 0.0, 400.0)
DEGREES = ("deg", degrees(1.0))


@dataclass(frozen=True)
class Variable:
    """One FMI variable."""

    name: str
    causality: str  # INPUT, OUTPUT or PARAMETER
    kind: str  # "Real", "Integer" or "Enumeration"
    quantity: Quantity
    place: int  # in the `inputs` array or, from `layout.INPUTS` on, in the `outputs` array; of a parameter, its number
    start: float | None = None  # of inputs and parameters
    depends_on: tuple | None = None  # of an output, names of what it depends on when initialization ends


def _vector(name, causality, unit, meaning, start=(None, None, None)):
    place = getattr(at, name.upper()) + (at.INPUTS if causality == OUTPUT else 0)
    return [
        Variable(f"{name}[{i + 1}]", causality, "Real", Quantity(unit, f"{meaning}, {axis}"), place + i, start[i])
        for i, axis in enumerate("xyz")
    ]


_ZERO = (0.0, 0.0, 0.0)
_KITE_MOTION = (
    *_vector("kite_position", INPUT, "m", "position of the kite attachment point", KITE_AT_START),
    *_vector("kite_velocity", INPUT, "m/s", "velocity of the kite attachment point", _ZERO),
)
_LOAD = "external force on the kite: aerodynamics, control; not its weight"
_KITE_LOAD = tuple(_vector("kite_load", INPUT, "N", _LOAD, _ZERO))


def _input_variables(variant):
    reel_out = Quantity("m/s", "rate of change of the unstretched length; positive pays out")
    return [
        *(_KITE_LOAD if variant in FREE else _KITE_MOTION),
        *_vector("ground_position", INPUT, "m", "position of the ground end", _ZERO),
        *_vector("ground_velocity", INPUT, "m/s", "velocity of the ground end", _ZERO),
        Variable("reel_out_speed", INPUT, "Real", reel_out, at.REEL_OUT_SPEED, 0.0),
        *_vector("wind_velocity", INPUT, "m/s", "wind at wind_reference_height", _ZERO),
    ]


_AZIMUTH = "azimuth at which the tether leaves the ground end, from the x axis, anti-clockwise seen from above"
_SCALAR_OUTPUTS = {  # unit, meaning, minimum, maximum
    "ground_tension": Quantity("N", "tension of the first segment"),
    "kite_tension": Quantity("N", "tension of the last segment"),
    "max_tension": Quantity("N", "largest tension of all segments now"),
    "tether_length": Quantity("m", "unstretched length now", 0.0),
    "ground_elevation": Quantity(
        "rad", "elevation at which the tether leaves the ground end", -pi / 2.0, pi / 2.0, display=DEGREES
    ),
    "ground_azimuth": Quantity("rad", _AZIMUTH, -pi, pi, display=DEGREES),
    "slack_segments": Quantity("", "number of segments that are shorter than unstretched", 0, at.MAX_SEGMENTS),
    "kite_end_mass": Quantity("kg", "tether mass lumped at the kite end", 0.0),
    "kite_stiffness": Quantity("N/m", "stiffness along the tether that the kite feels, all segments taut", 0.0),
    "kite_damping": Quantity("N.s/m", "damping along the tether that the kite feels, all segments taut", 0.0),
    "wave_time": Quantity("s", "travel time of a transverse wave over the tether", 0.0),
    "sag": Quantity("m", "largest distance of the tether from its chord", 0.0),
    "solver_steps": Quantity("", "internal steps of the solver since the start", 0, at.LARGEST_INTEGER),
    "solver_rejections": Quantity("", "internal steps that it took back since the start", 0, at.LARGEST_INTEGER),
    "solver_iterations": Quantity(
        "", "Newton iterations since the start, for shapes and fixed steps", 0, at.LARGEST_INTEGER
    ),
}
INTEGER_OUTPUTS = ("slack_segments", "solver_steps", "solver_rejections", "solver_iterations")


def _output_variables(variant, shape_points):
    outputs = [
        *_vector("ground_force", OUTPUT, "N", "force of the tether on the ground station"),
        *_vector("kite_force", OUTPUT, "N", "force of the tether on the kite"),
    ]
    for name, quantity in _SCALAR_OUTPUTS.items():
        kind = "Integer" if name in INTEGER_OUTPUTS else "Real"
        outputs.append(Variable(name, OUTPUT, kind, quantity, at.INPUTS + getattr(at, name.upper())))
    if variant in FREE:
        outputs += [replace(each, causality=OUTPUT, start=None) for each in _KITE_MOTION]
    for k in range(1, shape_points + 1):
        for i, axis in enumerate("xyz", start=1):
            meaning = f"point {k} of {shape_points} on the tether at equal unstretched length, {axis}"
            place = at.INPUTS + at.SHAPE + 3 * (k - 1) + i - 1
            outputs.append(Variable(f"shape[{k},{i}]", OUTPUT, "Real", Quantity("m", meaning), place))
    return outputs


# of all tethers together, by their places
INPUT_NAMES = {each.place: each.name for each in (*_KITE_MOTION, *_input_variables("dynamic_free"))}


def names_of(table, causality):
    """Names of the inputs, outputs or parameters in a table of `variables`, in their order."""
    return [variable.name for variable in table if variable.causality == causality]


def records_of(variant):
    """Records whose quantities are the parameters of a variant."""
    return (*RECORDS, FreeKite) if variant in FREE else RECORDS


_IGNORED_WITHOUT_WAVES = {
    **dict.fromkeys(("axial_damping", "slack_damping_ratio", "damping_law"), "this tether has no waves"),
    **dict.fromkeys(("relative_tolerance", "fixed_step"), "there is no motion to integrate"),
    "initial_shape": "this tether is in equilibrium from the start",
}
_IGNORED_WITHOUT_NODES = {
    **_IGNORED_WITHOUT_WAVES,
    "slack_stiffness_ratio": "no part of this tether is in compression",
    "segments": "this tether has no nodes",
}
IGNORED = {  # parameters that a variant ignores, and why
    "dynamic": {},
    "dynamic_free": {},
    "quasi_steady": _IGNORED_WITHOUT_WAVES,
    "catenary": _IGNORED_WITHOUT_NODES,
    "straight": _IGNORED_WITHOUT_NODES,
}


def parameters_of(record_classes, starts=None):
    """Variables of the quantities of records, numbered from 0; starts : dict name to start value, where it is no default."""
    variables = []
    for record in record_classes:
        defaults = {item.name: item.default for item in fields(record)}
        for name, declared in quantities(record):
            kind = "Enumeration" if declared.choices else "Integer" if isinstance(defaults[name], int) else "Real"
            start = (starts or {}).get(name, defaults[name])
            variables.append(Variable(name, PARAMETER, kind, declared, len(variables), start))
    return variables


def _parameter_variables(variant, starts):
    variables = []
    for each in parameters_of(records_of(variant), starts):
        if each.name in IGNORED[variant]:
            meaning = f"{each.quantity.meaning} (ignored: {IGNORED[variant][each.name]})"
            each = replace(each, quantity=replace(each.quantity, meaning=meaning))
        variables.append(each)
    if variant in FREE:
        for each in _KITE_MOTION:
            meaning = each.quantity.meaning.replace(", ", " at the start, ")
            declared = Quantity(each.quantity.unit, meaning, -at.LARGEST_INPUT, at.LARGEST_INPUT)
            name = f"initial_{each.name}"
            variables.append(Variable(name, PARAMETER, "Real", declared, len(variables), starts.get(name, each.start)))
    return variables


_NO_WAVES = {
    "kite_damping": "damping along the tether that the kite feels: 0, this tether has none",
    "solver_steps": "internal steps of the solver since the start: 0, there is no motion to integrate",
    "solver_rejections": "internal steps that it took back since the start: 0, there is no motion to integrate",
}
_ONE_LINE = {
    **_NO_WAVES,
    "ground_tension": "tension at the ground end",
    "kite_tension": "tension at the kite end",
    "max_tension": "larger one of the tensions at the ends",
    "slack_segments": "1 if the kite is closer than the unstretched length, else 0",
    "kite_end_mass": "tether mass lumped at the kite end: 0, the mass of this tether is not lumped",
}
_AND_WEIGHT = (
    ": its tension and its half of the weight, as far as that is along it; negative at the lower end of a slack tether"
)
NOTES = {  # meanings of outputs where they differ from the dynamic tether's
    "dynamic": {},
    "dynamic_free": {},
    "quasi_steady": _NO_WAVES,
    "catenary": _ONE_LINE,
    "straight": {
        **_ONE_LINE,
        "ground_tension": f"force along the tether at the ground end{_AND_WEIGHT}",
        "kite_tension": f"force along the tether at the kite end{_AND_WEIGHT}",
        "kite_end_mass": "tether mass lumped at the kite end: half of the tether",
        "solver_iterations": "Newton iterations since the start: 0, this tether needs none",
        "sag": "largest distance of the tether from its chord: 0, this tether is straight",
    },
}


@lru_cache
def variables(variant, shape_points, starts=(), left_out=()):
    """The table of all variables, a tuple: inputs, outputs, parameters.

    variant : one of `variants.EVERY_VARIANT`.  shape_points : number of points of the output `shape`.
    starts : pairs (input or parameter, start value) that replace defaults.  left_out : names of inputs and outputs that an
    FMU for one scene goes without; such inputs stay 0.
    """
    first = dict(starts)
    inputs = [replace(variable, start=first.get(variable.name, variable.start)) for variable in _input_variables(variant)]
    outputs = [
        replace(
            variable,
            quantity=replace(variable.quantity, meaning=NOTES[variant].get(variable.name, variable.quantity.meaning)),
            depends_on=depends_on(variant, variable.name, shape_points, (*IGNORED[variant], *left_out)),
        )
        for variable in _output_variables(variant, shape_points)
    ]
    table = (*inputs, *outputs, *_parameter_variables(variant, first))
    return tuple(variable for variable in table if variable.name not in left_out)


def table_of(variant, options):
    """The table of an FMU with these build options: `segments`, `shape_points`, and of a scene `starts` and `left_out`."""
    starts = (("segments", options["segments"]), *map(tuple, options.get("starts", ())))
    return variables(variant, options["shape_points"], starts, tuple(options.get("left_out", ())))


def parameters_at(shape_points):
    """Place of the first parameter in the array of all values: inputs, outputs, parameters."""
    return at.INPUTS + at.outputs_size(shape_points)


def references(table, shape_points):
    """Value references of a table of `variables`: their places in the array of all values."""
    first = parameters_at(shape_points)
    return [variable.place + (first if variable.causality == PARAMETER else 0) for variable in table]


def records(record_classes, table, numbers):
    """Records from the values of all parameters; ValueError names what is out of range.

    record_classes : such as `records_of`.  table : of `variables`.  numbers : in the order of its parameters.
    """
    values = dict(zip(names_of(table, PARAMETER), numbers, strict=True))
    for variable in table:
        if variable.causality == PARAMETER:
            if variable.kind != "Real" and values[variable.name].is_integer():
                values[variable.name] = int(values[variable.name])
            checked(variable.name, values[variable.name], variable.quantity)
    return tuple(record(**{name: values[name] for name, _ in quantities(record)}) for record in record_classes)
