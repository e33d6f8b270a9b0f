"""The three tasks of the manual: their commands print what the pages say, and that agrees with another calculation."""

import re
import shlex
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from manual import ROOT, codes, page
from native.programs import available
from tetherfmu import TetherDynamicFree
from tetherfmu.__main__ import main as tetherfmu

G = 9.81


def block(text, language, part=""):
    """The first block of a language that contains a text."""
    return next(code for code in codes(text, language) if part in code)


def commands(text):
    """Arguments of the commands `tetherfmu` of a page."""
    return [shlex.split(line)[1:] for line in "".join(codes(text, "bash")).splitlines() if line.startswith("tetherfmu")]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_mean_power_of_a_pumping_eight(here, fmu_folder, capfd):
    """P T = sum of (F v + c v^2) h: the tether turns a drum against its force and its damping; inertia gives all back."""
    (here / "dist").symlink_to(fmu_folder, target_is_directory=True)
    text = page("use/task_pumping")
    (here / "pumping.toml").write_text(block(text, "toml"), encoding="utf-8")
    fly, compare, sweep = commands(text)
    assert tetherfmu(fly) == 0
    table = pd.read_csv("pumping.csv")
    force = np.interp(table["time"], [0, 29, 31, 44, 45], [4000, 4000, 1500, 1500, 4000])
    expected = np.mean(force * table["winch_speed"] + 50.0 * table["winch_speed"] ** 2)
    assert table["power"].mean() == pytest.approx(expected, rel=0.005)
    assert tetherfmu([*compare, "--csv", "all.csv"]) == 0
    found = pd.read_csv("all.csv")
    for name, power in re.findall(r"^\| `(Tether\w+)` \| (\d+) W \|$", text, re.MULTILINE):
        assert f"{found[f'{name}.power'].mean():.0f}" == power
    assert f"has the mean, {table['power'].mean():.0f} W" in text.replace("\n", " ")
    assert tetherfmu([*sweep, "--processes", "1", "--segments", "5"]) == 0
    assert pd.read_csv("forces/flights.csv")["power_mean"].is_monotonic_increasing
    capfd.readouterr()


HOME, MASS, SPRING, DAMPER, DRAG = np.array([0.0, 0.0, 60.0]), 6.0, 20.0, 22.0, 0.5 * 1.225 * 0.15


def drone_as_the_end_of_its_tether(step, duration):
    """Positions of the drone [m] and forces of the tether [N], by `TetherDynamicFree` in short steps: no iteration."""
    tether = TetherDynamicFree(segments=10, initial_length=61.0, kite_mass=MASS)
    found, rows = tether.initialize(kite_position=HOME, wind_velocity=(4.0, 0.0, 0.0)), []
    for k in range(round(duration / step)):
        wind = np.array([4.0 if step * k < 5.0 - 1e-9 else 12.0, 0.0, 0.0])
        air = wind - found.kite_velocity
        load = SPRING * (HOME - found.kite_position) - DAMPER * found.kite_velocity + DRAG * np.linalg.norm(air) * air
        found = tether.step(step, kite_load=load + np.array([0.0, 0.0, MASS * G]), wind_velocity=wind)
        rows.append((*found.kite_position, np.linalg.norm(found.kite_force)))
    return np.array(rows)


@pytest.mark.skipif(not available(), reason="needs gcc on 64-bit Linux")
def test_a_tethered_drone_in_c(here):
    """As the drone as the end of its tether; what is printed is on the page."""
    text = page("use/task_drone_in_c")
    (here / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    tetherfmu(commands(text)[0])
    for line in "".join(codes(text, "bash")).splitlines():
        if line.startswith("python"):
            subprocess.run([sys.executable, *shlex.split(line)[1:]], check=True)
    strict = f"{shutil.which('gcc')} -Wall -Wextra -Wconversion -Wshadow -Werror"
    script = block(text, "bash", "cc ").replace("cc examples", f"{strict} examples").replace("python ", f"{sys.executable} ")
    done = subprocess.run(["bash", "-euc", script], capture_output=True, text=True, check=True)
    assert done.stdout == block(text, "text")
    rows = [[float(each) for each in re.findall(r"-?\d+\.\d+", line)] for line in done.stdout.splitlines()[:-1]]
    step, expected = 0.002, drone_as_the_end_of_its_tether(0.002, 20.0)
    for k, (x, z, force) in enumerate(rows, 1):
        place = expected[round(4.0 * k / step) - 1]
        assert (x, z) == pytest.approx(place[[0, 2]], abs=2e-3)
        assert force == pytest.approx(place[3], abs=0.05)
    farthest = np.linalg.norm(expected[:, :3] - HOME, axis=1).max()
    assert float(re.search(r"farthest (\S+) m", done.stdout)[1]) == pytest.approx(farthest, rel=0.01)


def test_a_hoist_of_four_falls(here, capfd):
    """At rest each fall carries a quarter of the weight; the block sinks by a quarter of the rope, and falls with g."""
    text = page("use/task_hoist")
    (here / "hoist.toml").write_text(block(text, "toml"), encoding="utf-8")
    fly, slower, breaking, *_ = commands(text)
    assert tetherfmu(fly) == 0
    said, expected = capfd.readouterr(), block(text, "text").splitlines()
    numbers = [line for line in expected if "times real time" not in line]
    assert [line for line in said.out.splitlines() if line in numbers] == numbers
    assert not said.err
    table = pd.read_csv("hoist.csv")
    weight = (2000.0 + 80.0 * 5080.0 * np.pi * 0.012**2 / 4.0) * G
    assert table["rope.tension_from"][0] == pytest.approx(weight / 4.0, rel=0.01)
    down = table[(table["time"] > 20.0) & (table["time"] < 40.0)]
    sunk, paid = (np.ptp(down[name]) for name in ("block.position[3]", "rope.payout"))
    assert sunk == pytest.approx(paid / 4.0, rel=0.02)
    landed = table[table["time"] > 50.0]
    assert landed["block.position[3]"].abs().max() < 0.01
    assert np.ptp(landed["block.position[1]"]) < 1e-3
    assert tetherfmu([*slower, "--csv", "slower.csv"]) == 0
    assert pd.read_csv("slower.csv")["block.position[3]"].min() > 0.5
    capfd.readouterr()
    assert tetherfmu([*breaking, "--csv", "broken.csv"]) == 0
    broke = "rope[4]: segment 2, counted from the winch, broke 17.0785 s after the start under 5300 N"
    assert broke in capfd.readouterr().err
    table = pd.read_csv("broken.csv")
    falls = table[(table["time"] > 17.2) & (table["time"] < 17.9)]  # the rope that runs off holds it back a little
    gained = np.polyfit(falls["time"], falls["block.velocity[3]"], 1)[0]
    assert -G < gained < -0.8 * G
