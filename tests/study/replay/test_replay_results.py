"""What a replay leaves behind: tables, figures, a page, a scene that is advised, an FMU that flies the log."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.image import imread

from coarse_figures import PART
from isolation import in_own_process
from running import status_of
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files.scene_files import load
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime import layout as at
from tetherfmu.study.advice.scene_advice import FAST_BUDGET, advise
from tetherfmu.study.measuring import runs as measuring
from tetherfmu.study.replay import comparison, driven_tethers, figures, log, scene
from tetherfmu.study.replay import replay as command
from tetherfmu.study.replay.flight import prepare

LOG = EXAMPLES / "flights" / "kitepower_20191008_0012.csv"
START, END, SEGMENTS = 20.0, 32.0, 5  # s
VECTORS = [f"{name}[{k}]" for name in ("kite_position", "kite_velocity", "wind_velocity") for k in (1, 2, 3)]


def flown(lead="tension", wanted=(), tethers=("dynamic", "straight"), **constants):
    """A short part of a published flight as a `Replay`."""
    read = log.read(LOG, "kitepower_2019")
    if constants:
        read = log.read(LOG, read.map.with_constants({name.replace("_", ".", 1): each for name, each in constants.items()}))
    return command.replay(prepare(read, START, END), lead, tethers, wanted, None, SEGMENTS)


@pytest.fixture(scope="module")
def made():
    return flown()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the command leaves behind."""
    place = tmp_path_factory.mktemp("results")
    part = ["--from", str(START), "--to", str(END), "--segments", str(SEGMENTS), "--fit", "nothing"]
    assert tetherfmu(["replay", str(LOG), *part, "--out", str(place), "--html", "--fmu"]) == 0
    return place


def test_all_files_are_there(folder):
    tables, drawn = {"report.md", "series.csv", "errors.csv"}, {"flight.png", "shapes.png", "flight.html"}
    (fmu,) = folder.glob(f"Tether*_{LOG.stem}.fmu")
    assert {path.name for path in folder.iterdir()} == {*tables, *drawn, "scene.toml", "flight.csv", fmu.name}


@pytest.mark.parametrize("name", ["flight.png", "shapes.png"])
def test_figures_are_as_wide_as_a_page(folder, name):
    height, width, _ = imread(folder / name).shape
    assert width == pytest.approx(PART * figures.WIDTH * figures.DPI, abs=1)
    assert 350 * PART <= height <= 1200 * PART


def test_series_for_a_tether(folder):
    """The columns are inputs by their names, the velocities are those of the positions, the path that of series.csv."""
    table, whole = pd.read_csv(folder / "flight.csv"), pd.read_csv(folder / "series.csv")
    assert list(table) == ["time", *VECTORS, "winch_length"]
    assert table.time.iloc[0] == 0.0
    assert table.time.iloc[-1] == END - START
    np.testing.assert_allclose(table[VECTORS], whole[VECTORS], rtol=1e-5, atol=1e-5)  # which has six digits
    moved = (table[VECTORS[:3]].to_numpy()[2:] - table[VECTORS[:3]].to_numpy()[:-2]) / 0.2
    # by a sixth of the rate of the acceleration, some 30 m/s3, times the square of 0.1 s
    np.testing.assert_allclose(moved, table[VECTORS[3:6]].to_numpy()[1:-1], atol=0.1)


def test_scene_has_the_values_of_the_map(folder, made):
    found, told = load(folder / "scene.toml"), made.flight.log.map
    length = pd.read_csv(folder / "flight.csv").winch_length[0]
    assert found.tether == replace(told.tether, segments=found.tether.segments, initial_length=length)
    assert found.environment == told.environment
    assert found.ground == told.ground
    assert found.duration == END - START
    assert found.wanted.outputs == ("kite_force", "ground_force")


def test_scene_is_advised(folder):
    advice = advise(load(folder / "scene.toml"), FAST_BUDGET)
    assert advice.met
    assert advice.expected <= 0.05


def test_length_that_was_found_gives_the_measured_tension(made, tmp_path):
    """Between its rows the length is known to a millimetre or so, which on 13 kN/m is 13 N of 3000 N.

    Its acceleration is not, and the rope has a mass: over 2 s that averages out.

    Both start with the shape of a tether that turns with its kite, as scenes do: after another start both lengths differ.
    """
    turning = driven_tethers.fly(made.flight, "dynamic", "tension", SEGMENTS, initial_shape="quasi_steady")
    scene.write(replace(made, flown={"dynamic": turning}), tmp_path, "turning")
    found = load(tmp_path / "scene.toml")
    again = measuring.run(found, measuring.Config("dynamic", SEGMENTS, 0.0, 0.02)).flown.of("ground_tension")
    measured = made.flight.measured("ground_tension", START + found.times[1:])
    averaged = np.convolve(again - measured, np.full(20, 1.0 / 20.0), "valid")
    assert np.sqrt(np.mean(averaged**2)) < 13.0
    assert np.sqrt(np.mean((again - measured) ** 2)) < 0.05 * measured.mean()
    assert measured.mean() > 1500.0


def test_residuals_are_those_of_the_tether_less_the_log(made):
    """A tether that is 5 m longer and pulls with 7 N more."""
    whole = made.flown["dynamic"]
    table = whole.table.assign(tether_length=whole.table.tether_length + 5.0, mean_tension=whole.table.mean_tension + 7.0)
    before, after = (
        comparison.residuals(made.flight, {"dynamic": each})
        for each in (whole, driven_tethers.Flown(table, whole.shapes, ()))
    )
    np.testing.assert_allclose(after.length - before.length, 5.0, rtol=1e-9)
    np.testing.assert_allclose((after.tension - before.tension).dropna(), 7.0, rtol=1e-9)
    assert before.tension.notna().sum() > 100


@pytest.mark.parametrize("lead", ["tension", "length", "speed"])
def test_scene_of_each_lead(lead, tmp_path):
    """The winch of the scene follows the length that was found or logged, or the logged speed; the ground is there."""
    each = flown(lead, ("offset",), ("dynamic",), ground_contact="flat", ground_height=-7.5)
    scene.write(each, tmp_path, "of a lead")
    found, table = load(tmp_path / "scene.toml"), each.flown["dynamic"].table
    assert found.name == "of a lead"
    assert (found.ground.ground_contact, found.ground.ground_height) == (at.FLAT, -7.5)
    assert measuring.winch_control(found) == (at.WINCH_BY_SPEED if lead == "speed" else at.WINCH_BY_LENGTH)
    assert found.tether.initial_length == pytest.approx(table.tether_length[0], abs=0.02)  # less than a step of reeling
    column = pd.read_csv(tmp_path / "flight.csv").iloc[:, -1]
    wanted = {"tension": table.tether_length, "length": each.flight.length(each.flight.times)}
    speed = each.flight.measured("reel_out_speed", each.flight.times)
    np.testing.assert_allclose(column, wanted.get(lead, speed), rtol=1e-8)


def test_shape_is_wanted_of_a_slack_tether(made):
    """Twice as long as it was."""
    table = made.flown["dynamic"].table
    slack = driven_tethers.Flown(table.assign(tether_length=2.0 * table.tether_length), made.flown["dynamic"].shapes, ())
    hanging = replace(made, flown={"dynamic": slack})
    assert made.is_slack.mean() == 0.0
    assert hanging.is_slack.mean() == 1.0
    assert 'outputs = ["shape"]' in scene.toml(hanging, "slack")
    assert figures.draw_sag in figures.panels(hanging)
    assert figures.draw_sag not in figures.panels(made)


def test_names_that_a_path_may_not_have(made):
    text = scene.toml(made, 'flug "1" [a]\n%')
    assert 'name = "flug _1_ _a___"' in text
    assert text.startswith("# The measured flight flug _1_ _a___ (Kitepower, 8 October 2019")


def test_steps_that_were_refused(made, tmp_path):
    """Their times are left out, and that is said; figures and page have the others."""
    whole = made.flown["dynamic"]
    table, shapes = whole.table.copy(), whole.shapes.copy()
    table.loc[30:39, table.columns.drop("time")], shapes[30:40] = np.nan, np.nan
    broken = replace(made, flown={"dynamic": driven_tethers.Flown(table, shapes, ())})
    command.write(broken, tmp_path, "broken", html=True)
    assert "# 10 times are left out" in (tmp_path / "scene.toml").read_text(encoding="utf-8")
    assert len(pd.read_csv(tmp_path / "flight.csv")) == len(table) - 10
    assert load(tmp_path / "scene.toml").duration == END - START
    assert np.isfinite(figures.seen(broken.flown["dynamic"]).kite_force).all()


def test_a_tether_that_breaks_is_told():
    """It then holds nothing, and the lengths that are compared are no longer those of a winch that holds the tension."""
    found = flown(tethers=("dynamic",), tether_breaking_force=500.0)
    assert any("dynamic broke after 0" in each and "of a broken tether" in each for each in found.doubts)
    assert not any("broke" in each for each in flown(tethers=("dynamic",)).doubts)


def test_page_shows_the_flown_path_and_the_ground(made, monkeypatch, tmp_path):
    seen = {}

    def write_page(flights, file, path, count, title, ground):
        seen.update(flights=flights, file=file, path=path, title=title, ground=ground)

    monkeypatch.setattr(figures, "drawing", lambda: SimpleNamespace(write_page=write_page))
    assert figures.write_page(made, tmp_path, "a <log>") == seen["file"] == tmp_path / "flight.html"
    np.testing.assert_array_equal(seen["path"], made.flight.kite(made.flight.times)[0])
    assert seen["title"] == "Tether along the flight of a <log>"
    assert seen["ground"] is None
    (tether,) = seen["flights"].values()
    np.testing.assert_allclose(tether.shape[:, -1], seen["path"], atol=0.05)  # where the tether was at that time
    figures.write_page(flown(ground_contact="flat", ground_height=-7.5, tethers=("straight",)), tmp_path, "log")
    assert seen["ground"] == -7.5


def test_page_needs_nothing_else(folder):
    text = (folder / "flight.html").read_text(encoding="utf-8")
    assert f"<title>Tether along the flight of {LOG.stem}</title>" in text
    assert "path of the kite" in text
    assert "<script src=" not in text


def test_fmu_starts_with_the_values_of_the_log(folder):
    from fmpy import read_model_description

    (fmu,), rows = folder.glob("*.fmu"), pd.read_csv(folder / "flight.csv")
    description = read_model_description(fmu)
    start = {each.name: each.start for each in description.modelVariables}
    for name in VECTORS:
        assert float(start[name]) == rows[name][0]
    assert float(start["initial_length"]) == rows.winch_length[0]
    assert float(start["diameter"]) == 0.01
    assert int(start["winch_control"]) == at.WINCH_BY_LENGTH
    assert {each.name for each in description.modelVariables if each.causality == "input"} >= {*rows} - {"time"}


@in_own_process
def test_fmu_flies_the_log(folder):
    """FMPy takes flight.csv as it is; the force at the ground is the measured tension within the allowed error of 5 %."""
    from fmpy import read_model_description, simulate_fmu

    (fmu,), rows = folder.glob("*.fmu"), pd.read_csv(folder / "flight.csv")
    step = float(read_model_description(fmu).defaultExperiment.stepSize)
    inputs = rows.to_records(index=False)
    made = simulate_fmu(str(fmu), stop_time=rows.time.iloc[-1], output_interval=step, input=inputs)
    assert made["time"][-1] == pytest.approx(rows.time.iloc[-1])
    series = pd.read_csv(folder / "series.csv")
    measured = np.interp(made["time"] + START, series.time, series.measured_tension)
    force = np.linalg.norm([made[f"ground_force[{k}]"] for k in (1, 2, 3)], axis=0)
    late = made["time"] > 0.25 * (END - START)  # as the errors of an advice are counted, at the latest
    assert np.sqrt(np.mean((force - measured)[late] ** 2)) < 0.05 * np.sqrt(np.mean(measured[late] ** 2))


def test_no_fmu_is_good_enough(made, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(scene.scene_build, "advised", lambda *_: ("No configuration is known", False, "", None))
    assert scene.build(tmp_path) == 1
    assert "No configuration is known" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())


def test_a_file_as_folder_is_refused(tmp_path, capsys):
    (tmp_path / "there").touch()
    assert status_of("replay", str(LOG), "--out", str(tmp_path / "there")) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_without_plotly_nothing_is_flown(tmp_path, monkeypatch, capsys):
    figures.drawing()
    monkeypatch.delitem(sys.modules, "shared.flight_page")
    monkeypatch.setitem(sys.modules, "plotly", None)
    assert tetherfmu(["replay", str(LOG), "--html", "--out", str(tmp_path / "new")]) == 2
    told = capsys.readouterr()
    assert told.err == 'plotly is not installed: pip install "tetherfmu[html]"\n'
    assert told.out == ""
    assert not (tmp_path / "new").exists()


def test_scale_is_not_that_of_a_transient():
    """Neither the first second nor single peaks set an axis; what is measured is always in it, a tether not at any price."""
    times = np.linspace(0.0, 100.0, 1001)
    measured, tether = 100.0 + 50.0 * np.sin(times), 120.0 + 50.0 * np.sin(times)
    tether[:12], tether[500] = 30e3, -9e3
    low, high = figures.limits(times, [measured], [tether])
    assert 35.0 < low < 50.0
    assert 170.0 < high < 190.0
    low, high = figures.limits(times, [measured], [tether + 5e3])
    assert 150.0 < high < 250.0
    assert "quasi-steady, " in next(figures.cut_off(times, {"quasi_steady": tether + 5e3}, low, high))
    assert list(figures.cut_off(times, {"dynamic": measured}, low, high)) == []


def test_gaps_stay_gaps():
    values = np.ones(100)
    values[40:60] = np.nan
    np.testing.assert_array_equal(figures.smooth(values), values)


def test_phases_of_a_log():
    times, labels = np.arange(6.0), np.array(["ro", "ro", "", "ri", "ri", "ro"])
    assert list(figures.intervals(times, labels)) == [("ro", 0.0, 2.0), ("ri", 3.0, 5.0), ("ro", 5.0, 5.0)]


def test_view_from_the_side():
    """In the plane of station and kite the distance along the ground is that of the kite, whatever its azimuth."""
    shape = np.array([[[0.0, 0.0, 0.0], [3.0, 4.0, 20.0], [6.0, 8.0, 50.0]]])
    along, height = figures.side_view(shape)
    np.testing.assert_allclose(along, [[0.0, 5.0, 10.0]])
    np.testing.assert_allclose(height, [[0.0, 20.0, 50.0]])


def test_tables_for_people():
    table = comparison.rounded(
        pd.DataFrame(
            {"tether": ["a"], "length: mean [m]": [-0.0012], "tension: rms [N]": [13346.2], "tension: mean [N]": [1.149]}
        )
    )
    assert table.to_dict("records") == [
        {"tether": "a", "length: mean [m]": 0.0, "tension: rms [N]": 13300.0, "tension: mean [N]": 1.1}
    ]
