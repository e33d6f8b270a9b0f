"""Lines of systems that break and let go: a load that falls from its crane, one arm of a Y that breaks, winches.

free fall    x0 + v t + g t^2/2 of a load without drag that no line holds any more
Y            what is left pulls at the knot as a system without the broken arm does
"""

import numpy as np
import pytest

from of_systems import assert_continues
from solvers import ADAPTIVE, fixed, with_each_solver
from tetherfmu import Environment, Ground, Line, Point, StepRefused, Tether, TetherSystem, Winch

G = np.array((0.0, 0.0, -9.81))
NONE = Ground()
ROPE = {"axial_stiffness": 5e5, "axial_damping": 500.0}
pytestmark = pytest.mark.filterwarnings("ignore:.*presses its ends apart", "ignore:.*(backward|broke)")  # recoil


def crane(solver=ADAPTIVE, ground=NONE, **more):
    """A load of 500 kg on a rope of 12 m."""
    points = [Point("trolley", (0.0, 0.0, 20.0)), Point("load", None, mass=500.0)]
    rope = Line("rope", "trolley", "load", Tether(segments=4, initial_length=12.0, **ROPE), **more)
    system = TetherSystem(points, [rope], Environment(), solver, ground)
    system.initialize()
    return system


@with_each_solver(0.005)
def test_a_load_that_is_released_falls_freely(solver):
    system = crane(solver)
    first = system.step(0.02).points["load"]
    for _ in range(50):
        outputs = system.step(0.02, releases={"rope": True})
    fallen, time = outputs.points["load"], 1.0
    order_one = 0.5 * time * 0.005 * 9.81 if solver.fixed_step_method == 2 else 0.0  # of backward Euler
    assert fallen.position == pytest.approx(first.position + time * first.velocity + 0.5 * time**2 * G, abs=1e-6 + order_one)
    assert fallen.velocity == pytest.approx(first.velocity + time * G, abs=1e-6)
    assert outputs.lines["rope"].broken
    assert outputs.lines["rope"].break_time == pytest.approx(0.02)
    assert outputs.lines["rope"].kite_tension == 0.0
    rope = system.positions["rope"]
    assert rope[-1, 2] > fallen.position[2] + 3.0  # it springs up, and hangs from the trolley


@with_each_solver(0.005)
def test_a_load_that_is_released_lies_on_the_ground_at_the_end(solver):
    system = crane(solver, Ground(ground_contact="flat", ground_height=6.0))
    for _ in range(200):
        outputs = system.step(0.02, releases={"rope": True})
    load = outputs.points["load"]
    assert load.position[2] == pytest.approx(6.0, abs=0.05)
    assert np.linalg.norm(load.velocity) < 0.01


@pytest.mark.parametrize("control", ["speed", "force", "length"])
@pytest.mark.parametrize("solver", [ADAPTIVE, fixed(0.005, "second_order")])
def test_the_winch_of_a_released_line_reels_in_what_is_left(control, solver):
    drum = {"winch_mass": 50.0, "winch_damping": 200.0} if control == "force" else {}
    system = crane(solver, winch=Winch(winch_control=control, **drum))
    given = {"speed": {"reel_out_speeds": {"rope": -1.0}}, "force": {"winch_forces": {"rope": 300.0}}}.get(control)
    for k in range(150):
        asked = given or {"winch_lengths": {"rope": 12.0 - 0.02 * k}}
        outputs = system.step(0.02, releases={"rope": k > 0}, **asked)
    assert outputs.lines["rope"].tether_length < 11.0
    assert outputs.lines["rope"].winch_speed < -0.3
    assert outputs.points["load"].velocity[2] < -25.0


ENDS = {"main": "knot", "l": "left", "r": "knot"}  # of the lines


def y_system(arms, solver=ADAPTIVE, strong=1e9, **more):
    """A knot on a line from the ground, held by arms to the kites "left" and "right"."""
    kites = {"left": (-20.0, 0.0, 120.0), "right": (20.0, 0.0, 120.0)}
    points = [Point("winch", (0.0, 0.0, 0.0)), Point("knot", (0.0, 0.0, 97.0), mass=3.0)]
    points += [Point(name, kites[name]) for name in arms]
    lines = [Line("main", "winch", "knot", Tether(segments=5, initial_length=96.0, breaking_force=strong, **ROPE), **more)]
    forces, ends = {"left": 0.0, "right": 6000.0}, {"left": ("knot", "left"), "right": ("right", "knot")}
    for name in arms:
        arm = Tether(segments=3, initial_length=30.2, breaking_force=forces[name], **ROPE)
        lines.append(Line(name[0], *ends[name], arm))
    system = TetherSystem(points, lines, Environment(), solver)
    system.initialize()
    return system


def test_a_knot_goes_on_when_an_arm_breaks():
    system, broken = y_system(["left", "right"]), None
    for k in range(150):
        at_right = (20.0 + 0.02 * k, 0.0, 120.0)
        outputs = system.step(0.01, positions={"right": at_right}, velocities={"right": (2.0, 0.0, 0.0)})
        if outputs.lines["r"].broken and broken is None:
            broken = k
    assert broken is not None
    assert 0 < broken < 100
    assert outputs.lines["r"].peak_tension < 6000.0
    assert not outputs.lines["l"].broken
    assert not outputs.lines["main"].broken
    assert outputs.points["knot"].position[0] < -5.0  # the other arm draws it to its side
    assert (said := [each for each in system.implausible if "broke" in each])
    assert said[0].startswith("the line r: segment")


@pytest.mark.parametrize("solver", [ADAPTIVE, fixed(0.005, "second_order")])
def test_two_lines_break_one_after_the_other(solver):
    system = y_system(["left", "right"], solver, strong=9000.0)

    def inputs(k):
        ways = {name: (x, 0.0, 120.0 + 0.05 * k) for name, x in (("left", -20.0), ("right", 20.0))}
        return {"positions": ways, "velocities": dict.fromkeys(ways, (0.0, 0.0, 5.0))}

    outputs = assert_continues(system, inputs, 30, 70, 0.01)[-1]
    assert outputs.lines["r"].broken
    assert outputs.lines["r"].break_time < 0.99


@with_each_solver(0.005)
@pytest.mark.parametrize("name", ["main", "l", "r"])
def test_any_line_at_a_point_lets_go(solver, name):
    system = y_system(["left", "right"], solver)
    for k in range(50):
        outputs = system.step(0.01, releases={name: k >= 5})
    assert [line for line, each in outputs.lines.items() if each.broken] == [name]
    free = system.positions[name][-1]
    assert np.linalg.norm(free - outputs.points[ENDS[name]].position) > 1.0


def test_a_point_without_mass_cannot_be_released_from_its_last_line():
    points = [Point("a", (0.0, 0.0, 0.0)), Point("b", (9.0, 0.0, 1.0), mass=0.0)]
    system = TetherSystem(points, [Line("rope", "a", "b", Tether(segments=3, initial_length=10.0))])
    system.initialize()
    with pytest.raises(StepRefused, match="the line rope: release is true"):
        system.step(0.01, releases={"rope": True})
    assert not system.step(0.01, releases={"rope": False}).lines["rope"].broken


def test_states_and_flights_across_the_events():
    def inputs(k):
        motion = {"positions": {"right": (20.0 + 0.02 * k, 0.0, 120.0)}, "velocities": {"right": (2.0, 0.0, 0.0)}}
        return {**motion, "releases": {"l": k >= 110}}

    outputs = assert_continues(y_system(["left", "right"]), inputs, 10, 120, 0.01)[-1]
    assert outputs.lines["l"].broken
    assert outputs.lines["r"].broken
