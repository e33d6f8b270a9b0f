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

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ends_of_ropes import DRUMS, FALL, FREE, STEP, G, at_a_drum, at_a_free_winch, on_a_drum, over_a_sheave
from tetherfmu import Solver, Tether, TetherDynamicFree, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # a load stops at once, a winch runs alone
SIZES, METHODS = (0.001, 0.005, 0.01), ("second_order", "backward_euler")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("segments", [1, 4])
def test_a_load_runs_into_its_sheave(segments, size, method):
    block, weight = ((10.0, 0.0, 0.0), 1.0), ((0.001, 0.0, -4.0), 1.0)
    rope, solver = {"segments": segments, "density": 724.0}, Solver(fixed_step=size, fixed_step_method=method)
    assert over_a_sheave(block, weight, rope, 200, solver) < 1e-3 * 1.0 * G * 10.0


@pytest.mark.parametrize("size", [0.001, 0.005])
def test_a_step_that_does_not_converge(size):
    block, weight = ((0.001, 0.0, -10.0), 20.0), ((-0.001, 0.0, -4.0), 30.0)
    rope = {"segments": 10, "density": 0.009 / (np.pi * 0.002**2), "drag_coefficient": 0.0}
    assert over_a_sheave(block, weight, rope, 500, Solver(fixed_step=size)) < 1e-3 * 10.0 * G * 10.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", SIZES)
def test_rope_that_piles_up(size, method):
    for scene in FREE[::3]:
        gained, speed = at_a_free_winch(*scene, Solver(fixed_step=size, fixed_step_method=method))
        assert gained < 0.01
        assert speed < 1.01 * G


@pytest.mark.parametrize("size", SIZES)
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


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [0.0, *SIZES])
def test_a_load_at_its_drum(size, method):
    """In two of 24 scenes rope and load weigh more than the winch pulls: rope that leaves it brings nine times its work."""
    found = [at_a_drum(*scene, Solver(fixed_step=size, fixed_step_method=method)) for scene in DRUMS]
    assert max(gained for gained, _ in found) < 1e-3
    brought = sorted(of_rope for _, of_rope in found)
    assert brought[-3] < 0.03 < 9.0 < brought[-2]


@pytest.mark.parametrize("segments", [1, 4])
@pytest.mark.parametrize("solver", [Solver(), Solver(fixed_step=0.005)])
def test_heavy_rope_runs_out(solver, segments):
    """Stretch of the rope, 2 mm, is not in the formula."""
    mass, density, force = 1.0, 0.1, 1.3 * G
    right = solve_ivp(lambda _, y: (y[1], G - force / (mass + density * y[0])), (0.0, 2.0), (10.0, 0.0), rtol=1e-10).y[:, -1]
    tether = on_a_drum(mass, segments, density, solver)
    for _ in range(200):
        outputs = tether.step(STEP, winch_force=force)
    assert (outputs.tether_length, outputs.winch_speed) == pytest.approx(right, rel=3e-5)
