"""The evidence set of the FMU of a system, in the files of FMI's cross-check, as `evidence.py` makes that of a tether.

From the start of the file a wind rises, all driven points sway together, the lines pay out. The reference is the Python API
with a tolerance far tighter than the FMU's.
"""

from dataclasses import replace
from math import cos, sin
from warnings import catch_warnings

from tetherfmu.results import PlausibilityWarning
from tetherfmu.runtime.inputs import ZERO, components, wind_at_names
from tetherfmu.runtime.variants import DYNAMIC
from tetherfmu.systems.tether_system import TetherSystem

from .documents import EVIDENCE_FOLDER, filled
from .evidence import INPUT_DIGITS, OUTPUT_DIGITS, rise, table_text, text_of, with_wind_at

STEP, STEPS = 0.05, 100  # of communication [s], and how many of them
TOLERANCE = 1e-6  # of the run: at the default one the tension of a short stiff line may be wrong by that of its neighbours
REFERENCE_TOLERANCE = 1e-8
_WIND, _GUST, _RISES, _RATE = 4.0, 1.0, 3.0, 0.7  # [m/s], [m/s], [s], [rad/s]
_SWAY = 0.01  # of the mean length of the lines, amplitude of the driven points [-]
_PAID_OUT = 2e-4  # of the length of a line, in a second [1/s]
_TENSIONS = {"tension_from": "ground_tension", "tension_to": "kite_tension", "tether_length": "tether_length"}


def files(name, found, arrays=False, wind_points=0):
    """Texts of the evidence set, dict of their path in the archive; empty if the reference cannot be flown.

    name : of the FMU.  found : `systems.files.SystemFile`.
    arrays : whether a vector is one variable, as in FMI 3.  wind_points : of each line.
    """
    scene = [_with_wind_at(inputs_at(k * STEP, found), found, wind_points) for k in range(STEPS + 1)]
    try:
        rows = reference(found, scene, wind_points)
    except ValueError:
        return {}
    facts = {"step": STEP, "stop": STEP * STEPS, "tolerance": TOLERANCE, "allowed": DYNAMIC.evidence_deviation}
    flat = [_flat(each) for each in scene]
    texts = {
        f"{name}_in.csv": table_text(list(flat[0]), [each.values() for each in flat], INPUT_DIGITS, arrays, STEP),
        f"{name}_ref.csv": table_text(list(rows[0]), [row.values() for row in rows], OUTPUT_DIGITS, arrays, STEP),
        f"{name}_ref.opt": filled("evidence.opt", **facts),
        "README.txt": filled("system_evidence.txt", name=name, reference_tolerance=REFERENCE_TOLERANCE, **facts),
    }
    return {f"{EVIDENCE_FOLDER}/{file}": text for file, text in texts.items()}


def inputs_at(time, found):
    """Inputs at a time [s] with the digits of their file, as a dict of arguments of `TetherSystem.step` (SI units)."""
    share, rate, _ = rise(time, _RISES)
    length = _SWAY * sum(line.tether.initial_length for line in found.lines) / len(found.lines)
    sway = length * share * sin(_RATE * time)
    speed = length * (rate * sin(_RATE * time) + share * _RATE * cos(_RATE * time))
    driven = [point for point in found.points if point.is_driven]
    moved = {point.name: (point.position[0], point.position[1] + sway, point.position[2]) for point in driven}
    reeling = {line.name: share * _PAID_OUT * line.tether.initial_length for line in found.lines}
    return {
        "positions": {name: _rounded(place) for name, place in moved.items()},
        "velocities": {point.name: _rounded((0.0, speed, 0.0)) for point in driven},
        "reel_out_speeds": {name: _rounded((each,))[0] for name, each in reeling.items()},
        "wind_velocity": _rounded((_WIND * share, _GUST * share * sin(_RATE * time), 0.0)),
    }


def _with_wind_at(given, found, wind_points):
    """Inputs with the wind at points, which grows along each line, in the place of `wind_velocity`."""
    if not wind_points:
        return given
    wind_at = with_wind_at(given, wind_points)["wind_at"]
    return {**given, "wind_velocity": ZERO, "wind_at": {line.name: wind_at for line in found.lines}}


def _rounded(numbers):
    """Numbers with the digits of the input file."""
    return tuple(float(text_of(each, INPUT_DIGITS)) for each in numbers)


def _flat(given):
    """Inputs by their FMI names, from arguments of `TetherSystem.step`."""
    flat = {}
    for what, vectors in (("position", given["positions"]), ("velocity", given["velocities"])):
        for point, numbers in vectors.items():
            flat |= dict(zip(components(f"{point}.{what}", 3), numbers, strict=True))
    flat |= {f"{line}.reel_out_speed": speed for line, speed in given["reel_out_speeds"].items()}
    flat |= dict(zip(components("wind_velocity", 3), given["wind_velocity"], strict=True))
    for line, winds in given.get("wind_at", {}).items():
        names = (f"{line}.{name}" for name in wind_at_names(len(winds)))
        flat |= dict(zip(names, (each for wind in winds for each in wind), strict=True))
    return flat


def reference(found, scene, wind_points=0):
    """Recorded outputs of the Python API at the start and after each step: list of dicts of FMI name to number.

    ValueError if the system does not start, or a step is refused.
    """
    solver = replace(found.solver, relative_tolerance=REFERENCE_TOLERANCE)
    with catch_warnings(action="ignore", category=PlausibilityWarning):  # the FMU says it itself
        records = found.points, found.lines, found.environment, solver, found.ground
        system = TetherSystem(*records, wind_points=wind_points)
        rows = [system.initialize(**scene[0])]
        rows += [system.step(STEP, **given) for given in scene[:-1]]
    return [_recorded(found, row) for row in rows]


def _recorded(found, row):
    """Recorded outputs by their FMI names, from `SystemOutputs`."""
    flat = {}
    for point in found.points:
        own, what = row.points[point.name], "force" if point.is_driven else "position"
        flat |= dict(zip(components(f"{point.name}.{what}", 3), getattr(own, what).tolist(), strict=True))
    for line in found.lines:
        flat |= {f"{line.name}.{name}": float(getattr(row.lines[line.name], of)) for name, of in _TENSIONS.items()}
    return flat
