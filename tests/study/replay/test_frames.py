"""Geodetic coordinates to east, north, up against the transform by the centre of the Earth, and columns to SI units."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.replay.known_flight import seen_from_origin
from tetherfmu.files.csv_files import Table
from tetherfmu.study.replay import frames, log, readings
from tetherfmu.study.replay.columns import read

ROUNDING = 1e-7  # m: 6e6 m from the centre, 16 digits, some operations
ORIGINS = [
    (51.769, 4.119, -4.2),
    (54.126, -9.781, 19.3),
    (-33.9, 151.2, 30.0),
    (0.0, 0.0, 0.0),
    (78.2, 15.6, 500.0),
    (-21.0, 179.99, 5.0),
]


@pytest.mark.parametrize("origin", ORIGINS)
def test_points_are_those_of_the_transform_by_the_centre_of_the_earth(origin):
    random = np.random.default_rng(1)
    degrees = np.array(origin) + random.uniform(-1.0, 1.0, (200, 3)) * (0.02, 0.02, 1000.0)
    right = seen_from_origin(*degrees.T, origin)
    assert np.abs(frames.local(*degrees.T, origin) - right).max() < ROUNDING


def test_a_minute_of_latitude_is_a_nautical_mile_and_some_metres():
    """Meridian arc of WGS 84 at 45 deg: M = a (1 - e2) / (1 - e2/2)^1.5 = 6367381.8 m, times 1/60 deg: 1852.2 m."""
    ((east, north, up),) = frames.local([45.0 + 1.0 / 120.0], [7.0], [0.0], (45.0 - 1.0 / 120.0, 7.0, 0.0))
    assert abs(east) < ROUNDING
    assert north == pytest.approx(np.radians(1.0 / 60.0) * 6367381.8, abs=2e-3)
    assert up == pytest.approx(-(1852.2**2) / (2.0 * 6367382.0), rel=1e-3)


def test_the_date_line_is_no_border():
    ((east, _, _),) = frames.local([-21.0], [-179.999], [0.0], (-21.0, 179.999, 0.0))
    assert east == pytest.approx(np.radians(0.002) * 6378137.0 * np.cos(np.radians(21.0)), rel=1e-3)


@pytest.mark.parametrize("origin", ORIGINS)
def test_an_origin_is_found_from_both_positions_of_a_receiver(origin):
    random = np.random.default_rng(2)
    degrees = np.array(origin) + random.uniform(-1.0, 1.0, (500, 3)) * (3e-3, 3e-3, 200.0)
    metres = seen_from_origin(*degrees.T, origin)
    degrees[:100:7], metres[3:100:9] = np.nan, 1e42
    degrees[100:110, :2] = 0.0  # no fix yet
    found = frames.origin_of(degrees, np.where(metres > 1e10, np.nan, metres))
    assert np.abs(np.array(found) - origin).max() < 1e-8  # deg and m: rounding 6e6 m from the centre
    shaken = frames.origin_of(degrees, metres + random.normal(0.0, 1.0, metres.shape))
    assert np.abs(seen_from_origin(*np.array(shaken)[:, None], origin)).max() < 0.3  # m: 1.25 / sqrt(500) of 1 m, five times


def two_positions():
    random = np.random.default_rng(3)
    degrees = np.array(ORIGINS[0]) + random.uniform(-1.0, 1.0, (500, 3)) * (3e-3, 3e-3, 200.0)
    return degrees, seen_from_origin(*degrees.T, ORIGINS[0])


@pytest.mark.parametrize(
    "wrong",
    [
        lambda degrees, metres: (degrees[:, [1, 0, 2]], metres),
        lambda degrees, metres: (np.radians(degrees), metres),
        lambda degrees, metres: (degrees, metres[:, [1, 0, 2]]),
        lambda degrees, metres: (degrees, -metres),
        lambda degrees, metres: (degrees, metres / 0.3048),
        lambda degrees, metres: (degrees, metres[::-1]),
    ],
    ids=["latitude and longitude swapped", "radians", "axes swapped", "signs", "feet", "other rows"],
)
def test_positions_that_are_not_the_same_have_no_origin(wrong):
    with pytest.raises(ValueError, match="the origin cannot be found: its positions in degrees and in metres differ by"):
        frames.origin_of(*wrong(*two_positions()))


def test_no_positions_have_no_origin():
    degrees, metres = two_positions()
    with pytest.raises(ValueError, match="no row has a position in degrees and in metres"):
        frames.origin_of(degrees, np.full_like(metres, np.nan))


def log_of(map_table, **readings):
    """`Log` of 40 rows of the same readings."""
    time = np.arange(40) * 0.1
    cells = pd.DataFrame({"time": time, **readings})
    return log.log_of(Table(cells.astype(str)), read(map_table, "own"))


POINTS = {"kite_position": {"x": "x", "y": "y", "z": "z"}}
METRES = {"x": 100.0, "y": 20.0, "z": 150.0}


@pytest.mark.parametrize(
    ("axes", "right"),
    [
        ({"x": "a", "y": "b", "z": "c"}, (1.0, 2.0, 3.0)),
        ({"east": "a", "north": "b", "up": "c"}, (1.0, 2.0, 3.0)),
        ({"north": "a", "east": "b", "down": "c"}, (2.0, 1.0, -3.0)),
        ({"west": "a", "south": "b", "up": "c"}, (-1.0, -2.0, 3.0)),
        ({"north": "a", "west": "b", "up": "c", "unit": "km/h"}, (-2.0 / 3.6, 1.0 / 3.6, 3.0 / 3.6)),
        ({"x": "a", "y": "b", "z": "c", "unit": "kn"}, tuple(np.array([1.0, 2.0, 3.0]) * 1852.0 / 3600.0)),
        ({"x": "a", "y": "b", "z": "c", "unit": "ft/s"}, (0.3048, 0.6096, 0.9144)),
    ],
)
def test_velocities_are_turned_to_east_north_up(axes, right):
    found = log_of({**POINTS, "kite_velocity": axes}, **METRES, a=1.0, b=2.0, c=3.0)
    assert np.allclose(found.of(readings.VELOCITY)[0], right, rtol=1e-12)


@pytest.mark.parametrize(
    ("unit", "newton"), [("N", 1.0), ("kN", 1000.0), ("kgf", 9.80665), ("lbf", 4.4482216152605), ("MN", 1e6)]
)
def test_tensions_are_in_newton(unit, newton):
    found = log_of({**POINTS, "ground_tension": {"column": "f", "unit": unit}}, **METRES, f=2.0)
    assert found.table["ground_tension"][0] == pytest.approx(2.0 * newton, rel=1e-12)


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("ft", 0.3048), ("km", 1000.0), ("cm", 0.01), ("mm", 0.001)])
def test_positions_are_in_metres(unit, metres):
    found = log_of({"kite_position": {"x": "x", "y": "y", "down": "z", "unit": unit}}, x=2.0, y=3.0, z=4.0)
    assert np.allclose(found.of(readings.POSITION)[0], np.array([2.0, 3.0, -4.0]) * metres, rtol=1e-12)


@given(st.floats(0.0, 360.0), st.floats(0.1, 30.0))
def test_the_wind_blows_from_where_it_is_said_to_come(direction, speed):
    """A point at this bearing, clockwise from north, has x = sin, y = cos: the wind goes the other way."""
    found = log_of({**POINTS, "wind_velocity": {"speed": "w", "from": "d"}}, **METRES, w=speed, d=direction)
    bearing = np.array([np.sin(np.radians(direction)), np.cos(np.radians(direction)), 0.0])
    assert np.allclose(found.of(readings.WIND)[0], -speed * bearing, atol=1e-9)


@pytest.mark.parametrize(("angle", "from_north"), [("deg", 270.0), ("rad", 1.5 * np.pi)])
def test_a_west_wind_blows_to_the_east(angle, from_north):
    wind = {"speed": "w", "from": "d", "unit": "kn", "angle": angle}
    found = log_of({**POINTS, "wind_velocity": wind}, **METRES, w=10.0, d=from_north)
    assert np.allclose(found.of(readings.WIND)[0], [18520.0 / 3600.0, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize(
    ("angle", "value", "doubts"),
    [
        ("deg", 4.7, ["d, from where wind_velocity comes, is 4.7 deg at most: is it in radians?"]),
        ("rad", 270.0, ["d, from where wind_velocity comes, is up to 270 rad: is it in degrees?"]),
        ("deg", 270.0, []),
        ("rad", 4.7, []),
        ("deg", 0.0, []),  # a wind sensor that is not there reads 0
    ],
)
def test_a_direction_in_the_other_unit_is_doubted(angle, value, doubts):
    wind = {"speed": "w", "from": "d", "angle": angle}
    found = log_of({**POINTS, "wind_velocity": wind}, **METRES, w=5.0, d=value)
    assert found.report.doubts == doubts
