"""Wrong uses of tethers and systems: each is refused with a sentence that names what is wrong and what is allowed."""

import re

import numpy as np
import pytest

from tetherfmu import (
    Ground,
    Line,
    MovingEnd,
    Point,
    SharedWinch,
    StepRefused,
    Tether,
    TetherCatenary,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
    TetherSystem,
    inputs_along,
    kite_at,
    tether_of,
)
from tetherfmu.runtime.inputs import COUNT


def running(model=TetherDynamic, **quantities):
    tether = model(**quantities)
    tether.initialize()
    return tether


HOLE = [(300.0, 0.0, 400.0), (300.0, np.nan, 400.0), (300.0, 0.0, 400.0)]
SOFT, FAR = {"segments": 2, "axial_stiffness": 1.0}, (9e8, 0.0, 4e8)
WRONG = {  # what is raised: calls, and what is said of each
    TypeError: {
        "number for a tether": (lambda: TetherDynamic(505), "tether is 505; it must be a Tether or a sequence"),
        "number among tethers": (lambda: TetherDynamic([Tether(), 3]), r"or in short TetherDynamic\(initial_length=505"),
        "no tether": (lambda: TetherDynamic(()), "must be a Tether or a sequence of them"),
        "wrong record": (lambda: TetherDynamic(Tether(), Tether()), "it must be an Environment, as in"),
        "number for a solver": (lambda: TetherDynamic(solver=1e-5), "solver is 1e-05; it must be a Solver, as in"),
        "unknown quantity": (lambda: TetherDynamic(length=5.0),
            r"TetherDynamic has no argument 'length'; did you mean initial_length\?$"),
        "quantity of several": (lambda: TetherDynamic([Tether()] * 2, diameter=0.1), "to each of the 2 tethers"),
    },
    ValueError: {
        "no segments": (lambda: TetherDynamic(segments=0), "segments is 0; it must be at least 1 and at most 300"),
        "half a segment": (lambda: TetherDynamic(segments=1.5), "segments is 1.5; it must be a whole number"),
        "text": (lambda: TetherDynamic(diameter="4 mm"), "diameter is '4 mm'; it must be at least 1e-06 m"),
        "not a number": (lambda: Tether(density=np.nan), "density is nan; it must be at least 0.001 kg/m3"),
        "unknown name": (lambda: TetherDynamic(wind_profile="log"), r"wind_profile is 'log'; .* 3 \(logarithmic\)"),
        "short segments": (lambda: TetherDynamic(initial_length=0.1), "it must be at least 0.01 m for each"),
        "nodes of a line": (lambda: TetherCatenary(point_masses={0: 1.0}), "one uniform line: it accepts one Tether"),
        "no such node": (lambda: TetherDynamic(point_masses={21: 1.0}), "a node from 0 to 20"),
        "negative mass": (lambda: TetherDynamic(point_masses={2: -1.0}), "at least 0 kg"),
        "points": (lambda: TetherDynamic(shape_points=-1), "shape_points is -1; it must be a whole number"),
        "one number": (lambda: TetherDynamic().initialize(5.0), "kite_position is 5.0; it must be three numbers"),
        "two numbers": (lambda: TetherDynamic().initialize((1.0, 2.0)), "kite_position is .* it must be three numbers"),
        "letters": (lambda: running().step(0.02, "abc"), "kite_position is 'abc'; it must be three numbers"),
        "matrix": (lambda: running().step(0.02, np.zeros((3, 3))), "it must be three numbers"),
        "vector speed": (lambda: running().step(0.02, reel_out_speed=(1.0, 2.0)), "reel_out_speed .* a number"),
        "wind of nodes": (lambda: running().step(0.02, wind_velocity=np.zeros((5, 3))), r"or \(21, 3\) for a wind at"),
        "step in words": (lambda: running().step("soon"), r"step is 'soon'; it must be a number \[s\]"),
        "length of a wave": (lambda: running().step(0.02, tether_length=5.0), "tether_length is an input of .* without"),
        "length in words": (lambda: running(TetherQuasiSteady).step(0.02, tether_length="long"), r"must be a number \[m\]"),
        "flown in words": (lambda: running().fly(np.zeros((3, COUNT)), "soon"),
            r"step is 'soon'; it must be a number \[s\]"),
        "huge nodes": (lambda: TetherDynamic().initialize(positions=np.full((21, 3), 1e200)), "above 1e\\+09"),
        "too short": (lambda: TetherDynamic().initialize(slack=-2.0), "slack is -2.0: the tether would be"),
        "slack in words": (lambda: TetherDynamic().initialize(slack="some"), r"slack is 'some'; it must be a number"),
        "nodes": (lambda: TetherDynamic().initialize(positions=np.zeros((3, 3))), r"it must be \(21, 3\)"),
        "half of nodes": (lambda: TetherDynamic().initialize(velocities=np.zeros((21, 3))), "without their positions"),
        "nodes at rest": (lambda: TetherQuasiSteady().initialize(positions=np.zeros((21, 3))),
            "TetherQuasiSteady is always in equilibrium"),
        "far nodes": (lambda: TetherDynamic().initialize(positions=np.full((21, 3), np.inf)), "not finite"),
        "flight": (lambda: running().fly(np.zeros((3, 4)), 0.02), rf"shape \(3, 4\); it must be \(steps, {COUNT}\)"),
        "rows": (lambda: running().fly(np.zeros((3, COUNT)), 0.02, every=-1),
            "every is -1; it must be a whole number of at least 0"),
        "what to do": (lambda: running().fly(np.zeros((3, COUNT)), 0.02, on_refusal="ignore"),
            "on_refusal is 'ignore'; it must be one of 'raise', 'stop', 'skip'"),
        "state": (lambda: running().set_state(np.zeros(3)), r"state has the shape \(3,\)"),
        "material": (lambda: tether_of("rope", 0.01), "material is 'rope'; it must be one of dyneema_sk75"),
        "material in millimetres": (lambda: tether_of("steel", 10), r"diameter is 10 m \(4 mm are 0\.004\): with it"),
        "diameter in millimetres": (lambda: Tether().with_diameter(8),
            r"diameter is 8 m \(4 mm are 0\.004\): with it axial_stiffness is 2458"),
        "diameter in words": (lambda: Tether().with_diameter("8 mm"), "diameter is '8 mm'; it must be at least"),
        "diameter of nothing": (lambda: Tether().with_diameter(0.0), "diameter is 0.0; it must be at least 1e-06 m"),
        "elevation in degrees": (lambda: kite_at(30, 0.0, 500.0), "elevation is 30; .* at most pi/2 rad: .*degrees"),
        "elevation of nothing": (lambda: kite_at(np.nan, 0.0, 500.0), "elevation is nan; it must be at least -pi/2"),
        "number as a text": (lambda: Tether(diameter="0.004"), "diameter is '0.004'; it must be at least 1e-06 m"),
        "half a release": (lambda: running().step(0.02, release=0.5), "release is 0.5; it must be true or false"),
        "release of a flight": (lambda: running().fly(inputs_along(3, 0.02, release=[0.0, 1.0, 2.0]), 0.02),
            "release is 2; it must be true or false"),
        "hole in a log": (lambda: inputs_along(3, 0.02, kite=HOLE),
            "kite is nan in row 1, column 1, counted from 0; it must be a finite number"),
        "path": (lambda: MovingEnd(lambda t: (t, t)).at(1.0), r"position of the moving end at 1.0 s has the shape \(2,\)"),
        "paths": (lambda: inputs_along(2, 0.02, kite=MovingEnd(lambda t: t)), "must be"),
    },
    StepRefused: {
        "nan": (lambda: running().step(0.02, (np.nan, 0, 0)), r"kite_position\[1\] is nan"),
        "infinite wind": (lambda: running().step(0.02, wind_velocity=(0, 0, np.inf)), r"wind_velocity\[3\]"),
        "no time": (lambda: running().step(0.0), "communication step is 0.0 s; it must be greater than 0"),
        "back in time": (lambda: running().step(-0.02), "must be greater than 0"),
        "positions in millimetres": (lambda: TetherQuasiSteady(**SOFT).initialize(FAR, wind_velocity=(1e6, 0.0, 0.0)),
            r"no equilibrium was found between the given ends, 9.84886e\+08 m apart; check .* in m, .*length 505.0 m"),
        "fast start of a free kite": (lambda: TetherDynamicFree().initialize((300.0, 0.0, 400.0), (0.0, 2e9, 0.0)),
            r"the input kite_velocity\[2\] at the start is 2000000000.0; it must be a finite number, at most 1e\+09"),
    },
}  # fmt: skip


@pytest.mark.parametrize(("error", "name"), [(error, name) for error, each in WRONG.items() for name in each])
def test_is_refused_in_words(error, name):
    wrong, words = WRONG[error][name]
    with pytest.raises(error, match=words):
        wrong()


# --- systems


ROPE = Tether(segments=3, initial_length=10.1)
POINTS = [Point("pod", (0.0, 0.0, 0.0)), Point("left", (-2.0, 0.0, 9.8)), Point("right", (2.0, 0.0, 9.8))]
LINES = [Line("a", "pod", "left", ROPE), Line("b", "pod", "right", ROPE)]


def started(ratio=1.0):
    system = TetherSystem(POINTS, LINES, winches=[SharedWinch("drum", {"a": ratio, "b": -1.0})])
    system.initialize()
    return system


WRONG_OF_SYSTEMS = {
    "a line for lines": (lambda: TetherSystem(POINTS, LINES[0]), "lines is Line(name='a'"),
    "no lines": (lambda: TetherSystem(POINTS, None), "lines is None; it must be a sequence of Line"),
    "a dict of points": (lambda: TetherSystem({"pod": 1}, LINES), "points is {'pod': 1}; it must be a sequence of Point"),
    "a winch for winches": (lambda: TetherSystem(POINTS, LINES, winches=SharedWinch("drum", {"a": 1.0})),
        "it must be a sequence of SharedWinch"),
    "a dict for a ground": (lambda: TetherSystem(POINTS, LINES, ground={"contact": "flat"}),
        "ground is {'contact': 'flat'}; it must be a Ground, as in TetherSystem(..., ground=Ground())"),
    "a speed for speeds": (lambda: started().step(0.02, reel_out_speeds=1.0), "reel_out_speeds is 1.0; it must be a dict"),
    "a list of releases": (lambda: started().step(0.02, releases=["a"]), "releases is ['a']; it must be a dict"),
    "positions at the start": (lambda: started().initialize(positions=[(0.0, 0.0, 1.0)]), "positions is [(0.0, 0.0, 1.0)]"),
    "forces at the start": (lambda: started().initialize(winch_forces=3.0), "winch_forces is 3.0; it must be a dict"),
    "half a release": (lambda: started().step(0.02, releases={"a": 0.5}), "a.release is 0.5; it must be true or false"),
    "half a release in a flight": (lambda: started().fly(2, 0.02, releases={"a": [0.0, 2.0]}),
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
    "a wind for winds": (lambda: started().step(0.02, wind_at=np.zeros((11, 3))),
        "; it must be a dict by the names of points or lines"),
    "a state of other ratios": (lambda: started().set_state(started(2.0).get_state()),
        "state belongs to another system: its points, lines,"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG_OF_SYSTEMS)
def test_of_systems_it_is_refused_in_words(case):
    wrong, says = WRONG_OF_SYSTEMS[case]
    with pytest.raises((TypeError, ValueError), match=re.escape(says)):
        wrong()


def test_a_refused_step_changes_nothing():
    refused, twin = started(), started()
    for wrong in ({"reel_out_speeds": 1.0}, {"releases": {"a": 0.5}}, {"positions": [(0.0, 0.0, 1.0)]}):
        with pytest.raises((TypeError, ValueError)):
            refused.step(0.02, **wrong)
    one, other = (each.step(0.02, releases={"a": np.True_}) for each in (refused, twin))
    assert np.array_equal(one.points["left"].force, other.points["left"].force)
    assert one.lines["a"].broken
    assert TetherSystem(POINTS, LINES, ground=Ground()).initialize().lines["a"].broken == 0
