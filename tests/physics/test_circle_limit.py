"""The slower the kite flies its circle, the closer the dynamic tether is to the quasi-steady one.

Both have the same equilibrium at rest. In flight the quasi-steady tether turns rigidly; the dynamic one also changes its
shape as the directions of gravity and wind turn, with node velocities of the order of the rate g that the other does not
know. They change inertia, as g^2, and drag: in still air as the square of velocities that are all proportional to g, so by
second order; in a wind linearly in these velocities, so by first order. Over half a turn the part of first order was found
to average out, as the waves of the start do: the means differ by second order with and without wind.
"""

import numpy as np
import pytest

from scenes import REVOLUTION, fly_circle
from tetherfmu import Solver, Tether, TetherDynamic, TetherQuasiSteady

STILL, BREEZE = (0.0, 0.0, 0.0), (0.1, 0.0, 0.0)


def forces(model, n, rate, wind, step):
    """Ground force and kite force [N] over the second half of the turn, array (rows, 2, 3)."""
    tether = model(Tether(segments=n, initial_length=525.0), solver=Solver(initial_shape=2))
    turn = 2.0 * np.pi / rate
    times, outputs = fly_circle(tether, step, turn, wind, rate)
    assert np.isclose(times[-1], turn, rtol=1e-3)
    half = outputs[len(outputs) // 2 :]
    return np.array([[each.ground_force, each.kite_force] for each in half])


def differences(n, rate, wind, step):
    """Mean of |ground_force| and of |kite_force| of the dynamic tether over that of the quasi-steady one, less 1."""
    dynamic, quasi_steady = (
        np.linalg.norm(forces(model, n, rate, wind, step), axis=2).mean(axis=0)
        for model in (TetherDynamic, TetherQuasiSteady)
    )
    return dynamic / quasi_steady - 1.0


@pytest.mark.parametrize("wind", [STILL, BREEZE])
def test_mean_forces_agree_on_the_circle(wind):
    """The bar: 1 % at both ends; the scene itself, 20 segments, g = 0.05, every 20 ms."""
    found = differences(20, 0.05, wind, REVOLUTION / 6283)
    assert (np.abs(found) < 0.01).all(), found


@pytest.mark.parametrize("wind", [STILL, BREEZE, (8.0, 0.0, 0.0)])
def test_difference_of_the_means_falls_with_the_square_of_the_rate(wind):
    """Six segments and 2000 steps in each turn; an error of the step would fall as g^2 too, so it is halved once."""
    rates = (0.025, 0.0125, 0.00625)
    found = np.array([differences(6, rate, wind, 2.0 * np.pi / rate / 2000) for rate in rates])
    orders = np.log2(found[:-1] / found[1:])
    assert np.allclose(orders, 2.0, atol=0.25), orders  # the next term still shows; 2.02 to 2.13 found
    finer = differences(6, rates[0], wind, 2.0 * np.pi / rates[0] / 4000)
    assert np.allclose(finer, found[0], rtol=0.02)


@pytest.mark.parametrize(("wind", "order"), [(STILL, 2.0), ((0.0, 8.0, 0.0), 1.0)])
def test_difference_at_every_moment_falls_with_its_order(wind, order):
    """Root mean square of the differences of both forces in the second half of the turn."""
    rates, found = (0.00625, 0.003125), []
    for rate in rates:
        dynamic, quasi_steady = (
            forces(model, 6, rate, wind, 2.0 * np.pi / rate / 2000) for model in (TetherDynamic, TetherQuasiSteady)
        )
        found.append(np.sqrt(np.mean((dynamic - quasi_steady) ** 2)))
    assert np.isclose(np.log2(found[0] / found[1]), order, atol=0.15)  # part of the next order is left: 2.02 and 1.08
