"""The equations of motion in plain lines (`motion.accelerations`) are what the solvers solve.

forces  m v' - load is the force of `assembly.node_forces`, which the Rosenbrock step takes
flight  DOP853 at 1e-10 on v' = F/m comes where the tether flies: with a free kite, wind, reeling, and a ground without
        friction, which is stiff
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from kernels.chain_problem import ChainProblem
from kernels.interleaved import node_forces
from tetherfmu import Environment, Ground, Solver, Tether, TetherDynamicFree
from tetherfmu.kernels.equations import motion
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.runtime import layout as at

LOAD = (30.0, -20.0, 90.0)
SMOOTH = Ground(ground_contact="flat", ground_height=0.0, ground_sink=0.05, ground_friction=0.0)
TETHER = Tether(segments=3, initial_length=49.0, axial_stiffness=2e4, axial_damping=40.0)
EXACT = Solver(relative_tolerance=1e-8)
WIND, GROUND_END, STEP = (8.0, 1.0, 0.0), (2.0, 5.0, 0.0), 0.02


def accelerations(chain, x, v, load):
    mass, a = np.zeros(chain.n + 1), np.zeros(3 * (chain.n + 1))
    motion.accelerations(chain, np.ascontiguousarray(x), np.ascontiguousarray(v), tuple(load), mass, a)
    return mass, a


@pytest.mark.parametrize(("slack", "masses"), [(False, ()), (True, ()), (False, ((2, 0.3),))])
@pytest.mark.parametrize("damping_law", [1, 2])
@pytest.mark.parametrize("wind_profile", [1, 2, 3, 4, at.AT_NODES])
def test_the_forces_are_those_of_the_solver(wind_profile, damping_law, slack, masses):
    problem = ChainProblem(damping_law=damping_law, wind_profile=wind_profile, masses=masses)
    chain = chain_at(problem.n, problem.parameters, 60.0 if slack else problem.length, 1.5, problem.wind)
    mass, a = accelerations(chain, problem.x, problem.v, LOAD)
    force = np.repeat(mass, 3) * a
    force[-3:] -= LOAD
    expected = node_forces(chain, np.zeros(problem.n), problem.x, problem.v)
    np.testing.assert_allclose(force, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())  # sums in another order


def flown(model, load, reeling):
    """Positions of all nodes after 1 s of v' = F/m from where a model is; its first node rests."""
    start = np.concatenate([model.positions.ravel(), model.velocities.ravel()])

    def rates(t, y):
        x, v = y.reshape(2, -1)
        length = TETHER.initial_length + reeling * t
        _, a = accelerations(chain_at(TETHER.segments, model._parameters, length, reeling, WIND), x, v, load)
        a[:3] = 0.0
        return np.concatenate([v, a])

    return solve_ivp(rates, (0.0, 1.0), start, method="DOP853", rtol=1e-10, atol=1e-10).y[:, -1].reshape(2, -1, 3)[0]


@pytest.mark.parametrize("reeling", [0.0, 1.5])
@pytest.mark.parametrize(
    ("ground", "kite", "load"),
    [(Ground(), (30.0, 0.0, 40.0), LOAD), (SMOOTH, (40.0, 0.0, 2.0), (15.0, 5.0, 0.0))],
    ids=["in the air", "onto the ground"],
)
def test_a_tether_flies_by_them(ground, kite, load, reeling):
    """A free kite for 1 s: the error of the tether at a tolerance of 1e-8 is below a micrometre."""
    model = TetherDynamicFree(TETHER, Environment(), EXACT, ground=ground, kite_mass=3.0)
    model.initialize(kite, GROUND_END, wind_velocity=WIND, reel_out_speed=reeling)
    expected = flown(model, load, reeling)
    for _ in range(50):
        model.step(STEP, kite_load=load)
    np.testing.assert_allclose(model.positions, expected, rtol=0.0, atol=1e-6)
