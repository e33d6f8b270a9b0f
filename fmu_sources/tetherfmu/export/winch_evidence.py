"""Evidence sets of the winch inside a tether, controlled by force or length; `evidence.py` has the set with a speed.

    force    A drum with mass and dry friction. It holds still until its force exceeds the friction, breaks away, reels the
             tether taut, lets it go as the force falls, and is stopped at `longest_length` with the tether slack.
    length   The tether follows a length that is reeled in until it is taut, and out until it is slack.

The kite is held where the FMU has it; a free one is pulled outwards by a constant load. Forces are parts of the weight of
the tether, so that they suit light and heavy ones.
"""

from math import hypot, pi
from typing import NamedTuple
from warnings import catch_warnings

from tetherfmu import models
from tetherfmu.results import PlausibilityWarning
from tetherfmu.runtime.inputs import KITE_AT_START
from tetherfmu.runtime.parameters import Environment, FreeKite, Solver, Winch
from tetherfmu.runtime.variables import INPUT, OUTPUT, names_of, variables
from tetherfmu.runtime.variants import BY_NAME

from .evidence import INPUT_DIGITS, OUTPUT_DIGITS, STEP, flat, rise, rounded, table_text

STEPS = 120  # of communication
TOLERANCE, REFERENCE_TOLERANCE = 1e-6, 1e-8  # of the run: a drum remembers when it broke away; of the reference
# With one segment kite and drum bounce between slack and taut, and the tolerance leaves 0.3 % of the largest force; with
# many, waves in the slack tether are so short that it leaves 1 to 6 %.
SEGMENTS = range(2, 41)
RECORDED = ("ground_tension", "kite_tension", "tether_length", "winch_speed")
GIVEN = {"force": "winch_force", "length": "winch_length"}  # kind of set: the input that changes

# of the drum, in the weight of the tether, and its pull over time: stuck, taut, slack
_MASS, _FRICTION, _STOP = 5.0, 0.5, 1.001  # [-], [-], [-] of `initial_length`
_HELD, _PULL, _LET_GO = 1.0, 5.0, -2.0  # parts of the weight [-]
_PULL_BEGINS, _PULL_RISES, _PULL_ENDS, _PULL_FALLS = 0.4, 0.8, 3.0, 0.8  # [s]
# of the length, in `initial_length`: reeled in, and out again
_REELED_IN, _REEL_IN, _REELED_OUT, _REEL_OUT_BEGINS, _REEL_OUT = 0.0115, 2.5, 0.012, 2.75, 3.0  # [-], [s], [-], [s], [s]
_OUTWARDS = 4.0  # load on a free kite, in the weight of the tether [-]


class WinchSet(NamedTuple):
    """One evidence set: start values of the winch, and the inputs over time as the Python API's arguments."""

    winch: Winch
    scene: list  # of dicts, one for each communication point


def weight_of(tether):
    """Weight of a tether of its first length in the standard gravity [N]."""
    return 0.25 * pi * tether.diameter**2 * tether.density * tether.initial_length * Environment().gravity


def pull_at(time, weight):
    """Force of the winch at a time [s] on a tether of a weight [N]."""
    up = rise(time - _PULL_BEGINS, _PULL_RISES)[0]
    down = rise(time - _PULL_ENDS, _PULL_FALLS)[0]
    return weight * (_HELD + (_PULL - _HELD) * up + (_LET_GO - _PULL) * down)


def length_at(time, first):
    """Length that the winch should have paid out at a time [s], of a tether of a first length [m]."""
    back, out = rise(time, _REEL_IN)[0], rise(time - _REEL_OUT_BEGINS, _REEL_OUT)[0]
    return first * (1.0 - _REELED_IN * back + _REELED_OUT * out)


def winch_set(kind, model, tether):
    """`WinchSet` of a kind, a key of `GIVEN`, for a class of the Python API and the `Tether` of the start values."""
    weight, load = weight_of(tether), {}
    mass, friction, stop = rounded(
        (_MASS * weight / Environment().gravity, _FRICTION * weight, _STOP * tether.initial_length)
    )
    winch = Winch(winch_control=kind)
    if kind == "force":
        winch = Winch(winch_control=kind, winch_mass=mass, winch_friction=friction, longest_length=stop)
    if BY_NAME[model.variant].kite_is_free:
        load = {"kite_load": _load_on(weight)}
    value_at = (
        (lambda time: pull_at(time, weight)) if kind == "force" else (lambda time: length_at(time, tether.initial_length))
    )
    return WinchSet(winch, [{GIVEN[kind]: rounded(value_at(k * STEP)), **load} for k in range(STEPS + 1)])


def _load_on(weight):
    """Load that pulls a free kite outwards and carries it [N]."""
    x, y, z = (_OUTWARDS * weight * part / hypot(*KITE_AT_START) for part in KITE_AT_START)
    return rounded((x, y, z + FreeKite().kite_mass * Environment().gravity))


def files(name, tether, arrays=False):
    """Inputs and reference of all kinds, and their options: two dicts of file name to text, and to `options_of`.

    Both are empty for a tether with waves and a number of segments that is not in `SEGMENTS`.

    name, tether, arrays : as in `evidence.files`.
    """
    model, texts, options = getattr(models, name), {}, {}
    if BY_NAME[model.variant].has_waves and tether.segments not in SEGMENTS:
        return texts, options
    of_inputs = names_of(variables(model.variant, 0), INPUT)
    for kind in GIVEN:
        given = winch_set(kind, model, tether)
        inputs = [each for each in of_inputs if each.partition("[")[0] in given.scene[0]]
        rows = reference(model, tether, given)
        texts |= {
            f"{name}_{kind}_in.csv": table_text(inputs, [flat(each, inputs) for each in given.scene], INPUT_DIGITS, arrays),
            f"{name}_{kind}_ref.csv": table_text(recorded(model.variant), rows, OUTPUT_DIGITS, arrays),
        }
        options[f"{name}_{kind}_ref.opt"] = options_of(model.variant, given.winch)
    return texts, options


def starts_of(winch):
    """Start values of a winch that are not the defaults: dict of name to number."""
    default = vars(Winch())
    return {name: value for name, value in vars(winch).items() if value != default[name]}


def recorded(variant):
    """FMI names of the recorded outputs."""
    vectors = (*RECORDED, *(("kite_position",) if BY_NAME[variant].kite_is_free else ()))
    return [name for name in names_of(variables(variant, 0), OUTPUT) if name.partition("[")[0] in vectors]


def options_of(variant, winch):
    """Numbers in assets/evidence.opt, the options of the run, and the start values of parameters: two dicts."""
    allowed = BY_NAME[variant].evidence_deviation
    return {"step": STEP, "stop": STEP * STEPS, "tolerance": TOLERANCE, "allowed": allowed}, starts_of(winch)


def reference(model, tether, given, tolerance=REFERENCE_TOLERANCE):
    """Recorded outputs of the Python API at the start and after each step: list of lists of numbers."""
    with catch_warnings(action="ignore", category=PlausibilityWarning):  # the FMU says it itself
        flown = model(tether, solver=Solver(relative_tolerance=tolerance), winch=given.winch)
        rows = [flown.initialize(**given.scene[0])]
        rows += [flown.step(STEP, **inputs) for inputs in given.scene[:-1]]
    return [flat(row._asdict(), recorded(model.variant)) for row in rows]
