"""Times of a log: what they become, which rows stay, and which are refused."""

import numpy as np
import pandas as pd
import pytest

from tetherfmu.study.replay import clock
from tetherfmu.study.replay.log import Report


def repaired(times, factor=1.0, **more):
    """Times, rows and report of a column of texts."""
    report, cells = Report(), pd.DataFrame({"t": [str(each) for each in times], **more})
    time, rows = clock.repaired(cells, "t", factor, report)
    return time - time[0], rows, report


@pytest.mark.parametrize(
    ("times", "factor"),
    [
        ([3.0, 3.5, 4.5, 6.0], 1.0),
        ([3000, 3500, 4500, 6000], 1e-3),
        ([1570533128.0, 1570533128.5, 1570533129.5, 1570533131.0], 1.0),
        ([1570533128000000, 1570533128500000, 1570533129500000, 1570533131000000], 1e-6),
        (["13:12:08", "13:12:08.5", "13:12:09.5", "13:12:11.0"], 1.0),
        (["9:59:58", "9:59:58,5", "9:59:59,50", "10:00:01"], 1.0),
        (["23:59:59", "23:59:59.5", "00:00:00.5", "00:00:02"], 1.0),
        (["2019-10-08 13:12:08", "2019-10-08 13:12:08.5", "2019-10-08 13:12:09.5", "2019-10-08 13:12:11"], 1.0),
        (["2019-12-31T23:59:59Z", "2019-12-31T23:59:59.5Z", "2020-01-01T00:00:00.5Z", "2020-01-01T00:00:02Z"], 1.0),
        (
            [
                "2019-10-27T02:59:59+02:00",
                "2019-10-27T02:59:59.5+02:00",
                "2019-10-27T02:00:00.5+01:00",
                "2019-10-27T02:00:02+01:00",
            ],
            1.0,
        ),
    ],
)
def test_times_begin_at_0(times, factor):
    time, rows, _ = repaired(times, factor)
    assert np.allclose(time, [0.0, 0.5, 1.5, 3.0], rtol=0.0, atol=1e-6)
    assert list(rows) == [0, 1, 2, 3]


def test_reversed_rows_are_turned():
    time, rows, report = repaired([3.0, 2.0, 1.5, 0.0])
    assert list(time) == [0.0, 1.5, 2.0, 3.0]
    assert list(rows) == [3, 2, 1, 0]
    assert "reversed: the time falls from row to row" in report.lines


def test_rows_of_whole_seconds_lie_evenly_in_them():
    """Ten rows each, of which the first second has four and the last one six: at its end, and at its beginning."""
    true = np.arange(0.6, 3.55, 0.1)
    time, rows, report = repaired(np.floor(true + 1e-9), value=np.arange(len(true)))
    assert np.allclose(time, true - true[0], rtol=0.0, atol=1e-9)
    assert len(rows) == len(true)
    assert any("rounded to 1 s; the 10 rows of each" in each for each in report.lines)


def test_two_rows_of_each_time_lie_evenly_in_it():
    true = np.arange(0.0, 5.0, 0.05)
    time, _, _ = repaired(np.round(np.floor(true * 10.0 + 1e-6) / 10.0, 1), value=np.arange(len(true)))
    assert np.allclose(time, true, rtol=0.0, atol=1e-9)


def test_copies_of_rows_are_dropped():
    time, rows, report = repaired(np.repeat(np.arange(10.0), 3), value=np.repeat(np.arange(10), 3))
    assert list(time) == list(range(10))
    assert list(rows) == list(range(0, 30, 3))
    assert "dropped: 20 of 30 rows, which are copies of the row above" in report.lines


def test_a_time_that_is_there_twice_is_dropped_once():
    times = [*np.arange(0.0, 3.0, 0.1), *np.arange(2.9, 6.0, 0.1)]
    time, rows, report = repaired(np.round(times, 1), value=np.arange(len(times)))
    assert np.all(np.diff(time) > 0.0)
    assert len(rows) == len(times) - 1
    assert any("whose time is that of the row above" in each for each in report.lines)


@pytest.mark.parametrize(("place", "value"), [(40, 1e6), (40, -1e6), (0, 1e6), (99, -5.0), (0, 200.0)])
def test_a_time_that_does_not_fit_in_is_dropped_alone(place, value):
    times = np.arange(0.0, 100.0)
    times[place] = value
    time, rows, report = repaired(times)
    assert len(rows) == 99
    assert place not in rows
    assert "dropped: 1 of 100 rows, whose time does not fit in between those of the rows around" in report.lines
    assert time[-1] - time[0] <= 99.0


def longest(numbers):
    """Length of the longest part that never falls, by trying all ends: L(i) = 1 + max L(j), j < i, x_j <= x_i."""
    lengths = []
    for i, each in enumerate(numbers):
        lengths.append(1 + max((lengths[j] for j in range(i) if numbers[j] <= each), default=0))
    return max(lengths)


@pytest.mark.parametrize("seed", range(5))
def test_as_few_rows_as_possible_are_dropped(seed):
    numbers = np.random.default_rng(seed).integers(0, 30, 60).astype(float)
    kept = clock.never_falling(numbers)
    assert np.all(np.diff(numbers[kept]) >= 0.0)
    assert np.all(np.diff(kept) > 0)
    assert len(kept) == longest(numbers)


@pytest.mark.parametrize(
    ("times", "sentence"),
    [
        (["a", "b", "c"], "t has no time in 3 of 3 rows; it must have numbers, dates such as"),
        (["02:20.9", "02:21.0", "02:21.1"], "t has no time in 3 of 3 rows"),
        (["08/10/2019 13:12", "08/10/2019 13:13"], "t has no time in 2 of 2 rows"),
        ([1.0, 1.0, 1.0], "t does not grow: 1.0 in all rows"),
        ([0.0, 1000.0, 2000.0], "t grows by 1e.03 s from row to row; 10 s at most"),
        ([1.57e12, 1.57e12 + 100.0], "t is 1.57e.12 s; is it in another unit"),
        (
            [*range(50), *range(50)],
            "t goes back: 49 of 100 rows .* after 49 s, where 0 s follows at row 50 of the file; is this more than one log",
        ),
        (np.random.default_rng(1).permutation(100), "t goes back"),
    ],
)
def test_what_are_no_times_of_a_flight_is_refused(times, sentence):
    with pytest.raises(ValueError, match=sentence):
        repaired(times)


def test_rows_without_a_time_are_dropped():
    time, rows, report = repaired([0, 1, "", "x", "nan", "inf", "1e42", 7, 8, 9, 10, 11, 12])
    assert list(time) == [0.0, 1.0, *range(7, 13)]
    assert list(rows) == [0, 1, *range(7, 13)]
    assert "dropped: 5 of 13 rows, which have no time" in report.lines
