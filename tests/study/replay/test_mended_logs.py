"""The flight of a mended log is that of the unbroken one, and the report says what was done."""

import re
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

from study.replay.breaking import (
    FEW,
    RATHER,
    ROUNDED,
    as_whole_numbers,
    assert_same,
    held,
    on,
    put,
    scaled,
    spread_over,
    texts,
    within,
)
from study.replay.known_flight import FULL, flown, full, map_of, motions

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them


class Mended(NamedTuple):
    """Of the known flight: what is done, line of the report, allowed change of position [m], velocity [m/s] and tension."""

    done: Callable
    line: str
    motion: float = FEW
    tension: float = RATHER  # [%]


POSITION = ["lat", "lon", "alt"]
MENDED = {
    "a tenth of the positions empty": (lambda t: put(t, "lat", spread_over(10), ""), "left out of lat: 107 of"),
    "a tenth of all cells empty": (
        lambda t: texts(t).where(np.random.default_rng(2).random(t.shape) > 0.1 * (t.columns != "time"), ""),
        "left out of force: 1",
        FEW,
        5.0,  # two or three readings in a row are missing now and then
    ),
    "minus signs for none": (lambda t: put(t, "force", spread_over(20), "-"), "left out of force: 53 of", ROUNDED),
    "null for none": (lambda t: put(t, "alt", spread_over(20), "null"), "left out of alt: 53 of"),
    "NaN for none": (lambda t: put(t, "vn", spread_over(20), "NaN"), "left out of vn: 53 of"),
    "infinities": (lambda t: put(t, "ve", spread_over(20), "-inf"), "left out of ve: 53 of"),
    "9999 for none": (lambda t: put(t, "force", spread_over(20), "9999"), "left out of force: 53 of .*9999", ROUNDED),
    "9999 for none, for 1 s": (lambda t: put(t, "alt", range(500, 510), "9999"), "left out of alt: 10 of .*9999"),
    "-999 for none, for 1 s": (lambda t: put(t, "length", range(500, 510), "-999"), "length: 10 of .*999", ROUNDED),
    "coordinates of 1e42": (lambda t: put(t, "lon", spread_over(50), "1e42"), r"kite_position\[1\]: 21 of"),
    "no fix for 1 s": (within("lat lon", range(500, 510), np.zeros_like), r"kite_position\[3\]: 10 of"),
    "positions every fifth row": (lambda t: put(t, POSITION, t.index[t.index % 5 != 0], ""), "left out of lat: 960 of"),
    "tension every tenth row": (lambda t: put(t, "force", t.index[t.index % 10 != 0], ""), "force: 1080", ROUNDED, 6.0),
    "a gap of 1 s": (lambda t: t.drop(range(500, 510)), "bridged: 1 of", FEW, 6.0),
    "a tension of a million": (lambda t: put(t, "force", 600, "1000000"), "ground_tension: 1 of .*spikes", ROUNDED),
    "spikes of the tension": (within("force", range(50, 1200, 100), lambda c: 8.0 * c), "ground_tension: 12 of", ROUNDED),
    "a spike of the length": (within("length", [600], lambda c: c + 40.0), "tether_length: 1 of .*spikes", ROUNDED),
    "a length of 0": (lambda t: put(t, "length", 600, "0"), "tether_length: 1 of .*impossible", ROUNDED),
    "a spike of the altitude": (within("alt", [600], lambda c: c + 40.0), r"kite_position\[3\]: 1 of"),
    "a jump to and fro": (within("lat", range(600, 603), lambda c: c + 3e-4), r"kite_position\[2\]: 3 of"),
    "a spike of the velocity": (within("vn", [600], lambda c: c + 100.0), r"kite_velocity\[2\]: 1 of"),
    "times in ms": (scaled("time", 1000.0), "time from 0", ROUNDED),
    "times in us": (on("time", lambda c: 1e6 * c + 1.57e15), "time from 0", ROUNDED),
    "jitter": (lambda t: motions((t["time"] + 0.03 * np.sin(37.0 * t["time"]) ** 2).to_numpy()), "time from 0", ROUNDED),
    "coordinates as whole numbers": (as_whole_numbers, "time from 0", 0.05),
    "once a second": (lambda t: full(every=1.0), "time from 0", 0.6, 6.0),  # the figure is flown in 20 s, sides in 10 s
    "100 times a second": (lambda t: full(every=0.01), "time from 0", 0.05),  # ends of 10 Hz are known less well
    "positions held for 1 s": (lambda t: held(t, POSITION, 10), "kite_position: 1080 of .*repeat"),
    "velocities held for 0.5 s": (lambda t: held(t, ["vn", "ve", "vd"], 5), "kite_velocity: 960 of .*repeat"),
    "tension held for 0.5 s": (lambda t: held(t, ["force"], 5), "ground_tension: 960 of .*repeat", ROUNDED, 3.0),
    "length held for 1 s": (lambda t: held(t, ["length"], 10), "tether_length: 1080 of .*repeat", ROUNDED),
    "drift of 1 m": (on("alt", lambda c: c + np.linspace(0.0, 1.0, len(c))), "noise 1 m", 1.05, RATHER),
}
MAPS_OF_MENDED = {
    "times in ms": FULL.replace('time = "time"', 'time = {column = "time", unit = "ms"}'),
    "times in us": FULL.replace('time = "time"', 'time = {column = "time", unit = "us"}'),
    "coordinates as whole numbers": FULL.replace('altitude = "alt"', 'altitude = "alt"\nangle = "1e-7 deg"'),
}


@pytest.mark.parametrize("kind", MENDED)
def test_a_broken_log_is_mended_and_says_so(kind, folder, own, unbroken):
    done, line, motion, tension = Mended(*MENDED[kind])
    found = flown(folder, done(full()), map_of(MAPS_OF_MENDED[kind], folder, "other") if kind in MAPS_OF_MENDED else own)
    assert_same(found, unbroken, motion, tension)
    assert re.search(line, " ".join(found.log.report.lines))
