"""A log in another form is the same flight, and the report says what was read."""

import re

import numpy as np
import pandas as pd
import pytest

from study.replay.breaking import RATHER, ROUNDED, assert_same, lines_of, of_the_day, on, put, shifted, with_decimal_commas
from study.replay.known_flight import flown, full

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them


def after(date, seconds):
    """Dates so many seconds after one."""
    return pd.Timestamp(date) + pd.to_timedelta(seconds, unit="s")


# of both logs: (what is done, line of the report); the flight stays as it is.  More forms of a table, which are read in the
# same way, are in tests/files/test_csv_files.py
FORMATS = {
    "semicolons and decimal commas": (with_decimal_commas, "time from 0"),
    "carriage returns and newlines": (lambda t: t.to_csv(index=False).replace("\n", "\r\n"), "time from 0"),
    "blanks around cells": (lambda t: t.to_csv(index=False).replace(",", " ,  "), "time from 0"),
    "a comma at the end of each line": (lambda t: t.to_csv(index=False).replace("\n", ",\n"), "time from 0"),
    "a comma at the end of each row": (lambda t: ",\n".join(lines_of(t)), "time from 0"),
    "comments": (lambda t: "# made by a logger, version 2\n" + t.to_csv(index=False) + "# end\n", "begin with #"),
    "a row of units": (
        lambda t: "\n".join([lines_of(t)[0], ",".join(["unit"] * len(t.columns)), *lines_of(t)[1:]]),
        "units are those of the map, not unit of time, unit of lat",
    ),
    "a header in the middle": (
        lambda t: "\n".join([*lines_of(t)[:500], lines_of(t)[0], *lines_of(t)[500:]]),
        "dropped: 1 of .* no time",
    ),
    "a row with too many cells": (
        lambda t: t.to_csv(index=False) + lines_of(t)[-1] + ",1,2,3",
        "dropped: 1 of .* more cells",
    ),
    "columns in another order": (lambda t: t[t.columns[::-1]], "time from 0"),
    "reversed": (lambda t: t[::-1], "reversed"),
    "rows twice": (lambda t: t.loc[t.index.repeat(2)], "copies of the row above"),
    "rows four times": (lambda t: t.loc[t.index.repeat(4)], "copies of the row above"),
    "a row that came late": (lambda t: t.loc[[*range(200), *range(201, 220), 200, *t.index[220:]]], "dropped: 1 of .* time"),
    "one time from the future": (lambda t: put(t, "time", 600, "9e9"), "dropped: 1 of .* time"),
    "one time of 1e42": (lambda t: put(t, "time", 600, "1e42"), "dropped: 1 of .* no time"),
    "Unix time": (shifted("time", 1570533128.8), "time from 0 at time = 15705331"),
    "dates": (on("time", lambda c: after("2019-10-08T13:12:08", c)), "has dates"),
    "dates with a zone": (on("time", lambda c: after("2019-10-08T23:59:08Z", c).map(pd.Timestamp.isoformat)), "has dates"),
    "time of the day over midnight": (on("time", of_the_day), "time of the day.*midnight"),
    "seconds of the day over midnight": (on("time", lambda c: (86340.0 + c) % 86400.0), "midnight"),
    "whole seconds": (on("time", np.floor), "spread: times are rounded to 1 s"),
    "whole seconds, from within one": (lambda t: on("time", np.floor)(t[3:-4]), "spread: times are rounded to 1 s"),
    "fifths of a second": (on("time", lambda c: np.floor(c * 5.0 + 1e-6) / 5.0), "spread: times are rounded to 0.2 s"),
}
SHIFTED = {"whole seconds, from within one": 0.3}  # s, by which a log begins later


@pytest.mark.parametrize("kind", FORMATS)
def test_a_known_flight_is_the_same_in_another_form(kind, folder, own, unbroken):
    done, line = FORMATS[kind]
    found = flown(folder, done(full()), own)
    assert_same(found, unbroken, ROUNDED, RATHER, SHIFTED.get(kind, 0.0))
    assert re.search(line, " ".join(found.log.report.lines))


# how a text is written has nothing to do with the noise of a cycle; readings that are moved, lost or doubled may have
MOVED = list(FORMATS)[list(FORMATS).index("reversed") :]


@pytest.mark.parametrize("kind", MOVED)
def test_a_measured_cycle_is_the_same_in_another_form(kind, folder, cycle, unbroken_cycle):
    done, line = FORMATS[kind]
    found = flown(folder, done(cycle), "kitepower_2019")
    is_less = "late" in kind or "one time" in kind or kind in SHIFTED  # one reading of a noisy kite, or some at its ends
    assert_same(found, unbroken_cycle, 0.3 if is_less else 1e-6, 3.0, SHIFTED.get(kind, 0.0))
    assert re.search(line, " ".join(found.log.report.lines))
