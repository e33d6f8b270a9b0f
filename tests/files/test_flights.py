"""Flights: velocities are derivatives of positions, and each kind is what its name says."""

import numpy as np
import pytest

from tetherfmu.files.flights import KINDS, FigureOfEight, Launch, Reel, Towing
from tetherfmu.files.scene_files import Wind

TIMES = np.linspace(0.3, 31.7, 200)
STEP = 1e-4


@pytest.mark.parametrize("kind", KINDS)
def test_velocities_are_derivatives_of_positions(kind):
    """Central differences: rounding 1e-13 |p|/STEP and h^2/6 |p'''| are below 1e-5 of the speeds here, or 1e-6 m/s."""
    flight = KINDS[kind]()
    before, now, after = (flight.motion(TIMES + shift) for shift in (-STEP, 0.0, STEP))
    for position, velocity in (("kite", "kite_velocity"), ("ground", "ground_velocity"), ("reeled", "reel_out_speed")):
        slope = (getattr(after, position) - getattr(before, position)) / (2.0 * STEP)
        assert getattr(now, velocity) == pytest.approx(slope, rel=1e-5, abs=1e-5)


def test_figure_of_eight_is_flown_in_laps_of_the_given_speed():
    """The sphere shortens the width by cos of the elevation, between 13 and 25 % here; a lap closes."""
    flight = FigureOfEight(elevation=0.0)
    speeds = np.linalg.norm(flight.motion(np.linspace(0.0, 20.0, 400, endpoint=False)).kite_velocity, axis=1)
    assert speeds.mean() == pytest.approx(40.0, rel=0.01)
    assert flight.kite(20.0) == pytest.approx(flight.kite(0.0))


def test_reel_goes_out_and_in_at_the_given_speed():
    motion = Reel(ramp_time=3.0, phase_time=15.0).motion(np.array([1.5 + 3.0, 20.0, 40.0]))
    assert motion.reel_out_speed == pytest.approx([8.0, -8.0, 0.0])
    assert motion.reeled[-1] == pytest.approx(0.0, abs=1e-9)


def test_launch_is_at_the_end_of_its_tether():
    flight = Launch()
    assert np.linalg.norm(flight.kite(TIMES), axis=0) == pytest.approx(30.0)


def test_towing_vehicle_reaches_its_speed():
    motion = Towing(speed=10.0, ramp_time=10.0).motion(np.array([0.0, 5.0, 12.0]))
    assert motion.ground_velocity[:, 0] == pytest.approx([0.0, 5.0, 10.0])


def test_gust_is_highest_half_way():
    """v (1 + g sin^2(pi t/P))"""
    wind = Wind((8.0, 0.0, 1.0), gust=0.5, gust_period=10.0)
    assert wind(np.array([0.0, 5.0])) == pytest.approx(np.array([[8.0, 0.0, 1.0], [12.0, 0.0, 1.5]]))
