"""Lines over sheaves, and beside them, whose winches start with the length at which the rope pulls with their force.

straight   without gravity each portion is as long as d/(1 + W/EA)
alone      a line beside sheaves starts as a tether alone
first step the drum stays where it is
"""

import numpy as np
import pytest

from over_sheaves import LIGHT, rope
from tetherfmu import Environment, Line, Point, SharedWinch, StepRefused, Tether, TetherDynamic, TetherSystem, Winch

BALANCED = Winch(winch_control="force", winch_start="equilibrium", winch_mass=20.0)


@pytest.mark.parametrize("given", [41.0, 52.0, 80.0])
@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_a_winch_over_sheaves_starts_in_balance(gravity, given):
    """The rope pulls with the force, and the drum stays; without gravity it is as long as straight: d/(1 + W/EA)."""
    places = np.array([(-8.0, 0.0, 0.0), (0.0, 0.0, 6.0), (1.0, 0.0, -14.0), (3.0, 0.0, 6.0)])
    points = [Point(name, place) for name, place in zip(("winch", "head", "foot", "anchor"), places, strict=True)]
    tether = rope(given, 4, diameter=0.01, mass_per_length=0.3, axial_stiffness=2e4)
    line = Line("rope", "winch", "anchor", tether, winch=BALANCED, through=["head", "foot"])
    system = TetherSystem(points, [line], Environment(gravity=gravity))
    start = system.initialize(winch_forces={"rope": 200.0})
    assert start.portions["rope"].tension_from[0] == pytest.approx(200.0, rel=1e-9)
    assert start.portions["rope"].tension_to[:-1] == pytest.approx(start.portions["rope"].tension_from[1:], rel=1e-9)
    if gravity == 0.0:
        spans = np.linalg.norm(np.diff(places, axis=0), axis=1)
        assert start.portions["rope"].length == pytest.approx(spans / (1.0 + 200.0 / 2e4), rel=1e-8)
    for _ in range(10):
        outputs = system.step(0.02)
    assert abs(outputs.lines["rope"].winch_speed) < 1e-6
    assert outputs.lines["rope"].tether_length == pytest.approx(start.lines["rope"].tether_length, abs=1e-7)


@pytest.mark.parametrize("beside", ["line", "sheave", "shared winch"])
def test_a_line_beside_others_starts_as_alone(beside):
    """Also beside a sheave, and beside a winch that holds a line by force."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (300.0, 0.0, 400.0)), Point("end", (5.0, 100.0, 0.0))]
    points += [Point("s", (0.0, 50.0, 9.0))] if beside == "sheave" else []
    tether, through = Tether(initial_length=600.0), ["s"] if beside == "sheave" else []
    lines = [Line("main", "ground", "kite", tether, winch=BALANCED)]
    lines.append(Line("guy", "ground", "end", rope(111.0, 4, **LIGHT), through=through))
    winches = [SharedWinch("drum", {"guy": 1.0}, "force")] if beside == "shared winch" else []
    system = TetherSystem(points, lines, winches=winches)
    start = system.initialize(winch_forces={"main": 3000.0})
    alone = TetherDynamic(tether, winch=BALANCED).initialize(winch_force=3000.0)
    assert start.lines["main"].tether_length == alone.tether_length
    assert abs(system.step(0.02, winch_forces={"main": 3000.0}).lines["main"].winch_speed) < 1e-3


def test_a_rope_and_a_point_at_it_cannot_both_be_sought():
    """Nor is there a length with which the rope pulls with less than its weight."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("block", mass=200.0), Point("anchor", (1.0, 0.0, 30.0))]
    line = Line("hoist", "winch", "anchor", rope(40.0, 4, **LIGHT), winch=BALANCED, through=["block"])
    with pytest.raises(StepRefused, match="the line hoist: winch_start is 2"):
        TetherSystem(points, [line]).initialize(winch_forces={"hoist": 1000.0})
    points[1] = Point("block", (0.5, 0.0, 10.0), mass=200.0)
    system = TetherSystem(points, [line])
    with pytest.raises(StepRefused, match=r"no lengths of the portions were found .* pulls with winch_force"):
        system.initialize(winch_forces={"hoist": 10.0})
    weight = 200.0 * 9.81
    start = system.initialize(winch_forces={"hoist": 0.5 * weight + 40.0})
    assert start.portions["hoist"].tension_to[0] == pytest.approx(0.5 * weight, rel=2e-3)
