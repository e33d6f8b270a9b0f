"""What is wrong with a log is found: length offset, origin and delay, with intervals that hold as often as they say."""

import re

import numpy as np
import pytest

from study.replay import logs_of_tests
from tetherfmu.files.csv_files import Table
from tetherfmu.study.replay import fitting
from tetherfmu.study.replay.flight import prepare
from tetherfmu.study.replay.log import LogError

CASES = 40
FEWEST = 34  # of them: 38 are expected, and 34 or more in 99 of 100 draws of 40 (binomial)


def errors(seed):
    """Errors of a log: offset [m], origin [m], delay [s]."""
    random = np.random.default_rng(1000 + seed)
    return {
        "offset": random.uniform(-10.0, 10.0),
        "origin": random.uniform(-3.0, 3.0, 3),
        "delay": random.uniform(-0.5, 0.5),
    }


@pytest.fixture(scope="module")
def fits():
    """Pairs of errors and what was fitted."""
    found = []
    for seed in range(CASES):
        wrong = errors(seed)
        log = logs_of_tests.made(seed=seed, end=65.0, **wrong)
        found.append((wrong, fitting.fit(prepare(log), ("offset", "origin", "delay"), logs_of_tests.SEGMENTS)))
    return found


def misses(wrong, fit):
    """Errors of the numbers over the half widths of their intervals."""
    true = np.array([wrong["offset"], *wrong["origin"], wrong["delay"]])
    values, half = np.transpose(list(fit.found.values()))
    return (values - true) / half


def test_intervals_hold_all_at_once_in_95_percent_of_logs(fits):
    held = [np.abs(misses(*each)).max() <= 1.0 for each in fits]
    assert sum(held) >= FEWEST, sum(held)


def test_no_number_is_off_on_average(fits):
    mean = np.mean([misses(*each) for each in fits], axis=0)
    # half widths are three standard deviations, so the mean of 40 is known to 1/19; the model adds a little
    assert np.abs(mean).max() < 0.15, mean


def test_what_can_be_known_is_known(fits):
    """Across the flight and in time the intervals are narrow; along it offset and origin share an error."""
    half = np.mean([[width for _, width in fit.found.values()] for _, fit in fits], axis=0)
    assert half[2] < 0.4, half  # north, across: three times 0.5 m over the root of some 30 independent positions
    assert half[4] < 0.05, half  # s
    assert all(fit.rms < 0.3 for _, fit in fits)  # of 0.5 m in each position, smoothed


def test_offset_alone():
    found = fitting.fit(prepare(logs_of_tests.made(offset=7.0)))
    value, half = found.found["length offset m"]
    assert abs(value - 7.0) < half < 0.1


@pytest.mark.parametrize("delay", [-6.0, 4.5, 9.0])
def test_a_delay_of_seconds(delay):
    """Correlation finds where the fit begins: from 0 it would end at another minimum of the residual."""
    found = fitting.fit(prepare(logs_of_tests.made(delay=delay, offset=2.0)), ("offset", "delay"), logs_of_tests.SEGMENTS)
    value, half = found.found["delay s"]
    assert abs(value - delay) < half < 0.05
    assert found.rms < 0.3


def test_on_another_part():
    flight = prepare(logs_of_tests.made(offset=7.0))
    found = fitting.fit(flight.part(0.0, 50.0))
    said = fitting.test(found, flight)
    assert re.match(r"tested from 50.0 to 109.9 s: mean error of the length [+-]0.0", said), said
    assert "not tested" in fitting.test(found, flight.part(10.0, 50.0))


def test_jackknife_of_white_noise_is_least_squares():
    """Half widths over those of the textbook, s sqrt((A'A)^-1) with the same quantile."""
    random = np.random.default_rng(3)
    a, ratios = random.normal(size=(2000, 3)), []
    for _ in range(50):
        _, half = fitting.jackknife(a, 0.7 * random.normal(size=2000))
        quantile = fitting.student.ppf(1.0 - 0.025 / 3, fitting.BLOCKS - 1)
        ratios.append(half / (quantile * 0.7 * np.sqrt(np.diag(np.linalg.inv(a.T @ a)))))
    np.testing.assert_allclose(np.mean(ratios, axis=0), 1.0, atol=0.1)  # 1/sqrt(2 x 19 x 50) x 3 is 0.07


def test_what_cannot_be_told_apart_is_refused():
    """A kite that stays in one direction: its origin acts as the length does."""
    flight = prepare(logs_of_tests.made())
    direction = np.array([0.8, 0.0, 0.6])
    columns = np.hstack([np.ones((500, 1)), np.tile(-direction, (500, 1))])
    with pytest.raises(LogError, match="cannot distinguish length offset m from origin"):
        fitting.refuse_alike(columns, ["length offset m", *fitting.NAMES["origin"]])
    with pytest.raises(LogError, match="the part from 3 to 4 s is not possible"):
        fitting.fit(flight.part(3.0, 4.0))


def test_nothing_taut_is_refused():
    cells = logs_of_tests.cells()
    cells["tension"] = "0.5"
    flight = prepare(logs_of_tests.log.log_of(Table(cells), logs_of_tests.MAP))
    with pytest.raises(LogError, match="nowhere taut"):
        fitting.fit(flight)
