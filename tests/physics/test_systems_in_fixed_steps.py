"""Systems with a `fixed_step`, of which some winches are told a force.

held ends, slack and taut:        kinetic + elastic energy + that of weight never exceeds that of the start
a smooth flight of two winches:   order 2 or 1 to the adaptive solution (which `test_systems.py` compares with DOP853)
random networks, without air:     each step of backward Euler solves the equations of nodes and drums (`random_drums.py`)

One line: `test_one_line_of_a_system.py`.
"""

from dataclasses import replace

import numpy as np
import pytest

from networks import Network
from random_drums import left, random_drums, started
from random_systems import random_network
from solvers import bounded_flight, fixed
from tetherfmu import Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch
from tetherfmu.runtime.limits import COARSE_WORK, ITERATION_BUDGET, LAST_ITERATIONS, STAGES, WORST_WORK

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # drums at the extremes
WIND = (8.0, 1.0, 0.0)


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


def slack_line_beside_a_hoist(**solver):
    """System of a long, stiff and undamped slack line, straight, and of a load on a winch that is told a force, started."""
    hard = Tether(segments=300, initial_length=600.0, axial_stiffness=1e7, axial_damping=0.0)
    points = [Point("low", (0.0, 0.0, 0.0)), Point("high", (300.0, 0.0, 400.0)), Point("load", (0.0, 0.0, -9.9), mass=40.0)]
    drum = Winch(winch_control="force", winch_mass=30.0)
    lines = [Line("hard", "low", "high", hard), Line("rope", "low", "load", Tether(4, 10.0), 0.0, drum)]
    system = TetherSystem(points, lines, solver=Solver(initial_shape="straight", **solver))
    system.initialize((20.0, 0.0, 0.0))
    return system


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


def test_fixed_steps_are_hurried_beyond_their_budget_and_refused_beyond_twice():
    """That of the segments of all lines, as the sentence says."""
    system = slack_line_beside_a_hoist(fixed_step=1e-3)
    share, forces = ITERATION_BUDGET // 304, {"winch_forces": {"rope": 300.0}}
    with pytest.raises(StepRefused, match=rf"more than {share} iterations .*fixed_step 0\.001 s"):
        system.step(10.0, **forces)
    before = system.counters["iterations"]
    system.step(1.0, **forces)
    spent = system.counters["iterations"] - before
    assert system.counters["steps"] == 1000
    assert STAGES * share < spent <= STAGES * share + WORST_WORK + LAST_ITERATIONS * 1000
    assert any("was ended at its bound on factorizations" in each for each in system.implausible)


def hoist(solver, drum):
    """Node positions and lengths [m] after 1 s of a load of two bodies on two winches, from equilibrium, without jumps."""
    rope = {"axial_stiffness": 2e4, "axial_damping": 40.0}
    points = [Point("port", (-6.0, 0.0, 20.0)), Point("starboard", (6.0, 0.0, 20.0))]
    points += [Point("left", mass=40.0), Point("right", mass=60.0)]
    ropes = {"a": ("port", "left"), "b": ("starboard", "right")}
    lines = [Line(name, *ends, Tether(4, 10.0, **rope), 0.0, drum) for name, ends in ropes.items()]
    lines.append(Line("bar", "left", "right", Tether(2, 5.0, **rope)))
    system = TetherSystem(points, lines, solver=solver)
    outputs = system.initialize(WIND)
    balance = {name: outputs.lines[name].ground_tension for name in ropes}
    for time in 0.02 * np.arange(50):
        more = time**3 / (1.0 + time * time)  # begins without velocity and acceleration
        forces = {"a": balance["a"] + 60.0 * more, "b": balance["b"] - 50.0 * more}
        outputs = system.step(0.02, winch_forces=forces, loads={"left": (0.0, 20.0 * more, 0.0)})
    assert system.counters["rejections"] == 0 or solver.fixed_step == 0.0
    lengths = [outputs.lines[name].tether_length for name in ropes]
    assert np.abs(np.subtract(lengths, 10.0)).min() > 0.005
    return np.concatenate([*map(np.ravel, system.positions.values()), lengths])


@pytest.mark.parametrize("drum", [{"winch_mass": 30.0, "winch_damping": 20.0}, {"winch_damping": 200.0}, {}])
def test_orders_of_a_hoist(drum):
    """Slopes over 20, 10 and 5 ms, to the adaptive solver at 1e-9: 1.9 to 2 (ends at 1e-5 of a segment), and 0.98 to 1."""
    winch = Winch(winch_control="force", **drum)
    exact, steps = hoist(Solver(relative_tolerance=1e-9), winch), np.array((0.02, 0.01, 0.005))
    for method, order, largest in (("second_order", 2.0, 1e-5), ("backward_euler", 1.0, 0.02)):
        errors = [np.abs(hoist(fixed(h, method), winch) - exact).max() for h in steps]
        assert errors[0] < largest
        if drum or order == 1.0:  # a bare drum rings with the rope that leaves it, 10 g, which no such step resolves
            assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.1)


def test_backward_euler_solves_the_equations_of_random_networks():
    """Lines by force, speed, length in loops; iterations end with moves of 1e-6 of a segment, and converge quadratically."""
    found, parted = [], 0
    for seed in range(60):
        rng = np.random.default_rng((3, seed))
        network, told = random_drums(rng)
        h = float(rng.choice((0.002, 0.01, 0.05)))
        system = started(network, told, fixed(h, "backward_euler"))
        for number in range(10):
            rest = left(network, told, system, number, h)
            parted += rest is None
            found += [] if rest is None else [rest]
    assert parted < 60  # of 600
    assert np.max(found) < 1e-5


def test_second_order_flies_random_networks():
    """Stiff and undamped, with drums of all kinds: nothing is refused, all numbers are finite, the work is bounded."""
    for seed in range(60):
        rng = np.random.default_rng((4, seed))
        network, told = random_drums(rng)
        h = float(rng.choice((0.002, 0.01, 0.05)))
        system = started(network, told, fixed(h, "second_order"))
        bounded_flight(system, h, lambda _, told=told: told)
