"""Without damping and drag the energy of a swinging tether stays; with them it never grows.

    E = sum m_i v_i^2/2 + sum k_s (l_s - l0)^2/2 + sum m_i g z_i,   k = EA/l0 taut, slack_stiffness_ratio EA/l0 slack

The tethers pass many times from taut to slack. Each of the N steps may change E by a part `tolerance` of 2 E_kin, with
signs that do not line up: a random walk of standard deviation sqrt(N) tolerance 2 max(E_kin), of which 3 are allowed.
"""

import numpy as np
import pytest

from mechanics import energy, node_masses
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Solver, Tether

KITE = (40.0, 0.0, 10.0)
N = 8


def plucked(tether, tolerance, free, initial_shape):
    """A hanging (1) or straight (3) tether between two ends, with sideways speed of its inner nodes."""
    model = TetherDynamic(
        tether, solver=Solver(relative_tolerance=tolerance, initial_shape=initial_shape), free_ends=(False, free)
    )
    model.initialize(kite_position=KITE)
    part = np.pi * np.arange(N + 1) / N
    state = model.get_state()
    velocity = state[at.STATE_HEADER + 3 * (N + 1) : at.nodes_end(N)].reshape(-1, 3)
    velocity[:, 1] += 5.0 * np.sin(part)
    velocity[:, 2] += 2.5 * np.sin(2.0 * part)
    model.set_state(state)
    return model


def history(tether, tolerance, free, initial_shape, step=0.02, count=200):
    """Energy and kinetic energy [J] at every communication step, and the number of internal steps."""
    model = plucked(tether, tolerance, free, initial_shape)
    total, kinetic = [], []
    for k in range(count + 1):
        if k > 0:
            model.step(step, kite_position=KITE)
        v = model.velocities
        total.append(energy(model.positions, v, tether))
        kinetic.append(0.5 * node_masses(tether) @ np.sum(v**2, axis=1))
    return np.array(total), np.array(kinetic), model.counters["steps"]


@pytest.mark.parametrize("initial_shape", [1, 3], ids=["hanging", "straight"])
@pytest.mark.parametrize("free", [False, True], ids=["held", "free"])
def test_energy_is_conserved(free, initial_shape):
    tether = Tether(segments=N, initial_length=50.0, axial_damping=0.0, drag_coefficient=0.0)
    total, kinetic, steps = history(tether, 1e-8, free, initial_shape)
    bound = 3.0 * np.sqrt(steps) * 1e-8 * 2.0 * kinetic.max()
    np.testing.assert_allclose(total, total[0], rtol=0, atol=bound)
    assert kinetic.max() > 1.0  # it does swing


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("initial_shape", [1, 3], ids=["hanging", "straight"])
@pytest.mark.parametrize("free", [False, True], ids=["held", "free"])
def test_energy_never_grows_with_damping_and_drag(free, initial_shape, tolerance):
    total, kinetic, _ = history(Tether(segments=N, initial_length=50.0), tolerance, free, initial_shape)
    # a communication step is one to a few internal steps, each with an error of `tolerance` 2 E_kin
    assert np.diff(total).max() < 4.0 * tolerance * kinetic.max()
    assert total[-1] < total[0] - 1.0


@pytest.mark.parametrize(("damping", "drag_coefficient"), [(473.0, 0.0), (0.0, 0.958)], ids=["damping", "drag"])
def test_each_of_them_takes_energy(damping, drag_coefficient):
    tether = Tether(segments=N, initial_length=50.0, axial_damping=damping, drag_coefficient=drag_coefficient)
    total, kinetic, _ = history(tether, 1e-6, True, 1)
    assert np.diff(total).max() < 1e-4 * kinetic.max()
    assert total[-1] < total[0] - 1e-3 * kinetic.max()
