"""What moves by rows of a file: forces against closed forms, starts in motion, landing and letting go, refusals."""

import tomllib
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from running import status_of
from scenes import hanging_load
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files.named import named_scenes, named_systems
from tetherfmu.files.scene_files import load, read
from tetherfmu.study.measuring.runs import Config, run

G, MASS, LENGTH, DIAMETER, DENSITY = 9.81, 200.0, 20.0, 0.01, 1000.0
ROPE = DENSITY * np.pi * DIAMETER**2 / 4.0 * LENGTH
HANGING = hanging_load("tip", 50, MASS, initial_length=LENGTH, diameter=DIAMETER, density=DENSITY, segments=6)
BRIDLE = """
[points.drone]
position = [0, 0, 60]
[points.knot]
mass = "1 kg"
[points.left]
mass = "7 kg"
[points.right]
mass = "7 kg"
[lines.main]
from = "drone"
to = "knot"
initial_length = "20 m"
segments = 4
[lines.a]
from = "knot"
to = "left"
initial_length = "5 m"
segments = 2
[lines.b]
from = "knot"
to = "right"
initial_length = "6 m"
segments = 2
"""


@pytest.fixture
def flown(tmp_path):
    """Function of the text of a file of a system, and of options: the table that `fly` writes."""

    def fly(text, *options):
        file, table = tmp_path / "system.toml", tmp_path / "table.csv"
        file.write_text(text, encoding="utf-8")
        assert tetherfmu(["fly", str(file), "--csv", str(table), "--out", str(tmp_path), *options]) == 0
        return pd.read_csv(table)

    return fly


def mean(table, name, begin, end):
    """Mean of a column from a time to another one [s]."""
    return table[name][(table.time >= begin) & (table.time <= end)].mean()


def test_a_load_weighs_more_while_it_is_accelerated(flown):
    """By its driven point along rows of a velocity: (m + rope) (g + a), then the same with the weight alone."""
    table = flown(HANGING + "[series]\ntip.velocity = [[0, [0, 0, 0]], [4, [0, 0, 3]], [8, [0, 0, 3]]]\n")
    assert table.time.iloc[-1] == 8.0  # the last row
    whole = MASS + ROPE
    assert mean(table, "rope.tension_from", 1.0, 3.9) == pytest.approx(whole * (G + 0.75), rel=0.005)
    assert mean(table, "rope.tension_from", 5.0, 8.0) == pytest.approx(whole * G, rel=0.005)
    assert table["tip.position[3]"].to_numpy() == pytest.approx(50.0 + height(table.time.to_numpy()), abs=2e-4)  # a h^2/2


def height(time):
    """Integral of the rows."""
    return np.where(time < 4.0, 0.375 * time**2, 6.0 + 3.0 * (time - 4.0))


def test_a_load_is_a_force(flown):
    """Half of the weight of the load is taken off in a ramp."""
    lift = 0.5 * MASS * G
    table = flown(f"{HANGING}[series]\nload.load = [[0, [0, 0, 0]], [5, [0, 0, {lift}]]]\n")
    assert table["rope.tension_from"].iloc[0] == pytest.approx((MASS + ROPE) * G, rel=1e-3)
    assert table["rope.tension_from"].iloc[-1] == pytest.approx((MASS + ROPE) * G - lift, rel=0.005)


@pytest.mark.parametrize("motion", ["drone.velocity = [0, 0, -2]", "main.reel_out_speed = 2.0"])
def test_what_starts_in_motion_is_not_jerked(flown, motion):
    """A drone that sinks with a bridle, and one that pays it out, pull with its weight from the start on."""
    table = flown(f"duration = 2.0\n[series]\n{motion}\n{BRIDLE}")
    force = table["main.tension_from"]
    still = flown(f"duration = 0.5\n{BRIDLE}")["main.tension_from"][0]
    assert np.abs(force / still - 1.0).max() < 0.005
    assert table["left.velocity[3]"].iloc[0] == pytest.approx(-2.0, abs=0.01)


def test_a_drum_by_force_starts_with_what_it_holds(flown):
    """Its point rises at 2 m/s and the load stands on the ground of another rope: the drum turns from the start on."""
    winch = "winch_control = 'force'\nwinch_mass = 50.0\nwinch_start = 'equilibrium'\n"
    rows = "[series]\ntip.velocity = [0, 0, 2]\nrope.winch_force = [[0, 3000.0], [2, 3000.0]]\n"
    fixed = HANGING.replace(f"mass = {MASS}", "position = [0, 0, 30]").replace("segments = 6\n", f"segments = 6\n{winch}")
    table = flown(fixed + rows)
    assert np.abs(table["rope.tension_from"] / 3000.0 - 1.0).max() < 0.01
    assert table["rope.winch_speed"].to_numpy() == pytest.approx(2.0, rel=0.01)


def test_a_drum_of_a_scene_does_too():
    """A kite that flies away at 3 m/s from a drum of 100 kg that holds 3 kN: it is no more than that."""
    scene = named_scenes()["eight_on_a_winch"]
    table = tomllib.loads(scene.read_text(encoding="utf-8"))
    table |= {"duration": 4.0, "winch": {"force": 3000.0, "mass": 100.0}, "flight": {"kind": "parked", "sway": 0.0}}
    table["series"] = {"kite_velocity": [1.5, 0.0, 2.598]}
    made = read(table, scene.parent, "drum")
    flown = run(replace(made, every=0.02), Config("dynamic", 6, 1e-4, 0.02)).flown
    assert np.abs(flown.of("ground_tension") / 3000.0 - 1.0).max() < 0.02
    assert flown.of("winch_speed").mean() == pytest.approx(3.0, rel=0.01)


def test_a_crane_slews_lands_and_lets_go(tmp_path):
    """One file, one command: the load stands where it landed; after it is let go, the hook hangs alone."""
    table = tmp_path / "table.csv"
    assert tetherfmu(["fly", str(named_systems()["landing_hook"]), "--csv", str(table), "--out", str(tmp_path)]) == 0
    found = pd.read_csv(table)
    last, time = found.iloc[-1], found.time
    assert np.hypot(last["tip.position[1]"], last["tip.position[2]"]) == pytest.approx(25.01, abs=0.01)
    assert last["tip.position[1]"] == pytest.approx(0.0, abs=1e-6)
    assert last["hoist.payout"] == pytest.approx(11.6, abs=1e-6)  # area below the rows
    assert last["sling.broken"] == 1
    assert last["sling.break_time"] == pytest.approx(50.0)
    assert found["load.position[3]"][0] > 10.0
    landed = found[time > 52.0]
    for i in (1, 2, 3):
        assert np.ptp(landed[f"load.position[{i}]"]) < 1e-3
    steel = found["hoist.tension_from"][0] - found["hoist.tension_to"][0]  # the weight of the rope, 25 m of it
    hook = 100.0 * G + steel * (25.0 + 11.6) / 25.0
    assert mean(found, "hoist.tension_from", 55.0, 60.0) == pytest.approx(hook, rel=0.05)


def test_a_scene_is_driven_as_a_system_is():
    """The payout of the crane is the area below the rows, its load lands, and is let go."""
    scene = load("landing_crane")
    flown = run(replace(scene, every=0.02), Config("dynamic", 8, 1e-4, 0.02)).flown
    assert flown.of("tether_length")[-1] == pytest.approx(40.0 + 20.25, abs=1e-6)
    assert flown.of("break_time")[-1] == pytest.approx(50.0)
    assert flown.of("kite_tension")[-1] == 0.0


@pytest.mark.parametrize("asked", ["advise landing_crane", "tradeoff landing_crane", "advise landing_hook"])
def test_no_advice_for_a_tether_that_is_let_go(asked, tmp_path, monkeypatch, capsys):
    """A tether that recoils has no error that converges."""
    monkeypatch.chdir(tmp_path)
    assert status_of(*asked.split()) == 2
    assert "series.release is for fly and sweep only" in capsys.readouterr().err


def test_a_distance_alone_keeps_the_direction_of_the_flight():
    """Of figures of eight: as far away as the rows say, in the same direction, with the velocity of that path."""
    scene = named_scenes()["eight_on_a_winch"]
    table = tomllib.loads(scene.read_text(encoding="utf-8"))
    flown = read(table | {"series": {"distance": [[0, 300.0], [30, 420.0]]}}, scene.parent, "eight").flight
    time, near = np.linspace(0.0, 40.0, 81), 1e-4
    kite, before = flown.motion(time).kite, read(table, scene.parent, "eight").flight.motion(time).kite
    far = np.linalg.norm(kite, axis=1)
    assert far[[0, -1]] == pytest.approx([300.0, 420.0])
    assert kite / far[:, None] == pytest.approx(before / 400.0, abs=1e-12)
    slope = (flown.motion(time + near).kite - flown.motion(time - near).kite) / (2.0 * near)
    assert flown.motion(time).kite_velocity[1:] == pytest.approx(slope[1:], abs=1e-3)
