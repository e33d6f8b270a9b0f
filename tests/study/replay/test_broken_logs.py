"""Broken copies of logs end in a flight that is still right and a line on what was done, in one sentence, or in a doubt.

MENDED : the flight is that of the unbroken log, and the report says what was done.
REFUSED : `LogError`, one line that names file, quantity or column.
DOUBTED : what cannot be told from the data, or may be meant so, is a doubt that names the quantity.
"""

import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.study.replay.known_flight import AREA, FULL, KGF, WIND, enu, flown, full, map_of, motions, path, written
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.study.replay import checks, log, readings
from tetherfmu.study.replay.flight import prepare

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them

CYCLE = EXAMPLES / "flights" / "kitepower_20191008_0012.csv"
KEPT = ("time", "kite_pos_east", "kite_pos_north", "kite_height", "ground_tether_force", "ground_tether_reelout_speed")
FORCE, SPEED_2019 = "ground_tether_force", "ground_tether_reelout_speed"
ROUNDED = 0.02  # m, m/s: what millimetres and 1e-8 deg in a log, smoothed, come to, ten times
FEW = 0.5  # m, m/s: of a smoothed motion where a second, or a part of the readings, is missing
RATHER = 1.0  # of the largest tension [%], where it is interpolated over two tenths of a second; over 1 s: 6


def texts(table):
    """The same table with its cells as texts."""
    return table.astype(object).map(lambda cell: cell if isinstance(cell, str) else f"{cell:.10g}")


def put(table, column, rows, cell):
    """The same table with a text in some rows of a column."""
    table = texts(table)
    table.loc[rows, column] = cell
    return table


def changed(table, **columns):
    """The same table with other columns; each is a function of the old one."""
    return table.assign(**{name: function(table[name]) for name, function in columns.items()})


def lines_of(table):
    """Lines of the log."""
    return table.to_csv(index=False).splitlines()


def with_decimal_commas(table):
    return texts(table).map(lambda cell: cell.replace(".", ",")).to_csv(index=False, sep=";")


def spread_over(count, seed=1):
    """A part of the rows, one in `count`, at random, neither the first nor the last ones."""
    rows = np.arange(30, 1100)
    return np.sort(np.random.default_rng(seed).choice(rows, len(rows) // count, replace=False))


def held(table, names, rows):
    """The same table, in which some columns change only every few rows, as those of a slower sensor."""
    return table.assign(**{name: table[name].where(table.index % rows == 0).ffill() for name in names})


def of_the_day(time):
    """Times of the day, hh:mm:ss.fff, the first of which is one minute before midnight."""
    at = 86340.0 + np.asarray(time)
    return [f"{int(t // 3600) % 24:02d}:{int(t // 60) % 60:02d}:{t % 60:06.3f}" for t in at]


# of both logs: (what is done, line of the report); the flight stays as it is
FORMATS = {
    "quotes": (lambda t: t.to_csv(index=False, quoting=1), "time from 0"),
    "byte order mark": (lambda t: b"\xef\xbb\xbf" + t.to_csv(index=False).encode(), "time from 0"),
    "latin-1": (lambda t: t.assign(pitch="1\xb0").to_csv(index=False).encode("latin-1"), "not used: .*pitch"),
    "UTF-16 with tabs": (lambda t: t.to_csv(index=False, sep="\t").encode("utf-16"), "time from 0"),
    "semicolons": (lambda t: t.to_csv(index=False, sep=";"), "time from 0"),
    "semicolons and decimal commas": (with_decimal_commas, "time from 0"),
    "tabs": (lambda t: t.to_csv(index=False, sep="\t"), "time from 0"),
    "carriage returns and newlines": (lambda t: t.to_csv(index=False).replace("\n", "\r\n"), "time from 0"),
    "carriage returns": (lambda t: t.to_csv(index=False).replace("\n", "\r"), "time from 0"),
    "blanks around cells": (lambda t: t.to_csv(index=False).replace(",", " ,  "), "time from 0"),
    "empty lines": (lambda t: t.to_csv(index=False).replace("\n", "\n\n"), "time from 0"),
    "a comma at the end of each line": (lambda t: t.to_csv(index=False).replace("\n", ",\n"), "time from 0"),
    "a comma at the end of each row": (lambda t: ",\n".join(lines_of(t)).replace(",", "", 0), "time from 0"),
    "comments": (lambda t: "# made by a logger, version 2\n" + t.to_csv(index=False) + "# end\n", "begin with #"),
    "a row of units": (
        lambda t: "\n".join([lines_of(t)[0], ",".join(["unit"] * len(t.columns)), *lines_of(t)[1:]]),
        "first row has no numbers.*dropped: 1 of",
    ),
    "a header in the middle": (
        lambda t: "\n".join([*lines_of(t)[:500], lines_of(t)[0], *lines_of(t)[500:]]),
        "dropped: 1 of .* no time",
    ),
    "a row with too many cells": (
        lambda t: "\n".join([*lines_of(t), lines_of(t)[-1] + ",1,2,3"]),
        "dropped: 1 of .* more cells",
    ),
    "columns in another order": (lambda t: t[t.columns[::-1]], "time from 0"),
    "reversed": (lambda t: t[::-1], "reversed"),
    "rows twice": (lambda t: t.loc[t.index.repeat(2)], "copies of the row above"),
    "rows four times": (lambda t: t.loc[t.index.repeat(4)], "copies of the row above"),
    "a row that came late": (lambda t: t.loc[[*range(200), *range(201, 220), 200, *t.index[220:]]], "dropped: 1 of .* time"),
    "one time from the future": (lambda t: put(t, "time", 600, "9e9"), "dropped: 1 of .* time"),
    "one time of 1e42": (lambda t: put(t, "time", 600, "1e42"), "dropped: 1 of .* no time"),
    "Unix time": (lambda t: changed(t, time=lambda c: c + 1570533128.8), "time from 0 at time = 15705331"),
    "dates": (
        lambda t: t.assign(time=pd.Timestamp("2019-10-08T13:12:08") + pd.to_timedelta(t["time"], unit="s")),
        "has dates",
    ),
    "dates with a zone": (
        lambda t: t.assign(
            time=(pd.Timestamp("2019-10-08T23:59:08Z") + pd.to_timedelta(t["time"], unit="s")).map(pd.Timestamp.isoformat)
        ),
        "has dates",
    ),
    "time of the day over midnight": (lambda t: t.assign(time=of_the_day(t["time"])), "time of the day.*midnight"),
    "seconds of the day over midnight": (lambda t: changed(t, time=lambda c: (86340.0 + c) % 86400.0), "midnight"),
    "whole seconds": (lambda t: changed(t, time=np.floor), "spread: times are rounded to 1 s"),
    "whole seconds, from within one": (lambda t: changed(t[3:-4], time=np.floor), "spread: times are rounded to 1 s"),
    "fifths of a second": (
        lambda t: changed(t, time=lambda c: np.floor(c * 5.0 + 1e-6) / 5.0),
        "spread: times are rounded to 0.2 s",
    ),
}
SHIFTED = {"whole seconds, from within one": 0.3}  # s, by which a log begins later

# of the known flight: what is done, line of the report, allowed change of position [m], velocity [m/s] and tension [%]
MENDED = {
    "a tenth of the positions empty": (lambda t: put(t, "lat", spread_over(10), ""), "left out of lat: 107 of", FEW, RATHER),
    "a tenth of all cells empty": (
        lambda t: texts(t).where(np.random.default_rng(2).random(t.shape) > 0.1 * (t.columns != "time"), ""),
        "left out of force: 1",
        FEW,
        5.0,  # two or three readings in a row are missing now and then
    ),
    "minus signs for none": (lambda t: put(t, "force", spread_over(20), "-"), "left out of force: 53 of", ROUNDED, RATHER),
    "null for none": (lambda t: put(t, "alt", spread_over(20), "null"), "left out of alt: 53 of", FEW, RATHER),
    "NaN for none": (lambda t: put(t, "vn", spread_over(20), "NaN"), "left out of vn: 53 of", FEW, RATHER),
    "infinities": (lambda t: put(t, "ve", spread_over(20), "-inf"), "left out of ve: 53 of", FEW, RATHER),
    "9999 for none": (
        lambda t: put(t, "force", spread_over(20), "9999"),
        "left out of force: 53 of .*9999",
        ROUNDED,
        RATHER,
    ),
    "9999 for none, for 1 s": (
        lambda t: put(t, "alt", range(500, 510), "9999"),
        "left out of alt: 10 of .*9999",
        FEW,
        RATHER,
    ),
    "-999 for none, for 1 s": (lambda t: put(t, "length", range(500, 510), "-999"), "length: 10 of .*999", ROUNDED, RATHER),
    "coordinates of 1e42": (lambda t: put(t, "lon", spread_over(50), "1e42"), r"kite_position\[1\]: 21 of", FEW, RATHER),
    "no fix for 1 s": (
        lambda t: t.assign(lat=t["lat"].where(t.index // 10 != 50, 0.0), lon=t["lon"].where(t.index // 10 != 50, 0.0)),
        r"kite_position\[3\]: 10 of",
        FEW,
        RATHER,
    ),
    "positions every fifth row": (
        lambda t: put(t, ["lat", "lon", "alt"], t.index[t.index % 5 != 0], ""),
        "left out of lat: 960 of",
        FEW,
        RATHER,
    ),
    "tension every tenth row": (
        lambda t: put(t, "force", t.index[t.index % 10 != 0], ""),
        "left out of force: 1080",
        ROUNDED,
        6.0,
    ),
    "a gap of 1 s": (lambda t: t.drop(range(500, 510)), "bridged: 1 of", FEW, 6.0),
    "a tension of a million": (
        lambda t: put(t, "force", 600, "1000000"),
        "ground_tension: 1 of .*stand out",
        ROUNDED,
        RATHER,
    ),
    "spikes of the tension": (
        lambda t: changed(t, force=lambda c: c.where(c.index % 100 != 50, 8.0 * c)),
        "ground_tension: 12 of",
        ROUNDED,
        RATHER,
    ),
    "a spike of the length": (
        lambda t: changed(t, length=lambda c: c.where(c.index != 600, c + 40.0)),
        "tether_length: 1 of .*stand out",
        ROUNDED,
        RATHER,
    ),
    "a length of 0": (lambda t: put(t, "length", 600, "0"), "tether_length: 1 of .*no kite", ROUNDED, RATHER),
    "a spike of the altitude": (
        lambda t: changed(t, alt=lambda c: c.where(c.index != 600, c + 40.0)),
        r"kite_position\[3\]: 1 of",
        FEW,
        RATHER,
    ),
    "a jump to and fro": (
        lambda t: changed(t, lat=lambda c: c.where(c.index // 3 != 200, c + 3e-4)),
        r"kite_position\[2\]: 3 of",
        FEW,
        RATHER,
    ),
    "a spike of the velocity": (
        lambda t: changed(t, vn=lambda c: c.where(c.index != 600, c + 100.0)),
        r"kite_velocity\[2\]: 1 of",
        FEW,
        RATHER,
    ),
    "times in ms": (lambda t: changed(t, time=lambda c: 1000.0 * c), "time from 0", ROUNDED, RATHER),
    "times in us": (lambda t: changed(t, time=lambda c: 1e6 * c + 1.57e15), "time from 0", ROUNDED, RATHER),
    "jitter": (
        lambda t: motions((t["time"] + 0.03 * np.sin(37.0 * t["time"]) ** 2).to_numpy()),
        "time from 0",
        ROUNDED,
        RATHER,
    ),
    "coordinates as whole numbers": (
        lambda t: t.assign(lat=(t["lat"] * 1e7).round(), lon=(t["lon"] * 1e7).round()),
        "time from 0",
        0.05,
        RATHER,
    ),
    "once a second": (lambda t: full(every=1.0), "time from 0", 0.6, 6.0),  # the figure is flown in 20 s, sides in 10 s
    "100 times a second": (
        lambda t: full(every=0.01),
        "time from 0",
        0.05,
        RATHER,
    ),  # ends of the log with 10 Hz are known less well
    "positions held for 1 s": (lambda t: held(t, ["lat", "lon", "alt"], 10), "kite_position: 1080 of .*repeat", FEW, RATHER),
    "velocities held for 0.5 s": (lambda t: held(t, ["vn", "ve", "vd"], 5), "kite_velocity: 960 of .*repeat", FEW, RATHER),
    "tension held for 0.5 s": (lambda t: held(t, ["force"], 5), "ground_tension: 960 of .*repeat", ROUNDED, 3.0),
    "length held for 1 s": (lambda t: held(t, ["length"], 10), "tether_length: 1080 of .*repeat", ROUNDED, RATHER),
    "drift of 1 m": (lambda t: changed(t, alt=lambda c: c + np.linspace(0.0, 1.0, len(c))), "noise 1 m", 1.05, RATHER),
}
MAPS_OF_MENDED = {
    "times in ms": FULL.replace('time = "time"', 'time = {column = "time", unit = "ms"}'),
    "times in us": FULL.replace('time = "time"', 'time = {column = "time", unit = "us"}'),
    "coordinates as whole numbers": FULL.replace('altitude = "alt"', 'altitude = "alt"\nangle = "1e-7 deg"'),
}

# of the known flight: what is done, and the sentence
REFUSED = {
    "empty file": (lambda t: "", "has 0 lines"),
    "blank file": (lambda t: "\n \n\n", "has 0 lines"),
    "header only": (lambda t: t[:0], "has 1 lines"),
    "one row": (lambda t: t[:1], "has 1 rows; it must have at least 20"),
    "no header": (
        lambda t: t.drop(columns="phase").to_csv(index=False, header=False),
        "number in each cell of the first row",
    ),
    "binary": (lambda t: bytes(range(256)) * 100, "is no text file"),
    "binary without zeros": (lambda t: bytes(range(1, 256)) * 100, "column|header"),
    "a page of the web": (lambda t: "<html>\n<body>Not found</body>\n</html>", "the column time .* is missing"),
    "a column is missing": (lambda t: t.drop(columns="vd"), "the column vd of the map own is missing; there are time, lat"),
    "a column is there twice": (lambda t: pd.concat([t, t["lat"]], axis=1), "the column lat is there twice"),
    "decimal commas between commas": (
        lambda t: texts(t).map(lambda cell: cell.replace(".", ",")).to_csv(index=False),
        "time",
    ),
    "decimal commas and points": (
        lambda t: put(t, "alt", range(100), "123,4").to_csv(index=False, sep=";"),
        "alt .*commas and points",
    ),
    "texts for positions": (lambda t: put(t, "alt", t.index, "high"), "kite_position .*left out of alt: 1200 of"),
    "no tension": (lambda t: put(t, "force", t.index, ""), "ground_tension .*columns force"),
    "rows shuffled": (lambda t: t.sample(frac=1.0, random_state=1), "time goes back: .* rows stand in the wrong order"),
    "two logs": (lambda t: pd.concat([t, t]), "time goes back: .*more than one log"),
    "times in ms": (lambda t: changed(t, time=lambda c: 1000.0 * c), "time grows by 100 s .*unit"),
    "times in us": (lambda t: changed(t, time=lambda c: 1e6 * c), "time grows by 1e.05 s .*unit"),
    "Unix time in ms": (
        lambda t: changed(t, time=lambda c: 1000.0 * c + 1.57e12),
        "time is 1.57e.12 s; is it in another unit",
    ),
    "times in minutes": (lambda t: changed(t, time=lambda c: c / 60.0), "shortest|kite_position moves by"),
    "one time": (lambda t: t.assign(time=1.0), "time does not grow"),
    "no times": (lambda t: t.assign(time=""), "time has no time in 1200 of 1200 rows"),
    "dates with the day first": (
        lambda t: t.assign(time=[f"08/10/2019 {each}" for each in of_the_day(t["time"])]),
        "it must have numbers, dates",
    ),
    "minutes and seconds": (
        lambda t: t.assign(time=[each[3:] for each in of_the_day(t["time"])]),
        "it must have numbers, dates",
    ),
    "a gap of 30 s": (lambda t: t.drop(range(300, 600)), "no position is known from 29.9 to 60.0 s"),
    "no position for 30 s": (lambda t: put(t, "lat", range(300, 600), ""), "no position is known from 29.9 to 60.0 s"),
    "no fix for 10 s": (
        lambda t: t.assign(lat=t["lat"].where(t.index >= 100, 0.0), lon=t["lon"].where(t.index >= 100, 0.0)),
        "no position is known from 0.0 to 10.0 s",
    ),
    "no fix at all": (lambda t: t.assign(lat=0.0, lon=0.0), "kite_position has readings in 0 of"),
    "latitude and longitude swapped": (
        lambda t: t.rename(columns={"lat": "lon", "lon": "lat"}),
        "kite_position has readings in 0 of .*origin",
    ),
    "radians for degrees": (
        lambda t: changed(t, lat=np.radians, lon=np.radians),
        "kite_position has readings in 0 of .*origin",
    ),
    "coordinates as whole numbers": (
        lambda t: t.assign(lat=(t["lat"] * 1e7).round(), lon=(t["lon"] * 1e7).round()),
        "lat is 5.2.*e.08 deg .*unit",
    ),
    "origin 100 km away": (lambda t: changed(t, lat=lambda c: c + 1.0), "kite_position has readings in 0 of .*origin"),
    "origin 1 km away": (
        lambda t: changed(t, lat=lambda c: c + 0.01),
        "kite_position is, in 5 % of the rows or more, .* as far away as tether_length.*origin",
    ),
    "altitude 300 m off": (lambda t: changed(t, alt=lambda c: c + 300.0), "kite_position is, .* as far away .*altitude"),
    "altitude in feet": (lambda t: changed(t, alt=lambda c: c / 0.3048), "kite_velocity and kite_position do not fit"),
    "no velocity sensor": (lambda t: t.assign(vn=0.0, ve=0.0, vd=0.0), "kite_velocity and kite_position do not fit"),
    "velocity in km/s": (
        lambda t: changed(t, vn=lambda c: c / 1e3, ve=lambda c: c / 1e3, vd=lambda c: c / 1e3),
        "kite_velocity and kite_position do not fit",
    ),
    "north and east swapped": (
        lambda t: t.rename(columns={"vn": "ve", "ve": "vn"}),
        "kite_velocity and kite_position do not fit",
    ),
    "up for down": (lambda t: changed(t, vd=np.negative), "goes 1 m up, the position goes -1 m up"),
    "velocity in km/h": (
        lambda t: changed(t, vn=lambda c: 3.6 * c, ve=lambda c: 3.6 * c, vd=lambda c: 3.6 * c),
        "kite_velocity and kite_position do not fit",
    ),
    "length in km": (lambda t: changed(t, length=lambda c: c / 1000.0), "as far away as tether_length"),
    "length in feet": (
        lambda t: changed(t, length=lambda c: c / 0.3048),
        "tether_length changes by 3.3 m for each metre of reel_out_speed",
    ),
    "speed with the wrong sign": (lambda t: changed(t, speed=np.negative), "tether_length changes by -1 m .*sign"),
    "speed in km/h": (lambda t: changed(t, speed=lambda c: 3.6 * c), "tether_length changes by 0.28 m"),
    "tension with the wrong sign": (lambda t: changed(t, force=np.negative), "ground_tension .*sign"),
}
REFUSED_ENU = {  # of the same flight for the map `enu`
    "velocity as north, east, down": (
        lambda t: t.assign(vx=t["vy"], vy=t["vx"], vz=-t["vz"]),
        "kite_velocity and kite_position",
    ),
    "axes swapped": (lambda t: t.rename(columns={"x": "y", "y": "x"}), "kite_velocity and kite_position do not fit"),
    "up and down": (lambda t: changed(t, z=np.negative), "goes 1 m up, the position goes -1 m up"),
    "positions in feet": (
        lambda t: changed(t, x=lambda c: c / 0.3048, y=lambda c: c / 0.3048, z=lambda c: c / 0.3048),
        "do not fit.*3.3 m",
    ),
    "positions in km": (lambda t: changed(t, x=lambda c: c / 1e3, y=lambda c: c / 1e3, z=lambda c: c / 1e3), "do not fit"),
    "times in minutes": (lambda t: changed(t, time=lambda c: c / 12.0), "kite_velocity and kite_position|moves by"),
    "zeros for 10 s": (
        lambda t: t.assign(**{name: t[name].where(t.index >= 100, 0.0) for name in "xyz"}),
        "no position is known from 0.0",
    ),
}

# of the known flight: what is done, and the doubt
DOUBTED = {
    "tension in N": (lambda t: changed(t, force=lambda c: KGF * c), "ground_tension is 4.9 times .*unit"),
    "tension in kN": (lambda t: changed(t, force=lambda c: KGF / 1000.0 * c), "ground_tension is 0.0049 times .*unit"),
    "tension in pounds": (
        lambda t: changed(t, force=lambda c: c / 0.45359237),
        "ground_tension is 1.1 times",
    ),
    "airspeed in km/h": (lambda t: changed(t, airspeed=lambda c: 3.6 * c), "airspeed is 3.6 times"),
    "wind in km/h": (lambda t: changed(t, wind=lambda c: 3.6 * c), "wind_velocity fits .* best times 0.3"),
    "wind in ft/s": (lambda t: changed(t, wind=lambda c: c / 0.3048), "wind_velocity fits .* best times 0.3"),
    "wind from the wrong side": (
        lambda t: changed(t, wind_from=lambda c: c - 180.0),
        "wind_velocity blows from kite_position",
    ),
    "wind direction in radians": (lambda t: changed(t, wind_from=np.radians), "wind_from.* is it in radians"),
    "altitude 19 m too high": (lambda t: changed(t, alt=lambda c: c + 19.0), "kite_position is up to 1.0.* altitude"),
    "altitude 19 m too low": (
        lambda t: changed(t, alt=lambda c: c - 19.0),
        "kite_position is, while the tether is taut, only 0.9.* altitude",
    ),
    "tension frozen": (
        lambda t: changed(t, force=lambda c: c.where((c.index < 500) | (c.index > 600), c[500])),
        "ground_tension reads .* from 50.0 to 60.0 s",
    ),
    "length frozen": (
        lambda t: changed(t, length=lambda c: c.where((c.index < 600) | (c.index > 660), c[600])),
        "tether_length reads .* from 60.0 to 66.0 s",
    ),
    "position frozen": (
        lambda t: t.assign(
            **{name: t[name].where((t.index < 500) | (t.index > 560), t[name][500]) for name in ("lat", "lon", "alt")}
        ),
        "kite_position reads .* from 50.0 to 56.0 s",
    ),
    "a small jump that stays": (
        lambda t: changed(t, alt=lambda c: c.where(c.index < 500, c + 8.0)),
        "kite_position jumps 1 times, first by [78].* m at 49.9 s, which kite_velocity does not explain",
    ),
    "a jump of the length": (
        lambda t: changed(t, length=lambda c: c.where(c.index < 500, c - 4.0)),
        "tether_length jumps 1 times, first by 4.* m at 49.9 s, which reel_out_speed does not explain",
    ),
    "a jump that stays": (
        lambda t: changed(t, alt=lambda c: c.where((c.index < 500) | (c.index > 540), c - 60.0)),
        "kite_position jumps 2 times, first by .* m at 49.[89] s",
    ),
}
DOUBTED_ENU = {
    "tension in kgf": (lambda t: changed(t, ground_tension=lambda c: c / KGF), "not checked.* ground_tension"),
    "tension in kN": (lambda t: changed(t, ground_tension=lambda c: c / 1e3), "not checked.* ground_tension"),
    "tension in mN": (lambda t: changed(t, ground_tension=lambda c: c * 1e3), "ground_tension would stretch the tether by"),
    "length in feet, without speed": (
        lambda t: changed(t, tether_length=lambda c: c / 0.3048).drop(columns="reel_out_speed"),
        "kite_position is never more than 0.3",
    ),
    "no velocity": (lambda t: t.drop(columns=["vx", "vy", "vz"]), "not checked.*kite_position with kite_velocity"),
    "axes swapped, no velocity": (
        lambda t: t.drop(columns=["vx", "vy", "vz"]).rename(columns={"x": "y", "y": "x"}),
        "not checked.*kite_position with kite_velocity",
    ),
    "down for up, no velocity": (
        lambda t: changed(t.drop(columns=["vx", "vy", "vz"]), z=np.negative),
        "kite_position is below the outlet",
    ),
    "no wind": (lambda t: t.drop(columns="wind_x"), "no wind_velocity: the tethers fly in still air"),
    "no tether": (lambda t: t, "the map does not say which tether flew: a default one of 4 mm and 9.1 g/m does"),
    "no length": (lambda t: t.drop(columns="tether_length"), "not checked.*kite_position with tether_length"),
    "speed with the wrong sign, no length": (
        lambda t: changed(t.drop(columns="tether_length"), reel_out_speed=np.negative),
        "distance of kite_position changes by -1 m",
    ),
    "most of the wind empty": (
        lambda t: put(t, "wind_x", range(50, 1200), ""),
        "wind_velocity has readings in 50 of 1200 rows",
    ),
    "most of the tension empty": (
        lambda t: put(t, "ground_tension", range(50, 1200), ""),
        "ground_tension has readings in 50 of",
    ),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("logs")


@pytest.fixture(scope="module")
def own(folder):
    return map_of(FULL, folder)


@pytest.fixture(scope="module")
def unbroken(folder, own):
    return flown(folder, full(), own)


@pytest.fixture(scope="module")
def cycle():
    """The cycle from its first second on, without velocities."""
    table = pd.read_csv(CYCLE)[[*KEPT, "ground_wind_velocity", "ground_upwind_direction"]]
    return table.assign(time=(table.time - table.time[0]).round(1))


@pytest.fixture(scope="module")
def unbroken_cycle(folder, cycle):
    return flown(folder, cycle, "kitepower_2019")


def test_an_unbroken_log_has_no_doubts(unbroken):
    assert unbroken.log.report.doubts == []


def assert_same(found, unbroken, motion, tension, shift=0.0):
    """The motion [m, m/s], the length [m] and the tension [% of its largest] are those of the unbroken log.

    shift : by how much later the log begins [s].  The first and last second are left out: nothing is known beyond them.
    """
    time = np.arange(1.0, min(found.end, unbroken.end - shift) - 1.0, 0.1)
    assert time[-1] > 100.0
    for mine, right in zip(found.kite(time), unbroken.kite(time + shift), strict=True):
        assert np.abs(mine - right).max() < motion
    mine, right = (found.measured("ground_tension", time), unbroken.measured("ground_tension", time + shift))
    assert np.abs(mine - right).max() < 0.01 * tension * right.max()
    mine, right = found.length(time), unbroken.length(time + shift)
    assert np.abs(mine - mine[0] - right + right[0]).max() < max(0.1, motion)
    if "tether_length" in unbroken.log.table:
        assert np.abs(mine - right).max() < max(0.1, motion)


@pytest.mark.parametrize("kind", FORMATS)
def test_a_known_flight_is_the_same_in_another_form(kind, folder, own, unbroken):
    done, line = FORMATS[kind]
    found = flown(folder, done(full()), own)
    assert_same(found, unbroken, ROUNDED, RATHER, SHIFTED.get(kind, 0.0))
    assert re.search(line, " ".join(found.log.report.lines))


@pytest.mark.parametrize("kind", FORMATS)
def test_a_measured_cycle_is_the_same_in_another_form(kind, folder, cycle, unbroken_cycle):
    done, line = FORMATS[kind]
    found = flown(folder, done(cycle), "kitepower_2019")
    is_less = "late" in kind or "one time" in kind or kind in SHIFTED  # one reading of a noisy kite, or some at its ends
    assert_same(found, unbroken_cycle, 0.3 if is_less else 1e-6, 3.0, SHIFTED.get(kind, 0.0))
    assert re.search(line, " ".join(found.log.report.lines))


@pytest.mark.parametrize("kind", MENDED)
def test_a_broken_log_is_mended_and_says_so(kind, folder, own, unbroken):
    done, line, motion, tension = MENDED[kind]
    found = flown(folder, done(full()), map_of(MAPS_OF_MENDED[kind], folder, "other") if kind in MAPS_OF_MENDED else own)
    assert_same(found, unbroken, motion, tension)
    assert re.search(line, " ".join(found.log.report.lines))


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


@pytest.mark.parametrize("kind", DOUBTED)
def test_what_may_be_wrong_is_doubted(kind, folder, own):
    done, doubt = DOUBTED[kind]
    doubts = flown(folder, done(full()), own).log.report.doubts
    assert any(re.search(doubt, each) for each in doubts), doubts


@pytest.mark.parametrize("kind", DOUBTED_ENU)
def test_what_may_be_wrong_in_a_plain_log_is_doubted(kind, folder):
    done, doubt = DOUBTED_ENU[kind]
    doubts = flown(folder, done(enu()), "enu").log.report.doubts
    assert any(re.search(doubt, each) for each in doubts), doubts


def test_there_are_at_least_forty_kinds():
    assert len(FORMATS) + len(MENDED) + len(REFUSED) + len(DOUBTED) >= 40


def test_a_folder_and_a_missing_file_are_refused(folder, own):
    with pytest.raises(log.LogError, match="is no regular file"):
        log.read(folder, own)
    with pytest.raises(log.LogError, match=r"nowhere.csv: cannot be read \(No such file"):
        log.read(folder / "nowhere.csv", own)


@pytest.mark.parametrize("name", ["kitepower_2019", "kitepower_2023", "kitepower", "fmu"])
def test_a_map_of_another_log_is_refused(name, folder):
    refused(folder, full(), name, "is missing|name its map")


NASTY = [
    "",
    "-",
    "nan",
    "inf",
    "-1e308",
    "1e42",
    "0",
    "9999",
    "text",
    "12:30",
    '"',
    "1,5",
    "\x1b[31m",
    "2019-10-08",
    "-0",
    "1e-320",
]


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    cells=st.lists(
        st.tuples(st.integers(0, 99), st.integers(0, 13), st.integers(1, 100), st.sampled_from(NASTY)),
        min_size=1,
        max_size=6,
    )
)
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


def calm(time, position, length=None, tension=None, **more):
    """A plain log of a motion whose velocity is the difference of neighbours."""
    made = pd.DataFrame({"time": time})
    made[["x", "y", "z"]] = np.round(position, 3)
    made[["vx", "vy", "vz"]] = np.round(np.gradient(position, time, axis=0), 3)
    made["tether_length"] = length if length is not None else np.round(np.linalg.norm(position, axis=1) * 1.01, 3)
    made["reel_out_speed"] = np.round(np.gradient(made["tether_length"], time), 3)
    made["ground_tension"] = tension if tension is not None else np.round(50.0 + np.sin(time), 3)
    return made.assign(**more)


TIME = np.arange(0.0, 60.0, 0.1)
STILL = np.zeros_like(TIME)
LEGITIMATE = {
    "slack": calm(TIME, np.stack([60.0 + STILL, 10.0 * np.sin(TIME), 60.0 + STILL], axis=1), 120.0 + STILL),
    "very slack": calm(TIME, np.stack([30.0 + STILL, 5.0 * np.sin(TIME), 40.0 + STILL], axis=1), 160.0 + STILL),
    "load nearly at rest": calm(
        TIME, np.stack([0.02 * np.sin(TIME), STILL, 0.0 * TIME - 20.0], axis=1), tension=1000.0 + np.sin(TIME)
    ),
    "load lowered": calm(TIME, np.stack([0.3 * np.sin(TIME), STILL, -5.0 - 1.5 * TIME], axis=1)),
    "straight up": calm(TIME, np.stack([STILL, STILL, 2.0 + 3.0 * TIME], axis=1)),
    "straight up and down": calm(TIME, np.stack([STILL, STILL, 50.0 - 40.0 * np.cos(0.1 * TIME)], axis=1)),
    "along a line": calm(TIME, np.stack([4.0 * TIME, 2.0 * TIME, 10.0 + 3.0 * TIME], axis=1)),
    "to and fro along a line": calm(TIME, (50.0 + 30.0 * np.sin(0.3 * TIME))[:, None] * np.array([0.6, 0.0, 0.8])),
    "hovering": calm(TIME, np.stack([STILL, 0.1 * np.sin(TIME), 80.0 + 0.05 * np.cos(2.0 * TIME)], axis=1), 85.0 + STILL),
    "hovering exactly": calm(TIME, np.tile([0.0, 0.0, 80.0], (len(TIME), 1)), 85.0 + STILL),
    "parked": calm(TIME, np.stack([150.0 + STILL, 2.0 * np.sin(0.5 * TIME), 150.0 + np.cos(TIME)], axis=1), 213.0 + STILL),
    "quick loops once a second": calm(
        TIME[::10],
        np.stack([150.0 + 0 * TIME[::10], 15.0 * np.sin(1.3 * TIME[::10]), 90.0 + 15.0 * np.cos(1.3 * TIME[::10])], axis=1),
    ).assign(vx=0.0, vy=np.round(19.5 * np.cos(1.3 * TIME[::10]), 3), vz=np.round(-19.5 * np.sin(1.3 * TIME[::10]), 3)),
    "hops once a second": calm(
        TIME[::10],
        np.stack(
            [0 * TIME[::10], 0 * TIME[::10], 20.0 + 10.0 * np.sin(np.pi / 4.0 * np.minimum(TIME[::10] % 20.0, 4.0)) ** 2],
            axis=1,
        ),
    ),
    "load cell about zero": calm(
        TIME,
        np.stack([30.0 + STILL, 5.0 * np.sin(TIME), 40.0 + STILL], axis=1),
        90.0 + STILL,
        tension=np.round(2.0 * np.sin(7.0 * TIME) - 3.0, 3),
    ),
    "landing": calm(TIME, np.stack([60.0 - 0.8 * TIME, STILL, 70.0 - 1.1 * TIME], axis=1), 100.0 - 1.3 * TIME),
}


@pytest.mark.parametrize("kind", LEGITIMATE)
def test_a_legitimate_flight_is_not_refused(kind, folder):
    table = LEGITIMATE[kind]
    found = flown(folder, table, "enu")
    assert not any("frozen" in each or "left out" in each for each in found.log.report.lines)
    position, _ = found.kite(table["time"].to_numpy()[5:-5])
    assert (
        np.abs(position - table[["x", "y", "z"]].to_numpy()[5:-5]).max() < 10.0
    )  # of hops in a second; nothing was left out


@pytest.mark.parametrize("kind", ["hovering", "hovering exactly", "parked"])
def test_what_rests_is_not_called_frozen(kind, folder):
    doubts = flown(folder, LEGITIMATE[kind], "enu").log.report.doubts
    assert not any("without any change" in each for each in doubts)


NOISY = {  # noise of a position [m], every [s], drift [m]
    "good receiver": (0.05, 0.1, 0.0),
    "usual receiver": (1.0, 0.1, 3.0),
    "bad receiver": (2.5, 0.2, 3.0),
    "slow receiver": (1.5, 1.0, 3.0),
    "fast receiver": (1.0, 0.02, 3.0),
}


@pytest.mark.parametrize("receiver", NOISY)
@pytest.mark.parametrize("kind", ["still", "flying"])
def test_noise_is_no_contradiction(kind, receiver, folder):
    """White noise and a slow drift of a receiver, 0.1 m/s noise of velocities: the log is flown without a jump."""
    noise, every, drift = NOISY[receiver]
    random, time = np.random.default_rng(7), np.arange(0.0, 60.0, every)
    position, velocity = (
        path(time) if kind == "flying" else (np.tile([60.0, 0.0, 150.0], (len(time), 1)), np.zeros((len(time), 3)))
    )
    table = calm(time, position)
    wandered = position + drift * np.sin(0.05 * time)[:, None] + noise * random.normal(size=position.shape)
    table[["x", "y", "z"]] = wandered.round(2)
    table[["vx", "vy", "vz"]] = (velocity + 0.1 * random.normal(size=velocity.shape)).round(2)
    found = flown(folder, table, "enu")
    assert not any("jumps" in each or "without any change" in each for each in found.log.report.doubts)
    assert found.log.table[["kite_position[1]"]].notna().mean().item() > 0.99


def test_the_work_on_a_long_log_grows_with_its_seconds():
    """20 minutes at 100 Hz are compared over windows of 1 s, and a reading with neighbours of 1.1 s."""
    time = np.arange(0.0, 1200.0, 0.01)
    assert len(checks.edges(time)) == 1200
    assert len(checks.edges(np.append(time, 1e10))) == 1201
    values = np.zeros(len(time))
    values[60_000] = 100.0
    assert readings.spikes_of(values, 5.0, 0.01).sum() == 1


def test_a_long_log_is_read(folder):
    found = log.read(written(folder, enu(every=0.01, duration=1200.0)), "enu")
    assert len(found.time) == 120_000
    assert prepare(found, 0.0, 1100.0).end == 1100.0


def test_kite_and_wind_of_the_known_flight():
    """The tension of the known flight is plausible: the doubts on it are tested with a right one."""
    made = motions(np.array([0.0]))
    assert 0.0 < made["force"][0] * KGF < 3e4
    assert np.hypot(*WIND[:2]) == pytest.approx(made["wind"][0])
    assert AREA > 0.0
