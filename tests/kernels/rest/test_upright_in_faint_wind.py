"""A slack tether that hangs almost straight above or below its station in a faint wind from the side has an equilibrium.

Hardly anything keeps its fold from turning about its chord. Each start must be in balance by `balance.py`, from its node
positions x alone, and stable: no eigenvalue of dF/dx, the derivative of the forces by the positions, has a positive real
part.
"""

from itertools import product

import numpy as np
import pytest

from balance import residual
from tetherfmu import TetherQuasiSteady
from tetherfmu.runtime.parameters import Environment, Tether

DISTANCE = 500.0


def start(n, slack, up, wind, aside):
    """Start of a quasi-steady tether in a wind [m/s] along y, with the kite a little aside [m] along x."""
    tether = Tether(segments=n, initial_length=DISTANCE / (1.0 - slack))
    model = TetherQuasiSteady(tether)
    model.initialize((aside, 0.0, up * DISTANCE), wind_velocity=(0.0, wind, 0.0))
    return tether, model


def forces(positions, tether, wind):
    """Forces [N] that are missing for the equilibrium of the inner nodes, flat, and the tensions [N]."""
    missing, tensions = residual(positions, np.zeros(3), (0.0, wind, 0.0), tether, Environment())
    return missing.ravel(), tensions


def slope(positions, tether, wind, change=1e-6):
    """dF/dx [N/m] of the inner nodes, by differences."""
    columns = []
    for k in range(3, positions.size - 3):
        moved = np.where(np.arange(positions.size) == k, change, 0.0).reshape(positions.shape)
        sides = [forces(positions + sign * moved, tether, wind)[0] for sign in (1.0, -1.0)]
        columns.append((sides[0] - sides[1]) / (2.0 * change))
    return np.transpose(columns)


# by steps 1 to 6 all of them are refused
@pytest.mark.parametrize(
    ("n", "slack", "up", "wind", "aside"),
    [
        (2, 0.8, 1, 1.0, 1e-6),
        (5, 0.9, -1, 1.0, 1e-6),
        (10, 0.02, 1, 0.1, 0.1),
        (10, 0.9, 1, 0.2, 1e-3),
        (15, 0.3, 1, 0.1, 1.0),
        (30, 0.1, -1, 0.1, 1.0),
        (50, 0.7, 1, 0.2, 0.1),
    ],
)
def test_found_in_balance_and_stable(n, slack, up, wind, aside):
    tether, model = start(n, slack, up, wind, aside)
    missing, tensions = forces(model.positions, tether, wind)
    # Newton's method stops at 1e-12 of the forces (100 times that for the other order of sums) or the rounding of springs
    segment = tether.initial_length / n
    rounding = tether.axial_stiffness / segment * 2.3e-16 * (np.abs(model.positions).max() + segment)
    assert np.abs(missing).max() < 1e-10 * tensions.max() + 8.0 * np.sqrt(n) * rounding
    # the softest of the others has some 1e-2 N/m, differences of springs of 1e5 N/m have an error of 1e-7 N/m
    assert np.linalg.eigvals(slope(model.positions, tether, wind)).real.max() < -1e-6


def test_none_is_refused():
    """Step 7 of docs/models/numerics.md, "Initial shape"; steps 1 to 6 refuse 314 of them."""
    cases = (10, 15, 20, 30, 50), (0.02, 0.1, 0.3, 0.5, 0.7, 0.9), (1, -1)
    cases += (0.1, 0.2, 0.5, 1.0, 2.0, 4.0), (1e-6, 1e-3, 0.1, 1.0, 5.0, 20.0)
    assert len(list(product(*cases))) == 2160
    for case in product(*cases):
        start(*case)
