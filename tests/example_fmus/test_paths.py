"""Where the prescribed kite is led, and where the controller steers."""

import sys
from pathlib import Path

import numpy as np
import pytest

from example_fmus.example_slaves import Model

sys.path.append(str(Path(__file__).resolve().parents[2] / "examples"))
from first_flight import circular_flight

AHEAD = {"kite_position": (170.0, 0.0, 100.0), "apparent_wind_speed": 15.0, "ground_tension": 1200.0, "tether_length": 250.0}


def test_the_circle_is_that_of_the_example():
    kite = Model("KiteOnPath")
    for k in range(200):
        position, velocity = circular_flight.circle(0.5 * k, 0.05)
        np.testing.assert_allclose(kite.get("kite_position"), position, rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(kite.get("kite_velocity"), velocity, rtol=0.0, atol=1e-12)
        kite.step(0.5)


@pytest.mark.parametrize("path", [1, 2])
def test_velocity_is_the_rate_of_the_position(path):
    kite = Model("KiteOnPath", path=path, rate=0.3, elevation=0.5, azimuth=0.2)
    step, rows = 1e-3, []
    for _ in range(2000):
        rows.append([*kite.get("kite_position"), *kite.get("kite_velocity")])
        kite.step(step)
    position, velocity = np.split(np.array(rows), 2, axis=1)
    # central difference: h^2/6 times the third derivative, 500 m (0.6/s)^3
    np.testing.assert_allclose((position[2:] - position[:-2]) / (2.0 * step), velocity[1:-1], rtol=0.0, atol=5e-5)
    np.testing.assert_allclose(np.linalg.norm(position, axis=1), 500.0, rtol=1e-12)


def test_steers_to_the_side_of_the_eight():
    """First to the left of the wind (+y), where a kite that flies upwards has to turn left, one that flies down right."""
    for heading, sign in ((0.0, -1.0), (-3.0, 1.0)):
        assert np.sign(Model("FlightController", heading=heading, **AHEAD).get("steering")) == sign


def test_steers_against_its_weight():
    """Without course control: c1 |v_a| u + c2/|v_a| sin(psi) cos(beta) = 0."""
    steering = Model("FlightController", course_gain=0.0, heading=1.0, **AHEAD).get("steering")
    turning = 0.0613 * 15.0 * steering + 1.226 / 15.0 * np.sin(1.0) * 170.0 / np.hypot(170.0, 100.0)
    assert turning == pytest.approx(0.0, abs=1e-15)
    assert steering < 0.0


def test_traction_speed_is_the_root_of_the_tension():
    controller = Model("FlightController", **AHEAD)
    controller.step(0.02)
    assert controller.get("set_speed") == pytest.approx((1200.0 / 300.0) ** 0.5, rel=1e-12)


def test_phases_change_with_the_length():
    """Depower goes to 1 and back at its rate; reeling in is slower the more the tether pulls, and rests at its limit."""
    controller = Model("FlightController", input_continuation=2, **AHEAD)
    for length, phase, depower in ((351.0, 2, 0.3), (250.0, 2, 0.6), (199.0, 1, 0.3), (250.0, 1, 0.0), (250.0, 1, 0.0)):
        for _ in range(10):
            controller.step(0.1, tether_length=length)
        assert (controller.get("phase"), controller.get("depower")) == (phase, pytest.approx(depower, abs=1e-9))
    for tension, speed in ((900.0, -4.0), (2000.0, 0.0)):
        for _ in range(50):
            controller.step(0.1, tether_length=400.0, ground_tension=tension)
        assert controller.get("set_speed") == pytest.approx(speed, abs=1e-9)


def test_wrong_lengths_are_named():
    with pytest.raises(ValueError, match=r"shortest_length is 400\.0; it must be less than longest_length"):
        Model("FlightController", shortest_length=400.0, longest_length=300.0, **AHEAD)
