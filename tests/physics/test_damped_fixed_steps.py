"""Fixed steps of a damped chain that swings: order 2 against the same masses, springs and dampers in `networks.py`."""

from functools import cache

import numpy as np
import pytest

from networks import Network
from tetherfmu import Environment, Line, Point, Solver, Tether, TetherDynamicFree, TetherSystem

LENGTH, MASS, EA, DENSITY, DIAMETER = 10.0, 5.0, 2000.0, 724.0, 0.01
DURATION, STEP = 1.0, 0.02
# of the load; the chain is straight and stays taut, and the load alone moves
START, SPEED = np.array([2.87, 0.0, -9.84]), np.array([0.0, 1.0, 0.0])
SIZES = (0.01, 0.005, 0.0025)
POINTS = [Point("top", (0.0, 0.0, 0.0)), Point("load", START, velocity=SPEED, mass=MASS)]


@cache
def swung(segments, damping):
    """Position of the load after DURATION; damping : D [N s]."""
    line, calm = Line("rope", "top", "load", rope(segments, damping)), Environment(air_density=0.0)
    network = Network(POINTS, [line], calm, np.zeros(3), {"top": lambda _: np.zeros((2, 3))})
    velocities = np.zeros((segments + 1, 3))
    velocities[-1] = SPEED
    start = network.state({"rope": np.linspace(np.zeros(3), START, segments + 1)}, {"rope": velocities})
    (end,) = network.integrate(start, (0.0, DURATION))
    return network.unpacked(DURATION, end)[0][1]


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
    system = TetherSystem(POINTS, [Line("rope", "top", "load", rope(segments, damping))], solver=solver)
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
