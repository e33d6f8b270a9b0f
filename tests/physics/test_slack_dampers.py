"""Segments that do not push, and do not damp while slack.

bounce   a mass bounces on one segment, against its motion by pieces, taut and slack, between located events
drum     a winch without mass draws a slack rope taut whose damper then pulls with more than EA
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tetherfmu import Environment, Solver, Tether, TetherDynamic, TetherDynamicFree, Winch

LENGTH, STIFFNESS, LINE, MASS, GRAVITY = 10.0, 1e5, 0.02, 20.0, 9.81  # m, N, kg/m, kg, m/s2
FALLS_FROM, STEP, STEPS = -9.5, 0.02, 300  # m, s
REFERENCE = {"rtol": 1e-11, "atol": 1e-13, "method": "DOP853", "dense_output": True}
# relative error of the tension; internal steps, tried ones too, in 300 communication steps with some 20 transitions
BARS = {1e-4: (5e-3, 500), 1e-6: (1e-4, 900), 1e-8: (1e-5, 1700)}


def by_pieces(damping):
    """Tension [N] at each communication point."""
    k, c = STIFFNESS / LENGTH, damping / LENGTH
    mass = MASS + 0.5 * LINE * LENGTH

    def tension(y, taut):
        return taut * (k * (-y[0] - LENGTH) - c * y[1])

    def rates(_, y, taut):
        return y[1], tension(y, taut) / mass - GRAVITY

    def stretch(_, y, taut):
        return -y[0] - LENGTH

    stretch.terminal = True
    times, y, t, taut, found = STEP * np.arange(1, STEPS + 1), [FALLS_FROM, 0.0], 0.0, False, []
    while len(found) < STEPS:
        stretch.direction = -1.0 if taut else 1.0
        piece = solve_ivp(rates, (t, times[-1]), y, args=(taut,), events=stretch, **REFERENCE)
        here = times[len(found) :][times[len(found) :] <= piece.t[-1]]
        found += [tension(piece.sol(each), taut) for each in here]
        t, y, taut = piece.t[-1], piece.y[:, -1], taut != (piece.status == 1)
    return np.array(found)


@pytest.mark.parametrize("tolerance", BARS)
@pytest.mark.parametrize("damping", [20.0, 200.0, 1000.0])
def test_the_tolerance_holds_where_dampers_switch(damping, tolerance):
    """Without steps that end where the segment goes taut the error is 14, 1.1, 0.03 % with 200 N.s."""
    tether = Tether(
        segments=1,
        initial_length=LENGTH,
        axial_stiffness=STIFFNESS,
        axial_damping=damping,
        mass_per_length=LINE,
        drag_coefficient=0.0,
        slack_stiffness_ratio=0.0,
    )
    model = TetherDynamicFree(tether, kite_mass=MASS, solver=Solver(relative_tolerance=tolerance))
    model.initialize(kite_position=(0.0, 0.0, FALLS_FROM))
    rows = [model.step(STEP) for _ in range(STEPS)]
    right, (error, tried) = by_pieces(damping), BARS[tolerance]
    wrong = np.abs([each.ground_tension for each in rows] - right)
    assert wrong.max() < error * right.max()
    assert rows[-1].solver_steps + rows[-1].solver_rejections < tried


@pytest.mark.parametrize("force", [3.0, 30.0, 300.0])
@pytest.mark.parametrize("segments", [1, 2, 4, 16])
def test_a_drum_draws_its_rope_taut(segments, force):
    """With e = d/L, of two ends a distance d apart: D e e' = R - EA (e^2 - 1)/2, R = W + W^2/(2 EA), from e = 1 on.

    When it draws taut the damper pulls with up to 300 EA, and T(R) is no longer nearly linear. Found within 2.5 %, of which
    1 % is the time at which it draws taut; 1 mm of overshoot, the tolerance, would be as much as the whole stretch.
    """
    distance, stiffness, damping, steps = 10.0, 4711.0, 64138.0, 100
    slack = {"axial_damping": damping, "slack_stiffness_ratio": 0.0, "drag_coefficient": 0.0}
    rope = Tether(segments=segments, initial_length=1.01 * distance, axial_stiffness=stiffness, **slack)
    still, solver = Environment(gravity=0.0), Solver(initial_shape="straight")
    tether = TetherDynamic(rope, still, solver, Winch(winch_control="force"))
    tether.initialize(kite_position=(distance, 0.0, 0.0), winch_force=force)
    rows = [tether.step(STEP, winch_force=force) for _ in range(steps)]
    squares = np.array([0.5 * ((distance / each.tether_length) ** 2 - 1.0) for each in rows])
    taut = STEP * (np.arange(steps) - np.argmax(squares > 0.0))
    right = (force + 0.5 * force**2 / stiffness) / stiffness * (1.0 - np.exp(-stiffness * taut / damping))
    assert squares[-1] == pytest.approx(right[-1], rel=0.04)
    assert rows[-1].ground_tension == pytest.approx(force, rel=1e-9)
