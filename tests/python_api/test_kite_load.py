"""TetherDynamicFree of the Python API: the dynamic tether with a free end and a point mass there, by shorter words."""

import numpy as np
import pytest

from scenes import same
from tetherfmu import StepRefused, TetherDynamic, TetherDynamicFree, inputs_along

KITE, WIND, LOAD = (300.0, 0.0, 400.0), (8.0, 1.0, 0.0), (150.0, 20.0, 300.0)


def started(segments=8, **options):
    tether = TetherDynamicFree(segments=segments, **options)
    tether.initialize(KITE, wind_velocity=WIND)
    return tether


def test_is_the_dynamic_tether_with_a_free_end_and_a_point_mass():
    short = started(kite_mass=12.0, point_masses={3: 1.0, 8: 2.0})
    long = TetherDynamic(segments=8, free_ends=(False, True), point_masses={3: 1.0, 8: 14.0})
    long.initialize(KITE, wind_velocity=WIND)
    for _ in range(20):
        assert same(short.step(0.02, kite_load=LOAD), long.step(0.02, kite_load=LOAD))


def test_outputs_have_the_motion_of_the_kite():
    tether = started()
    assert tether.outputs().kite_position.tolist() == list(KITE)
    outputs = tether.step(0.02, LOAD)
    np.testing.assert_array_equal(outputs.kite_position, tether.positions[-1])
    np.testing.assert_array_equal(outputs.kite_velocity, tether.velocities[-1])
    assert np.linalg.norm(outputs.kite_velocity) > 0.0


def test_a_load_stays_and_is_none_after_a_new_start():
    kept, given, without = started(), started(), started()
    for tether in (kept, given):
        tether.step(0.02, kite_load=LOAD)
    assert same(kept.step(0.02), given.step(0.02, kite_load=LOAD))
    kept.initialize(KITE, wind_velocity=WIND)
    assert same(kept.step(0.02), without.step(0.02))


def test_the_motion_of_the_kite_is_no_input():
    tether = started()
    with pytest.raises(TypeError, match="kite_position"):
        tether.step(0.02, kite_position=KITE)
    with pytest.raises(ValueError, match=r"kite_load is 3\.0; it must be three numbers"):
        tether.step(0.02, kite_load=3.0)


def test_a_load_that_is_no_number_is_refused():
    refused, twin = started(), started()
    with pytest.raises(StepRefused, match=r"the input kite_load\[3\] is nan; it must be a finite number"):
        refused.step(0.02, kite_load=(0.0, 0.0, np.nan))
    assert same(refused.step(0.02), twin.step(0.02))


@pytest.mark.parametrize("mass", [-1.0, np.nan, 1e10, "heavy"])
def test_a_mass_out_of_range_is_refused(mass):
    with pytest.raises(ValueError, match=f"kite_mass is {mass!r}; it must be at least 0 kg and at most 1e"):
        TetherDynamicFree(kite_mass=mass)


def test_a_flight_in_compiled_code_equals_a_loop():
    def load(time):
        return np.add(LOAD, (10.0 * time, 0.0, 0.0))

    looped, flown = started(), started()
    rows = [looped.step(0.02, kite_load=load(0.02 * k), wind_velocity=WIND) for k in range(30)]
    flight = flown.fly(inputs_along(30, 0.02, wind_velocity=WIND, kite_load=load), 0.02)
    np.testing.assert_array_equal(flight.kite_force, [row.kite_force for row in rows])
    np.testing.assert_array_equal(flight.positions[:, -1], [row.kite_position for row in rows])
