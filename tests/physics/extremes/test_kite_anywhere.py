"""A kite that flies through the zenith, below the ground station, and through the station's own position.

lines           have no memory: on any way they give what they give when they start there
quasi-steady    the same while the kite turns about the station. Towards the station its rate of stretching r . u/|r|^2 has
                no bound: there it may refuse, but recovers when the kite rests
dynamic         energy stays accounted for on the way; afterwards it comes to rest in the equilibrium of a fresh tether
"""

import numpy as np
import pytest

from audited import run
from tetherfmu import StepRefused, Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight

STEP, COUNT = 0.02, 200
WIND = (5.0, 1.0, 0.0)
PATHS = {
    "zenith": ((-40.0, 0.0, 80.0), (20.0, 0.0, 0.0)),
    "below": ((50.0, 0.0, 30.0), (0.0, 0.0, -20.0)),
    "through the station": ((-40.0, 0.0, 0.0), (20.0, 0.0, 0.0)),
    "down through the station": ((0.0, 0.0, 40.0), (0.0, 0.0, -20.0)),
}
TETHER = Tether(segments=10, initial_length=100.0)


@pytest.fixture(params=PATHS)
def path(request):
    """Inputs at a time; after 100 steps the kite is over, level with, or in the station."""
    start, velocity = np.array(PATHS[request.param])
    return lambda time: {"kite_position": start + velocity * time, "kite_velocity": velocity, "wind_velocity": WIND}


def assert_same(out, fresh, allowed):
    """All that is a continuous function of the ends; a direction is not, where they meet."""
    for name in ("ground_force", "kite_force", "sag", "shape"):
        value, expected = getattr(out, name), getattr(fresh, name)
        scale = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(value, expected, rtol=0, atol=allowed * scale, err_msg=name)


@pytest.mark.parametrize("variant", [TetherStraight, TetherCatenary])
def test_a_line_has_no_memory(variant, path):
    model, fresh = variant(TETHER, shape_points=11), variant(TETHER, shape_points=11)
    model.initialize(**path(0.0))
    for k in range(COUNT):
        out = model.step(STEP, **path(k * STEP))
        # the kite arrives within rounding; Newton's method of the catenary ends at 1e-10 of the load
        assert_same(out, fresh.initialize(**path((k + 1) * STEP)), 1e-8)


def rested(model, position):
    """Outputs after three steps with the kite at rest: its speed is estimated from the last two inputs."""
    for _ in range(3):
        out = model.step(STEP, position, (0.0, 0.0, 0.0), wind_velocity=WIND)
    return out


def test_quasi_steady_recovers(path, request):
    """Past the zenith nothing is refused."""
    model, refused = TetherQuasiSteady(TETHER), 0
    model.initialize(**path(0.0))
    for k in range(COUNT):
        try:
            out = model.step(STEP, **path(k * STEP))
        except StepRefused:
            refused += 1
        assert all(np.all(np.isfinite(value)) for value in out)
    end = path(COUNT * STEP)
    if request.node.callspec.params["path"] == "zenith":
        assert refused == 0
        assert_same(out, TetherQuasiSteady(TETHER).initialize(**end), 1e-6)
    fresh = TetherQuasiSteady(TETHER).initialize(end["kite_position"], wind_velocity=WIND)
    assert_same(rested(model, end["kite_position"]), fresh, 1e-6)  # both find the only equilibrium under tension


def dynamic_flight(path, pieces=10):
    """A dynamic tether after the path, and energy from nowhere over the turnover on the way; `pieces` audits per STEP."""
    model = TetherDynamic(TETHER, initial_shape="static_equilibrium")
    model.initialize(**path(0.0))
    result = run(model, path, STEP / pieces, pieces * COUNT)
    return model, np.abs(result.residual).max() / result.turnover


def test_dynamic_tether_accounts_for_its_energy_and_comes_to_rest(path):
    model, residual = dynamic_flight(path)
    # trapezoidal rule with 2 ms through jerks of some ms; it falls when they are halved
    assert residual < 0.01
    end = path(COUNT * STEP)["kite_position"]
    for _ in range(1500):
        out = model.step(STEP, end, (0.0, 0.0, 0.0), wind_velocity=WIND)
    expected = TetherDynamic(TETHER).initialize(end, wind_velocity=WIND)
    # 30 s of swinging in a breeze: 4 cm of 100 m are left
    np.testing.assert_allclose(out.shape, expected.shape, rtol=0, atol=0.1)
    np.testing.assert_allclose(out.kite_force, expected.kite_force, rtol=0, atol=0.02)
