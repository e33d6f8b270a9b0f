"""Winches that are told a force, in systems with a `fixed_step`.

one line between driven points:   TetherDynamic, to the last bit, with the same work
a smooth flight of two winches:   order 2 or 1 to the adaptive solution (which `test_system_winches.py` compares with DOP853)
random networks, without air:     each step of backward Euler solves the equations of nodes and drums (`random_drums.py`)
"""

import numpy as np
import pytest

from random_drums import left, random_drums, started
from solvers import METHODS, fixed
from tetherfmu import Line, Point, Solver, Tether, TetherDynamic, TetherSystem, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # drums at the extremes
WIND = (8.0, 1.0, 0.0)
POINTS = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (60.0, 0.0, 80.0), (3.0, 1.0, 6.0))]
DRUMS = {
    "mass": {"winch_mass": 50.0, "winch_damping": 10.0},
    "no mass": {"winch_damping": 30.0},
    "no drum": {},
    "friction": {"winch_mass": 20.0, "winch_friction": 60.0},
    "friction, no mass": {"winch_friction": 60.0},
    "stops": {"winch_mass": 5.0, "shortest_length": 99.0, "longest_length": 101.5},
    "stops, no mass": {"shortest_length": 99.0, "longest_length": 101.5},
}


def both(tether, winch, solver):
    """The same line as a system and as a TetherDynamic, started."""
    single = TetherDynamic(tether, solver=solver, winch=winch)
    system = TetherSystem(POINTS, [Line("line", "ground", "kite", tether, 0.3, winch)], solver=solver)
    motion = {"kite_position": POINTS[1].position, "kite_velocity": POINTS[1].velocity}
    single.initialize(**motion, reel_out_speed=0.3, wind_velocity=WIND)
    system.initialize(WIND)
    return system, single


def assert_equal(system, single):
    """Motion, drum, work and warnings of both are the same."""
    found, wanted = system.outputs(), single.outputs()
    np.testing.assert_array_equal(system.positions["line"], single.positions)
    np.testing.assert_array_equal(system.velocities["line"], single.velocities)
    assert (found.lines["line"].tether_length, found.lines["line"].winch_speed) == (wanted.tether_length, wanted.winch_speed)
    assert system.counters == single.counters
    assert found.solver_iteration_limit == wanted.solver_iteration_limit
    said = "; ".join(system.implausible).replace("the line line: ", "").replace("its end at kite", "the kite end")
    assert said.replace("kite.", "kite_") == "; ".join(single.implausible)


@pytest.mark.parametrize("segments", [1, 5])
@pytest.mark.parametrize("drum", DRUMS)
@pytest.mark.parametrize("method", METHODS)
def test_one_line_is_the_dynamic_tether(method, drum, segments):
    winch = Winch(winch_control="force", **DRUMS[drum])
    system, single = both(Tether(segments=segments, initial_length=100.2), winch, fixed(0.01, method))
    for time in 0.02 * np.arange(100):
        x = np.add(POINTS[1].position, (3.0 * np.sin(time), time, 2.0 * np.sin(3.0 * time)))
        v = (3.0 * np.cos(time), 1.0, 6.0 * np.cos(3.0 * time))
        force = 300.0 + 200.0 * np.sin(4.0 * time)
        single.step(0.02, kite_position=x, kite_velocity=v, winch_force=force)
        system.step(0.02, {"kite": x}, {"kite": v}, winch_forces={"line": force})
    assert_equal(system, single)
    assert system.counters["steps"] == 200


@pytest.mark.parametrize("method", METHODS)
def test_hard_steps_are_bounded_as_those_of_a_tether(method):
    """Slack, stiff and undamped in a hurricane, the drum reeled in at once: parts, some of which do not come to rest."""
    tether = Tether(segments=60, initial_length=140.0, axial_stiffness=1e7, axial_damping=0.0)
    winch = Winch(winch_control="force", winch_mass=0.1, winch_friction=5.0, shortest_length=20.0)
    system, single = both(tether, winch, fixed(0.1, method))
    most = 0
    for k in range(10):
        wind, force = (60.0, 30.0 * (-1) ** k, 0.0), 4000.0 * (k % 2)
        single.step(0.1, wind_velocity=wind, winch_force=force)
        before = system.counters["iterations"]
        system.step(0.1, wind_velocity=wind, winch_forces={"line": force})
        most = max(most, system.counters["iterations"] - before)
        assert_equal(system, single)
    assert 100 < most <= system.outputs().solver_iteration_limit == system.most_factorizations == single.most_factorizations


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
        for _ in range(10):
            before = system.counters["iterations"]
            outputs = system.step(h, **told)
            assert system.counters["iterations"] - before <= outputs.solver_iteration_limit == system.most_factorizations
        assert all(np.isfinite(each).all() for each in system.positions.values())
