"""Without gravity and air nothing but the tether acts: a free one keeps its momentum and its angular momentum.

    sum m_i v_i = const,   sum m_i x_i x v_i = const;   with damping its energy falls, and what is left is rigid motion

Between held ends: the tension EA (c/L - 1) of its chord c, or no load at all (lines: `test_strut.py`).
"""

import numpy as np
import pytest

from audited import VOID, run
from mechanics import node_masses
from solvers import MODELS
from tetherfmu import Solver, StepRefused, Tether, TetherDynamic, TetherQuasiSteady


def tumbling(n, tolerance, count=200, step=0.005):
    """Momentum, angular momentum after each step, and the `Run` of a tether thrown about."""
    tether = Tether(segments=n, initial_length=20.0)
    model = TetherDynamic(tether, VOID, Solver(relative_tolerance=tolerance, initial_shape=3), free_ends=(True, True))
    thrown = 3.0 * np.random.default_rng(5).normal(size=(n + 1, 3))
    model.initialize(positions=np.linspace((0.0, 0.0, 0.0), (20.0, 0.0, 0.0), n + 1), velocities=thrown)
    mass = node_masses(tether)
    linear, angular = [], []

    def inputs(time):
        linear.append(mass @ model.velocities)
        angular.append(mass @ np.cross(model.positions, model.velocities))
        return {}

    result = run(model, inputs, step, count)
    return np.array(linear), np.array(angular), result


@pytest.mark.parametrize("n", [1, 2, 10])
def test_momentum_and_angular_momentum(n):
    linear, angular, result = tumbling(n, 1e-6)
    # forces are equal and opposite in every stage: rounding. Angular momentum is a quadratic form: the solver's tolerance
    np.testing.assert_allclose(linear, linear[:1] + np.zeros_like(linear), rtol=0, atol=1e-13)
    np.testing.assert_allclose(angular, angular[:1] + np.zeros_like(angular), rtol=0, atol=1e-6 * np.abs(angular).max())
    total = np.array([energy.total for energy in result.energies])
    assert np.diff(total).max() < 1e-8 * total[0]
    assert total[-1] < 0.9995 * total[0]


KITE = (30.0, 0.0, 40.0)


@pytest.mark.parametrize("variant", MODELS)
@pytest.mark.parametrize("length", [49.9, 50.0])
def test_taut_between_held_ends(variant, length):
    tether = Tether(segments=6, initial_length=length)
    model = variant(tether, VOID)
    model.initialize(KITE)
    for _ in range(20):
        out = model.step(0.1, KITE)
    expected = tether.axial_stiffness * (50.0 / length - 1.0) * np.array([0.6, 0.0, 0.8])
    np.testing.assert_allclose(out.ground_force, expected, rtol=0, atol=1e-6)  # rounding of 50 m times EA/l0
    np.testing.assert_allclose(out.kite_force, -expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("variant", [TetherDynamic, TetherQuasiSteady])
@pytest.mark.parametrize("segments", [2, 3, 10, 20, 60])
def test_every_slack_tether_without_load_starts(variant, segments):
    """Any direction and slack, also those where the search finds no equilibrium on the straight line, not even a strut.

    Forces: rounding of 5 m times EA/l0, 2e-16 * 5 m * 614600 N/(5 m/60) = 1e-8 N in a segment, ten times for all of them.
    """
    random = np.random.default_rng(1)
    directions = random.normal(size=(20, 3))
    kites = random.uniform(0.0, 5.0, size=(20, 1)) * directions / np.linalg.norm(directions, axis=1)[:, None]
    model = variant(Tether(segments=segments, initial_length=5.0), VOID)
    for kite in [(3.0, 1.0, 2.0), *kites]:
        out = model.initialize(kite)
        np.testing.assert_allclose((out.ground_force, out.kite_force), 0.0, atol=1e-6)


def test_refused_start_names_its_length():
    """A kite that flies at 1 km/s towards the station stretches a quasi-steady tether at a rate no equilibrium stands."""
    model = TetherQuasiSteady(Tether(segments=6, initial_length=60.0))
    with pytest.raises(StepRefused, match=r"tether_length 60.0 m"):
        model.initialize((1e-3, 0.0, 0.0), (-1e3, 0.0, 0.0))


def test_pressed_column_buckles():
    """A slack chain started straight is a column under its slack stiffness: it buckles, and its energy only falls."""
    model = TetherDynamic(Tether(segments=6, initial_length=60.0), VOID, Solver(initial_shape=3, relative_tolerance=1e-6))
    model.initialize(KITE)
    start, energies = model.outputs(), [model.energy().total]
    for _ in range(200):
        out = model.step(0.02, KITE)
        energies.append(model.energy().total)
    assert start.sag < 1e-9
    assert out.sag > 3.0
    assert np.diff(energies).max() < 1e-6 * energies[0]
    assert energies[-1] < 0.5 * energies[0]
