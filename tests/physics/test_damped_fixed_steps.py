"""Fixed steps of a damped chain that swings: order 2 against the same chain of masses, springs and dampers in scipy.

m_i x_i'' = sum over its segments of +-(EA (l/l0 - 1) + D/l0 l') e - m_i g
"""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tetherfmu import Line, Point, Solver, Tether, TetherDynamicFree, TetherSystem

G, LENGTH, MASS, EA, DENSITY, DIAMETER = 9.81, 10.0, 5.0, 2000.0, 724.0, 0.01
DURATION, STEP = 1.0, 0.02
# of the load; the chain is straight and stays taut, and the load alone moves
START, SPEED = np.array([2.87, 0.0, -9.84]), np.array([0.0, 1.0, 0.0])
SIZES = (0.01, 0.005, 0.0025)


@cache
def swung(segments, damping):
    """Position of the load after DURATION; damping : D [N s]."""
    rest = LENGTH / segments
    masses = np.full(segments, DENSITY * np.pi * DIAMETER**2 / 4.0 * rest)
    masses[-1] = 0.5 * masses[-1] + MASS

    def rates(_, y):
        x, v = y.reshape(2, segments, 3)
        r, u = np.diff(x, axis=0, prepend=np.zeros((1, 3))), np.diff(v, axis=0, prepend=np.zeros((1, 3)))
        length = np.linalg.norm(r, axis=1)
        e = r / length[:, None]
        tension = EA * (length / rest - 1.0) + damping / rest * np.sum(e * u, axis=1)
        pull = tension[:, None] * e
        force = -pull
        force[:-1] += pull[1:]
        return np.concatenate((v, force / masses[:, None] - (0.0, 0.0, G))).ravel()

    part = np.arange(1, segments + 1)[:, None] / segments
    v = np.zeros((segments, 3))
    v[-1] = SPEED
    start = np.concatenate((part * START, v)).ravel()
    found = solve_ivp(rates, (0.0, DURATION), start, method="Radau", rtol=1e-10, atol=1e-12).y[:, -1]
    return found.reshape(2, segments, 3)[0, -1]


def rope(segments, damping):
    return Tether(
        segments=segments,
        initial_length=LENGTH,
        diameter=DIAMETER,
        density=DENSITY,
        axial_stiffness=EA,
        axial_damping=damping,
        drag_coefficient=0.0,
    )


def of_tether(segments, damping, solver):
    """The same of a tether with a free end."""
    tether = TetherDynamicFree(rope(segments, damping), kite_mass=MASS, solver=solver)
    nodes = np.linspace(np.zeros(3), START, segments + 1)
    velocities = np.zeros_like(nodes)
    velocities[-1] = SPEED
    tether.initialize(positions=nodes, velocities=velocities)
    for _ in range(round(DURATION / STEP)):
        outputs = tether.step(STEP)
    return outputs.kite_position


def of_system(segments, damping, solver):
    """The same of a line to a free point."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("load", START, velocity=SPEED, mass=MASS)]
    system = TetherSystem(points, [Line("rope", "top", "load", rope(segments, damping))], solver=solver)
    system.initialize()
    for _ in range(round(DURATION / STEP)):
        outputs = system.step(STEP)
    return outputs.points["load"].position


@pytest.mark.parametrize("damping", [20.0, 200.0, 1000.0])
@pytest.mark.parametrize(("fly", "segments"), [(of_tether, 4), (of_tether, 1), (of_system, 1)])
def test_the_order_is_two(fly, segments, damping):
    """Between 10, 5 and 2.5 ms; 5e-6 m at 10 ms, where order 1 gives up to 2e-5."""
    exact = swung(segments, damping)
    errors = [np.linalg.norm(fly(segments, damping, Solver(fixed_step=size)) - exact) for size in SIZES]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.linalg.norm(fly(segments, damping, Solver(relative_tolerance=1e-9)) - exact) < 1e-7
    assert np.all(orders > 1.9), (errors, orders)
    assert errors[0] < 5e-6
