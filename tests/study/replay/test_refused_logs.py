"""What is no log of a flight is refused: `LogError`, one line that names file, quantity or column."""

import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from study.replay.breaking import (
    as_whole_numbers,
    of_the_day,
    on,
    put,
    scaled,
    shifted,
    swapped,
    texts,
    with_decimal_commas,
    within,
    without,
)
from study.replay.known_flight import enu, flown, full, written
from tetherfmu.study.replay import log
from tetherfmu.study.replay.flight import prepare

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them


CONTRADICTS, GOES_BACK = "kite_velocity contradicts kite_position", "time goes back: "
NO_POSITION, NO_READING = "no position is known from", "kite_position has readings in 0 of"
REFUSED = {  # of the known flight: what is done, and the sentence
    "empty file": (lambda t: "", "has 0 lines"),
    "blank file": (lambda t: "\n \n\n", "has 0 lines"),
    "header only": (lambda t: t[:0], "has 1 lines"),
    "one row": (lambda t: t[:1], "has 1 rows; it must have at least 20"),
    "no header": (lambda t: without("phase")(t).to_csv(index=False, header=False), "number in each cell of the first row"),
    "binary": (lambda t: bytes(range(256)) * 100, "is not a text file"),
    "binary without zeros": (lambda t: bytes(range(1, 256)) * 100, "column|header"),
    "a page of the web": (lambda t: "<html>\n<body>Not found</body>\n</html>", "the column time .* is missing"),
    "a column is missing": (without("vd"), "the column vd of the map own is missing; there are time, lat"),
    "a column appears twice": (lambda t: pd.concat([t, t["lat"]], axis=1), "the column lat appears twice"),
    "decimal commas between commas": (lambda t: with_decimal_commas(t, ","), "time"),
    "commas and points": (lambda t: put(t, "alt", range(9), "1,4").to_csv(index=False, sep=";"), "alt .*commas and points"),
    "texts for positions": (lambda t: put(t, "alt", t.index, "high"), "kite_position .*left out of alt: 1200 of"),
    "no tension": (lambda t: put(t, "force", t.index, ""), "ground_tension .*columns force"),
    "rows shuffled": (lambda t: t.sample(frac=1.0, random_state=1), GOES_BACK + ".* rows are in the wrong order"),
    "two logs": (lambda t: pd.concat([t, t]), GOES_BACK + ".*more than one log"),
    "times in ms": (scaled("time", 1000.0), "time grows by 100 s .*unit"),
    "times in us": (scaled("time", 1e6), "time grows by 1e.05 s .*unit"),
    "Unix time in ms": (on("time", lambda c: 1000.0 * c + 1.57e12), "time is 1.57e.12 s; is it in another unit"),
    "times in minutes": (scaled("time", 1.0 / 60.0), "shortest|kite_position moves by"),
    "one time": (lambda t: t.assign(time=1.0), "time does not grow"),
    "no times": (lambda t: t.assign(time=""), "time has no time in 1200 of 1200 rows"),
    "the day first": (on("time", lambda c: [f"08/10/2019 {each}" for each in of_the_day(c)]), "it must have numbers, dates"),
    "minutes and seconds": (on("time", lambda c: [each[3:] for each in of_the_day(c)]), "it must have numbers, dates"),
    "a gap of 30 s": (lambda t: t.drop(range(300, 600)), f"{NO_POSITION} 29.9 to 60.0 s"),
    "no position for 30 s": (lambda t: put(t, "lat", range(300, 600), ""), f"{NO_POSITION} 29.9 to 60.0 s"),
    "no fix for 10 s": (within("lat lon", range(100), np.zeros_like), f"{NO_POSITION} 0.0 to 10.0 s"),
    "no fix at all": (lambda t: t.assign(lat=0.0, lon=0.0), NO_READING),
    "latitude and longitude swapped": (swapped("lat", "lon"), f"{NO_READING} .*origin"),
    "radians for degrees": (on("lat lon", np.radians), f"{NO_READING} .*origin"),
    "coordinates as whole numbers": (as_whole_numbers, "lat is 5.2.*e.08 deg .*unit"),
    "origin 100 km away": (shifted("lat", 1.0), f"{NO_READING} .*origin"),
    "origin 1 km away": (
        shifted("lat", 0.01),
        "kite_position is, in 5 % of the rows or more, .* as far away as tether_length.*origin",
    ),
    "altitude 300 m off": (shifted("alt", 300.0), "kite_position is, .* as far away as tether_length.*altitude"),
    "altitude in feet": (scaled("alt", 1.0 / 0.3048), CONTRADICTS),
    "no velocity sensor": (lambda t: t.assign(vn=0.0, ve=0.0, vd=0.0), CONTRADICTS),
    "velocity in km/s": (scaled("vn ve vd", 1e-3), CONTRADICTS),
    "north and east swapped": (swapped("vn", "ve"), CONTRADICTS),
    "up for down": (on("vd", np.negative), "says 1 m up, the position changes by -1 m up"),
    "velocity in km/h": (scaled("vn ve vd", 3.6), CONTRADICTS),
    "length in km": (scaled("length", 1e-3), "as far away as tether_length"),
    "length in feet": (scaled("length", 1.0 / 0.3048), "tether_length changes by 3.3 m for each metre of reel_out_speed"),
    "speed with the wrong sign": (on("speed", np.negative), "tether_length changes by -1 m .*sign"),
    "speed in km/h": (scaled("speed", 3.6), "tether_length changes by 0.28 m"),
    "tension with the wrong sign": (on("force", np.negative), "ground_tension .*sign"),
}
REFUSED_ENU = {  # of the same flight for the map `enu`
    "velocity as north, east, down": (lambda t: t.assign(vx=t["vy"], vy=t["vx"], vz=-t["vz"]), CONTRADICTS),
    "axes swapped": (swapped("x", "y"), CONTRADICTS),
    "up and down": (on("z", np.negative), "says 1 m up, the position changes by -1 m up"),
    "positions in feet": (scaled("x y z", 1.0 / 0.3048), "contradicts.*3.3 m"),
    "positions in km": (scaled("x y z", 1e-3), "contradicts"),
    "times in minutes": (scaled("time", 1.0 / 12.0), f"{CONTRADICTS}|moves by"),
    "a clock that jumps by 300 s": (
        within("time", range(300, 1200), lambda c: c + 300.0),
        "from 29.9 to 330.0 s: the time jumps by 300.1 s at row 302 of the file; replay a part",
    ),
    "a clock that is set back by 300 s": (
        within("time", range(300, 1200), lambda c: c - 300.0),
        GOES_BACK + ".* after 29.9 s, where -270 s follows at row 302 of the file",
    ),
    "a first time that is wrong": (lambda t: put(t, "time", 0, "-500"), "the time jumps by 500.1 s at row 3 of the file"),
    "a last time that is wrong": (lambda t: put(t, "time", 1199, "900"), "the time jumps by 780.2 s at row 1201 of the"),
    "zeros for 10 s": (within("x y z", range(100), np.zeros_like), f"{NO_POSITION} 0.0"),
}


def refused(folder, contents, found, sentence):
    """The log is refused with this sentence in one line that names the file; no other exception."""
    with pytest.raises(log.LogError) as raised:
        flown(folder, contents, found)
    message = str(raised.value)
    assert "\n" not in message
    assert message.isprintable()
    assert re.search(sentence, message), message
    assert "flight.csv" in message or "no position is known" in message or "shortest flight" in message


@pytest.mark.parametrize("kind", REFUSED)
def test_a_broken_log_is_refused_in_one_sentence(kind, folder, own):
    done, sentence = REFUSED[kind]
    refused(folder, done(full()), own, sentence)


@pytest.mark.parametrize("kind", REFUSED_ENU)
def test_a_broken_plain_log_is_refused_in_one_sentence(kind, folder):
    done, sentence = REFUSED_ENU[kind]
    refused(folder, done(enu()), "enu", sentence)


def test_the_part_before_a_jump_of_the_clock_is_flown(folder):
    table = within("time", range(300, 1200), lambda column: column + 300.0)(enu())
    assert prepare(log.read(written(folder, table), "enu"), 0.0, 29.0).end == 29.0


def test_a_folder_and_a_missing_file_are_refused(folder, own):
    with pytest.raises(log.LogError, match="is not a regular file"):
        log.read(folder, own)
    with pytest.raises(log.LogError, match=r"nowhere.csv: cannot be read \(No such file"):
        log.read(folder / "nowhere.csv", own)


@pytest.mark.parametrize("name", ["kitepower_2019", "kitepower_2023", "kitepower", "fmu"])
def test_a_map_of_another_log_is_refused(name, folder):
    refused(folder, full(), name, "is missing|name its map")


NASTY = ["", "-", "nan", "inf", "-1e308", "1e42", "0", "9999", "text", "12:30", '"', "1,5", "\x1b[31m", "2019-10-08", "-0"]
NASTY += ["1e-320"]


BROKEN = st.tuples(st.integers(0, 99), st.integers(0, 13), st.integers(1, 100), st.sampled_from(NASTY))


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(cells=st.lists(BROKEN, min_size=1, max_size=6))
def test_no_cells_whatever_end_in_another_exception(cells, folder):
    table = texts(enu(duration=10.0))
    for row, column, count, cell in cells:
        table.iloc[row : row + count, column % len(table.columns)] = cell
    try:
        found = flown(folder, "\n".join([",".join(table), *(",".join(row) for row in table.to_numpy())]), "enu")
    except log.LogError:
        return
    position, velocity = found.kite(found.times)
    assert np.isfinite(position).all()
    assert np.isfinite(velocity).all()
