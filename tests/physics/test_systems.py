"""Systems of tethers: lines between points in one step.

trees and loops:   the equations of `networks.py`, solved by DOP853
one line:          `test_one_line_of_a_system.py`;   momentum and energy: `test_random_systems.py`
"""

import numpy as np
import pytest

from networks import Network
from tetherfmu import Environment, Line, Point, Solver, StepRefused, Tether, TetherSystem

STEP = 0.02
WIND = np.array((8.0, 1.0, 0.0))
AIR = Environment()
TIGHT = Solver(relative_tolerance=1e-8)
SOFT = {"axial_stiffness": 20000.0, "axial_damping": 40.0}  # so that an explicit method needs few steps
MAIN = Tether(segments=5, initial_length=98.0, **SOFT)
ARM = Tether(segments=3, initial_length=39.0, **SOFT)
KNOT = Point("knot", (3.0, 1.0, 100.0), mass=2.0)
Y_POINTS = [
    Point("winch", (0.0, 0.0, 0.0)),
    KNOT,
    Point("left", (-23.0, 0.0, 131.0), (0.0, 3.0, 1.0)),
    Point("right", (26.0, 0.0, 131.0), (0.0, -4.0, 2.0)),
]


def y_lines(**speeds):
    """Main line from the winch to the knot, and two arms, one of which begins at its kite."""
    ends = {"main": ("winch", "knot", MAIN), "a": ("knot", "left", ARM), "b": ("right", "knot", ARM)}
    return [Line(name, *each, reel_out_speed=speeds.get(name, 0.0)) for name, each in ends.items()]


def straight_motions(points):
    """Motions of the driven points at constant velocity, which driven ends follow exactly."""

    def motion(point):
        return lambda time: (np.add(point.position, time * np.array(point.velocity)), np.array(point.velocity))

    return {point.name: motion(point) for point in points if point.is_driven}


def drive(system, motions, times):
    """Motions of the driven points at the start of each step, as keyword arguments of `fly`."""
    ways = {name: [motion(time) for time in times] for name, motion in motions.items()}
    return {
        "positions": {name: np.array([x for x, _ in way]) for name, way in ways.items()},
        "velocities": {name: np.array([v for _, v in way]) for name, way in ways.items()},
    }


def flown(network, steps, **given):
    """Node positions after each step of the system of a network, and those of its equations."""
    system = TetherSystem(network.points, network.lines, network.environment, TIGHT)
    system.initialize(network.wind, loads=network.loads)
    times = STEP * np.arange(steps + 1)
    wanted = network.solve(system, times[1:])
    flight = system.fly(steps, STEP, **drive(system, network.motions, times[:-1]), **given)
    found = np.array([network.gathered({name: each[k] for name, each in flight.positions.items()}) for k in range(steps)])
    return found, wanted[:, 0]


TRIANGLE = [
    Point("top", (0.0, 0.0, 60.0), (2.0, 0.0, 1.0)),
    Point("left", (-20.0, 0.0, 25.0), (0.0, 2.0, 0.0), mass=5.0),
    Point("right", (20.0, 1.0, 25.0), (0.0, -2.0, 0.0), mass=3.0),
]
SIDE = Tether(segments=4, initial_length=39.5, **SOFT)
SIDES = [Line(*each, SIDE) for each in (("a", "top", "left"), ("b", "left", "right"), ("c", "right", "top"))]
LOADS = {"left": np.array((-300.0, 0.0, -400.0)), "right": np.array((300.0, 30.0, -400.0))}
NETWORKS = {  # points, lines, loads, and the error [m]: 1e-8 of a segment of 13 m in each step
    "tree": (Y_POINTS, y_lines(main=0.3, b=0.2), {}, 1e-6),
    # with the rate of the mass left out of the load's share it is 3e-7
    "point whose mass grows fast": (Y_POINTS, y_lines(main=2.0, b=1.0), {"knot": np.array((300.0, 0.0, 0.0))}, 3e-8),
    "triangle": (TRIANGLE, SIDES, LOADS, 1e-6),
}


@pytest.mark.parametrize("name", NETWORKS)
def test_networks_move_as_their_equations_say(name):
    points, lines, loads, within = NETWORKS[name]
    network = Network(points, lines, AIR, WIND, straight_motions(points), loads)
    found, wanted = flown(network, 30, loads=loads)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=within)
    assert np.ptp(wanted[:, network.free], axis=0).max() > 0.1  # it moves


def test_many_steps_in_one_call_equal_single_steps():
    motions = straight_motions(Y_POINTS)
    systems = [TetherSystem(Y_POINTS, y_lines(main=0.1)) for _ in range(2)]
    for system in systems:
        system.initialize(WIND)
    given = drive(systems[0], motions, STEP * np.arange(20))
    flight = systems[0].fly(20, STEP, **given, every=5)
    for k in range(20):
        rows = {what: {name: each[k] for name, each in of.items()} for what, of in given.items()}
        outputs = systems[1].step(STEP, **rows)
    assert np.array_equal(systems[0].get_state(), systems[1].get_state())
    assert flight.positions["main"].shape == (4, 6, 3)
    assert np.array_equal(flight.points["knot"].force[-1], outputs.points["knot"].force)


def test_a_state_is_continued_to_the_bit():
    load = {"knot": (5.0, 0.0, 0.0)}
    system = TetherSystem(Y_POINTS, y_lines())
    system.initialize(WIND)
    still = dict.fromkeys(("left", "right"), np.zeros(3))
    system.fly(10, STEP, velocities=still, every=0)
    state = system.get_state()
    system.fly(10, STEP, loads=load, every=0)
    end = system.get_state()
    other = TetherSystem(Y_POINTS, y_lines())
    other.set_state(state)
    other.fly(10, STEP, loads=load, every=0)
    assert np.array_equal(other.get_state(), end)
    with pytest.raises(ValueError, match="another system"):
        TetherSystem([Y_POINTS[0], Point("knot", mass=3.0), *Y_POINTS[2:]], y_lines()).set_state(state)


BAD_STEPS = {
    "position": ({"positions": {"left": (np.nan, 0.0, 0.0)}}, r"left\.position\[1\] is nan"),
    "velocity": ({"velocities": {"right": (0.0, 1e300, 0.0)}}, r"right\.velocity\[2\] is 1e\+300"),
    "load": ({"loads": {"knot": (0.0, 0.0, np.inf)}}, r"knot\.load is"),
    "step": ({"step": 0.0}, "communication step is 0.0 s"),
    "reeling": ({"reel_out_speeds": {"a": -5e3}}, "the line a: the reel_out_speed -5000.0 m/s"),
    "name": ({"positions": {"knot": (0.0, 0.0, 0.0)}}, "no position of a driven point with the name 'knot'"),
    "shape": ({"loads": {"knot": (0.0, 0.0)}}, r"knot\.load has the shape \(2,\)"),
    "overflow": ({"loads": {"knot": (1e200, 0.0, 0.0)}}, "must be finite and at most|overflow|budget|tolerance"),
}


@pytest.mark.parametrize("case", BAD_STEPS)
def test_a_refused_step_changes_nothing(case):
    given, words = BAD_STEPS[case]
    system = TetherSystem(Y_POINTS, y_lines())
    system.initialize(WIND)
    system.step(STEP)
    before = system.get_state()
    with pytest.raises(ValueError, match=words):
        system.step(**{"step": STEP, **given})
    assert np.array_equal(system.get_state(), before)
    system.step(STEP)


def test_a_refused_flight_ends_before_the_step():
    system = TetherSystem(Y_POINTS, y_lines())
    system.initialize(WIND)
    way = np.zeros((10, 3))
    way[6] = np.nan
    with pytest.raises(StepRefused, match=r"step 7 of 10: .*winch\.position\[1\] is nan") as refusal:
        system.fly(10, STEP, positions={"winch": way})
    assert len(refusal.value.flown.positions["main"]) == 6
    assert system.step(STEP).points["knot"].position.shape == (3,)


CORNERS = [Point("a", (0.0, 0.0, 0.0)), Point("b", (9.0, 0.0, 0.0)), Point("c", mass=1.0)]
BAD_SYSTEMS = {
    "no line": (CORNERS, [], "at least one line"),
    "twice": ([*CORNERS, CORNERS[0]], [Line("l", "a", "b")], "name a is given twice"),
    "idle": (CORNERS, [Line("l", "a", "b")], "no line goes to the point c"),
    "unknown": (CORNERS, [Line("l", "a", "z")], "goes to the point z, which does not exist"),
}


@pytest.mark.parametrize("case", BAD_SYSTEMS)
def test_what_is_no_system_is_refused_in_words(case):
    points, lines, words = BAD_SYSTEMS[case]
    with pytest.raises(ValueError, match=words):
        TetherSystem(points, lines)


def test_wrong_records_are_refused_in_words():
    with pytest.raises(ValueError, match="from the point a to itself"):
        Line("l", "a", "a")
    with pytest.raises(ValueError, match=r"the point p is driven .* give its position"):
        Point("p")
    with pytest.raises(ValueError, match=r"the point p: mass is -1\.0; it must be"):
        Point("p", mass=-1.0)
    with pytest.raises(ValueError, match=r"p\.position is \(0, nan, 0\)"):
        Point("p", (0, np.nan, 0))
    with pytest.raises(ValueError, match="name of a line is 'main line'"):
        Line("main line", "a", "b")
    with pytest.raises(StepRefused, match="call initialize first"):
        TetherSystem(Y_POINTS, y_lines()).step(STEP)
