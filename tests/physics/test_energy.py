"""Without damping and drag the energy of a tether stays; with them, and in fixed steps, it never grows.

    E = sum m_i v_i^2/2 + sum k_s (l_s - l0)^2/2 + sum m_i g z_i,   k = EA/l0 taut, slack_stiffness_ratio EA/l0 slack

The tethers pass many times from taut to slack. Each of the N adaptive steps may change E by a part `tolerance` of 2 E_kin,
with signs that do not line up: a random walk of standard deviation sqrt(N) tolerance 2 max(E_kin), of which 3 are allowed.

A mass m on a segment of stiffness k, slack s k, without weight: half periods pi sqrt(m/k) taut and pi sqrt(m/(s k)) slack;
the speed at the kink is sqrt(k/m) times the amplitude taut, the amplitude slack that over sqrt(s).
"""

import numpy as np
import pytest

from mechanics import energy, node_masses, pluck
from tetherfmu import Environment, Solver, Tether, TetherDynamic

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


@pytest.mark.parametrize(
    ("tolerance", "damping", "drag"), [(1e-4, 473.0, 0.958), (1e-6, 473.0, 0.958), (1e-6, 473.0, 0.0), (1e-6, 0.0, 0.958)]
)
@every_shape
@every_end
def test_energy_never_grows_with_damping_and_drag(free, initial_shape, tolerance, damping, drag):
    """Each of them alone takes energy, too."""
    solver = {"relative_tolerance": tolerance, "initial_shape": initial_shape}
    total, kinetic, _ = history(solver, free, damping=damping, drag=drag)
    # a communication step is one to a few internal steps, each with an error of `tolerance` 2 E_kin
    assert np.diff(total).max() < 4.0 * tolerance * kinetic.max()
    assert total[-1] < total[0] - (1.0 if damping and drag else 1e-3 * kinetic.max())


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


TOLERANCE = 1e-4  # of the solver, its default


def released(tether, kite, gravity=9.81):
    """A straight, undamped tether in still air of density 0 whose kite end is let go at rest."""
    environment = Environment(gravity=gravity, air_density=0.0)
    solver = Solver(relative_tolerance=TOLERANCE, initial_shape=3)
    model = TetherDynamic(tether, environment, solver, free_ends=(False, True))
    model.initialize(kite_position=kite)
    return model


FALLS = {  # tether without damping, start of the kite [m], communication step [s], duration [s]
    "one segment": (
        dict(segments=1, initial_length=6.437352, axial_stiffness=339554.7, diameter=0.001539),
        (4.924, -4.17),
        0.1,
        20,
    ),
    "one, stiffer": (
        dict(segments=1, initial_length=15.261, axial_stiffness=427570.0, diameter=0.0018),
        (10.763, -11.232),
        0.1,
        20,
    ),
    "no slack stiffness": (dict(segments=5, initial_length=50.0, slack_stiffness_ratio=0.0), (0.0, -50.3), 0.02, 30),
    "stretched": (dict(segments=8, initial_length=50.0), (50.2, 0.0), 0.02, 10),
}


def fall(name, duration=None):
    """Total and kinetic energy [J] at the communication steps of a fall, for a duration [s] other than its own."""
    properties, (x, z), step, usual = FALLS[name]
    tether = Tether(axial_damping=0.0, **properties)
    model = released(tether, (x, 0.0, z))
    total, kinetic = [], []
    for _ in range(round((duration or usual) / step)):
        total.append(energy(model.positions, model.velocities, tether))
        kinetic.append(0.5 * node_masses(tether) @ np.sum(model.velocities**2, axis=1))
        model.step(step)
    return np.array(total), np.array(kinetic)


@pytest.mark.parametrize("name", FALLS)
def test_no_gain(name):
    """Without `kink.keep_energy` they gained 21, 5.9, 1.2 and 0.5 % of the kinetic energy."""
    total, kinetic = fall(name)
    assert total.max() - total[0] < TOLERANCE * kinetic.max()
    assert total[-1] > total[0] - 0.01 * kinetic.max()  # and they lose little, 0.2 % at most


@pytest.mark.parametrize("ratio", [0.01, 0.25])
def test_amplitudes_and_period_of_a_bouncing_mass(ratio):
    tether = Tether(segments=1, initial_length=10.0, axial_damping=0.0, slack_stiffness_ratio=ratio)
    amplitude = 0.02
    model = released(tether, (10.0 + amplitude, 0.0, 0.0), gravity=0.0)
    omega = np.sqrt(tether.axial_stiffness / tether.initial_length / node_masses(tether)[-1])
    period = np.pi / omega * (1.0 + 1.0 / np.sqrt(ratio))
    bounces = 20
    step = period / 40
    stretch = []
    for _ in range(40 * bounces):
        model.step(step)
        stretch.append(model.positions[1, 0] - 10.0)
    last = np.array(stretch[-40:])
    # a bounce takes some 20 steps, each with an error of the tolerance times 10 m/20 mm of the amplitude at most
    assert last.max() == pytest.approx(amplitude, rel=0.02)
    assert -last.min() == pytest.approx(amplitude / np.sqrt(ratio), rel=0.02)
    assert last[-1] == pytest.approx(amplitude, rel=0.05)  # after whole periods it is back
