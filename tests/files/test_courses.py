"""Inputs over time in files: ramps and steps by closed forms, smooth ways from rest to rest, columns, and refusals."""

import numpy as np
import pytest

from tetherfmu.files.courses import course
from tetherfmu.files.driven import Path as Way

TRAPEZOID = [[0, 0.0], [2, 1.5], ["10 s", 1.5], [10, 0.5]]


def made(value, name="reel_out_speed", unit="m/s", size=1, folder=None):
    """A `Course`."""
    return course(f"series.{name}", value, name, unit, size, *([folder] if folder else []))


def test_speeds_are_linear_and_steps_are_steps():
    """s = 0.75 t up to 2 s, then 1.5, from 10 s on 0.5; its integral."""
    found, time = made(TRAPEZOID), np.array([0.0, 1.0, 2.0, 9.98, 500 * 0.02, 30.0])
    assert found(time) == pytest.approx([0.0, 0.75, 1.5, 1.5, 0.5, 0.5])
    assert found.integral(time) == pytest.approx([0.0, 0.375, 1.5, 1.5 + 1.5 * 7.98, 13.5, 23.5], abs=1e-8)
    assert found.rate(np.array([1.0, 5.0, 20.0])) == pytest.approx([0.75, 0.0, 0.0])
    assert made("5.4 km/h")(np.array([0.0, 9.0])) == pytest.approx([1.5, 1.5])


def test_the_integral_is_that_of_many_small_steps():
    """Rows at random, the first one after the start."""
    rng = np.random.default_rng(1)
    times = np.sort(rng.uniform(1.0, 20.0, 12))
    found = made([[time, value] for time, value in zip(times.tolist(), rng.normal(size=12).tolist(), strict=True)])
    fine = np.linspace(0.0, 25.0, 250_001)
    values = found(fine)
    sums = np.concatenate([[0.0], np.cumsum(0.5e-4 * (values[1:] + values[:-1]))])
    assert np.allclose(found.integral(fine[::1000]), sums[::1000], atol=1e-7)


def test_a_position_goes_smoothly_from_rest_to_rest():
    """It never leaves the line between its rows, and its rate is that of differences."""
    found = made([[1, [0, 0, 5]], [3, [4, 0, 5]], [4, [4, 0, 2]]], "position", "m", 3)
    time = np.linspace(0.0, 6.0, 601)
    way = found(time)
    assert way[0] == pytest.approx([0, 0, 5])
    assert way[-1] == pytest.approx([4, 0, 2])
    assert np.all(np.diff(way[:, 0]) >= -1e-12)
    assert np.allclose(found.rate([0.5, 1.0, 3.0, 4.0, 5.0]), 0.0)
    middle = 0.5 * (time[1:] + time[:-1])
    assert np.allclose(found.rate(middle), np.diff(way, axis=0) / 0.01, atol=2e-3)


def test_angles_make_a_circle():
    """At a constant rate of the azimuth the speed is radius times rate."""
    azimuth = made([[0, 0.0], [1, 1.0]], "azimuth", "rad")
    courses = {
        "distance": made("50 m", "distance", "m"),
        "elevation": made("60 deg", "elevation", "rad"),
        "azimuth": azimuth,
    }
    way, time = Way(courses), np.linspace(0.0, 1.0, 101)
    assert np.allclose(np.linalg.norm(way.position(time), axis=1), 50.0)
    assert np.linalg.norm(way.velocity(time), axis=1) == pytest.approx(25.0 * azimuth.rate(time))
    assert np.allclose(way.position(1.0), [25.0 * np.cos(1.0), 25.0 * np.sin(1.0), 25.0 * np.sqrt(3.0)])


def test_release_holds_from_row_to_row():
    found = made([[3, True], [5, False]], "release", "")
    assert found([0.0, 2.99, 3.0, 4.9, 5.0]).tolist() == [0.0, 0.0, 1.0, 1.0, 0.0]
    assert found.first() == 3.0


def test_a_column_of_a_file(tmp_path):
    (tmp_path / "crane.csv").write_text(
        "time;force [kN];tip[1];tip[2];tip[3]\n0;1;0;0;9\n1;2,5;0;1;9\n2;2,5;0;2;9\n3;0;0;3;9\n"
    )
    force = made({"file": "crane.csv", "column": "force"}, "winch_force", "N", folder=tmp_path)
    assert force([0.5, 1.5, 2.5]) == pytest.approx([1750.0, 2500.0, 1250.0])
    tip = made({"file": "crane.csv", "column": "tip"}, "position", "m", 3, tmp_path)
    assert np.allclose(tip.rate([0.2, 2.8]), [0, 1, 0])  # a spline through a straight line


WRONG = [
    ("reel_out_speed", "fast", "it must be a number with one of the units"),
    ("reel_out_speed", [[0, 1], [2]], "row 2 is [2]; it must be a number, rows"),
    ("reel_out_speed", [[0, 1], [2, [1, 2, 3]]], "row 2 has [1, 2, 3]"),
    ("reel_out_speed", [[0, 1], [-1, 2]], "row 2 has the time -1 s; it must not be before that of the row before, 0 s"),
    ("reel_out_speed", [[-1, 1], [0, 2]], "row 1 has the time -1 s; it must be at least 0 s"),
    ("reel_out_speed", [[0, float("nan")]], "row 1 has [nan]; it must be a finite number"),
    ("winch_length", [[0, 1], [2, 2], [2, 3]], "row 3 has the time 2 s; it must be later than that of the row before, 2 s"),
    ("release", [[0, 0.5]], "row 1 has 0.5; it must be true or false"),
]


@pytest.mark.parametrize(("name", "value", "words"), WRONG)
def test_wrong_rows_are_named(name, value, words):
    with pytest.raises(ValueError, match=f"^series.{name}: ") as error:
        made(value, name, {"reel_out_speed": "m/s", "winch_length": "m", "release": ""}[name])
    assert words in str(error.value)
