"""Systems with a `fixed_step`: the properties of a single tether, of all lines and points at once.

a smooth flight of a Y:           order 2 or 1 to the adaptive solution
held ends, slack and taut:        kinetic + elastic energy + that of weight never exceeds that of the start
a free point at rest:             weights and load in balance
"""

from dataclasses import replace

import numpy as np
import pytest

from networks import Network
from random_systems import random_network
from tetherfmu import Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch
from tetherfmu.runtime.limits import COARSE_WORK, ITERATION_BUDGET, LAST_ITERATIONS, STAGES, WORST_WORK

WIND = (8.0, 1.0, 0.0)
quiet = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # random systems at the extremes


def circle(centre, radius, angle, rate):
    """Position and velocity on a horizontal circle: angle [rad] and its rate [rad/s] now."""
    c, s = np.cos(angle), np.sin(angle)
    return np.add(centre, (radius * c, radius * s, 0.0)), radius * rate * np.array((-s, c, 0.0))


def y_flight(solver):
    """Node positions after 2 s of a Y whose arms fly circles from rest, under a load; from equilibrium, without jumps."""
    soft = {"axial_stiffness": 20000.0, "axial_damping": 40.0}
    main, arm = Tether(segments=5, initial_length=98.0, **soft), Tether(segments=3, initial_length=39.0, **soft)
    ends = {"left": ((-28.0, 0.0, 131.0), 1.0), "right": ((21.0, 0.0, 131.0), -1.3)}
    points = [Point("winch", (0.0, 0.0, 0.0)), Point("knot", mass=2.0)]
    points += [Point(name, np.add(centre, (5.0, 0.0, 0.0))) for name, (centre, _) in ends.items()]
    lines = [Line("main", "winch", "knot", main), Line("a", "knot", "left", arm), Line("b", "right", "knot", arm)]
    system = TetherSystem(points, lines, solver=solver)
    system.initialize(WIND, loads={"knot": (20.0, 5.0, -10.0)})
    for time in 0.02 * np.arange(100):
        square = time * time  # an angle t^3/(t^2 + 1) begins without velocity and acceleration
        angle, rate = time * square / (square + 1.0), square * (square + 3.0) / (square + 1.0) ** 2
        now = {name: circle(centre, 5.0, part * angle, part * rate) for name, (centre, part) in ends.items()}
        positions, velocities = ({name: motion[k] for name, motion in now.items()} for k in range(2))
        system.step(0.02, positions=positions, velocities=velocities)
    assert system.counters["rejections"] == 0 or solver.fixed_step == 0.0
    return np.vstack(list(system.positions.values()))


@quiet
@pytest.mark.parametrize(("method", "order", "largest"), [("second_order", 2.0, 1e-4), ("backward_euler", 1.0, 0.03)])
def test_order_of_a_y(method, order, largest):
    """Against the adaptive solver at 1e-9. Observed slopes 1.97 and 0.99, errors at 20 ms 3.4e-5 m and 0.011 m."""
    exact = y_flight(Solver(relative_tolerance=1e-9))
    steps = np.array((0.02, 0.01, 0.005, 0.0025))
    errors = [np.abs(y_flight(Solver(fixed_step=h, fixed_step_method=method)) - exact).max() for h in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.1)
    assert errors[0] < largest


def slack_network(seed):
    """A random network with held ends, without air: lines slack by up to a half, free points thrown; and a step [s]."""
    rng = np.random.default_rng(seed)
    network = random_network(rng)
    points = [
        Point(each.name, each.position, (0.0, 0.0, 0.0) if each.is_driven else 10.0 * rng.normal(size=3), mass=each.mass)
        for each in network.points
    ]
    at = {each.name: np.array(each.position) for each in points}
    lines = []
    for each in network.lines:
        length = float(np.linalg.norm(at[each.start] - at[each.end]) * rng.uniform(1.0, 1.5))
        lines.append(replace(each, tether=replace(each.tether, initial_length=length, drag_coefficient=0.0)))
    return Network(points, lines, network.environment, np.zeros(3)), float(rng.choice([0.1, 0.2, 0.5, 1.0]))


def energy_of(network, system):
    """Energy [J] of motion, of springs, of weight; a slack segment has its part of the stiffness."""
    x, v = network.gathered(system.positions), network.gathered(system.velocities)
    mass, free = network.masses(0.0), network.free
    stretch = np.linalg.norm(x[network.q] - x[network.p], axis=1) - network.rest
    spring = np.where(stretch < 0.0, network.slack[0], 1.0) * network.stiffness / network.rest
    kinetic = 0.5 * np.sum(mass[free, None] * v[free] ** 2)
    return kinetic + 0.5 * np.sum(spring * stretch**2) + network.environment.gravity * mass[free] @ x[free, 2]


@quiet
@pytest.mark.parametrize(("method", "seeds"), [("second_order", range(100)), ("backward_euler", range(40))])
def test_random_slack_systems_stay_within_their_energy(method, seeds):
    """Steps of 0.1 to 1 s; none is refused, and none does more work than the bound that the code has."""
    for seed in seeds:
        network, h = slack_network(seed)
        system = TetherSystem(
            network.points, network.lines, network.environment, Solver(fixed_step=h, fixed_step_method=method)
        )
        system.initialize()
        first = energy_of(network, system)
        for _ in range(10):
            done = system.counters["iterations"]
            system.step(h)
            assert energy_of(network, system) <= first + 1e-9 * abs(first), seed
            assert system.counters["iterations"] - done <= system.most_factorizations, seed
        for point in network.points:  # all lines at a point end at the same place
            ends = [system.positions[each.name][0 if each.start == point.name else -1] for each in network.lines
                    if point.name in (each.start, each.end)]  # fmt: skip
            np.testing.assert_array_equal(ends, [ends[0]] * len(ends))


@quiet
def test_a_load_on_a_free_point_comes_to_rest_in_balance():
    """Of the knot of a Y: tensions, half weights of its segments, its weight and the load add up to zero."""
    line = Tether(segments=4, initial_length=50.0, axial_damping=2000.0)
    held = {"a": (-30.0, 0.0, 40.0), "b": (30.0, 0.0, 40.0), "c": (0.0, 40.0, 30.0)}
    points = [Point("knot", (0.0, 0.0, 0.0), mass=5.0), *(Point(name, place) for name, place in held.items())]
    lines = [Line(f"to_{name}", name, "knot", line) for name in held]
    solver = Solver(fixed_step=0.5, fixed_step_method="backward_euler")
    system = TetherSystem(points, lines, solver=solver)
    system.initialize(loads={"knot": (0.0, 0.0, 0.0)})
    load = np.array((20.0, 10.0, -30.0))
    for _ in range(200):
        found = system.step(1.0, loads={"knot": load})
    weight = 9.81 * (5.0 + 3 * 50.0 * line.density * np.pi * line.diameter**2 / 4.0)
    held_up = sum(found.points[name].force for name in held)  # of the lines on the held points
    rest = held_up - load + (0.0, 0.0, weight)
    # a hundredth of the motion is left each 10 s; the half segments of the held ends count in their forces, too
    np.testing.assert_allclose(rest, 0.0, atol=1e-3)


@quiet
def test_steps_are_hurried_when_their_iterations_have_spent_the_budget_and_refused_beyond_it():
    """The budget is that of the segments of all lines, as the sentence says."""
    hard = Tether(segments=300, initial_length=600.0, axial_stiffness=1e7, axial_damping=0.0)
    points = [Point("low", (0.0, 0.0, 0.0)), Point("high", (300.0, 0.0, 400.0))]
    solver = Solver(initial_shape="straight", fixed_step=1e-3)
    system = TetherSystem(points, [Line("line", "low", "high", hard)], solver=solver)
    system.initialize((20.0, 0.0, 0.0))
    with pytest.raises(StepRefused, match=rf"more than {ITERATION_BUDGET // 300} iterations .*fixed_step 0\.001 s"):
        system.step(10.0)
    budget, before = STAGES * (ITERATION_BUDGET // 300), system.counters["iterations"]
    system.step(1.0)
    spent = system.counters["iterations"] - before
    assert system.counters["steps"] == 1000
    assert budget < spent <= budget + WORST_WORK + LAST_ITERATIONS * 1000
    assert any("was ended at its bound on factorizations" in each for each in system.implausible)


def slack_line_beside_a_hoist(**solver):
    """System of a long, stiff and undamped slack line, straight, and of a load on a winch that is told a force, started."""
    hard = Tether(segments=300, initial_length=600.0, axial_stiffness=1e7, axial_damping=0.0)
    points = [Point("low", (0.0, 0.0, 0.0)), Point("high", (300.0, 0.0, 400.0)), Point("load", (0.0, 0.0, -9.9), mass=40.0)]
    drum = Winch(winch_control="force", winch_mass=30.0)
    lines = [Line("hard", "low", "high", hard), Line("rope", "low", "load", Tether(4, 10.0), 0.0, drum)]
    system = TetherSystem(points, lines, solver=Solver(initial_shape="straight", **solver))
    system.initialize((20.0, 0.0, 0.0))
    return system


@quiet
def test_a_step_that_is_given_up_is_done_with_fixed_steps():
    """As that of a tether (`test_guards.py`): bit for bit with 40 000/304 fixed steps, told once; the next is adaptive."""
    system = slack_line_beside_a_hoist(relative_tolerance=1e-6)
    fixed = slack_line_beside_a_hoist(fixed_step=304.0 / COARSE_WORK)
    for each in (system, fixed):
        found = each.step(1.0, winch_forces={"rope": 300.0})
    for name in ("hard", "rope"):
        np.testing.assert_array_equal(system.positions[name], fixed.positions[name])
        np.testing.assert_array_equal(system.velocities[name], fixed.velocities[name])
        assert system.outputs().lines[name].winch_speed == found.lines[name].winch_speed
    assert found.lines["rope"].winch_speed > 0.1
    assert sum("was done with fixed steps of 0.0076 s" in each for each in system.implausible) == 1
    before = system.counters["steps"]
    system.step(1e-4)
    assert 0 < system.counters["steps"] - before < 100
