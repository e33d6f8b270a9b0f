"""Evidence sets of an FMU, in the files of FMI's cross-check: inputs, expected outputs, and options.

A tether has three. Each begins at the start values of the FMU; forces are fractions of a tether force, so that they
suit light and heavy tethers.

    ""       A kite 500 m away moves along part of a circle and outwards; a load pulls a free one outwards and to and
             fro; the wind rises, the tether pays out and becomes taut.
    force    The winch has a drum with mass and dry friction. It is at rest until its force exceeds the friction, breaks
             away, reels in until taut, pays out as the force falls, and stops at `longest_length` with a slack tether.
    length   The tether follows a length that is reeled in until it is taut, and out until it is slack.

In the set of a system the wind rises, all driven points sway together, the lines pay out. The reference is the Python API
with a tolerance far tighter than the FMU's.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import cos, hypot, pi, sin
from time import monotonic
from typing import NamedTuple
from warnings import catch_warnings

from tetherfmu.python.tether_system import TetherSystem
from tetherfmu.records.problems import PlausibilityWarning
from tetherfmu.runtime.enumerations import WINCH_BY_FORCE, WINCH_BY_LENGTH, WINCH_BY_SPEED
from tetherfmu.runtime.inputs import KITE_AT_START, ZERO, components, wind_at_names
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, Environment, FreeKite, Solver, Winch
from tetherfmu.runtime.variants import BY_NAME, DYNAMIC
from tetherfmu.wiring.portions import portions_of
from tetherfmu.wiring.variables import INPUT, OUTPUT, names_of, variables
from tetherfmu.wiring.winches import holding

from .texts import filled

STEP = 0.05  # of communication [s]
PATIENCE = 5.0  # time between two texts on a long flight [s]
INPUT_DIGITS, OUTPUT_DIGITS = 10, 8  # so that the last bit of a mathematical library does not show
_BELOW = "\n" + 17 * " "  # where a second line of words begins
SCENES = (  # in words: with a driven kite, with a free one, of a system
    f"the kite flies into a part of a circle and outwards, the wind rises, the tether{_BELOW}pays out and becomes taut.",
    f"the kite is pulled outwards and to and fro by its load, the wind rises, the{_BELOW}tether pays out and becomes taut.",
    "a wind rises, the driven points sway together, the lines pay out.",
)


class EvidenceSet(NamedTuple):
    """One evidence set: the model, inputs, recorded outputs, and the options of the run."""

    kind: str  # "", or the control of the winch
    model: Callable  # makes a model of the Python API with a relative tolerance
    scene: list  # its arguments at each communication point: dicts with the digits of the input file
    inputs: tuple  # FMI names
    outputs: tuple
    tolerance: float  # of the run
    reference_tolerance: float
    allowed: float  # deviation, as a part of the largest value
    given: Callable = dict  # arguments as a dict of FMI vectors to numbers, the same for the record of its outputs
    found: Callable = lambda row: row._asdict()
    starts: dict = {}  # noqa: RUF012  start values of parameters that differ from the FMU


def reference(made, tolerance=None, now=str):
    """Recorded outputs of the Python API at the start and after each step: list of lists of numbers.

    made : `EvidenceSet`.  tolerance : None for the reference tolerance.  now : receives a text every `PATIENCE`.
    ValueError if a system does not start, or a step is refused.
    """
    count, said = len(made.scene) - 1, monotonic()
    with catch_warnings(action="ignore", category=PlausibilityWarning):  # command and FMU warn once
        model = made.model(tolerance or made.reference_tolerance)
        rows = [model.initialize(**made.scene[0])]
        for k, given in enumerate(made.scene[:-1]):
            if monotonic() - said > PATIENCE:
                now(f"{k} of {count} steps")
                said = monotonic()
            rows.append(model.step(STEP, **given))
    return [flat(made.found(row), made.outputs) for row in rows]


def files(name, sets, arrays=False, now=str, **words):
    """Texts of evidence sets, dict by file name: inputs, reference and options of each, and a common README.txt.

    name : of the FMU.  arrays : whether a vector is one variable, as in FMI 3; one cell then contains its numbers, separated
    by blanks, as FMPy reads them.  now : as for `reference`.  words : in assets/evidence.txt.
    """
    texts = {}
    for made in sets:
        start = f"{name}_{made.kind}_" if made.kind else f"{name}_"
        scene = [flat(made.given(each), made.inputs) for each in made.scene]
        options = {"step": STEP, "stop": STEP * (len(scene) - 1), "tolerance": made.tolerance, "allowed": made.allowed}
        texts[f"{start}in.csv"] = table_text(made.inputs, scene, INPUT_DIGITS, arrays)
        texts[f"{start}ref.csv"] = table_text(made.outputs, reference(made, now=now), OUTPUT_DIGITS, arrays)
        lines = [f"{each}, {value}\n" for each, value in made.starts.items()]
        texts[f"{start}ref.opt"] = filled("evidence.opt", **options) + "".join(lines)
    first = sets[0]
    facts = {"tolerance": first.tolerance, "allowed": first.allowed, "reference_tolerance": first.reference_tolerance}
    return texts | {"README.txt": filled("evidence.txt", name=name, step=STEP, **facts, **words)}


def flat(values, names):
    """Numbers of FMI variables from a dict of numbers and vectors; missing ones are 0."""
    row = []
    for name in names:
        vector, _, index = name.partition("[")
        value = values.get(vector, 0.0)
        for each in index[:-1].split(",") if index and vector in values else ():
            value = value[int(each) - 1]
        row.append(float(value))
    return row


def rounded(value):
    """A number, or numbers in tuples and dicts, with the digits of the input file."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return tuple(map(rounded, value))
    return float(text_of(value, INPUT_DIGITS))


def text_of(value, digits):
    """A number with this number of digits, and two fewer after the point: a zero with rounding errors becomes 0."""
    return f"{round(value, digits - 2) + 0.0:.{digits}g}"


def table_text(names, rows, digits, arrays):
    """CSV as FMI's cross-check asks for it: quoted names, commas, the time first."""
    columns = [name.partition("[")[0] if arrays else name for name in names]
    lines = [",".join(f'"{name}"' for name in ("time", *dict.fromkeys(columns)))]
    for k, row in enumerate(rows):
        cells = {}
        for name, value in zip(columns, row, strict=True):
            cells.setdefault(name, []).append(text_of(value, digits))
        lines.append(",".join([f"{k * STEP:.10g}", *map(" ".join, cells.values())]))
    return "\n".join(lines) + "\n"


def rise(time, duration):
    """A smooth rise from 0 to 1: its value, its rate [1/s] and its integral [s] at a time [s]."""
    u = min(max(time / duration, 0.0), 1.0)
    integral = duration * (u**3 - u**4 / 2.0) + max(time - duration, 0.0)
    return u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / duration, integral


# --- a tether

RECORDED = ("kite_force", "ground_tension", "kite_tension", "tether_length", "sag")  # and for 10 outputs one vector more
_STEPS = 200
_REFERENCE_TOLERANCE = 1e-9  # 1e-10 changes the reference by 1e-8 of the largest force
_TURN_RATE, _TURN_RISES = 0.08, 4.0  # [rad/s], [s]
_GROWTH, _GROWS = 0.018, 8.0  # of the distance [-], [s]
_REEL_OUT, _REEL_OUT_BEGINS, _REEL_OUT_RISES = 0.5, 2.0, 4.0  # [m/s], [s], [s]
_DISTANCE = hypot(*KITE_AT_START)
_WIND, _WIND_RISES = 8.0, 3.0  # [m/s], [s]
_WIND_AT_GROUND = 0.5  # wind at the first wind point over the wind in the middle [-]
_GUST, _GUST_RATE = 2.0, 0.5  # [m/s], [rad/s]
# on a free kite, as parts of the force of the tether at the start: along the tether and across it
_PULL, _PULL_RISES = 2.7, 6.0  # [-], [s]
_SWAY, _SWAY_RATE = 0.5, 0.8  # [-], [rad/s]


def of_tether(model, tether, wind_points=0):
    """Evidence sets of a tether, list of `EvidenceSet`; winch sets omit bouncing outputs (`SEGMENTS`).

    model : class of the Python API.  tether : `Tether` of the start values.  wind_points : of the FMU.
    """
    sets = [flight(model, tether, wind_points)]
    if not BY_NAME[model.variant].has_waves or tether.segments in SEGMENTS:
        sets += [winch_set(kind, model, tether) for kind in GIVEN]
    return sets


def flight(model, tether, wind_points=0, kite=KITE_AT_START, **others):
    """The `EvidenceSet` without a controlled winch, of a tether with these start values.

    kite : its start [m].  others : start values of other variables, by name.
    """
    variant, at = BY_NAME[model.variant], partial(inputs_at, kite=kite)
    if variant.kite_is_free:
        at = partial(inputs_of_free_kite, kite_force=model(tether, **others).initialize().kite_force.tolist())
    scene = [with_wind_at(rounded(at(k * STEP)), wind_points) for k in range(_STEPS + 1)]
    listed = variables(model.variant, 0, wind_points=wind_points)
    return EvidenceSet(
        kind="",
        model=lambda tolerance: model(tether, wind_points=wind_points, **{**others, "relative_tolerance": tolerance}),
        scene=scene,
        inputs=tuple(each.name for each in listed if each.causality == INPUT and each.kind == "Real"),  # nothing is released
        outputs=_recorded(model.variant, (*RECORDED, "kite_position" if variant.kite_is_free else "ground_force")),
        tolerance=variant.evidence_tolerance or DEFAULT_TOLERANCE,
        reference_tolerance=_REFERENCE_TOLERANCE,
        allowed=variant.evidence_deviation,
    )


def _recorded(variant, vectors):
    """FMI names of outputs of a variant."""
    return tuple(name for name in names_of(variables(variant, 0), OUTPUT) if name.partition("[")[0] in vectors)


def inputs_at(time, kite=KITE_AT_START):
    """Inputs of the scene at a time [s], as a dict of the Python API's arguments (SI units); kite : its start."""
    share, _, turn_time = rise(time, _TURN_RISES)
    angle, rate = _TURN_RATE * turn_time, _TURN_RATE * share
    growth, growth_rate, _ = (_GROWTH * each for each in rise(time, _GROWS))
    x, y, z = ((1.0 + growth) * each for each in kite)
    east, north = x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)
    stretching = growth_rate / (1.0 + growth)
    velocity = (stretching * east - rate * north, stretching * north + rate * east, stretching * z)
    return {"kite_position": (east, north, z), "kite_velocity": velocity, **_around(time, hypot(*kite) / _DISTANCE)}


def inputs_of_free_kite(time, kite_force):
    """As `inputs_at`, for a tether with a free kite end; kite_force : at the start [N].

    The load begins with the force that keeps kite and tether at rest.
    """
    force, distance = hypot(*kite_force), hypot(*KITE_AT_START)
    pull = _PULL * force * rise(time, _PULL_RISES)[0]
    x, y, z = (pull * part / distance - held for part, held in zip(KITE_AT_START, kite_force, strict=True))
    weight = FreeKite().kite_mass * Environment().gravity
    return {"kite_load": (x, y + _SWAY * force * sin(_SWAY_RATE * time), z + weight), **_around(time)}


def _around(time, share=1.0):
    """Wind and reel-out speed at a time [s]; share : of the usual distance of the kite."""
    wind = (_WIND * rise(time, _WIND_RISES)[0], _GUST * sin(_GUST_RATE * time), 0.0)
    reel_out = share * _REEL_OUT * rise(time - _REEL_OUT_BEGINS, _REEL_OUT_RISES)[0]
    return {"reel_out_speed": reel_out, "wind_velocity": wind}


def with_wind_at(inputs, wind_points, lines=None):
    """Inputs with the wind at points, which grows along the tether, in the place of `wind_velocity`.

    lines : of a system, dict of their names to their numbers of these points.
    """
    if not wind_points:
        return inputs
    own = {name: _winds_along(inputs["wind_velocity"], count) for name, count in (lines or {"": wind_points}).items()}
    return {**inputs, "wind_velocity": ZERO, "wind_at": own if lines else own[""]}


def _winds_along(wind, count):
    """Wind at this number of points [m/s], with `wind` in the middle."""
    shares = [_WIND_AT_GROUND + 2.0 * (1.0 - _WIND_AT_GROUND) * k / (count - 1) for k in range(count)]
    return rounded(tuple(tuple(share * each for each in wind) for share in shares))


# --- the winch inside a tether

# With one segment kite and drum bounce between slack and taut, and the tolerance leaves 0.3 % of the largest force; with
# many, waves in the slack tether are so short that it leaves 1 to 6 %.
SEGMENTS = range(2, 41)
GIVEN = {"force": "winch_force", "length": "winch_length"}  # kind of set: the input that changes
WINCH_STEPS = 120
_WINCH_TOLERANCE, _WINCH_REFERENCE = 1e-6, 1e-8  # a drum remembers when it broke away
_DRUM_DEVIATION = 2e-5  # of any drum at that tolerance; found: 9e-6 of the straight tether's
_WINCH_RECORDED = ("ground_tension", "kite_tension", "tether_length", "winch_speed")
# of the drum, in the weight of the tether, and its pull over time: stuck, taut, slack
_MASS, _FRICTION, _STOP = 5.0, 0.5, 1.001  # [-], [-], [-] of `initial_length`
_HELD, _TAUT, _LET_GO = 1.0, 5.0, -2.0  # parts of the weight [-]
_TAUT_BEGINS, _TAUT_RISES, _TAUT_ENDS, _TAUT_FALLS = 0.4, 0.8, 3.0, 0.8  # [s]
# of the length, in `initial_length`: reeled in, and out again
_REELED_IN, _REEL_IN, _REELED_OUT, _OUT_BEGINS, _OUT = 0.0115, 2.5, 0.012, 2.75, 3.0  # [-], [s], [-], [s], [s]
_OUTWARDS = 4.0  # load on a free kite, in the weight of the tether [-]


def winch_set(kind, model, tether):
    """The `EvidenceSet` of a kind, a key of `GIVEN`; model, tether : as in `of_tether`.

    The kite is held where the FMU has it; a free one is pulled outwards by a constant load.
    """
    weight, is_free = weight_of(tether), BY_NAME[model.variant].kite_is_free
    winch = Winch(winch_control=kind)
    if kind == "force":
        numbers = _MASS * weight / Environment().gravity, _FRICTION * weight, _STOP * tether.initial_length
        mass, friction, stop = rounded(numbers)
        winch = Winch(winch_control=kind, winch_mass=mass, winch_friction=friction, longest_length=stop)
    x, y, z = (_OUTWARDS * weight * part / hypot(*KITE_AT_START) for part in KITE_AT_START)
    carried = FreeKite().kite_mass * Environment().gravity
    load = {"kite_load": rounded((x, y, z + carried))} if is_free else {}
    at = partial(pull_at, weight=weight) if kind == "force" else partial(length_at, first=tether.initial_length)
    default = vars(Winch())
    return EvidenceSet(
        kind=kind,
        model=lambda tolerance: model(tether, solver=Solver(relative_tolerance=tolerance), winch=winch),
        scene=[{GIVEN[kind]: rounded(at(k * STEP)), **load} for k in range(WINCH_STEPS + 1)],
        inputs=tuple(n for n in names_of(variables(model.variant, 0), INPUT) if n.partition("[")[0] in (GIVEN[kind], *load)),
        outputs=_recorded(model.variant, (*_WINCH_RECORDED, *(("kite_position",) if is_free else ()))),
        tolerance=_WINCH_TOLERANCE,
        reference_tolerance=_WINCH_REFERENCE,
        allowed=max(BY_NAME[model.variant].evidence_deviation, _DRUM_DEVIATION if kind == "force" else 0.0),
        starts={name: value for name, value in vars(winch).items() if value != default[name]},
    )


def weight_of(tether):
    """Weight of a tether of its first length in the standard gravity [N]."""
    return 0.25 * pi * tether.diameter**2 * tether.density * tether.initial_length * Environment().gravity


def pull_at(time, weight):
    """Force of the winch at a time [s] on a tether of a weight [N]."""
    up = rise(time - _TAUT_BEGINS, _TAUT_RISES)[0]
    down = rise(time - _TAUT_ENDS, _TAUT_FALLS)[0]
    return weight * (_HELD + (_TAUT - _HELD) * up + (_LET_GO - _TAUT) * down)


def length_at(time, first):
    """Length that the winch should have paid out at a time [s], of a tether of a first length [m]."""
    back, out = rise(time, _REEL_IN)[0], rise(time - _OUT_BEGINS, _OUT)[0]
    return first * (1.0 - _REELED_IN * back + _REELED_OUT * out)


# --- a system

_SYSTEM_STEPS = 100
_SYSTEM_TOLERANCE, _SYSTEM_REFERENCE = 1e-6, 1e-8  # at the default a short stiff line may have an error of its neighbours
_MEAN, _GUSTS, _RISES, _RATE = 4.0, 1.0, 3.0, 0.7  # [m/s], [m/s], [s], [rad/s]
_AMPLITUDE = 0.01  # of the driven points, in the mean length of the lines [-]
_PAID_OUT = 2e-4  # of the length of a line, in a second [1/s]
_LIFT = 0.01  # of the force of a shared winch [-]
# arguments of `TetherSystem.step`, and the inputs of points and lines that they are
KINDS = {"positions": "position", "velocities": "velocity", "reel_out_speeds": "reel_out_speed"}
KINDS |= {"winch_lengths": "winch_length", "winch_forces": "winch_force", "wind_at": "wind_at"}
_LED_BY = {WINCH_BY_SPEED: "reel_out_speed", WINCH_BY_FORCE: "winch_force", WINCH_BY_LENGTH: "winch_length"}
_TENSIONS = {"tension_from": "ground_tension", "tension_to": "kite_tension", "tether_length": "tether_length"}


def of_system(system, wind_points=0):
    """The `EvidenceSet` of a system. system : `files.system_files.SystemFile`.  wind_points : of each line."""
    driven = [point.name for point in system.points if point.is_driven]
    lines = {line.name: len(portions_of(line)) * wind_points for line in system.lines}

    def model(tolerance):
        solver = replace(system.solver, relative_tolerance=tolerance)
        return TetherSystem.of(system, solver=solver, wind_points=wind_points)

    moves = [name for what in ("position", "velocity") for each in driven for name in components(f"{each}.{what}", 3)]
    turns = [f"{line.name}.{_LED_BY[line.winch.winch_control]}" for line in lines_alone(system)]
    turns += [f"{winch.name}.{winch.input}" for winch in system.winches]
    winds = [f"{line}.{name}" for line, count in lines.items() for name in wind_at_names(count)]
    forces = {each.name: f"{each.name}.{'force' if each.is_driven else 'position'}" for each in system.points}
    of_points = (name for vector in forces.values() for name in components(vector, 3))
    with catch_warnings(action="ignore", category=PlausibilityWarning):
        by_force = any(line.winch.winch_control == WINCH_BY_FORCE for line in lines_alone(system))
        start = model(_SYSTEM_TOLERANCE).initialize().lines if by_force else {}
    pulls = {name: line.ground_tension for name, line in start.items()}
    at = partial(inputs_of_system, system=system, pulls=pulls)
    return EvidenceSet(
        kind="",
        model=model,
        scene=[with_wind_at(rounded(at(k * STEP)), wind_points, lines) for k in range(_SYSTEM_STEPS + 1)],
        inputs=(*moves, *turns, *components("wind_velocity", 3), *winds),
        outputs=(*of_points, *(f"{line}.{what}" for line in lines for what in _TENSIONS)),
        given=_named,
        found=partial(_found_in_system, forces),
        tolerance=_SYSTEM_TOLERANCE,
        reference_tolerance=_SYSTEM_REFERENCE,
        allowed=DYNAMIC.evidence_deviation,
    )


def lines_alone(system):
    """The lines of a system without shared winches."""
    return [line for line in system.lines if not holding(system.winches, line.name)]


def inputs_of_system(time, system, pulls):
    """Inputs at a time [s], as a dict of arguments of `TetherSystem.step` (SI units); pulls [N] : of lines at the start."""
    share, rate, integral = rise(time, _RISES)
    mean = sum(line.tether.initial_length for line in system.lines) / len(system.lines)
    length = _AMPLITUDE * mean
    sway = length * share * sin(_RATE * time)
    speed = length * (rate * sin(_RATE * time) + share * _RATE * cos(_RATE * time))
    driven = {point.name: point.position for point in system.points if point.is_driven}
    alone = {name: [e for e in lines_alone(system) if _LED_BY[e.winch.winch_control] == name] for name in _LED_BY.values()}
    speeds = {line.name: share * _PAID_OUT * line.tether.initial_length for line in alone["reel_out_speed"]}
    lengths = {line.name: line.tether.initial_length * (1.0 + integral * _PAID_OUT) for line in alone["winch_length"]}
    forces = {line.name: pulls[line.name] * (1.0 + _LIFT * share) for line in alone["winch_force"]}
    winches = {name: [each for each in system.winches if each.input == name] for name in KINDS.values()}
    return {
        "positions": {name: (x, y + sway, z) for name, (x, y, z) in driven.items()},
        "velocities": dict.fromkeys(driven, (0.0, speed, 0.0)),
        "reel_out_speeds": speeds | {each.name: share * _PAID_OUT * mean for each in winches["reel_out_speed"]},
        "winch_lengths": lengths | {each.name: integral * _PAID_OUT * mean for each in winches["winch_length"]},
        "winch_forces": forces | {each.name: each.winch_force * (1.0 + _LIFT * share) for each in winches["winch_force"]},
        "wind_velocity": (_MEAN * share, _GUSTS * share * sin(_RATE * time), 0.0),
    }


def _named(given):
    """Arguments of `TetherSystem.step` by FMI vectors."""
    own = {f"{name}.{what}": each for key, what in KINDS.items() for name, each in given.get(key, {}).items()}
    return {"wind_velocity": given["wind_velocity"], **own}


def _found_in_system(forces, row):
    """Outputs by FMI vectors, from `SystemOutputs`; forces : dict of point to its vector."""
    own = {vector: getattr(row.points[name], vector.rpartition(".")[2]) for name, vector in forces.items()}
    lines = {f"{name}.{what}": getattr(line, of) for name, line in row.lines.items() for what, of in _TENSIONS.items()}
    return own | lines
