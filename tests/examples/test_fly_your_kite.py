"""The closed loop of a kite in Python with the free tether: it comes to rest where the forces on the kite balance."""

import numpy as np
import pytest
from running import run

from tetherfmu.runtime.parameters import Tether


def test_the_kite_finds_its_elevation(fmu_folder):
    said = run(
        fmu_folder,
        "import fly_your_kite, numpy\n"
        "rows = fly_your_kite.fly(circular_flight.find_fmu('TetherDynamicFree'))\n"
        "print(*numpy.mean(rows[-1000:], axis=0), numpy.ptp(rows[-1000:, 1:4]))\n",
    )
    _, x, y, z, *velocity, tension, _ = map(float, said.split()[-9:])
    pressure = 0.5 * 1.225 * 10.0 * 8.0**2
    lift, drag = 0.7 * pressure, 0.15 * pressure
    weight, tether = 10.0 * 9.81, Tether().mass_per_meter * 200.0 * 9.81
    # weight and drag of the tether (a few N) turn the chord down from the direction at the kite
    steepest = np.arctan2(lift - weight, drag)
    flattest = np.arctan2(lift - weight - tether, drag + 20.0)
    assert flattest < np.arctan2(z, x) < steepest
    assert abs(y) < 1e-6
    assert tension == pytest.approx(np.hypot(lift - weight, drag), rel=0.1)
    np.testing.assert_allclose(velocity, 0.0, atol=0.3)  # it still swings a little
