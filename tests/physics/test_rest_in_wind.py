"""At rest in wind: the quasi-steady tether, the dynamic tether's first shape, and where the dynamic tether settles are one.

And for every variant, what it gives to its ends is all that acts on it:

    ground_force + kite_force = weight + drag,    weight = -mu L g e_z

Drag is that of the segments for a chain; 1/2 rho cd d |w| w times c for the straight line and times L for the catenary,
where w is the wind across the chord of length c.
"""

import numpy as np
import pytest

from balance import VARIANTS, residual, weight
from mechanics import drag
from tetherfmu.python import models
from tetherfmu.runtime.parameters import Environment, Solver, Tether

KITE = np.array([240.0, -180.0, 400.0])  # 500 m away
WIND = (10.0, 0.0, 0.0)
HOLD = {"kite_position": KITE, "wind_velocity": WIND}
ENVIRONMENT = Environment()
every_slack = pytest.mark.parametrize("slack", [-0.005, 0.0, 0.02, 0.2])
every_n = pytest.mark.parametrize("n", [5, 20, 60])


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


@every_n
@every_slack
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


@every_n
@every_slack
def test_dynamic_tether_settles_there(n, slack):
    """From a straight line. Implicit Euler steps of 20 ms damp the waves; they have no influence on where it settles."""
    quasi, _, expected = at_rest("TetherQuasiSteady", n, slack)
    model, _, start = at_rest("TetherDynamic", n, slack, initial_shape=3, **EULER)
    assert np.linalg.norm(start.kite_force - expected.kite_force) > 1e-3 * np.linalg.norm(expected.kite_force)
    for _ in range(300):
        outputs = model.step(1.0, **HOLD)
    assert_same_rest(model, outputs, quasi, expected)


def test_dynamic_tether_settles_there_with_the_adaptive_solver():
    """Nothing but the drag damps these waves: the slowest one by a factor of e in about 12 s."""
    quasi, _, expected = at_rest("TetherQuasiSteady", 20, 0.2)
    model, _, _ = at_rest("TetherDynamic", 20, 0.2, initial_shape=3)
    for _ in range(400):
        outputs = model.step(1.0, **HOLD)
    assert_same_rest(model, outputs, quasi, expected)


@every_slack
@pytest.mark.parametrize("n", [1, 20])
@pytest.mark.parametrize("variant", VARIANTS)
def test_end_forces_add_up_to_weight_and_drag(variant, n, slack):
    model, tether, outputs = at_rest(variant, n, slack)
    if variant == "TetherCatenary":  # that of its shape, here of 800 pieces
        positions = models.TetherCatenary(tether, ENVIRONMENT, shape_points=801).initialize(**HOLD).shape
    else:
        positions = np.outer([0.0, 1.0], KITE) if variant == "TetherStraight" else model.positions
    loads = weight(tether, ENVIRONMENT) + drag(positions, 0.0 * positions, WIND, tether, ENVIRONMENT)
    # 3 kN at the ends cancel: 1e-10 is rounding; a chain adds residuals of nodes, a catenary has 8 places
    allowed = 1e-4 * np.linalg.norm(loads) if variant == "TetherCatenary" else 1e-7
    assert np.allclose(outputs.ground_force + outputs.kite_force, loads, rtol=0.0, atol=allowed)
