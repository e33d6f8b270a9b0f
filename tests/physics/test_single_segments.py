"""A slack rope over a sheave, with one segment on each side and no damper, catches a load that falls.

Without the weight of the rope the load m and the sheave M follow from two springs that do not push:

    m z'' = T_2 - m g,   M psi'' = T_2 - T_1,   T_1 = EA (d_1/(L_1 - psi) - 1),   T_2 = EA (-z/(L_2 + psi) - 1),   both >= 0

Where a segment becomes taut or slack in a step, ends and rope get the impulse that keeps the energy (`events.keep_energy`).
"""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tetherfmu import Line, Point, Solver, Tether, TetherSystem

G, EA, MASS = 9.81, 1e5, 100.0  # m/s2, N, kg
HEIGHT, BEFORE, BEHIND = 10.0, 10.05, 10.1  # of the sheave above winch and load; portions of the rope [m]
STEP, STEPS = 0.01, 150


def tensions(z, psi):
    """T_1 and T_2 [N]."""
    before, behind = EA * (HEIGHT / (BEFORE - psi) - 1.0), EA * (-z / (BEHIND + psi) - 1.0)
    return np.maximum(before, 0.0), np.maximum(behind, 0.0)


@cache
def expected(sheave):
    """Height of the load and tension at it after each step, with this mass of the sheave [kg]."""

    def rates(_, y):
        z, psi, speed, running = y
        before, behind = tensions(z, psi)
        return speed, running, behind / MASS - G, (behind - before) / sheave

    times = STEP * np.arange(1, STEPS + 1)
    tight = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12, "max_step": 1e-4}
    found = solve_ivp(rates, (0.0, times[-1]), (-HEIGHT, 0.0, 0.0, 0.0), t_eval=times, **tight).y
    return found[0], tensions(found[0], found[1])[1]


@pytest.mark.parametrize(
    ("sheave", "tolerance", "of_height", "of_tension"),
    [(2.0, 1e-4, 1e-4, 0.005), (0.2, 1e-4, 3e-5, 0.01), (0.2, 1e-6, 2e-6, 5e-4), (0.02, 1e-4, 1e-4, 0.03)],
)
def test_a_load_is_caught(sheave, tolerance, of_height, of_tension):
    """Height of the load [m]; tension over the largest one. Energy within 1e-3 of that of the fall by 0.2 m."""
    light = {"density": 0.001, "axial_stiffness": EA, "axial_damping": 0.0, "slack_stiffness_ratio": 0.0}
    rope = Tether(segments=1, initial_length=BEFORE + BEHIND, diameter=0.01, drag_coefficient=0.0, **light)
    points = [
        Point("winch", (0.0, 0.0, -HEIGHT)),
        Point("top", (0.0, 0.0, 0.0)),
        Point("load", (0.0, 0.0, -HEIGHT), mass=MASS),
    ]
    line = Line("rope", "winch", "load", rope, through=["top"], initial_portions=[BEFORE, BEHIND], sheave_mass=sheave)
    system = TetherSystem(points, [line], solver=Solver(relative_tolerance=tolerance))
    system.initialize()
    start, heights, pulls, gained = system.energy().total, [], [], 0.0
    for _ in range(STEPS):
        outputs = system.step(STEP)
        heights.append(outputs.points["load"].position[2])
        pulls.append(outputs.lines["rope"].kite_tension)
        gained = max(gained, abs(system.energy().total - start))
    height, tension = expected(sheave)
    assert np.max(tension) > 2.5 * MASS * G
    assert np.max(np.abs(heights - height)) < of_height
    assert np.max(np.abs(pulls - tension)) < of_tension * np.max(tension)
    assert gained < 1e-3 * MASS * G * 0.2
