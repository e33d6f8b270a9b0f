"""The evidence set of an FMU, in the files of FMI's cross-check: what goes in, what must come out, and with which options.

The scene starts from the start values of the FMU: a kite 500 m away flies into a part of a circle and outwards, a free one
is pulled outwards and to and fro by its load; the wind rises, the tether pays out and becomes taut. The reference is the
Python API with a tolerance far tighter than the FMU's.
"""

from functools import partial
from math import cos, hypot, sin
from warnings import catch_warnings

from tetherfmu import models
from tetherfmu.results import PlausibilityWarning
from tetherfmu.runtime.inputs import KITE_AT_START
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, Environment, FreeKite, Solver
from tetherfmu.runtime.variables import INPUT, OUTPUT, names_of, variables
from tetherfmu.runtime.variants import BY_NAME

STEP, STEPS = 0.05, 200  # of communication [s], and how many of them
REFERENCE_TOLERANCE = 1e-9  # of the solver; 1e-10 changes the reference by 1e-8 of the largest force
RECORDED = ("kite_force", "ground_tension", "kite_tension", "tether_length", "sag")  # and for 10 outputs one vector more
KITE = ("flies into a part of a circle and outwards", "is pulled outwards and to and fro by its load")  # driven, free
INPUT_DIGITS, OUTPUT_DIGITS = 10, 8  # so that the last bit of a mathematical library does not show

_TURN_RATE, _TURN_RISES = 0.08, 4.0  # [rad/s], [s]
_GROWTH, _GROWS = 0.018, 8.0  # of the distance [-], [s]
_REEL_OUT, _REEL_OUT_BEGINS, _REEL_OUT_RISES = 0.5, 2.0, 4.0  # [m/s], [s], [s]
_WIND, _WIND_RISES = 8.0, 3.0  # [m/s], [s]
_WIND_AT_GROUND = 0.5  # wind at the first wind point over that in the middle [-]
_GUST, _GUST_RATE = 2.0, 0.5  # [m/s], [rad/s]
# on a free kite, as parts of the force of the tether at the start: along the tether and across it
_PULL, _PULL_RISES = 2.7, 6.0  # [-], [s]
_SWAY, _SWAY_RATE = 0.5, 0.8  # [-], [rad/s]


def rise(time, duration):
    """A smooth rise from 0 to 1: its value, its rate [1/s] and its integral [s] at a time [s]."""
    u = min(max(time / duration, 0.0), 1.0)
    integral = duration * (u**3 - u**4 / 2.0) + max(time - duration, 0.0)
    return u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / duration, integral


def inputs_at(time):
    """Inputs of the scene at a time [s], as a dict of the Python API's arguments (SI units)."""
    share, _, turn_time = rise(time, _TURN_RISES)
    angle, rate = _TURN_RATE * turn_time, _TURN_RATE * share
    growth, growth_rate, _ = (_GROWTH * each for each in rise(time, _GROWS))
    x, _, z = KITE_AT_START
    east, north = (1.0 + growth) * x * cos(angle), (1.0 + growth) * x * sin(angle)
    stretching = growth_rate / (1.0 + growth)
    position = (east, north, (1.0 + growth) * z)
    velocity = (stretching * east - rate * north, stretching * north + rate * east, growth_rate * z)
    return {"kite_position": position, "kite_velocity": velocity, **_around(time)}


def inputs_of_free_kite(time, kite_force):
    """As `inputs_at`, for a tether with a free kite end; kite_force : at the start [N].

    The load begins with what holds the kite and the tether at rest, so that it suits light and heavy tethers.
    """
    force, distance = hypot(*kite_force), hypot(*KITE_AT_START)
    pull = _PULL * force * rise(time, _PULL_RISES)[0]
    x, y, z = (pull * part / distance - held for part, held in zip(KITE_AT_START, kite_force, strict=True))
    weight = FreeKite().kite_mass * Environment().gravity
    return {"kite_load": (x, y + _SWAY * force * sin(_SWAY_RATE * time), z + weight), **_around(time)}


def _around(time):
    """Wind and reel-out speed at a time [s]."""
    wind = (_WIND * rise(time, _WIND_RISES)[0], _GUST * sin(_GUST_RATE * time), 0.0)
    reel_out = _REEL_OUT * rise(time - _REEL_OUT_BEGINS, _REEL_OUT_RISES)[0]
    return {"reel_out_speed": reel_out, "wind_velocity": wind}


def with_wind_at(inputs, wind_points):
    """Inputs of `inputs_at` with the wind at points, which grows along the tether, in the place of `wind_velocity`."""
    if not wind_points:
        return inputs
    shares = [_WIND_AT_GROUND + 2.0 * (1.0 - _WIND_AT_GROUND) * k / (wind_points - 1) for k in range(wind_points)]
    wind = tuple(rounded(tuple(share * each for each in inputs["wind_velocity"])) for share in shares)
    return {**inputs, "wind_velocity": (0.0, 0.0, 0.0), "wind_at": wind}


def files(name, tether, arrays=False, wind_points=0):
    """Inputs and reference of an FMU: dict of file name to text.

    name : of the FMU and of its class in `models`.  tether : `Tether` of the start values of the FMU.  arrays : whether a
    vector is one variable, as in FMI 3; its numbers then stand in one cell, with blanks between them, as FMPy reads them.
    wind_points : of the FMU.
    """
    model = getattr(models, name)
    scene = [with_wind_at(each, wind_points) for each in scene_of(model, tether)]
    inputs = names_of(variables(model.variant, 0, wind_points=wind_points), INPUT)
    return {
        f"{name}_in.csv": table_text(inputs, [flat(each, inputs) for each in scene], INPUT_DIGITS, arrays),
        f"{name}_ref.csv": table_text(
            recorded(model.variant), reference(model, tether, scene, wind_points), OUTPUT_DIGITS, arrays
        ),
    }


def scene_of(model, tether):
    """Inputs at all communication points: list of dicts of the Python API's arguments, with the digits of the input file.

    model : class of the Python API.  tether : `Tether` of the start values.
    """
    at = inputs_at
    if BY_NAME[model.variant].kite_is_free:
        at = partial(inputs_of_free_kite, kite_force=model(tether).initialize().kite_force.tolist())
    return [{key: rounded(value) for key, value in at(k * STEP).items()} for k in range(STEPS + 1)]


def recorded(variant):
    """FMI names of the recorded outputs."""
    vectors = (*RECORDED, "kite_position" if BY_NAME[variant].kite_is_free else "ground_force")
    return [name for name in names_of(variables(variant, 0), OUTPUT) if name.partition("[")[0] in vectors]


def facts(variant):
    """Numbers in assets/evidence.opt, the options of the run, and in its description assets/evidence.txt."""
    tether = BY_NAME[variant]
    tolerance = tether.evidence_tolerance or DEFAULT_TOLERANCE
    return {
        "step": STEP,
        "stop": STEP * STEPS,
        "allowed": tether.evidence_deviation,
        "kite": KITE[tether.kite_is_free],
        "tolerance": tolerance,
        "reference_tolerance": REFERENCE_TOLERANCE,
    }


def reference(model, tether, scene, wind_points=0):
    """Recorded outputs of the Python API at the start and after each step: list of lists of numbers."""
    with catch_warnings(action="ignore", category=PlausibilityWarning):  # the command says once what is in doubt
        tether = model(tether, solver=Solver(relative_tolerance=REFERENCE_TOLERANCE), wind_points=wind_points)
        rows = [tether.initialize(**{key: value for key, value in scene[0].items() if key != "kite_load"})]
        rows += [tether.step(STEP, **inputs) for inputs in scene[:-1]]
    return [flat(row._asdict(), recorded(model.variant)) for row in rows]


def flat(values, names):
    """Numbers of FMI variables from a dict of numbers and vectors; what is not in it is 0."""
    row = []
    for name in names:
        vector, _, index = name.partition("[")
        value = values.get(vector, 0.0)
        for each in index[:-1].split(",") if index and vector in values else ():
            value = value[int(each) - 1]
        row.append(float(value))
    return row


def rounded(value):
    """A number or a vector with the digits of the input file."""
    if isinstance(value, tuple):
        return tuple(map(rounded, value))
    return float(text_of(value, INPUT_DIGITS))


def text_of(value, digits):
    """A number with so many digits, two of them less behind the point: what rounding leaves of a zero becomes 0."""
    return f"{round(value, digits - 2) + 0.0:.{digits}g}"


def table_text(names, rows, digits, arrays=False, step=STEP):
    """CSV as FMI's cross-check asks for it: quoted names, commas, the time first, every `step` [s]."""
    columns = [name.partition("[")[0] if arrays else name for name in names]
    lines = [",".join(f'"{name}"' for name in ("time", *dict.fromkeys(columns)))]
    for k, row in enumerate(rows):
        cells = {}
        for name, value in zip(columns, row, strict=True):
            cells.setdefault(name, []).append(text_of(value, digits))
        lines.append(",".join([f"{k * step:.10g}", *map(" ".join, cells.values())]))
    return "\n".join(lines) + "\n"
