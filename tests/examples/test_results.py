"""`tetherfmu fly --csv --from`: the table has what was flown, and the summary what its columns give by numpy."""

import re
import shlex

import numpy as np
import pandas as pd
import pytest

from running import assert_is_drawn, run_python
from scenes import hanging_load
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files.scene_files import load
from tetherfmu.study import sweep
from tetherfmu.study.measuring import flight_table

G = 9.81
MASS, SPEED, ROPE, DENSITY, DIAMETER = 300.0, 0.5, 30.0, 1000.0, 0.01
OF_THE_ROPE = {"initial_length": ROPE, "diameter": DIAMETER, "density": DENSITY, "segments": 8}
HOISTED = hanging_load("winch", 0, MASS, **OF_THE_ROPE, reel_out_speed=-SPEED)


def flown(tmp_path, *arguments):
    """Lines that a flight prints, and its table."""
    file = tmp_path / "table.csv"
    done = run_python("-m", "tetherfmu", "fly", *arguments, "--csv", file, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert str(file) in done.stdout.splitlines()
    return done.stdout.splitlines(), pd.read_csv(file)


def row_of(lines, name):
    """Mean, least and largest value and their times, as a summary prints them."""
    (line,) = (each for each in lines if each.strip().startswith(f"{name} ["))
    return [float(each) for each in re.findall(r"-?[\d.]+(?:e[-+]\d+)?", line.partition("]")[2])]


def test_the_summary_is_that_of_the_columns(fmu_folder, tmp_path):
    """Of a pumping kite: power from tension and speed, its means by phase, the payout by the formula of the flight."""
    lines, table = flown(tmp_path, "reel", "--fmus", fmu_folder, "--set", "segments=6", "--from", 2)
    assert table.time.iloc[0] == pytest.approx(2.0)
    assert len(table) == 1401
    power = table.ground_tension * table.winch_speed
    assert table.power.to_numpy() == pytest.approx(power.to_numpy(), rel=1e-8)
    for name, values in {"power": power, "ground_tension": table.ground_tension, "payout": table.payout}.items():
        mean, least, when, largest, later = row_of(lines, name)
        size = 1e-4 * values.abs().max()
        assert [mean, least, largest] == pytest.approx([values.mean(), values.min(), values.max()], abs=size)
        assert [when, later] == pytest.approx([table.time[values.idxmin()], table.time[values.idxmax()]])
    (phases,) = (line for line in lines if line.strip().startswith("power:"))
    out, back = (float(each) for each in re.findall(r"(-?[\d.]+) W", phases))
    assert out == pytest.approx(power[table.winch_speed > 1e-3].mean(), rel=1e-4)
    assert back == pytest.approx(power[table.winch_speed < -1e-3].mean(), rel=1e-4)
    paid_out = load("reel").flight.reeled(table.time.to_numpy())
    assert table.payout.to_numpy() == pytest.approx(paid_out, abs=0.01)  # jumps of the speed count by h/2


def test_a_sweep_has_the_same_numbers(fmu_folder, tmp_path):
    """A row in each communication step, without the start."""
    _, table = flown(tmp_path, "reel", "--fmus", fmu_folder, "--set", "segments=6", "--duration", 20)
    (row,) = sweep("reel", ["wind.speed=8"], settings=[("duration", 20.0)], segments=6, processes=1).to_dict("records")
    rows = table[1:]
    for name in ("ground_tension", "power", "payout"):
        values = rows[name]
        found = [row[f"{name}_{part}"] for part in ("mean", "min", "max")]
        assert found == pytest.approx([values.mean(), values.min(), values.max()], rel=1e-8)
    assert row["power_mean_out"] == pytest.approx(rows.power[rows.winch_speed > 1e-3].mean(), rel=1e-8)
    assert row["power_mean_in"] == pytest.approx(rows.power[rows.winch_speed < -1e-3].mean(), rel=1e-8)
    assert row["broken"] == 0.0


def test_the_worst_flight_of_a_sweep_flies_again(fmu_folder, tmp_path):
    """With the command on the page of the sweep, which has a surface over two values."""
    varied = ("--vary", "wind.speed=3,20", "--vary", "tether.diameter=3 mm,4 mm", "--set", "duration=1")
    asked = ["sweep", "parked", *varied, "--segments", "4", "--processes", "1", "--out", str(tmp_path / "sweep")]
    assert tetherfmu(asked) == 0
    assert_is_drawn(tmp_path / "sweep" / "figures" / "surface.png")
    page = (tmp_path / "sweep" / "report.md").read_text(encoding="utf-8")
    flight, command = re.search(
        r"^\| peak_tension \[N\] *\| \S+ *\| (\d+) *\| `tetherfmu fly (.*?)`", page, re.MULTILINE
    ).groups()
    _, table = flown(tmp_path, *shlex.split(command), "--fmus", fmu_folder)
    peaks = pd.read_csv(tmp_path / "sweep" / "flights.csv").peak_tension
    assert int(flight) == peaks.idxmax()
    assert table.peak_tension[1:].max() == pytest.approx(peaks.max(), rel=1e-8)


def test_several_tethers_are_in_one_table(fmu_folder, tmp_path):
    """The circle; the columns of each begin with its name."""
    lines, table = flown(
        tmp_path, "--tether", "all", "--fmus", fmu_folder, "--duration", 0.6, "--outputs", "ground_force,power"
    )
    vectors = [f"{fmu}.ground_force[{i}]" for fmu in ("TetherDynamic", "TetherStraight") for i in (1, 2, 3)]
    assert {*vectors, "time", "TetherCatenary.power"} <= {*table}
    assert not any("kite" in name for name in table)
    largest = np.linalg.norm(table[vectors[:3]], axis=1).max()
    (line,) = (each for each in lines if each.startswith("TetherDynamic: |"))
    assert f"|ground| {largest:.1f} N" in line


def test_the_power_of_a_hoist_is_its_weight_times_its_speed(tmp_path, capsys):
    """Once it swings no more along its rope, whose weight at the drum falls as it comes in."""
    system, file = tmp_path / "hoisted.toml", tmp_path / "table.csv"
    system.write_text(HOISTED, encoding="utf-8")
    asked = ("--duration", "6", "--from", "3", "--csv", str(file), "--out", str(tmp_path))
    assert tetherfmu(["fly", str(system), *asked]) == 0
    table, lines = pd.read_csv(file), capsys.readouterr().out.splitlines()
    per_metre = DENSITY * np.pi * DIAMETER**2 / 4.0
    weight = G * (MASS + per_metre * (ROPE - SPEED * table.time))
    assert table["rope.power"].mean() == pytest.approx(-SPEED * weight.mean(), rel=0.01)
    assert row_of(lines, "rope.power")[0] == pytest.approx(table["rope.power"].mean(), rel=1e-4)
    assert np.allclose(table["rope.payout"], -SPEED * table.time)
    climbed = table["load.position[3]"].iloc[-1] - table["load.position[3]"].iloc[0]
    assert climbed == pytest.approx(3.0 * SPEED, rel=0.01)


def test_the_summary_says_what_goes_slack_and_breaks():
    time = np.arange(5) * 0.5
    columns = {"time": time, "a.slack_segments": np.array([0, 0, 2, 1, 0]), "a.broken": np.array([0, 0, 0, 0, 1])}
    columns["a.break_time"] = np.array([-1, -1, -1, -1, 1.75])
    slack, broken = flight_table.summary(columns)
    assert slack == "a.slack: a segment at least 40 % of the time, first at 1 s"
    assert broken == "a.broken or let go at 1.75 s"
    assert flight_table.summary(flight_table.since(columns, 1.2))[0].endswith("50 % of the time, first at 1.5 s")


def test_a_small_mean_of_large_values_has_digits():
    """Power of a winch that reels out and in again; without any mean it is 0."""
    assert flight_table.alike(-1.0387, -23396.1, 23396.4) == ["-1.04", "-23396", "23396"]
    assert flight_table.alike(1e-12, -23396.1, 23396.4) == ["0", "-23396", "23396"]
    assert flight_table.alike(2.5, 0.0, 5.0) == ["2.5000", "0.0000", "5.0000"]
