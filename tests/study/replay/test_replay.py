"""Measured flights as a user flies them again: one command for each log, and numbers that are those of the physics."""

import re

import numpy as np
import pandas as pd
import pytest

from running import status_of
from study.replay import logs_of_tests
from study.replay.known_flight import enu, written
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files.csv_files import Table
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.study.replay import checks, comparison, driven_tethers, fitting, log, readings
from tetherfmu.study.replay.flight import prepare
from tetherfmu.study.replay.replay import part_of_fit, replay

CYCLES = [EXAMPLES / "flights" / f"kitepower_20191008_{cycle}.csv" for cycle in ("0012", "0031", "0064")]
MOST = {"kitepower_20191008_0012": 1.0, "kitepower_20191008_0031": 1.3, "kitepower_20191008_0064": 1.6}  # m


@pytest.fixture(scope="module")
def clean():
    """A flight whose positions, length and tension are those of our dynamic tether, to rounding and millimetres."""
    cells = logs_of_tests.cells(noise=1e-3)
    when, length, tension = logs_of_tests.flown()
    time = cells["time"].astype(float)
    cells["length"], cells["tension"] = (np.interp(time, when, each).astype(str) for each in (length, tension))
    told = logs_of_tests.MAP.with_constants({"smoothing.position_noise": 1e-3, "smoothing.acceleration_change": 50.0})
    return prepare(log.log_of(Table(cells), told), 20.0, 60.0)


@pytest.mark.parametrize("path", CYCLES, ids=lambda path: path.stem)
def test_a_published_cycle_in_one_command(path, tmp_path, capsys):
    """The scatter is that of the position of the wing (1 to 1.6 m about a line with the bare distance, too)."""
    assert tetherfmu(["replay", str(path), "--out", str(tmp_path), "--tether", "quasi_steady"]) == 0
    said = capsys.readouterr().out
    assert "map kitepower_2019" in said
    assert "fitted from 0.0" in said
    assert "tested from" in said
    errors = pd.read_csv(tmp_path / "errors.csv")
    (whole,) = errors[errors.part == "all"].to_dict("records")
    assert 0.5 < whole["length: rms about mean [m]"] < MOST[path.stem]
    assert {"phase pp-ro", "phase pp-ri"} <= set(errors.part)
    series = pd.read_csv(tmp_path / "series.csv")
    assert np.isfinite(series.to_numpy()).all()
    np.testing.assert_allclose(
        series["quasi_steady.ground_tension"][1:], series["measured_tension"][1:], rtol=0.02, atol=30.0
    )


def test_the_tension_leads_to_the_length(clean):
    """What was flown by force is found again; the first seconds are the tether's start in equilibrium."""
    flown = driven_tethers.fly(clean, "dynamic", "tension", logs_of_tests.SEGMENTS).table
    settled = flown.time > clean.start + 5.0
    error = flown.tether_length - clean.length(clean.times)
    assert np.abs(error[settled]).max() < 0.03  # 3 cm of 250 m: linear between readings every 0.1 s
    np.testing.assert_allclose(
        flown.mean_tension[settled], clean.measured("ground_tension", clean.times)[settled], rtol=0.02
    )


def test_the_length_leads_to_the_tension(clean):
    """With positions that are right to a millimetre, 28 N on 28 kN/m, a taut tension can be found."""
    found = comparison.residuals(clean, {"dynamic": driven_tethers.fly(clean, "dynamic", "length", logs_of_tests.SEGMENTS)})
    settled = found.time > clean.start + 5.0
    assert comparison.rms(found.tension[settled]) < 60.0  # N of 3000: twice the noise of a position
    assert comparison.untrustworthy(found) == (pytest.approx(1.0, abs=0.01), 0.0)  # the means of the ends may be missing


def test_noise_of_positions_is_said_where_the_length_leads():
    made = replay(prepare(logs_of_tests.made(noise=0.5), 0.0, 20.0), "length", ("quasi_steady",), wanted=())
    (doubt,) = made.doubts
    assert re.match(r"the tether is taut for \d+ % of the time; for 100 % of that the noise", doubt)
    assert "taut forces from positions are not reliable" in doubt
    stiffness = logs_of_tests.TETHER.axial_stiffness / made.flown["quasi_steady"].table.tether_length
    np.testing.assert_allclose(made.residuals.band.dropna(), (0.5 * stiffness)[made.residuals.band.notna()], rtol=1e-3)


def test_the_speed_leads_as_its_integral_does(clean):
    """The logged length's rate, as a reel-out speed."""
    cells = logs_of_tests.cells(noise=1e-3)
    when, length, _ = logs_of_tests.flown()
    time = cells["time"].astype(float)
    cells["speed"] = np.interp(time, when, np.gradient(length, when)).astype(str)
    sources = logs_of_tests.MAP.sources | {"reel_out_speed": logs_of_tests.source("speed")}
    del sources["tether_length"]
    read = log.log_of(Table(cells), log.columns.replace(logs_of_tests.MAP, sources=sources))
    flown = driven_tethers.fly(prepare(read, 20.0, 60.0), "catenary", "speed").table
    error = flown.tether_length - clean.length(clean.times)
    assert np.ptp(error) < 0.2  # of 25 m that are reeled: samples every 0.1 s of a speed that jumps with the force


def test_errors_by_phase_are_means_of_their_rows():
    time = np.arange(0.0, 10.0, 0.1)
    phase = np.where(time < 5.0, "out", "in")
    found = pd.DataFrame({"time": time, "tether": "dynamic", "length": np.where(time < 5.0, 1.0, 3.0), "phase": phase})
    found = found.assign(tension=-2.0, measured=100.0 + time, stiffness=1e4, band=5e3)
    by_length = comparison.errors(found, start=-comparison.SETTLED, lead="tension").set_index("part")
    assert by_length.at["all", "length: mean [m]"] == pytest.approx(2.0)
    assert by_length.at["all", "length: rms about mean [m]"] == pytest.approx(1.0)
    assert by_length.at["all", "equivalent tension [N]"] == pytest.approx(1e4)
    assert by_length.at["phase in", "length: mean [m]"] == pytest.approx(3.0)
    by_tension = comparison.errors(found, start=-comparison.SETTLED, lead="length").set_index("part")
    assert by_tension.at["phase out", "tension: rms [N]"] == pytest.approx(2.0)
    assert by_tension.at["all", "correlation"] == 1.0
    assert "length: mean [m]" not in by_tension
    falling = found.assign(tension=-2.0 * time)  # computed is 100 - t where 100 + t is measured
    assert comparison.errors(falling, -comparison.SETTLED, "length").set_index("part").at["all", "correlation"] == -1.0
    later = comparison.errors(found, start=0.0, lead="tension").set_index("part")
    assert later.at["all", "time [s]"] == pytest.approx(10.0 - comparison.SETTLED)


def test_the_part_of_the_fit_is_what_was_before_or_the_first_half():
    whole = prepare(logs_of_tests.made())
    assert (part_of_fit(whole).start, part_of_fit(whole).end) == (0.0, pytest.approx(54.95, abs=0.1))
    late = whole.part(40.0, 100.0)
    assert (part_of_fit(late).start, part_of_fit(late).end) == (0.0, 40.0)
    early = whole.part(10.0, 100.0)
    assert (part_of_fit(early).start, part_of_fit(early).end) == (10.0, 55.0)
    assert (part_of_fit(early, 20.0, 90.0).start, part_of_fit(early, 20.0, 90.0).end) == (20.0, 90.0)


WRONG = {
    "no map": (["--as", "nonsense"], "there is no map nonsense; it must be one of kitepower, "),
    "no part": (["--from", "500"], "the part from 500 to 123.7 s is not possible: the log has 0 to 123.7 s"),
    "too short": (["--from", "10", "--to", "11"], "the shortest flight is 5 s"),
    "fit": (["--fit", "nothing", "delay"], "nothing cannot be combined"),
    "constant": (["--set", "tether.diameter=50 km"], "tether.diameter is '50 km'; it must be"),
    "no section": (["--set", "rope.diameter=1"], "rope.diameter is not a constant of a map; sections are"),
    "no key": (["--set", "tether.colour=1"], "unknown key tether.colour; known are"),
    "part of the fit": (["--fit-from", "90", "--fit-to", "20"], "the part from 90 to 20 s is not possible"),
    "lead": (["--lead", "hope"], "'hope' is not possible; choose from tension, length, speed"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_use_is_refused_in_one_line(name, capsys, tmp_path):
    options, said = WRONG[name]
    assert status_of("replay", str(CYCLES[0]), "--out", str(tmp_path / "out"), *options) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def in_kilonewtons(tmp_path_factory):
    """A log whose tension does not hold its tether up."""
    table = enu(duration=12.0)
    return written(tmp_path_factory.mktemp("kN"), table.assign(ground_tension=table["ground_tension"] / 1e3))


def test_a_tether_that_refuses_all_is_stopped_and_said(in_kilonewtons):
    """It was tried for 5 min: each of its refusals takes the longest search for a length."""
    made = replay(prepare(log.read(in_kilonewtons, "enu")), "tension", ("catenary", "straight"), wanted=())
    assert list(made.flown) == ["straight"]
    assert set(made.errors.tether) == {"straight"}
    (doubt,) = made.doubts
    assert doubt.startswith(
        "without results: catenary refused 100 communication steps and was stopped at 2.0 s; the first: "
    )


def test_a_log_that_no_tether_can_fly_is_refused(in_kilonewtons, capsys, tmp_path):
    options = ["--as", "enu", "--tether", "catenary", "--fit", "nothing", "--out", str(tmp_path / "out")]
    assert tetherfmu(["replay", str(in_kilonewtons), *options]) == 2
    error = capsys.readouterr().err
    assert "flight.csv: no tether can fly this: without results: catenary refused 100 communication steps" in error
    assert "kN was probably meant" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_log_need_not_be_there(capsys):
    assert tetherfmu(["replay", "nowhere.csv"]) == 2
    assert capsys.readouterr().err == "nowhere.csv: cannot be read (No such file or directory)\n"


def test_what_the_smoother_and_the_fit_are_told_is_said():
    read = logs_of_tests.made()
    flight = prepare(read)
    assert "smoothed: positions (noise 0.5 m), acceleration changing by 5 m/s2 in 1 s" in str(read.report)
    found = fitting.fit(flight)
    assert str(found).startswith("fitted from 0.0 to 109.9 s: length offset m ")


def test_the_work_on_a_long_log_grows_with_its_seconds():
    """20 minutes at 100 Hz are compared over windows of 1 s, and a reading with neighbours of 1.1 s."""
    time = np.arange(0.0, 1200.0, 0.01)
    assert len(checks.edges(time)) == 1200
    assert len(checks.edges(np.append(time, 1e10))) == 1201
    values = np.zeros(len(time))
    values[60_000] = 100.0
    assert readings.spikes_of(values, 5.0, 0.01).sum() == 1


@pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them
def test_a_long_log_is_read(folder):
    found = log.read(written(folder, enu(every=0.01, duration=600.0)), "enu")
    assert len(found.time) == 60_000
    assert prepare(found, 0.0, 500.0).end == 500.0
