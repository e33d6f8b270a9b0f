"""Fixed steps where the rope ends: a load that runs into its sheave, and a winch without mass that lets go, make no energy.

sheave   one load pulls the other one up to the sheave, where the portion is as short as it may be: the energy of all never
         exceeds that of the start, up to 1e-3 of what the heavier load can lose
stuck    as sheave, where a step does not converge: heavy loads pull a light rope taut while it should stop
free     a load falls freely once the force of the winch is 0: after 1 s it has 9.81 m/s, and the winch has paid out 4.9 m
slack    the same without slack stiffness: the rope, which springs back, overruns the load and piles up. The energy is at
         most that of the start and of the rope that leaves the winch, mu u^3/2 per second
drum     a winch pulls a load up to its stop, or, too weak for a heavy rope, lets it run out. The energy beyond the work of
         the winch is at most that of the rope that leaves it, up to 1e-3 of the work on 10 m
heavy    rope of mu kg/m that runs out of a winch without mass: (m + mu L) L'' = (m + mu L) g - W
"""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tetherfmu import Line, Point, Solver, Tether, TetherDynamicFree, TetherSystem, Winch

G, FALL = 9.81, 4.9  # m/s2; of 1 s from rest [m]
pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # a load stops at once, a winch runs alone


def gained_over_a_sheave(block, weight, rope, steps, solver):
    """Largest energy [J] beyond that at the start; block, weight : position [m] and mass [kg] at 10 and 4 m of rope."""
    (at_block, of_block), (at_weight, of_weight) = block, weight
    points = [
        Point("block", at_block, mass=of_block),
        Point("top", (0.0, 0.0, 0.0)),
        Point("weight", at_weight, mass=of_weight),
    ]
    slack = {"axial_stiffness": 6.9e5, "axial_damping": 473.0, "slack_stiffness_ratio": 0.0, "diameter": 0.004}
    tether = Tether(initial_length=14.0, **slack, **rope)
    line = Line("rope", "block", "weight", tether, through=["top"], initial_portions=[10.0, 4.0])
    system = TetherSystem(points, [line], solver=solver)
    system.initialize()
    start, gained = system.energy().total, 0.0
    for _ in range(steps):
        system.step(0.01)
        gained = max(gained, system.energy().total - start)
    return gained


@pytest.mark.parametrize("method", ["second_order", "backward_euler"])
@pytest.mark.parametrize("size", [0.001, 0.005, 0.01])
@pytest.mark.parametrize("segments", [1, 4])
def test_a_load_runs_into_its_sheave(segments, size, method):
    block, weight = ((10.0, 0.0, 0.0), 1.0), ((0.001, 0.0, -4.0), 1.0)
    rope, solver = {"segments": segments, "density": 724.0}, Solver(fixed_step=size, fixed_step_method=method)
    assert gained_over_a_sheave(block, weight, rope, 200, solver) < 1e-3 * 1.0 * G * 10.0


@pytest.mark.parametrize("size", [0.001, 0.005])
def test_a_step_that_does_not_converge(size):
    block, weight = ((0.001, 0.0, -10.0), 20.0), ((-0.001, 0.0, -4.0), 30.0)
    rope = {"segments": 10, "density": 0.009 / (np.pi * 0.002**2), "drag_coefficient": 0.0}
    assert gained_over_a_sheave(block, weight, rope, 500, Solver(fixed_step=size)) < 1e-3 * 10.0 * G * 10.0


@pytest.mark.parametrize("method", ["second_order", "backward_euler"])
@pytest.mark.parametrize("size", [0.001, 0.005, 0.01])
def test_rope_that_piles_up(size, method):
    for diameter, segments, length, mass in product((0.002, 0.004), (4, 20), (10.0, 50.0), (5.0, 30.0)):
        stiff = {"axial_stiffness": 3.8e10 * diameter**2, "axial_damping": 3e7 * diameter**2, "slack_stiffness_ratio": 0.0}
        rope = Tether(segments=segments, initial_length=length, diameter=diameter, **stiff)
        solver, winch = Solver(fixed_step=size, fixed_step_method=method), Winch(winch_control="force")
        tether = TetherDynamicFree(rope, kite_mass=mass, kite_start="equilibrium", winch=winch, solver=solver)
        tether.initialize(kite_position=(0.0, 0.0, -length), winch_force=mass * G)
        allowed, speed, density = tether.energy().total, 0.0, 724.0 * np.pi / 4.0 * diameter**2
        for _ in range(100):
            outputs = tether.step(0.01, winch_force=0.0)
            allowed += 0.01 * 0.5 * density * max(speed, outputs.winch_speed) ** 3
            speed = outputs.winch_speed
            assert tether.energy().total < allowed + 0.01 * mass * G * FALL
        assert np.linalg.norm(outputs.kite_velocity) < 1.01 * G


@pytest.mark.parametrize("size", [0.001, 0.005, 0.01])
@pytest.mark.parametrize("mass", [0.0, 0.1])
def test_a_winch_that_lets_go(mass, size):
    """Drag and the rope that is carried along slow it down by less than 1 %."""
    rope = Tether(segments=10, initial_length=10.0, slack_stiffness_ratio=0.01)
    winch = Winch(winch_control="force", winch_mass=mass)
    tether = TetherDynamicFree(rope, kite_mass=30.0, winch=winch, solver=Solver(fixed_step=size))
    tether.initialize(kite_position=(0.0, 0.0, -10.0), winch_force=30.0 * G)
    for _ in range(100):
        outputs = tether.step(0.01, winch_force=0.0)
    assert np.linalg.norm(outputs.kite_velocity) == pytest.approx(G, rel=0.01)
    assert outputs.tether_length - 10.0 == pytest.approx(FALL, abs=0.05)


def on_a_drum(mass, segments, density, solver, **winch):
    """A load that hangs 10 m below a winch by force on a rope of `density` [kg/m], without drag."""
    stiff = {"axial_stiffness": 6.9e5, "axial_damping": 473.0, "slack_stiffness_ratio": 0.0, "drag_coefficient": 0.0}
    rope = Tether(segments=segments, initial_length=10.0, diameter=0.004, mass_per_length=density, **stiff)
    drum = Winch(winch_control="force", **winch)
    tether = TetherDynamicFree(rope, kite_mass=mass, kite_start="equilibrium", winch=drum, solver=solver)
    tether.initialize(kite_position=(0.0, 0.0, -10.0), winch_force=mass * G)
    return tether


SOLVERS = [Solver()] + [
    Solver(fixed_step=size, fixed_step_method=method)
    for size, method in product((0.001, 0.005, 0.01), ("second_order", "backward_euler"))
]


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_load_at_its_drum(solver):
    """In two of 24 scenes rope and load weigh more than the winch pulls: rope that leaves it brings nine times its work."""
    brought = []
    for mass, segments, density, drum in product((1.0, 20.0, 50.0), (1, 4), (0.009, 0.1), (0.0, 10.0)):
        tether, force = on_a_drum(mass, segments, density, solver, winch_mass=drum, shortest_length=0.1), 1.3 * mass * G
        start, of_rope, speed, gained = tether.energy().total, 0.0, 0.0, 0.0
        for _ in range(500):
            outputs = tether.step(0.01, winch_force=force)
            of_rope += 0.01 * 0.5 * density * 0.5 * (speed**3 + outputs.winch_speed**3)
            speed = outputs.winch_speed
            gained = max(gained, tether.energy().total - start - force * (10.0 - outputs.tether_length) - of_rope)
        assert gained < 1e-3 * force * 10.0
        brought.append(of_rope / (force * 10.0))
    assert sorted(brought)[-3] < 0.03 < 9.0 < sorted(brought)[-2]


@pytest.mark.parametrize("segments", [1, 4])
@pytest.mark.parametrize("solver", [Solver(), Solver(fixed_step=0.005)])
def test_heavy_rope_runs_out(solver, segments):
    """Stretch of the rope, 2 mm, is not in the formula."""
    mass, density, force = 1.0, 0.1, 1.3 * G
    right = solve_ivp(lambda _, y: (y[1], G - force / (mass + density * y[0])), (0.0, 2.0), (10.0, 0.0), rtol=1e-10).y[:, -1]
    tether = on_a_drum(mass, segments, density, solver)
    for _ in range(200):
        outputs = tether.step(0.01, winch_force=force)
    assert (outputs.tether_length, outputs.winch_speed) == pytest.approx(right, rel=3e-5)
