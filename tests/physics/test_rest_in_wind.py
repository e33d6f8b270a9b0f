"""At rest in wind the quasi-steady tether, the dynamic tether's first shape, and where that settles are one."""

import numpy as np
import pytest

from balance import residual
from tetherfmu import Environment, Solver, Tether
from tetherfmu.python import models

KITE = np.array([240.0, -180.0, 400.0])  # 500 m away
WIND = (10.0, 0.0, 0.0)
HOLD = {"kite_position": KITE, "wind_velocity": WIND}
ENVIRONMENT = Environment()
NUMBERS, SLACKS = (5, 20, 60), (-0.005, 0.0, 0.02, 0.2)


def at_rest(variant, n, slack, **solver):
    tether = Tether(segments=n, initial_length=500.0 * (1.0 + slack))
    model = getattr(models, variant)(tether, ENVIRONMENT, Solver(**solver))
    return model, tether, model.initialize(**HOLD)


def assert_same_rest(model, outputs, expected_model, expected):
    """The bar: forces to 1e-6 relative, node positions to 1e-6 m."""
    for name in ("ground_force", "kite_force"):
        force = getattr(expected, name)
        assert np.linalg.norm(getattr(outputs, name) - force) < 1e-6 * np.linalg.norm(force)
    assert np.abs(model.positions - expected_model.positions).max() < 1e-6


@pytest.mark.parametrize("n", NUMBERS)
@pytest.mark.parametrize("slack", SLACKS)
def test_quasi_steady_is_the_equilibrium_of_the_dynamic_tether(n, slack):
    quasi, tether, expected = at_rest("TetherQuasiSteady", n, slack)
    model, _, outputs = at_rest("TetherDynamic", n, slack)
    assert_same_rest(model, outputs, quasi, expected)
    missing, tensions = residual(quasi.positions, np.zeros(3), WIND, tether, ENVIRONMENT)
    assert np.abs(missing).max() < 1e-9 * tensions.max()  # rounding of the stretch of stiff segments, EA/l0 1e-16 |x|
    for _ in range(50):  # 5 s; the time integration has its own forces
        outputs = model.step(0.1, **HOLD)
    assert_same_rest(model, outputs, quasi, expected)


EULER = {"fixed_step": 0.02, "fixed_step_method": "backward_euler"}


@pytest.mark.parametrize(
    ("n", "slack", "solver", "steps"), [*((n, slack, EULER, 300) for n in NUMBERS for slack in SLACKS), (20, 0.2, {}, 400)]
)
def test_dynamic_tether_settles_there(n, slack, solver, steps):
    """From a straight line. Implicit Euler steps of 20 ms damp the waves; they have no influence on where it settles.

    With adaptive steps nothing but the drag does: the slowest one by a factor of e in about 12 s.
    """
    quasi, _, expected = at_rest("TetherQuasiSteady", n, slack)
    model, _, start = at_rest("TetherDynamic", n, slack, initial_shape=3, **solver)
    assert np.linalg.norm(start.kite_force - expected.kite_force) > 1e-3 * np.linalg.norm(expected.kite_force)
    for _ in range(steps):
        outputs = model.step(1.0, **HOLD)
    assert_same_rest(model, outputs, quasi, expected)
