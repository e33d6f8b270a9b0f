"""FMUs of systems in all flavours against `TetherSystem`: a table of flights, all outputs to the last bit, states too."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from flavours import NEXT, check_flight, every_flavour
from isolation import in_shared_process
from runtime.host import STEP, Host
from shared_drums import TEXT
from tetherfmu import TetherSystem
from tetherfmu.files import system_files as files
from tetherfmu.runtime.limits import WORST_WORK, WORST_WORK_WITH_DRUM
from tetherfmu.wiring import system_variables
from y_of_lines import y_of_lines

EXAMPLES = Path(__file__).parents[2] / "examples" / "systems"
STEPS, HALF = 20, 10
NAMES = {own: name for name, own in system_variables.OF_A_LINE.items()}  # outputs of a line in Python by those of an FMU
OF_PORTIONS = {"length": "portion_length", "tension_from": "portion_tension_from", "tension_to": "portion_tension_to"}
OF_PORTIONS |= {"payout": "sheave_payout", "speed": "sheave_speed"}


NOTHING = {}


class Flight(NamedTuple):
    """A flight of a system, its inputs and parameters by the names of an FMU."""

    file: str  # the text that the FMU is made of
    given: Callable  # inputs of step k
    start: dict = NOTHING  # inputs at the start
    parameters: dict = NOTHING  # of the FMU, at the start
    twin: str = ""  # text for the Python API that has the same effect as the parameters; else that of the FMU
    wind_points: int = 0
    seen: Callable = lambda rows: None  # asserts that what the flight is about does happen; rows : of all outputs by name


def text_of(name):
    return (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8")


# --- the flights


def of_kites(x, y, z):
    """Inputs of two kites, of which the left one moves away from where it starts [m]."""

    def given(k):
        time = STEP * k
        left = {"left.position": (x, y + math.sin(time), z), "left.velocity": (0.0, math.cos(time), 0.0)}
        return left | {
            "wind_velocity": (3.0 * time, 1.0, 0.0),
            "knot.load": (0.0, 20.0 * time, 5.0),
            "main.reel_out_speed": 0.4 * time,
        }

    return given


def reels_out(rows):
    assert rows[-1]["main.tether_length"] > 0.015 + rows[0]["main.tether_length"]


def with_fixed_steps(step, method="second_order"):
    """What a file has more, and the parameters of an FMU with the same effect."""
    methods = {"second_order": 1, "backward_euler": 2}
    more = f'\n[solver]\nfixed_step = {step}\nfixed_step_method = "{method}"\n'
    return more, {"fixed_step": step, "fixed_step_method": methods[method]}


def two_steps_of_work(rows):
    assert rows[-1]["solver_iteration_limit"] == 2 * WORST_WORK
    assert rows[-1]["solver_steps"] == 2 * STEPS


OF_WINCHES = y_of_lines("TwoWinches", "winch_control = 2\nwinch_mass = 20.0\nwinch_friction = 5.0", "winch_control = 3")


def of_winches(more="", parameters=NOTHING):
    """One line by force and one by length; more : in the file of the Python API, with the effect of the parameters."""

    def given(k):
        return {"main.winch_force": 200.0 + 10.0 * k, "a.winch_length": 39.0 - 0.002 * k}

    def both_turn(rows):
        assert rows[-1]["main.tether_length"] != 100.0
        assert rows[-1]["main.winch_speed"] != 0.0
        assert rows[-1]["a.tether_length"] == pytest.approx(39.0 - 0.002 * (STEPS - 1), abs=0.01)
        assert rows[-1]["solver_iteration_limit"] == (2 * WORST_WORK_WITH_DRUM if more else 0)

    return Flight(OF_WINCHES, given, {"a.winch_length": 39.0}, parameters, OF_WINCHES + more, seen=both_turn)


WEIGHTS = {"left.load": (-900.0, 0.0, 1500.0), "right.load": (900.0, 0.0, 1500.0)}


def pays_out(rows):
    assert rows[-1]["depower.payout"] > 0.005


def steered(control):
    """Tapes in two winches; control : of both, and what it is as an input."""
    name = {"length": "winch_length", "speed": "reel_out_speed"}[control]
    text = text_of("steered_kite").replace('"length"', f'"{control}"').replace("winch_length", name)
    text = text.replace("SteeredKite", control.title())
    given = {"steering": 0.001, "depower": 0.0005}
    return Flight(
        text,
        lambda k: {f"steering.{name}": given["steering"] * k, f"depower.{name}": given["depower"] * k * k},
        WEIGHTS,
        seen=pays_out,
    )


STARTS = """
name = "{name}"
[points]
left = {{position = [-6, 0, 30]}}
right = {{position = [6, 0, 30]}}
far = {{position = [0, 12, 31]}}
load = {{mass = 60.0}}
[lines]
a = {{from = "left", to = "load", initial_length = 9.0, segments = 3}}
b = {{from = "right", to = "load", initial_length = 9.5, segments = 3}}
c = {{from = "far", to = "load", initial_length = 15.0, segments = 3}}
[winches]
trim = {{lines = {{a = 1, b = -1}}, control = "{control}"{trim}}}
lift = {{lines = {{a = 0.5, b = 0.5, c = 1}}, control = "{control}"{lift}}}
"""
DRUMS = STARTS.format(
    name="DrumStarts",
    control="force",
    trim=', winch_force = 25.0, winch_start = "equilibrium", winch_mass = 10.0',
    lift=', winch_force = "0.9 kN", winch_start = "equilibrium", winch_mass = 20.0, winch_friction = 5.0',
)
LENGTHS = STARTS.format(name="LengthStarts", control="length", trim="", lift="")
GIVEN = 1


def winches_balance(rows):
    a, b, c = (rows[0][f"{line}.tension_from"] for line in "abc")
    assert (a - b, 0.5 * (a + b) + c) == pytest.approx((25.0, 900.0), rel=1e-8)


def starts_with(speeds):
    def seen(rows):
        for line, speed in speeds.items():
            assert rows[0][f"{line}.winch_speed"] == pytest.approx(speed, abs=1e-15)

    return seen


def three_forces(k):
    return {"steering.winch_force": 200.0 + 10.0 * k, "power.winch_force": 300.0 - 5.0 * k, "c.winch_force": 30.0 + 8.0 * k}


def drums_beside_a_sheave(strength):
    """Other parameters of a drum than in the file; and a line that breaks at a tension [N], or does not."""

    def seen(rows):
        assert rows[-1]["a.broken"] == (strength > 0.0)
        assert rows[-1]["power.winch_speed"] != 0.0
        assert rows[-1]["c.winch_speed"] != 0.0

    line = 'to = "load"\n'
    twin = TEXT.replace("winch_mass = 8", "winch_mass = 4").replace(line, f"{line}breaking_force = {strength}\n")
    own = {"power.winch_mass": 4.0, "a.breaking_force": strength}
    return Flight(TEXT, three_forces, {"c.winch_force": 30.0}, own, twin, seen=seen)


def rope_runs(line):
    def seen(rows):
        assert abs(rows[-1][f"{line}.sheave_payout"][0]) > 1e-3

    return seen


def hoisted(method):
    more, parameters = with_fixed_steps(0.005, method)
    text = text_of("two_fall_hoist")
    return Flight(text, lambda k: {"hoist.reel_out_speed": -0.01 * k}, {}, parameters, text + more, seen=rope_runs("hoist"))


def stopped():
    """A drum over a sheave, which the load draws to its stop."""
    text, longest = text_of("two_fall_hoist"), 40.3
    parameters = {"hoist.winch_control": 2, "hoist.winch_mass": 500.0, "hoist.longest_length": longest}
    more = f'\nwinch_control = "force"\nwinch_mass = 500\nlongest_length = {longest}\n'

    def seen(rows):
        assert rows[HALF]["hoist.winch_speed"] > 0.5
        assert rows[-1]["hoist.tether_length"] == pytest.approx(longest, rel=1e-9)
        assert rows[-1]["hoist.winch_speed"] == 0.0

    return Flight(text, lambda k: {"hoist.winch_force": 10.0 * k}, {}, parameters, text + more, seen=seen)


def let_go(line, k_of_release):
    def seen(rows):
        assert not rows[k_of_release][f"{line}.broken"]
        assert rows[-1][f"{line}.broken"]
        assert rows[-1][f"{line}.break_time"] == pytest.approx(k_of_release * STEP)

    return seen


HOIST = """
name = "Hoist"
[points]
top = {position = [0, 0, 30]}
load = {mass = 200}
[lines]
rope = {from = "top", to = "load", segments = 4, initial_length = 20, breaking_force = 1e6}
"""
SWING = """
name = "Swing"
[points]
left = {position = [0, 0, 30]}
right = {position = [8, 0, 30]}
load = {position = [4, 0, 10], mass = 20}
[lines]
a = {from = "left", to = "load", initial_length = 20.3, segments = 4, diameter = "10 mm"}
b = {from = "right", to = "load", initial_length = 20.4, segments = 3, diameter = "10 mm"}
"""
CHAIN = """
name = "Chain"
[points]
top = {position = [0, 0, 60], mass = 2e3}
knot = {mass = 3.0}
load = {mass = 20.0}
[lines]
upper = {from = "top", to = "knot", initial_length = 20.0, segments = 3}
lower = {from = "knot", to = "load", initial_length = 15.0, segments = 2}
"""
LOADS = {"top.load": (0.0, 0.0, 2.1e4), "knot.load": (30.0, 0.0, 0.0), "load.load": (0.0, -40.0, 10.0)}
WIND = np.array([[4.0, 1.0, 0.0], [9.0, -2.0, 0.5], [12.0, 1.5, 0.0]])  # at three points [m/s]
WINDY = len(WIND)


def winds(k):
    """At the points of both lines in step k, which have other winds."""
    return {f"{line}.wind_at": (WIND * (1.0 + 0.02 * k + more)).ravel() for line, more in (("a", 0.0), ("b", 0.3))}


def winds_of_falls(k):
    wind = np.outer(np.linspace(4.0, 12.0, 2 * WINDY), (1.0, 0.3, 0.0))
    return {"hoist.wind_at": ((1.0 + 0.1 * k) * wind).ravel()}


TWO_KITES = text_of("two_kites")
FIXED, OF_FIXED = with_fixed_steps(0.01)
FLIGHTS = {
    "a bridle": Flight(text_of("y_bridle"), of_kites(150.0, -3.0, 200.0), seen=reels_out),
    "two kites": Flight(TWO_KITES, of_kites(159.5, 40.0, 111.7), seen=reels_out),
    "fixed steps": Flight(TWO_KITES, of_kites(159.5, 40.0, 111.7), {}, OF_FIXED, TWO_KITES + FIXED, seen=two_steps_of_work),
    "a winch by force and one by length": of_winches(),
    "these winches in fixed steps": of_winches(FIXED, OF_FIXED),
    "shared winches by length": steered("length"),
    "shared winches by speed": steered("speed"),
    "shared drums in equilibrium": Flight(
        DRUMS,
        lambda k: {"trim.winch_force": 25.0 + k * k, "lift.winch_force": 900.0 - k},
        {"load.load": (0.0, 15.0, 40.0)},
        seen=winches_balance,
    ),
    "shared drums with a speed": Flight(DRUMS, lambda k: {}, {"lift.reel_out_speed": 0.25}, seen=starts_with({"a": 0.125})),
    "shared drums with a speed and a given length": Flight(
        DRUMS,
        lambda k: {},
        {"lift.reel_out_speed": 0.25},
        {"trim.winch_start": GIVEN, "lift.winch_start": GIVEN},
        DRUMS.replace('"equilibrium"', '"given"'),
        seen=starts_with({"a": 0.125}),
    ),
    "shared winches by length with a speed": Flight(
        LENGTHS, lambda k: {}, {"lift.reel_out_speed": 0.25, "trim.reel_out_speed": -0.1}, seen=starts_with({"b": 0.225})
    ),
    "shared drums beside a sheave": drums_beside_a_sheave(0.0),
    "a line of them breaks": drums_beside_a_sheave(330.0),
    "a hoist": Flight(text_of("two_fall_hoist"), lambda k: {"hoist.reel_out_speed": -0.01 * k}, seen=rope_runs("hoist")),
    "a hoist in fixed steps": hoisted("second_order"),
    "a hoist by backward Euler": hoisted("backward_euler"),
    "a hoist whose drum stops": stopped(),
    "wind at the points of its falls": Flight(
        text_of("two_fall_hoist"), winds_of_falls, winds_of_falls(0), wind_points=WINDY
    ),
    "two masses over a sheave": Flight(
        text_of("atwood"), lambda k: {"rope.reel_out_speed": -0.01 * k}, seen=rope_runs("rope")
    ),
    "a rope over a sheave lets go": Flight(text_of("atwood"), lambda k: {"rope.release": k >= 12}, seen=let_go("rope", 12)),
    "a load is let go": Flight(HOIST, lambda k: {"rope.release": k >= 12}, seen=let_go("rope", 12)),
    "wind at points": Flight(SWING, winds, winds(0), wind_points=WINDY),
    "points that are sought": Flight(CHAIN, lambda k: {}, {"wind_velocity": (9.0, 2.0, 0.0), **LOADS}),
    "a point that is given": Flight(
        CHAIN,
        lambda k: {},
        {"wind_velocity": (9.0, 2.0, 0.0), **LOADS},
        {"knot.start": GIVEN, "knot.initial_position": (3.0, 0.0, 41.0)},
        CHAIN.replace("knot = {", "knot = {position = [3, 0, 41], "),
    ),
}


# --- both sides, by the names of the FMU


def of_python(inputs):
    """Inputs as arguments of `TetherSystem`."""
    found = {}
    for name, value in inputs.items():
        owner, _, what = name.rpartition(".")
        value = np.reshape(value, (-1, 3)) if what == "wind_at" else value
        argument = what if what == "wind_at" or not owner else f"{what}s".replace("velocitys", "velocities")
        found = {**found, argument: {**found.get(argument, {}), owner: value} if owner else value}
    return found


def named(system, outputs):
    """`SystemOutputs` as outputs of an FMU, a dict."""
    found = {}
    for point in system.points:
        own = outputs.points[point.name]
        names = ("force",) if point.is_driven else ("position", "velocity")
        found |= {f"{point.name}.{name}": getattr(own, name).tolist() for name in names}
    for line in system.lines:
        own, portions = outputs.lines[line.name], outputs.portions.get(line.name)
        found |= {f"{line.name}.{name}": getattr(own, NAMES[name]) for name in NAMES}
        found[f"{line.name}.shape"] = own.shape.tolist()
        if portions:
            found |= {f"{line.name}.{theirs}": getattr(portions, ours).tolist() for ours, theirs in OF_PORTIONS.items()}
    for name, own in outputs.winches.items():
        found |= {f"{name}.payout": own.payout, f"{name}.winch_speed": own.winch_speed}
    found |= {f"solver_{name}": count for name, count in system.counters.items()}
    found["solver_iteration_limit"] = outputs.solver_iteration_limit
    found["fallback_steps"] = next(iter(outputs.lines.values())).fallback_steps
    return found


def outputs_of(host):
    """All outputs of an FMU; of a shape the points, once each: that at a sheave ends a portion and begins the next one."""
    found = host.outputs()
    for name in [name for name in found if name.endswith(".shape")]:
        points = np.reshape(found[name], (-1, 3))
        is_new = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9
        found[name] = points[np.concatenate([[True], is_new])].tolist()
    return found


def assert_same(found, expected):
    """To the last bit, but for sums of products in another order: the turns of winches that hold several lines."""
    winches = {name.partition(".")[0] for name in expected if name.endswith(".payout")}
    turns = {f"{winch}.{what}" for winch in winches for what in ("payout", "winch_speed")}
    assert {name: found[name] for name in turns} == pytest.approx({name: expected[name] for name in turns}, abs=1e-12)
    assert found.keys() == expected.keys()
    wrong = {name: (value, expected[name]) for name, value in found.items() if value != expected[name]}
    assert not wrong.keys() - turns, wrong


@every_flavour
@pytest.mark.parametrize("name", FLIGHTS)
def test_flight_of_the_python_api(built, tmp_path, name, flavour):
    flight, twin = FLIGHTS[name], tmp_path / "twin.toml"
    twin.write_text(flight.twin or flight.file, encoding="utf-8")
    fmu, other = (built(flight.file, each, flight.wind_points) for each in (flavour, NEXT[flavour]))
    check(path=fmu, other=other, twin=str(twin), name=name)


@in_shared_process
def check(path, other, twin, name):
    flight, found = FLIGHTS[name], files.load(twin)
    records = (found.points, found.lines, found.environment, found.solver, found.ground)
    system = TetherSystem(*records, winches=found.winches, wind_points=flight.wind_points)
    rows = [named(system, system.initialize(**of_python(flight.start)))]
    rows += [named(system, system.step(STEP, **of_python(flight.given(k)))) for k in range(STEPS)]
    flight.seen(rows)
    check_flight(
        Host(path),
        other,
        rows,
        system.implausible,
        HALF,
        start=lambda host: host.start(**flight.start, **flight.parameters),
        step=lambda host, k: host.step(STEP, **flight.given(k)),
        assert_same=lambda host, row: assert_same(outputs_of(host), row),
    )
