"""The plug: the table of FMI variables, made from the records. One table for every tether.

A variable lives at one place of the flat arrays (`layout.py`): an input, an output, or a parameter of a record. Its value
reference is its place in `variables()`. Standard library only: finished FMUs ship this file.
"""

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import degrees, pi

from . import layout as at
from .dependencies import depends_on
from .parameters import Environment, Solver, Tether
from .quantities import Quantity, checked, quantities

INPUT, OUTPUT, PARAMETER = "input", "output", "parameter"
RECORDS = (Tether, Environment, Solver)
KITE_AT_START = (300.0, 0.0, 400.0)
DEGREES = ("deg", degrees(1.0))


@dataclass(frozen=True)
class Variable:
    """One FMI variable.

    name, causality : as in the model description.  kind : "Real", "Integer" or "Enumeration".  quantity : unit, meaning,
    limits.  place : in the `inputs` or `outputs` array; of a parameter, its number.  start : of inputs and parameters.
    depends_on : of an output, names of what it depends on when initialization ends.
    """

    name: str
    causality: str
    kind: str
    quantity: Quantity
    place: int
    start: float | None = None
    depends_on: tuple | None = None


def _vector(name, causality, place, unit, meaning, start=(0.0, 0.0, 0.0)):
    axes = ("x", "y", "z")
    starts = start if causality == INPUT else (None, None, None)
    return [
        Variable(f"{name}[{i + 1}]", causality, "Real", Quantity(unit, f"{meaning}, {axes[i]}"), place + i, starts[i])
        for i in range(3)
    ]


def _input_variables():
    reel_out = Quantity("m/s", "rate of change of the unstretched length; positive pays out")
    return [
        *_vector("kite_position", INPUT, at.KITE_POSITION, "m", "position of the kite attachment point", KITE_AT_START),
        *_vector("kite_velocity", INPUT, at.KITE_VELOCITY, "m/s", "velocity of the kite attachment point"),
        *_vector("ground_position", INPUT, at.GROUND_POSITION, "m", "position of the ground end"),
        *_vector("ground_velocity", INPUT, at.GROUND_VELOCITY, "m/s", "velocity of the ground end"),
        Variable("reel_out_speed", INPUT, "Real", reel_out, at.REEL_OUT_SPEED, 0.0),
        *_vector("wind_velocity", INPUT, at.WIND_VELOCITY, "m/s", "wind at wind_reference_height"),
    ]


def _scalar_output(name, place, unit, meaning, kind="Real", **limits):
    return Variable(name, OUTPUT, kind, Quantity(unit, meaning, **limits), place)


def _output_variables(shape_points):
    vector_outputs = [
        *_vector("ground_force", OUTPUT, at.GROUND_FORCE, "N", "force of the tether on the ground station"),
        *_vector("kite_force", OUTPUT, at.KITE_FORCE, "N", "force of the tether on the kite"),
    ]
    scalar = _scalar_output
    points = []
    for k in range(shape_points):
        for i, axis in enumerate(("x", "y", "z")):
            meaning = f"point {k + 1} of {shape_points} on the tether at equal unstretched length, {axis}"
            points.append(scalar(f"shape[{k + 1},{i + 1}]", at.SHAPE + 3 * k + i, "m", meaning))
    return [
        *vector_outputs,
        scalar("ground_tension", at.GROUND_TENSION, "N", "tension of the first segment"),
        scalar("kite_tension", at.KITE_TENSION, "N", "tension of the last segment"),
        scalar("max_tension", at.MAX_TENSION, "N", "largest tension of all segments now"),
        scalar("tether_length", at.TETHER_LENGTH, "m", "unstretched length now", minimum=0.0),
        scalar(
            "ground_elevation",
            at.GROUND_ELEVATION,
            "rad",
            "elevation at which the tether leaves the ground end",
            minimum=-pi / 2.0,
            maximum=pi / 2.0,
            display=DEGREES,
        ),
        scalar(
            "ground_azimuth",
            at.GROUND_AZIMUTH,
            "rad",
            "azimuth at which the tether leaves the ground end, from the x axis, anti-clockwise seen from above",
            minimum=-pi,
            maximum=pi,
            display=DEGREES,
        ),
        scalar(
            "slack_segments",
            at.SLACK_SEGMENTS,
            "",
            "number of segments that are shorter than unstretched",
            kind="Integer",
            minimum=0,
            maximum=at.MAX_SEGMENTS,
        ),
        scalar("kite_end_mass", at.KITE_END_MASS, "kg", "tether mass lumped at the kite end", minimum=0.0),
        scalar(
            "kite_stiffness",
            at.KITE_STIFFNESS,
            "N/m",
            "stiffness along the tether that the kite feels, all segments taut",
            minimum=0.0,
        ),
        scalar(
            "kite_damping",
            at.KITE_DAMPING,
            "N.s/m",
            "damping along the tether that the kite feels, all segments taut",
            minimum=0.0,
        ),
        scalar("wave_time", at.WAVE_TIME, "s", "travel time of a transverse wave over the tether", minimum=0.0),
        scalar("sag", at.SAG, "m", "largest distance of the tether from its chord", minimum=0.0),
        *points,
    ]


def parameter_names():
    """Names of all parameters, in the order of their numbers."""
    return [name for record in RECORDS for name, _ in quantities(record)]


INPUT_NAMES = {variable.place: variable.name for variable in _input_variables()}


_SOLVER = "there is no motion to integrate"
_NO_WAVES = "this tether has no waves"
_IGNORED_WITHOUT_WAVES = {
    "axial_damping": _NO_WAVES,
    "slack_damping_ratio": _NO_WAVES,
    "damping_law": _NO_WAVES,
    "relative_tolerance": _SOLVER,
    "fixed_step": _SOLVER,
    "initial_shape": "this tether is in equilibrium from the start",
}
_IGNORED_WITHOUT_NODES = {
    **_IGNORED_WITHOUT_WAVES,
    "slack_stiffness_ratio": "no part of this tether is in compression",
    "segments": "this tether has no nodes",
}
IGNORED = {  # parameters that a variant ignores, and why
    "dynamic": {},
    "quasi_steady": _IGNORED_WITHOUT_WAVES,
    "catenary": _IGNORED_WITHOUT_NODES,
    "straight": _IGNORED_WITHOUT_NODES,
}


def _parameter_variables(variant, starts):
    variables = []
    for record in RECORDS:
        defaults = {item.name: item.default for item in fields(record)}
        for name, declared in quantities(record):
            kind = "Enumeration" if declared.choices else "Integer" if isinstance(defaults[name], int) else "Real"
            start = starts.get(name, defaults[name])
            if name in IGNORED[variant]:
                declared = replace(declared, meaning=f"{declared.meaning} (ignored: {IGNORED[variant][name]})")
            variables.append(Variable(name, PARAMETER, kind, declared, len(variables), start))
    return variables


_NO_DAMPING = {"kite_damping": "damping along the tether that the kite feels: 0, this tether has none"}
NOTES = {  # meanings of outputs where they differ from the dynamic tether's
    "dynamic": {},
    "quasi_steady": _NO_DAMPING,
    "catenary": {
        **_NO_DAMPING,
        "ground_tension": "tension at the ground end",
        "kite_tension": "tension at the kite end",
        "max_tension": "larger one of the tensions at the ends",
        "slack_segments": "1 if the kite is closer than the unstretched length, else 0",
        "kite_end_mass": "tether mass lumped at the kite end: 0, the mass of this tether is not lumped",
    },
    "straight": {
        **_NO_DAMPING,
        "ground_tension": "force along the tether at the ground end",
        "kite_tension": "force along the tether at the kite end",
        "max_tension": "larger one of the tensions at the ends",
        "slack_segments": "1 if the kite is closer than the unstretched length, else 0",
        "kite_end_mass": "tether mass lumped at the kite end: half of the tether",
        "sag": "largest distance of the tether from its chord: 0, this tether is straight",
    },
}


@lru_cache
def variables(variant, shape_points, starts=(), left_out=()):
    """The table of all variables, a tuple: inputs, outputs, parameters.

    variant : "dynamic", "quasi_steady", "catenary" or "straight".  shape_points : number of points of the output `shape`.
    starts : pairs (input or parameter, start value) that replace defaults.  left_out : names of inputs and outputs that an
    FMU for one scene goes without; such inputs stay 0.
    """
    first = dict(starts)
    inputs = [replace(variable, start=first.get(variable.name, variable.start)) for variable in _input_variables()]
    outputs = [
        replace(
            variable,
            quantity=replace(variable.quantity, meaning=NOTES[variant].get(variable.name, variable.quantity.meaning)),
            depends_on=depends_on(variant, variable.name, shape_points, IGNORED[variant]),
        )
        for variable in _output_variables(shape_points)
    ]
    return tuple(
        replace(variable, depends_on=tuple(name for name in variable.depends_on or () if name not in left_out))
        for variable in (*inputs, *outputs, *_parameter_variables(variant, first))
        if variable.name not in left_out
    )


def table_of(variant, options):
    """The table of an FMU with these build options: `segments`, `shape_points`, and of a scene `starts` and `left_out`."""
    starts = (("segments", options["segments"]), *map(tuple, options.get("starts", ())))
    return variables(variant, options["shape_points"], starts, tuple(options.get("left_out", ())))


def records(table, numbers):
    """Records (Tether, Environment, Solver) from the values of all parameters; ValueError names what is out of range.

    table : of `variables`.  numbers : in the order of `parameter_names`.
    """
    values = dict(zip(parameter_names(), numbers, strict=True))
    for variable in table:
        if variable.causality == PARAMETER:
            checked(variable.name, values[variable.name], variable.quantity)
            if variable.kind != "Real":
                values[variable.name] = int(values[variable.name])
    return tuple(record(**{name: values[name] for name, _ in quantities(record)}) for record in RECORDS)
