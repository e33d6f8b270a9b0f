"""Whip of a released end: a chain hangs folded from two points close together; one end is let go and falls faster than g.

With energy conserved, after the fall by x of a chain of length L (separation 0, inextensible)

    v^2 = 2 g x (1 - x/(2 L))/(1 - x/L)

Source: M. G. Calkin and R. H. March, The dynamics of a falling chain, American Journal of Physics 57 (1989) 154. Their chain
did so until x = 0.97 L.
"""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from audited import run
from mechanics import node_masses
from tetherfmu import Environment, Solver, Tether, TetherDynamic

LENGTH, GRAVITY = 10.0, 9.81


def let_go(n, damping, tolerance=1e-5):
    """Fall x/L, speed over that of the formula and over free fall, and energy from nowhere over m g L."""
    tether = Tether(segments=n, initial_length=LENGTH, axial_damping=damping, axial_stiffness=1e4)
    model = TetherDynamic(
        tether, Environment(air_density=0.0), Solver(relative_tolerance=tolerance), free_ends=(False, True)
    )
    model.initialize((0.5, 0.0, 0.0))
    step = 0.002
    tip = []

    def inputs(time):
        tip.append((-model.positions[-1, 2], np.linalg.norm(model.velocities[-1])))
        return {}

    result = run(model, inputs, step, round(np.sqrt(2.0 * LENGTH / GRAVITY) / step))
    fall, speed = np.array(tip).T
    last = np.argmax(fall)
    fall, speed = fall[1:last] / LENGTH, speed[1:last]
    free = np.sqrt(2.0 * GRAVITY * LENGTH * fall)
    exact = free * np.sqrt((1.0 - 0.5 * fall) / (1.0 - fall))
    return fall, speed / exact, speed / free, result.residual.max() / result.turnover


def test_speed_of_the_tip():
    fall, part, free, residual = let_go(50, 5.0)
    between = (fall > 0.3) & (fall < 0.85)
    # the fold is not a point: 0.5 m wide, and of segments of 0.2 m
    np.testing.assert_allclose(part[between], 1.0, atol=0.05)
    assert np.interp(0.85, fall, free) > 1.8  # nearly twice as fast as a stone
    assert fall.max() > 0.95
    assert residual < 5e-3


def test_force_at_the_support_and_time_of_the_fall():
    """T/(m g) = (2 + 2 y - 3 y^2)/(4 (1 - y)) with y = x/L; all of it takes 0.847 of the free fall over L.

    Means of T from the momentum of the chain, over stretches of the fall, since waves run in it. Near the end the fold, half
    a metre wide, swings sideways, which takes from the force.
    """
    n, step = 80, 0.002
    tether = Tether(segments=n, initial_length=LENGTH, axial_damping=5.0, axial_stiffness=1e4)
    model = TetherDynamic(tether, Environment(air_density=0.0), Solver(relative_tolerance=1e-5), free_ends=(False, True))
    model.initialize((0.5, 0.0, 0.0))
    mass = node_masses(tether)
    fall, momentum = [0.0], [0.0]
    for _ in range(round(0.9 * np.sqrt(2.0 * LENGTH / GRAVITY) / step)):
        model.step(step)
        fall.append(-model.positions[-1, 2] / LENGTH)
        momentum.append(mass @ model.velocities[:, 2])
    fall, time = np.array(fall), step * np.arange(len(fall))
    impulse = np.array(momentum) / (mass.sum() * GRAVITY) + time
    for begin, end, allowed in ((0.1, 0.3, 0.02), (0.3, 0.5, 0.02), (0.5, 0.7, 0.02), (0.7, 0.9, 0.1)):
        i, j = np.argmax(fall > begin), np.argmax(fall > end)
        y = fall[i : j + 1]
        exact = trapezoid((2.0 + 2.0 * y - 3.0 * y * y) / (4.0 * (1.0 - y)), time[i : j + 1])
        assert impulse[j] - impulse[i] == pytest.approx(exact, rel=allowed)
    assert time[np.argmax(fall)] / np.sqrt(2.0 * LENGTH / GRAVITY) == pytest.approx(0.847, rel=0.01)
