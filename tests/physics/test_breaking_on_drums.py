"""Lines break on drums by force beside sheaves, and on those that hold several lines (docs/models/theory.md, "Breaking").

as alone      beside a sheave a line breaks as in a system without one, whose drum is found in another way
braked        the drum of a line that broke, and all that it holds, pays out no more; momentum goes to the nodes
event         states and flights go over it bit for bit
"""

import numpy as np
import pytest

from of_systems import assert_continues
from solvers import ADAPTIVE, with_each_solver
from tetherfmu import Line, Point, SharedWinch, Tether, TetherSystem, Winch

STEP = 0.02  # [s]
DRUM = Winch(winch_control="force", winch_mass=50.0, winch_damping=10.0)


def rope(**more):
    """A tether whose broken ends do not press."""
    return Tether(segments=8, initial_length=100.0, slack_stiffness_ratio=0.0, **more)


def kite(time):
    """Position and velocity of a kite that pulls ever harder."""
    return (20.0 * np.sin(0.5 * time), 0.0, 99.9 + 3.0 * time), (10.0 * np.cos(0.5 * time), 0.0, 3.0)


def main_line(solver, has_sheave):
    """A line of 4 kN on a drum, and beside it two lines, or one over a sheave."""
    points = [Point("winch", (0.0, 0.0, 0.0)), Point("kite", kite(0.0)[0]), Point("a", (30.0, 0.0, 0.0))]
    lines = [Line("main", "winch", "kite", rope(breaking_force=4000.0), winch=DRUM)]
    lines.append(Line("tie", "winch", "a", Tether(segments=2, initial_length=31.0)))
    if has_sheave:
        points += [Point("b", (40.0, 0.0, 0.0)), Point("sheave", (35.0, 0.0, 20.0))]
        lines.append(Line("over", "a", "b", Tether(segments=3, initial_length=42.0), through=["sheave"]))
    system = TetherSystem(points, lines, solver=solver)
    system.initialize(winch_forces={"main": 500.0})
    return system


def told(system, k, forces, more=50.0):
    """Inputs of step k; forces : of winches by their names, at the start [N].  more : in each step [N]."""
    kites, motion = [point.name for point in system.points if point.name.startswith("kite")], kite(STEP * (k + 1))
    motion = {what: dict.fromkeys(kites, motion[i]) for i, what in enumerate(("positions", "velocities"))}
    return {"winch_forces": {name: force + more * k for name, force in forces.items()}, **motion}


def pulled(system, steps, forces, more=50.0):
    """Outputs after each step, by `told`."""
    return [system.step(STEP, **told(system, k, forces, more)) for k in range(steps)]


@with_each_solver(0.001)
def test_beside_a_sheave_a_line_breaks_as_alone(solver):
    alone, beside = (
        [each.lines["main"] for each in pulled(main_line(solver, has_sheave), 65, {"main": 500.0})]
        for has_sheave in (False, True)
    )
    assert not beside[59].broken
    assert beside[-1].broken
    assert beside[-1].break_time == pytest.approx(alone[-1].break_time, abs=1e-9)
    for name in ("tether_length", "winch_speed"):
        ours, theirs = (np.array([getattr(each, name) for each in found]) for found in (beside, alone))
        assert ours == pytest.approx(theirs, abs=1e-6)
    assert beside[-1].winch_speed == 0.0
    if solver is ADAPTIVE:
        assert beside[-1].max_tension == pytest.approx(alone[-1].max_tension, rel=1e-6)


def tapes(solver, **strengths):
    """Two kites on one drum, which pays out the second line twice as fast; strengths : of lines that may break [N]."""
    points = [Point("winch", (0.0, 0.0, 0.0)), Point("kite", kite(0.0)[0]), Point("kite2", kite(0.0)[0])]
    forces = {"slow": 0.0, "fast": 0.0} | strengths
    lines = [
        Line(name, "winch", end, rope(breaking_force=forces[name])) for name, end in (("slow", "kite"), ("fast", "kite2"))
    ]
    drum = SharedWinch("drum", {"slow": 1.0, "fast": 2.0}, control="force", winch_mass=200.0, winch_damping=300.0)
    system = TetherSystem(points, lines, winches=[drum], solver=solver)
    system.initialize(winch_forces={"drum": 3000.0})
    return system


@with_each_solver(0.001)
@pytest.mark.parametrize(("weak", "other"), [("slow", "fast"), ("fast", "slow")])
def test_a_drum_turns_on_with_what_it_still_holds(weak, other, solver):
    """m u' = r T - W - c u with the ratio r of the line that is left; the broken one keeps its length."""
    ratio = {"slow": 1.0, "fast": 2.0}[other]
    system, force = tapes(solver, **{weak: 1500.0}), 3000.0
    before = pulled(system, 5, {"drum": force}, 0.0)[-1]
    assert before.lines[weak].broken
    gained, last = 0.0, None
    for _ in range(100):
        now = system.step(0.001, winch_forces={"drum": force})
        speed, tension = now.lines[other].winch_speed / ratio, now.lines[other].ground_tension
        pull = ratio * tension - force - 300.0 * speed
        if last is None:
            first = speed
        else:
            gained += 0.0005 * (pull + last) / 200.0
        last = pull
    assert abs(speed - first) > 0.05
    assert speed - first == pytest.approx(gained, rel=1e-2)  # by the trapezoidal rule, and backward Euler has order 1
    assert now.lines[weak].tether_length == before.lines[weak].tether_length
    assert now.lines[weak].winch_speed == 0.0


@with_each_solver(0.001)
def test_a_drum_whose_lines_all_broke_is_braked(solver):
    system = tapes(solver, slow=1500.0, fast=1500.0)
    found = pulled(system, 150, {"drum": 3000.0})
    first = next(k for k, each in enumerate(found) if each.lines["slow"].broken and each.lines["fast"].broken)
    assert found[first - 1].winches["drum"].winch_speed != 0.0
    assert {each.winches["drum"].winch_speed for each in found[first:]} == {0.0}
    assert len({each.winches["drum"].payout for each in found[first:]}) == 1


@with_each_solver(0.002)
def test_states_and_flights_go_over_the_break(solver):
    system = tapes(solver, fast=1500.0)
    outputs = assert_continues(system, lambda k: told(system, k, {"drum": 3000.0}), 1, 59)
    assert not outputs[0].lines["fast"].broken
    assert outputs[-1].lines["fast"].broken
