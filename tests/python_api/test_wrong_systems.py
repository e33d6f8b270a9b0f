"""Wrong uses of `TetherSystem`: each is refused in words, and changes nothing."""

import re

import numpy as np
import pytest

from tetherfmu import Ground, Line, Point, SharedWinch, Tether, TetherSystem

ROPE = Tether(segments=3, initial_length=10.1)
POINTS = [Point("pod", (0.0, 0.0, 0.0)), Point("left", (-2.0, 0.0, 9.8)), Point("right", (2.0, 0.0, 9.8))]
LINES = [Line("a", "pod", "left", ROPE), Line("b", "pod", "right", ROPE)]


def running(ratio=1.0):
    system = TetherSystem(POINTS, LINES, winches=[SharedWinch("drum", {"a": ratio, "b": -1.0})])
    system.initialize()
    return system


WRONG = {
    "a line for lines": (lambda: TetherSystem(POINTS, LINES[0]), "lines is Line(name='a'"),
    "no lines": (lambda: TetherSystem(POINTS, None), "lines is None; it must be a sequence of Line"),
    "a dict of points": (lambda: TetherSystem({"pod": 1}, LINES), "points is {'pod': 1}; it must be a sequence of Point"),
    "a winch for winches": (lambda: TetherSystem(POINTS, LINES, winches=SharedWinch("drum", {"a": 1.0})),
        "it must be a sequence of SharedWinch"),
    "a dict for a ground": (lambda: TetherSystem(POINTS, LINES, ground={"contact": "flat"}),
        "ground is {'contact': 'flat'}; it must be a Ground, as in TetherSystem(..., ground=Ground())"),
    "a speed for speeds": (lambda: running().step(0.02, reel_out_speeds=1.0), "reel_out_speeds is 1.0; it must be a dict"),
    "a list of releases": (lambda: running().step(0.02, releases=["a"]), "releases is ['a']; it must be a dict"),
    "positions at the start": (lambda: running().initialize(positions=[(0.0, 0.0, 1.0)]), "positions is [(0.0, 0.0, 1.0)]"),
    "forces at the start": (lambda: running().initialize(winch_forces=3.0), "winch_forces is 3.0; it must be a dict"),
    "half a release": (lambda: running().step(0.02, releases={"a": 0.5}), "a.release is 0.5; it must be true or false"),
    "half a release in a flight": (lambda: running().fly(2, 0.02, releases={"a": [0.0, 2.0]}),
        "a.release is 2; it must be true or false"),
    "a speed as a text": (lambda: Line("a", "pod", "left", reel_out_speed="1"), "a.reel_out_speed is '1'; it must be"),
    "a force as a text": (lambda: SharedWinch("drum", {"a": 1.0}, "force", winch_force="5"),
        "drum.winch_force is '5'; it must be finite"),
    "a mass as a text": (lambda: Point("a", mass="5"), "the point a: mass is '5'; it must be at least 0 kg"),
    "a name for points": (lambda: Line("a", "pod", "left", through="block"),
        "a.through is 'block'; it must be a list of names of points"),
    "a point for its name": (lambda: Line("a", POINTS[0], "left"),
        "the line a goes to Point(name='pod', position=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), mass=None); it must be"),
    "no efficiency": (lambda: Line("a", "pod", "left", through=["right"], sheave_efficiency=None),
        "a.sheave_efficiency is None; it must be at least 0.001 and at most 1"),
    "a friction as a text": (lambda: Line("a", "pod", "left", through=["right"], sheave_friction=["0.1"]),
        "a.sheave_friction is '0.1'; it must be at least 0"),
    "half of the portions": (lambda: Line("a", "pod", "left", ROPE, through=["right"], initial_portions=[None, 10.1]),
        "a.initial_portions is [None, 10.1]; it must be 2 lengths above 0"),
    "a wind for winds": (lambda: running().step(0.02, wind_at=np.zeros((11, 3))),
        "; it must be a dict by the names of points or lines"),
    "a state of other ratios": (lambda: running().set_state(running(2.0).get_state()),
        "state belongs to another system: its points, lines,"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_is_refused_in_words(case):
    wrong, says = WRONG[case]
    with pytest.raises((TypeError, ValueError), match=re.escape(says)):
        wrong()


def test_a_refused_step_changes_nothing():
    refused, twin = running(), running()
    for wrong in ({"reel_out_speeds": 1.0}, {"releases": {"a": 0.5}}, {"positions": [(0.0, 0.0, 1.0)]}):
        with pytest.raises((TypeError, ValueError)):
            refused.step(0.02, **wrong)
    one, other = (each.step(0.02, releases={"a": np.True_}) for each in (refused, twin))
    assert np.array_equal(one.points["left"].force, other.points["left"].force)
    assert one.lines["a"].broken
    assert TetherSystem(POINTS, LINES, ground=Ground()).initialize().lines["a"].broken == 0
