"""Rodas4P: its coefficients satisfy the order conditions, and the chain converges with order 4.

In the usual form k_i = h f(y0 + sum alpha_ij k_j) + h J sum gamma_ij k_j the transformed coefficients are
Gamma = (diag(1/gamma) - C)^-1, alpha = A Gamma, b = m Gamma, beta = alpha + Gamma. Conditions: Hairer and Wanner, Solving
Ordinary Differential Equations II, section IV.7, table 7.1.
"""

import json

import numpy as np
import pytest

from scenes import REFERENCE
from tetherfmu import Environment, Solver, Tether, TetherDynamic, TetherDynamicFree
from tetherfmu.kernels.line import rodas4p
from tetherfmu.runtime import layout as at

ROUNDING = 1e-12  # coefficients have 16 digits and are as large as 58


def square(rows):
    return np.column_stack([rows, np.zeros(6)])


def test_coefficients_are_those_of_the_reference():
    reference = json.loads((REFERENCE / "rodas4p.json").read_text())
    np.testing.assert_array_equal(square(rodas4p.A), reference["a"])
    np.testing.assert_array_equal(square(rodas4p.C), reference["C"])
    np.testing.assert_array_equal(rodas4p.ALPHA, reference["alpha"])
    np.testing.assert_array_equal(rodas4p.GAMMA_I, reference["gamma_i"])
    assert reference["gamma"] == rodas4p.GAMMA
    # the step adds U_6 to the argument of the last stage, whose row of A is m without its last entry
    np.testing.assert_array_equal([*rodas4p.A[5], 1.0], reference["m"])


def usual_form():
    gamma = np.linalg.inv(np.eye(6) / rodas4p.GAMMA - square(rodas4p.C))
    alpha = square(rodas4p.A) @ gamma
    weights = np.append(rodas4p.A[5], 1.0) @ gamma
    embedded = np.append(rodas4p.A[5], 0.0) @ gamma
    return alpha, gamma, weights, embedded


def test_positions_follow_from_velocities():
    """P = alpha (A + 1) and R/gamma = Gamma (A + 1)/gamma below their diagonals, see `rodas4p`."""
    alpha, gamma, _, _ = usual_form()
    a = square(rodas4p.A) + np.eye(6)
    for stage in range(1, 6):
        found = rodas4p.R_BY_GAMMA[stage, :stage]
        np.testing.assert_allclose(found, (gamma @ a)[stage, :stage] / rodas4p.GAMMA, atol=ROUNDING)
    for stage in range(1, 5):
        np.testing.assert_allclose(rodas4p.P[stage, :stage], (alpha @ a)[stage, :stage], atol=ROUNDING)
    # the last stage: x_5 = x_4 + d (V_4 + r_4)
    np.testing.assert_allclose((alpha @ a)[5] - (alpha @ a)[4], (gamma @ a)[4], atol=ROUNDING)


def test_row_sums():
    alpha, gamma, _, _ = usual_form()
    np.testing.assert_allclose(alpha.sum(axis=1), rodas4p.ALPHA, atol=ROUNDING)
    np.testing.assert_allclose(gamma.sum(axis=1), rodas4p.GAMMA_I, atol=ROUNDING)


def conditions(alpha, gamma, b):
    """Left minus right sides of the conditions of order 1, 2, 3, 3, 4, 4, 4, 4."""
    beta = alpha + gamma
    a, c = alpha.sum(axis=1), beta.sum(axis=1)
    return np.array(
        [
            b.sum() - 1,
            b @ c - 1 / 2,
            b @ a**2 - 1 / 3,
            b @ beta @ c - 1 / 6,
            b @ a**3 - 1 / 4,
            b @ (a * (alpha @ c)) - 1 / 8,
            b @ beta @ a**2 - 1 / 12,
            b @ beta @ beta @ c - 1 / 24,
        ]
    )


def test_order_4_and_embedded_order_3():
    alpha, gamma, weights, embedded = usual_form()
    np.testing.assert_allclose(conditions(alpha, gamma, weights), 0.0, atol=ROUNDING)
    np.testing.assert_allclose(conditions(alpha, gamma, embedded)[:4], 0.0, atol=ROUNDING)


def test_l_stable():
    """R(infinity) = 1 - b beta^-1 1 = 0."""
    alpha, gamma, weights, _ = usual_form()
    assert abs(1.0 - weights @ np.linalg.solve(alpha + gamma, np.ones(6))) < 1e-10


CHAIN = {"segments": 4, "initial_length": 38.0, "diameter": 0.02, "axial_stiffness": 2e3, "axial_damping": 60.0}
SHEARED = Environment(wind_profile="logarithmic", air_density_scale_height=500.0)
ROUGH = Solver(relative_tolerance=1e-2)  # accepts each communication step as one internal step
NODES = np.linspace([0.0, 0.0, 7.0], [22.0, 3.0, 42.0], 5)
NODES[1:-1] += [[0.3, -0.5, -0.9], [0.8, 0.2, -1.0], [-0.2, 0.4, -0.7]]  # bent, but taut: forces are smooth
VELOCITIES = np.linspace([1.0, 0.0, 0.5], [6.0, 4.0, -3.0], 5)
GROUND_GAIN, KITE_GAIN = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 2.0]])  # accelerations of the ends [m/s2]
WIND, LOAD = (8.0, 2.0, 1.0), np.array((60.0, 10.0, 100.0))


def march(steps, reeling=1.5, acceleration=0.0, load_rate=None, damping_law="strain_rate"):
    """Positions [m] and velocities [m/s] of a swinging chain with moving ends in a sheared wind after 0.4 s in equal steps.

    acceleration : of the reeling [m/s2].  load_rate : None, or that of the load on a kite end that is free [N/s].
    """
    h, tether = 0.4 / steps, Tether(damping_law=damping_law, **CHAIN)
    rates = {at.GROUND_VELOCITY: GROUND_GAIN, at.REEL_OUT_SPEED: (acceleration,), at.WIND_VELOCITY: np.zeros(3)}
    rates |= {at.KITE_VELOCITY: KITE_GAIN} if load_rate is None else {at.KITE_LOAD: load_rate}
    rates = {place + k: rate for place, numbers in rates.items() for k, rate in enumerate(numbers)}

    def moving(end, gain, t):
        return NODES[end] + t * VELOCITIES[end] + 0.5 * t * t * gain, VELOCITIES[end] + t * gain

    model = TetherDynamic(tether, SHEARED, ROUGH) if load_rate is None else TetherDynamicFree(tether, SHEARED, ROUGH)
    model.initialize(positions=NODES, velocities=VELOCITIES, wind_velocity=WIND, reel_out_speed=reeling)
    for t in h * np.arange(steps):
        given = {"wind_velocity": WIND, "reel_out_speed": reeling + acceleration * t}
        given |= dict(zip(("ground_position", "ground_velocity"), moving(0, GROUND_GAIN, t), strict=True))
        if load_rate is None:
            given |= dict(zip(("kite_position", "kite_velocity"), moving(-1, KITE_GAIN, t), strict=True))
        else:
            given["kite_load"] = LOAD + t * np.array(load_rate)
        model._state[at.GIVEN_DERIVATIVES] = sum(1 << place for place in rates)
        for place, rate in rates.items():
            model._state[at.INPUT_DERIVATIVES + place] = rate
        model.step(h, **given)
    assert model.counters["steps"] == steps
    return np.concatenate([model.positions, model.velocities])


MOTIONS = {
    "no reeling": {"reeling": 0.0},
    "reeling": {"reeling": 1.5},
    "reeling that speeds up": {"reeling": 0.0, "acceleration": 4.0},
    "the same, stretch rate law": {"reeling": 1.0, "acceleration": -6.0, "damping_law": "stretch_rate"},
    "growing load": {"reeling": 1.5, "acceleration": 2.0, "load_rate": (30.0, -60.0, 90.0)},
}


@pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # ends and loads that no kite has
@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_observed_order(motion):
    """The slope of log error over log step is 4, with moving ends and a growing tether (explicit time derivative)."""
    exact = march(1024, **motion)
    steps = np.array([32, 64, 128])
    errors = [np.abs(march(count, **motion) - exact).max() for count in steps]
    slope = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(4.0, abs=0.05)
