"""Without damping and drag the energy of a plucked tether stays; with them, and in fixed steps, it never grows.

    E = sum m_i v_i^2/2 + sum k_s (l_s - l0)^2/2 + sum m_i g z_i,   k = EA/l0 taut, slack_stiffness_ratio EA/l0 slack

The tethers pass many times from taut to slack. Each of the N adaptive steps may change E by a part `tolerance` of 2 E_kin,
with signs that do not line up: a random walk of standard deviation sqrt(N) tolerance 2 max(E_kin), of which 3 are allowed.
"""

import numpy as np
import pytest

from mechanics import energy, node_masses, pluck
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Solver, Tether

KITE = (40.0, 0.0, 10.0)
every_shape = pytest.mark.parametrize("initial_shape", [1, 3], ids=["hanging", "straight"])
every_end = pytest.mark.parametrize("free", [False, True], ids=["held", "free"])
every_fixed_step = pytest.mark.parametrize("fixed_step", [0.002, 0.02, 0.2])
every_damping = pytest.mark.parametrize("damping", [0.0, 473.0])


def history(solver, free=False, length=50.0, step=0.02, damping=473.0, drag=0.958):
    """Energy and kinetic energy [J] of a plucked tether after each of 200 steps [s], and the number of internal steps."""
    tether = Tether(segments=8, initial_length=length, axial_damping=damping, drag_coefficient=drag)
    model = TetherDynamic(tether, solver=Solver(**solver), free_ends=(False, free))
    model.initialize(kite_position=KITE)
    pluck(model)
    total, kinetic = [], []
    for k in range(201):
        if k > 0:
            model.step(step, kite_position=KITE)
        v = model.velocities
        total.append(energy(model.positions, v, tether))
        kinetic.append(0.5 * node_masses(tether) @ np.sum(v**2, axis=1))
    return np.array(total), np.array(kinetic), model.counters["steps"]


@every_shape
@every_end
def test_energy_is_conserved(free, initial_shape):
    solver = {"relative_tolerance": 1e-8, "initial_shape": initial_shape}
    total, kinetic, steps = history(solver, free, damping=0.0, drag=0.0)
    bound = 3.0 * np.sqrt(steps) * 1e-8 * 2.0 * kinetic.max()
    np.testing.assert_allclose(total, total[0], rtol=0, atol=bound)
    assert kinetic.max() > 1.0  # it does swing


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@every_shape
@every_end
def test_energy_never_grows_with_damping_and_drag(free, initial_shape, tolerance):
    total, kinetic, _ = history({"relative_tolerance": tolerance, "initial_shape": initial_shape}, free)
    # a communication step is one to a few internal steps, each with an error of `tolerance` 2 E_kin
    assert np.diff(total).max() < 4.0 * tolerance * kinetic.max()
    assert total[-1] < total[0] - 1.0


@pytest.mark.parametrize(("damping", "drag"), [(473.0, 0.0), (0.0, 0.958)], ids=["damping", "drag"])
def test_each_of_them_takes_energy(damping, drag):
    total, kinetic, _ = history({"relative_tolerance": 1e-6, "initial_shape": 1}, True, damping=damping, drag=drag)
    assert np.diff(total).max() < 1e-4 * kinetic.max()
    assert total[-1] < total[0] - 1e-3 * kinetic.max()


@every_fixed_step
@every_damping
def test_energy_never_grows_with_backward_euler(damping, fixed_step):
    """But for slack compression: a slack segment pushes with its stiffness ratio of 0.01; the matrix leaves that push across
    out, the energy does not.
    """
    solver = {"fixed_step": fixed_step, "fixed_step_method": "backward_euler"}
    total, _, _ = history(solver, step=fixed_step, damping=damping, drag=0.0)
    scale = total[0] - min(total)
    assert np.diff(total).max() < 1e-6 * scale
    assert scale > 0.1


@pytest.mark.parametrize("length", [40.0, 42.0, 50.0])
@every_fixed_step
@every_damping
def test_energy_of_three_stages_never_exceeds_that_of_the_start(damping, fixed_step, length):
    """Taut and slack: a single step may trade back what the last ones lost, never more than there was."""
    total, _, _ = history({"fixed_step": fixed_step}, length=length, step=fixed_step, damping=damping, drag=0.0)
    scale = total[0] - min(total)
    assert total.max() <= total[0] + 1e-6 * scale
    assert np.diff(total).max() < 0.01 * scale  # observed 0.004
    assert total[-1] < total[0]
