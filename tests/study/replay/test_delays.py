"""Delays between recorders, signs, factors and offsets of columns are found, also together; a sound log has none."""

from dataclasses import replace

import numpy as np
import pytest

from study.replay.breaking import changed
from study.replay.known_flight import enu
from tetherfmu.files.csv_files import Table
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.study.replay import checks, delays, log
from tetherfmu.study.replay.readings import POSITION

CYCLES = [EXAMPLES / "flights" / f"kitepower_20191008_{number}.csv" for number in ("0012", "0031", "0064")]
LOGGED = CYCLES[1]
KITE = ("kite_position", "kite_velocity")


def late(made, names, seconds):
    """The same log with some columns later by so much [s]."""
    table = made.table.copy()
    for name in (each for each in table if each.partition("[")[0] in names):
        table[name] = np.interp(made.time - seconds, made.time, table[name].to_numpy(), np.nan, np.nan)
    return replace(made, table=table, report=log.Report())


def doubts(made):
    """Doubts of `checks.check` on a log."""
    checks.check(made)
    return "\n".join(made.report.doubts)


@pytest.mark.parametrize("seconds", [-9.0, -4.4, 0.0, 5.0])
def test_the_clock_of_a_logged_kite_against_that_of_its_winch(seconds):
    """A cycle as it was published, and with the recorders apart; the winch is 0.1 s off at most there."""
    said = doubts(late(log.read(LOGGED, "kitepower"), KITE, seconds))
    pair = ("kite_velocity", "reel_out_speed") if seconds > 0.0 else ("reel_out_speed", "kite_velocity")
    assert ("later in the log" in said) == (seconds != 0.0)
    if seconds:
        found = float(said.partition(f"{pair[0]} is ")[2].split()[0])
        assert said.partition(f"{pair[0]} is ")[2].split()[7].rstrip(":") == pair[1]
        assert abs(found - abs(seconds)) < 0.2


@pytest.mark.parametrize("seconds", [-4.4, 0.3, 5.0])
def test_the_clock_of_a_load_cell(seconds):
    said = doubts(late(log.read(LOGGED, "kitepower"), ("ground_tension",), seconds))
    pair = ("ground_tension", "airspeed") if seconds > 0.0 else ("airspeed", "ground_tension")
    found = float(said.partition(f"{pair[0]} is ")[2].split()[0])
    assert abs(found - abs(seconds)) < 0.15  # with two digits
    assert f"set delay.ground_tension = {np.sign(seconds) * found:.2g} s" in said


@pytest.mark.parametrize("seconds", [0.0, 5.0])
@pytest.mark.parametrize("part", [-0.6, 0.0, 0.6])
@pytest.mark.parametrize("cycle", CYCLES, ids=lambda path: path.stem)
def test_the_zero_of_a_load_cell(cycle, part, seconds):
    """Logged cycles as they were published, and with a part of the median tension added, also on a late clock."""
    made = log.read(cycle, "kitepower")
    tension = made.table["ground_tension"]
    made = replace(made, table=made.table.assign(ground_tension=tension + part * tension.median()))
    said = doubts(late(made, ("ground_tension",), seconds)).partition("ground_tension would be ")[2]
    assert bool(said) == (part != 0.0)
    if part:
        assert abs(float(said.split()[0]) / tension.median() - part) < 0.2  # of which the flight itself has up to 0.12


KNOWN = {  # what is done to the columns of a sound log, and what is said; seconds by which the winch is late
    "sound": ({}, 0.0, ""),
    "late": ({}, 3.0, "is 3 s later in the log than kite_velocity"),
    "late, with an offset": (
        {"reel_out_speed": lambda c: c + 0.8},
        3.0,
        "is 3 s later .*\n.*reel_out_speed is too large by 0.8 m/s all the time",
    ),
    "an offset of the velocity": ({"vx": lambda c: c + 1.5}, 0.0, "kite_velocity is too large by 1.5, .* m/s all the time"),
}


def known(changes, seconds):
    """`Log` of the known flight with changes of its columns, and a winch that is late."""
    made = log.log_of(Table(changed(enu(), **changes).astype(str)), log.columns.load("enu"))
    return late(made, ("reel_out_speed", "tether_length", "ground_tension"), seconds)


@pytest.mark.parametrize("case", KNOWN)
def test_offsets_beside_delays(case):
    changes, seconds, said = KNOWN[case]
    found = doubts(known(changes, seconds))
    for each in said.split("\n"):
        assert each.removeprefix(".*").partition(" .*")[0] in found
    assert ("later in the log" in found, "all the time" in found) == ("later" in said, "all the time" in said)


@pytest.mark.parametrize(("factor", "seen"), [(-1.0, -1), (3.6, 0.28)], ids=["the opposite sign", "another unit"])
def test_signs_and_factors_beside_delays(factor, seen):
    made = known({"reel_out_speed": lambda c: factor * c}, 3.0)
    with pytest.raises(log.LogError, match=f"changes by {seen} m for each metre of reel_out_speed"):
        checks.check(made)
    assert "3 s later in the log" in "\n".join(made.report.doubts)


def test_of_peaks_that_are_as_high_the_nearest_counts():
    """A sine of 8 s that is 1 s late, and 7 s early as well."""
    time = 0.1 * np.arange(1200)
    one, other = (np.sin(np.pi / 4.0 * (time - shift))[:, None] for shift in (1.0, 0.0))
    seconds, best, before = delays.peak(one, other, 0.1)
    np.testing.assert_allclose((seconds, best, before), (1.0, 1.0, np.cos(np.pi / 4.0)), atol=2e-3)


def test_the_delay_of_a_map_is_taken_into_account():
    made = late(log.read(LOGGED, "kitepower"), KITE, 5.0)
    made = replace(made, map=replace(made.map, delay=log.columns.Delay(kite_position=5.0, kite_velocity=5.0)))
    assert "later in the log" not in doubts(made)
    assert delays.of_position(made) == 0.0
    assert POSITION[0] in made.table
