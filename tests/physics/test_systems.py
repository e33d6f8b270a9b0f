"""Systems of tethers: lines between points in one step.

trees, loops, drums:   the equations of `networks.py`, solved by DOP853
one line:              `test_one_line_of_a_system.py`;   momentum and energy: `test_random_systems.py`
"""

import numpy as np
import pytest

from networks import Network
from of_systems import assert_continues, unexplained
from tetherfmu import Environment, Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch
from tetherfmu.runtime.layout import TETHER_LENGTH, WINCH_SPEED

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


def y_lines(winches=None, **speeds):
    """Main line from the winch to the knot, and two arms, one of which begins at its kite."""
    winches = winches or {}
    ends = {"main": ("winch", "knot", MAIN), "a": ("knot", "left", ARM), "b": ("right", "knot", ARM)}
    return [Line(name, *each, speeds.get(name, 0.0), winches.get(name, Winch())) for name, each in ends.items()]


def straight_motions(points):
    """Motions of the driven points at constant velocity, which driven ends follow exactly."""

    def motion(point):
        return lambda time: (np.add(point.position, time * np.array(point.velocity)), np.array(point.velocity))

    return {point.name: motion(point) for point in points if point.is_driven}


def drive(motions, times):
    """Motions of the driven points at the start of each step, as keyword arguments of `fly`."""
    ways = {name: [motion(time) for time in times] for name, motion in motions.items()}
    return {
        "positions": {name: np.array([x for x, _ in way]) for name, way in ways.items()},
        "velocities": {name: np.array([v for _, v in way]) for name, way in ways.items()},
    }


def at_time(motions, time):
    """The same at a time, as keyword arguments of `step`."""
    driven = {name: motion(time) for name, motion in motions.items()}
    return {what: {name: each[k] for name, each in driven.items()} for k, what in enumerate(("positions", "velocities"))}


def flown(network, steps, **given):
    """Nodes after each step of the system of a network, lengths and speeds of its drums, and those of its equations."""
    system = TetherSystem(network.points, network.lines, network.environment, TIGHT)
    system.initialize(network.wind, loads=network.loads)
    times = STEP * np.arange(steps + 1)
    wanted = network.integrate(network.state(system.positions, system.velocities), times)
    nodes = np.array([network.unpacked(time, y)[0] for time, y in zip(times[1:], wanted, strict=True)])
    flight = system.fly(steps, STEP, **drive(network.motions, times[:-1]), **given)
    found = np.array([network.gathered({name: each[k] for name, each in flight.positions.items()}) for k in range(steps)])
    drums = [flight.outputs[each.name][:, at] for at in (TETHER_LENGTH, WINCH_SPEED) for each in network.on_drums]
    return found, nodes, np.reshape(drums, (-1, steps)).T, wanted[:, 6 * len(network.free) :]


TRIANGLE = [
    Point("top", (0.0, 0.0, 60.0), (2.0, 0.0, 1.0)),
    Point("left", (-20.0, 0.0, 25.0), (0.0, 2.0, 0.0), mass=5.0),
    Point("right", (20.0, 1.0, 25.0), (0.0, -2.0, 0.0), mass=3.0),
]
SIDE = Tether(segments=4, initial_length=39.5, **SOFT)
SIDES = [Line(*each, SIDE) for each in (("a", "top", "left"), ("b", "left", "right"), ("c", "right", "top"))]
LOADS = {"left": np.array((-300.0, 0.0, -400.0)), "right": np.array((300.0, 30.0, -400.0))}
DRUMS = {  # with mass at the ground and on the knot, without at a kite
    "main": Winch(winch_control="force", winch_mass=8.0, winch_damping=20.0),
    "a": Winch(winch_control="force", winch_mass=5.0),
    "b": Winch(winch_control="force", winch_damping=150.0),
}
FORCES = {"main": 600.0, "a": 300.0, "b": 250.0}
NETWORKS = {  # points, lines, loads, winch forces, and the error [m]: 1e-8 of a segment of 13 m in each step
    "tree": (Y_POINTS, y_lines(main=0.3, b=0.2), {}, {}, 1e-6),
    # with the rate of the mass left out of the load's share it is 3e-7
    "point whose mass grows fast": (Y_POINTS, y_lines(main=2.0, b=1.0), {"knot": np.array((300.0, 0.0, 0.0))}, {}, 3e-8),
    "triangle": (TRIANGLE, SIDES, LOADS, {}, 1e-6),
    # a point whose mass grows by the forces of one line only is wrong by 2e-7
    "drums": (Y_POINTS, y_lines(DRUMS), {"knot": np.array((10.0, 20.0, -30.0))}, FORCES, 1e-7),
}


@pytest.mark.parametrize("name", NETWORKS)
def test_networks_move_as_their_equations_say(name):
    points, lines, loads, forces, within = NETWORKS[name]
    constant = {name: (lambda _, force=force: force) for name, force in forces.items()}
    network = Network(points, lines, AIR, WIND, straight_motions(points), loads, constant)
    more = {"winch_forces": forces} if forces else {}
    found, wanted, drums, wanted_drums = flown(network, 12 if forces else 30, loads=loads, **more)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=within)
    assert np.ptp(wanted[:, network.free], axis=0).max() > 0.1  # it moves
    np.testing.assert_allclose(drums, wanted_drums, rtol=0, atol=1e-6)
    assert np.all(np.abs(drums[-1]) > 0.1)  # they turn


@pytest.mark.parametrize("winches", [{}, DRUMS], ids=["reel at a speed", "have drums"])
def test_energy_comes_from_what_is_accounted_for(winches):
    """By the trapezoidal rule; its error falls with the square of the step, but for what the tolerance leaves."""
    motions, given, left = straight_motions(Y_POINTS), {"loads": {"knot": (60.0, 10.0, 120.0)}}, []
    for step in (0.004, 0.002):
        system = TetherSystem(Y_POINTS, y_lines(winches, main=0.3), solver=TIGHT)
        system.initialize(WIND, **given, winch_forces=FORCES if winches else None)
        system.step(step, **at_time(motions, 0.0), **given)  # the powers of the start are those of ends at rest

        def inputs(time, step=step):
            return at_time(motions, time + step) | given

        residual, exchanged = unexplained(system, step, round(1.0 / step), inputs)
        left.append(abs(residual))
    assert left[1] < 0.35 * left[0]
    assert left[1] < 5e-4 * exchanged


def test_a_flight_and_a_state_go_on_to_the_bit():
    load, motions = {"knot": (5.0, 0.0, 0.0)}, straight_motions(Y_POINTS)
    system, other = (TetherSystem(Y_POINTS, y_lines(main=0.1)) for _ in range(2))
    system.initialize(WIND)
    other.set_state(system.get_state())

    outputs = assert_continues(system, lambda k: at_time(motions, STEP * k) | {"loads": load}, 0, 20)
    flight = other.fly(20, STEP, **drive(motions, STEP * np.arange(20)), loads=load, every=5)
    assert np.array_equal(system.get_state(), other.get_state())
    assert flight.positions["main"].shape == (4, 6, 3)
    assert np.array_equal(flight.points["knot"].force[-1], outputs[-1].points["knot"].force)
    with pytest.raises(ValueError, match="another system"):
        TetherSystem([Y_POINTS[0], Point("knot", mass=3.0), *Y_POINTS[2:]], y_lines()).set_state(system.get_state())


BAD_STEPS = {
    "position": ({"positions": {"left": (np.nan, 0.0, 0.0)}}, r"left\.position\[1\] is nan"),
    "velocity": ({"velocities": {"right": (0.0, 1e300, 0.0)}}, r"right\.velocity\[2\] is 1e\+300"),
    "load": ({"loads": {"knot": (0.0, 0.0, np.inf)}}, r"knot\.load is"),
    "step": ({"step": 0.0}, "communication step is 0.0 s"),
    "reeling": ({"reel_out_speeds": {"a": -5e3}}, "the line a: the reel_out_speed -5000.0 m/s"),
    "name": ({"positions": {"knot": (0.0, 0.0, 0.0)}}, "no position of a driven point with the name 'knot'"),
    "shape": ({"loads": {"knot": (0.0, 0.0)}}, r"knot\.load has the shape \(2,\)"),
    "length": ({"winch_lengths": {"main": -5.0}}, "the line main: .*winch_length", "length"),
    "force": ({"winch_forces": {"main": np.nan}}, r"main\.winch_force is nan", "force"),
    "push": ({"winch_forces": {"main": -100.0}}, "the line main: .*winch_force", "force"),
    "winch": ({"winch_lengths": {"rope": 5.0}}, "no winch_length of a line or a winch with the name 'rope'", "length"),
    "overflow": ({"loads": {"knot": (1e200, 0.0, 0.0)}}, "must be finite and at most|overflow|budget|tolerance"),
}


@pytest.mark.parametrize("case", BAD_STEPS)
def test_a_refused_step_changes_nothing(case):
    given, words, *control = BAD_STEPS[case]
    system = TetherSystem(Y_POINTS, y_lines({"main": Winch(*control)}))
    system.initialize(WIND, winch_forces={"main": 500.0} if "force" in control else None)
    system.step(STEP)
    before = system.get_state()
    with pytest.raises(ValueError, match=words):
        system.step(**{"step": STEP, **given})
    assert np.array_equal(system.get_state(), before)
    system.step(STEP)


def test_a_refused_start_names_its_line():
    system = TetherSystem(Y_POINTS, y_lines({"main": Winch(winch_control="force", longest_length=50.0)}))
    with pytest.raises(StepRefused, match=r"the line main: .*longest_length"):
        system.initialize(WIND)


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
