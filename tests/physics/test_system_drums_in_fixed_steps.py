"""Winches that are told a force, in systems with a `fixed_step`.

a smooth flight of two winches:   order 2 or 1 to the adaptive solution (which `test_system_winches.py` compares with DOP853)
random networks, without air:     each step of backward Euler solves the equations of nodes and drums (`random_drums.py`)
"""

import numpy as np
import pytest

from random_drums import left, random_drums, started
from solvers import bounded_flight, fixed
from tetherfmu import Line, Point, Solver, Tether, TetherSystem, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # drums at the extremes
WIND = (8.0, 1.0, 0.0)


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
