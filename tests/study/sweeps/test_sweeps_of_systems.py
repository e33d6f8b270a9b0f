"""Sweeps of systems and of series: statistics of a flight by the Python API, courses that are changed, wrong names."""

import numpy as np
import pandas as pd
import pytest

from scenes import hanging_load
from tetherfmu import TetherSystem
from tetherfmu.__main__ import main
from tetherfmu.files.system_files import load
from tetherfmu.runtime.outputs import PLACES
from tetherfmu.study import sweep

STEP, COUNT, G = 0.02, 100, 9.81
LOAD = hanging_load("tip", 50, 200.0, initial_length=20.0, diameter=0.01, density=1000.0, segments=3)
HOIST = f"{LOAD}\n[series]\nrope.reel_out_speed = [[0, 0], [1, 0.5], [2, 0.5]]\n"
ROPE = 1000.0 * np.pi * 0.01**2 / 4.0 * 20.0  # mass [kg]
ONE = {"processes": 1}


@pytest.fixture
def hoist(tmp_path):
    path = tmp_path / "hoist.toml"
    path.write_text(HOIST, encoding="utf-8")
    return path


def test_statistics_are_those_of_a_flight_of_the_python_api(hoist):
    """Of the second of three loads, a row after each step; the drum runs as the rows say, at twice their speed."""
    values = {"points.load.mass": [100.0, 300.0, 500.0], "series.rope.reel_out_speed.factor": [2.0]}
    row = sweep(hoist, values, **ONE).iloc[1]
    hoist.write_text(HOIST.replace("mass = 200.0", "mass = 300.0"), encoding="utf-8")
    system, time = TetherSystem.of(load(hoist)), STEP * np.arange(COUNT)
    system.initialize()
    flown = system.fly(COUNT, STEP, reel_out_speeds={"rope": np.minimum(time, 1.0)})
    tension, speed = (flown.outputs["rope"][:, PLACES[name]] for name in ("ground_tension", "winch_speed"))
    assert row["rope.tension_from_max"] == tension.max()
    assert row["rope.power_mean"] == pytest.approx(np.mean(tension * speed), rel=1e-12)
    assert row["rope.payout_max"] == pytest.approx(1.5, abs=0.02)  # area below the rows, twice 0.75 m; inputs are linear
    assert row["peak_tension"] >= row["rope.tension_from_max"]


def test_a_load_at_rest_pulls_with_its_weight_and_that_of_its_rope(hoist):
    found = sweep(hoist, ["points.load.mass=100,200"], **ONE)
    mass = found["points.load.mass"].to_numpy()
    assert found["rope.tension_from_min"].to_numpy() == pytest.approx((mass + ROPE) * G, rel=0.2)
    assert found["rope.tension_from_p50"].to_numpy() == pytest.approx((mass + ROPE) * G, rel=0.06)  # 0.5 m/s2 of 9.81


def test_a_later_course_moves_nothing_before(hoist):
    found = sweep(hoist, ["series.rope.reel_out_speed.delay=0,1 s"], settings=[("duration", 1.0)], **ONE)
    assert found["rope.payout_max"].tolist() == pytest.approx([0.25, 0.0], abs=0.01)
    assert found["rope.payout_max"][1] == 0.0


def test_a_series_of_a_scene_is_varied(tmp_path):
    """A drum at 1 m/s for 2 s, at other speeds: what is paid out is in proportion."""
    scene = tmp_path / "reel.toml"
    text = 'duration = 2.0\n[flight]\nkind = "parked"\nsway = 0.0\n[tether]\ninitial_length = 210\n[wanted]\n'
    scene.write_text(f"{text}allowed_error = 0.03\n[series]\nreel_out_speed = 1.0\n", encoding="utf-8")
    by_factor = sweep(scene, ["series.reel_out_speed.factor=0.5,1,2"], segments=4, **ONE)
    assert by_factor["payout_max"].tolist() == pytest.approx([1.0, 2.0, 4.0], rel=1e-9)
    by_value = sweep(scene, ["series.reel_out_speed=0.5 m/s..2 m/s:4"], segments=4, **ONE)
    assert by_value["payout_max"].tolist() == pytest.approx([1.0, 2.0, 3.0, 4.0], rel=1e-9)


def test_the_command_flies_a_system_and_repeats_its_worst_flight(hoist, tmp_path, capsys):
    out = tmp_path / "swept"
    asked = ["sweep", str(hoist), "--vary", "points.load.mass=100 kg..300 kg:3", "--vary", "lines.rope.diameter=8 mm,10 mm"]
    assert main([*asked, "--outputs", "tension_from,load.position", "--processes", "1", "--out", str(out)]) == 0
    capsys.readouterr()
    table = pd.read_csv(out / "flights.csv")
    assert {"rope.tension_from_max", "load.position[3]_min", "refused"} <= {*table}
    page = (out / "report.md").read_text(encoding="utf-8")
    command = next(line for line in page.splitlines() if "peak_tension" in line and "tetherfmu fly" in line).split("`")[1]
    csv = tmp_path / "again.csv"
    assert main([*command.split()[1:], "--csv", str(csv), "--out", str(tmp_path / "plots")]) == 0
    assert pd.read_csv(csv)["rope.peak_tension"][1:].max() == pytest.approx(table["peak_tension"].max(), rel=1e-9)


@pytest.mark.parametrize(
    ("vary", "says"),
    {
        "lines.rop.diameter=1,2": "lines has no rop; did you mean rope?",
        "lines.rope.diametre=1,2": "a system has no lines.rope.diametre; did you mean diameter?",
        "tether.diameter=1,2": "a system has no tether.diameter; its values are in environment",
        "series.rope.winch_force=1,2": "the table [series] has no series.rope.winch_force",
        "series.rope.reel_out_speed[1]=1,2": "series.rope.reel_out_speed is one number; vary series.rope.reel_out_speed, ",
        "series.load.load=1,2": "series.load.load is three numbers; vary series.load.load[1], series.load.load.factor",
        "series.load.load.factor=1,2": "there is no series.load.load to change",
        "points.load.mass=1 s": "it must be a number with one of the units kg",
    }.items(),
)
def test_wrong_names_are_refused(hoist, vary, says):
    """At once, or as the reason in the row of the flight."""
    try:
        said = sweep(hoist, [vary], **ONE).refused[0]
    except ValueError as error:
        said = str(error)
    assert says in said


@pytest.mark.parametrize(
    ("options", "says"),
    {
        ("--tether", "catenary"): "tether is catenary; the lines of a system are dynamic",
        ("--segments", "5"): "segments are those of each line of a system, lines.NAME.segments",
        ("--outputs", "sag,tension_frm"): "there is no output 'sag'",
        ("--cycles-of", "rope.tension"): "there is no output 'rope.tension'",
    }.items(),
)
def test_what_the_file_decides_is_refused(hoist, tmp_path, capsys, options, says):
    asked = ["sweep", str(hoist), "--vary", "points.load.mass=1,2", *options, "--out", str(tmp_path / "out")]
    assert main(asked) == 2
    assert says in capsys.readouterr().err
