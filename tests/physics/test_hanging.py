"""A hanging chain at rest converges to the elastic catenary with order 2.

Catenary (Irvine 1981, section 1.3): tension (H, V) at the ground end, (H, V + w L) at the kite, w = mu g,

    span = H L/EA + H/w (asinh((V + w L)/H) - asinh(V/H)),   rise = L (V + w L/2)/EA + (T_kite - T_ground)/w

The ends of the chain carry the weight of half a segment each; with it the end forces converge with order 2, without it
with order 1.
"""

import numpy as np
import pytest

from mechanics import elastic_catenary, line_density
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Tether

KITE = np.array([100.0, 100.0, 800.0])
LENGTH = 853.0240324867758
GROUND_FORCE = np.array([2.7950759559722207 / 2**0.5, 2.7950759559722207 / 2**0.5, -1.5790958788949883])
KITE_FORCE = np.array([-2.7950759559722207 / 2**0.5, -2.7950759559722207 / 2**0.5, -74.55491405628115])
LOAD = 0.08925189330624916


def at_rest(n, kite, length):
    return TetherDynamic(Tether(segments=n, initial_length=length)).initialize(kite_position=kite)


def test_scipy_catenary_agrees_with_published_numbers():
    h, v = elastic_catenary(np.hypot(100.0, 100.0), 800.0, LENGTH, LOAD, 614600.0)
    # the solver above stops at 1e-13 of its unknowns; the conditioning of H costs a few digits
    np.testing.assert_allclose((h, v), (2.7950759559722207, -1.5790958788949883), rtol=1e-9)
    assert line_density(Tether()) * 9.81 == pytest.approx(LOAD, rel=1e-14)


@pytest.mark.parametrize(("end", "exact"), [("ground_force", GROUND_FORCE), ("kite_force", KITE_FORCE)])
def test_end_forces_converge_with_order_two(end, exact):
    numbers = [10, 20, 40, 80]
    error = [np.linalg.norm(getattr(at_rest(n, KITE, LENGTH), end) - exact) for n in numbers]
    order = -np.diff(np.log(error)) / np.log(2.0)
    # at n = 10 the bottom of this steep catenary is one segment: the order comes down to 2 from 2.9, and is 1.97 from 40
    # to 80; without the weight of the end nodes it is 1
    np.testing.assert_allclose(order[-1], 2.0, atol=0.05)
    assert np.all(order > 1.9)
    assert error[1] < 0.005 * np.linalg.norm(KITE_FORCE)


def test_lumped_chain_of_22_segments():
    outputs = at_rest(22, KITE, LENGTH)
    end_weight = np.array([0.0, 0.0, 0.5 * LOAD * LENGTH / 22])
    # the published numbers have 5 decimals
    np.testing.assert_allclose(outputs.ground_force + end_weight, (1.92751, 1.92751, 0.042482), atol=6e-6)
    np.testing.assert_allclose(outputs.kite_force + end_weight, (-1.92751, -1.92751, -72.71586), atol=6e-6)


@pytest.mark.parametrize(
    ("kite", "length"),
    [((400.0, 0.0, 0.0), 401.0), ((100.0, 0.0, 0.0), 150.0), ((30.0, 0.0, -60.0), 100.0), ((0.0, 300.0, 300.0), 424.0)],
    ids=["equal height", "equal height, slack", "below, slack", "taut"],
)
def test_richardson_extrapolation_is_the_catenary(kite, length):
    h, v = elastic_catenary(np.hypot(kite[0], kite[1]), kite[2], length, LOAD, 614600.0)
    direction = np.array([kite[0], kite[1], 0.0]) / np.hypot(kite[0], kite[1])
    exact = h * direction + (0.0, 0.0, v)
    coarse, fine = at_rest(60, kite, length), at_rest(120, kite, length)
    size = LOAD * length + h
    # left after the terms of order 2: order 4 with a factor of order 10, 10/60^4 = 8e-7; 2e-6 is a hundredth of the
    # plain error at n = 120
    np.testing.assert_allclose((4 * fine.ground_force - coarse.ground_force) / 3, exact, atol=2e-6 * size)
    np.testing.assert_allclose(
        (4 * fine.kite_force - coarse.kite_force) / 3, (0, 0, -LOAD * length) - exact, atol=2e-6 * size
    )
