"""At rest the two end forces carry the whole tether: ground_force + kite_force = weight + drag, for every tether.

The drag 1/2 rho cd d l |w| w of each segment is summed here with numpy from the node positions alone; of the lines without
nodes that of 800 pieces of their shape.
"""

from itertools import product

import numpy as np
import pytest

from mechanics import drag, line_density
from tetherfmu import Environment, Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight

KITE = np.array([300.0, 50.0, 400.0])
CHORD = np.linalg.norm(KITE)
CHAINS, LINES = (TetherDynamic, TetherQuasiSteady), (TetherCatenary, TetherStraight)
# Positions near 500 m are rounded at 6e-14 m; with EA/l0 = 5e4 N/m at n = 40 that is 3e-9 N per segment and direction,
# some 1e-8 N in all. The taut tether (slack 0.995) bends that by nothing.
ROUNDING = 1e-7


def missing_force(n, slack, wind, air, kite=KITE, variant=TetherDynamic):
    """Sum of the end forces minus weight and drag, and weight and drag [N]."""
    tether = Tether(segments=n, initial_length=slack * CHORD)
    model = variant(tether, air, shape_points=801)
    outputs = model.initialize(kite_position=kite, wind_velocity=wind)
    x = outputs.shape if variant in LINES else model.positions
    weight = np.array([0.0, 0.0, -line_density(tether) * tether.initial_length * air.gravity])
    loads = weight + drag(x, np.zeros_like(x), wind, tether, air)
    return outputs.ground_force + outputs.kite_force - loads, loads


@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (8.0, 0.0, 0.0), (6.0, 9.0, 0.5), (3.0, 80.0, 1.0)], ids=str)
@pytest.mark.parametrize("slack", [0.995, 1.0001, 1.05, 1.2, 1.4])
@pytest.mark.parametrize(("variant", "n"), [*product(CHAINS, (1, 2, 6, 20, 40)), *product(LINES, (1,))])
def test_weight_and_drag(variant, n, slack, wind):
    """A hurricane, too. A catenary has its load at 8 places, which are few where it bends most; found: 5e-5, 2.3e-3."""
    missing, loads = missing_force(n, slack, wind, Environment(), variant=variant)
    part = 1e-9 if variant is not TetherCatenary else 1e-4 if slack <= 1.2 else 4e-3
    np.testing.assert_allclose(missing, 0.0, atol=ROUNDING + part * np.linalg.norm(loads))


@pytest.mark.parametrize("variant", CHAINS)
@pytest.mark.parametrize("scale_height", [0.0, 8550.0])
@pytest.mark.parametrize("slack", [0.999, 1.02, 1.2])
@pytest.mark.parametrize("n", [1, 2, 7, 20])
def test_weight_and_drag_of_winds_at_the_nodes(n, slack, scale_height, variant):
    """Each segment meets the mean of the winds at its nodes."""
    winds = np.array([12.0, 0.0, 0.0]) + 5.0 * np.random.default_rng(1).normal(size=(n + 1, 3))
    missing, _ = missing_force(n, slack, winds, Environment(air_density_scale_height=scale_height), variant=variant)
    np.testing.assert_allclose(missing, 0.0, atol=ROUNDING)


# Slack in gales, coarse chains that hold a segment in compression, a short tether whose springs are all rounding.
HARD = [
    (2, (0.78, 5.6, 8.08), 13.8, (0.0, 0.0, 0.0)),
    (6, (60.0, 20.0, 3.0), 70.0, (1.0, 20.0, 3.0)),
    (20, (-3.556, -1.761, -13.3), 14.55, (0.0, 0.0, 0.0)),
    (20, (2.054, -2.174, -11.442), 26.98, (0.0, 0.0, 0.0)),
    (20, (16.24, -9.18, -0.93), 78.46, (0.485, 1.935, 1.102)),
    (20, (13.677, 2.463, 7.957), 31.27, (12.28, -1.98, 11.05)),
]


@pytest.mark.parametrize(("n", "kite", "length", "wind"), HARD)
def test_weight_and_drag_of_a_hard_case(n, kite, length, wind):
    missing, _ = missing_force(n, length / CHORD, wind, Environment(), kite)
    # EA/l0 reaches 8e5 N/m here: positions of 15 m rounded at 2e-15 m make 2e-9 N per node, and the equilibrium may stop
    # at 100 times that when it falls no further
    np.testing.assert_allclose(missing, 0.0, atol=1e-5 * 0.0893 * length)


@pytest.mark.parametrize(("profile", "scale_height"), [*product([1, 2, 3, 4], [0.0, 8550.0])])
@pytest.mark.parametrize("kite", [KITE, (400.0, 100.0, 60.0), (200.0, 0.0, -300.0)], ids=["high", "dips", "below"])
def test_weight_and_drag_in_a_profile(profile, scale_height, kite):
    air = Environment(wind_profile=profile, air_density_scale_height=scale_height, gravity=9.5)
    missing, _ = missing_force(15, 1.1 * np.linalg.norm(kite) / CHORD, (5.0, -2.0, 0.0), air, kite)
    np.testing.assert_allclose(missing, 0.0, atol=ROUNDING)
