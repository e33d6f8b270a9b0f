"""`tetherfmu fly SCENE`: an FMU flies the scene as the Python API does, bit for bit; what cannot be flown is named."""

import re

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn, run_code, run_python
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files.named import named_scenes, named_systems
from tetherfmu.libraries.examples import example

SAME = """
import sys
from pathlib import Path
import numpy as np
from first_flight import scene_flight
from tetherfmu.study.measuring.runs import Config, run
folder, *names = sys.argv[1:]
for name in names:
    scene = scene_flight.scene_of(name, [("duration", 0.6)])
    (fmu,) = scene_flight.names_of(scene, "dynamic") or ["TetherDynamic"]
    flown = scene_flight.fly(scene_flight.fmu_of(fmu, Path(folder), scene.wind_points), scene)
    right = run(scene, Config("dynamic", 20, 1e-4, 0.02)).flown
    assert np.array_equal(flown.kite_force[1:], right.kite_force), name
    assert np.array_equal(flown.ground_force[1:], right.ground_force), name
    assert np.linalg.norm(right.ground_force, axis=1).min() > 5.0, name
"""


def test_the_forces_are_those_of_python(fmu_folder):
    """A winch that holds a force, a load, a ground, a log."""
    done = run_code(SAME, fmu_folder, "eight_on_a_winch", "slewing_crane", "landing", "logged")
    assert done.returncode == 0, done.stderr


def test_an_fmu_of_the_scene_has_what_it_lacks_built_in(tmp_path):
    """`build --scene` leaves out what is 0, as the position of the ground station is; another constant is refused."""
    scene, fly = EXAMPLES / "first_flight" / "eight_on_a_winch.toml", ("fly", "eight_on_a_winch", "--duration", 2, "--fmu")
    assert tetherfmu(["build", "--scene", str(scene), "--out", str(tmp_path)]) == 0
    (fmu,) = tmp_path.glob("*.fmu")
    done = run_python("-m", "tetherfmu", *fly, fmu, "--out", tmp_path / "plots")
    assert done.returncode == 0, done.stderr
    assert "no variable" not in done.stderr
    assert re.match(rf"{fmu.stem}: \|ground\| 3\d\d\d\.\d N, ", done.stdout)
    inputs = "kite_position,kite_velocity,wind_velocity,reel_out_speed"
    rope = "initial_length,diameter,wind_profile,winch_mass"
    lean = ("--preset", "kite", "--inputs", inputs, "--parameters", rope, "--set", "winch_control=force")
    whole = (*lean, "--set", "winch_force=3000", "--set", "winch_start=equilibrium", "--set", "gravity=1.6")
    for chosen, words in (
        (lean, "has winch_force = 0 and no variable for it; it is 3000 in this scene"),
        (whole, "has gravity = 1.6 and no variable for it; it is 9.81"),
    ):
        assert tetherfmu(["build", "dynamic", *chosen, "--out", str(tmp_path / "lean")]) == 0
        done = run_python("-m", "tetherfmu", *fly, tmp_path / "lean" / "TetherDynamic.fmu", "--out", tmp_path / "plots")
        assert done.returncode == 2
        assert words in done.stderr


def test_turbulence_is_that_of_python(tmp_path):
    """Its FMU has wind points; it is built."""
    done = run_code(SAME, tmp_path, "parked_in_turbulence")
    assert done.returncode == 0, done.stderr


def test_prints_and_draws_as_the_circle_does(fmu_folder, tmp_path):
    changed = ("--set", "winch.force=5 kN", "--set", "segments=6", "--duration", 0.6)
    options = (*changed, "--fmus", fmu_folder, "--out", tmp_path)
    done = run_python("-m", "tetherfmu", "fly", "eight_on_a_winch", *options)
    assert done.returncode == 0, done.stderr
    first, *_ = done.stdout.splitlines()
    paths = done.stdout.splitlines()[-3:]
    found = re.match(r"TetherDynamic: \|ground\| (\d+\.\d) N, \|kite\| (\d+\.\d) N at most; 30 steps; ", first)
    assert [float(each) for each in found.groups()] == pytest.approx([5000.0, 5000.0], rel=0.01)
    assert paths == [str(tmp_path / f"{name}.png") for name in ("first_shape", "forces", "shapes")]
    for path in paths:
        assert_is_drawn(tmp_path / path)


def test_a_system_is_flown_from_its_file(tmp_path, capsys):
    """The load of the hoist hangs at rest: both ropes carry half of it, and no winch turns but that which is set."""
    asked = ["fly", "hoist", "--duration", "0.6", "--out", str(tmp_path)]
    assert tetherfmu(asked) == 0
    left, right, beam, last, *_, shapes, of_forces = capsys.readouterr().out.splitlines()
    vertical = 400.0 * 9.81 / 2.0
    forces = [float(re.search(r"\|winch_\w+\| ([\d.]+) N, ", line)[1]) for line in (left, right)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-3)
    assert vertical < forces[0] < 1.1 * vertical  # the ropes lean, and have weight
    assert left.startswith("rope_left: |winch_left| ")
    assert beam.startswith("beam: |left| ")
    assert last.startswith("Hoist: 30 steps; ")
    for path in (shapes, of_forces):
        assert_is_drawn(path)


def test_a_system_moves_as_its_file_says():
    """A driven point goes straight on with its velocity, and a line is paid out at its speed."""
    flight = example("first_flight.system_flight")
    settings = [("points.winch_left.velocity", [0.0, 0.5, 0.0]), ("lines.rope_right.reel_out_speed", 1.0)]
    what, system = flight.read(named_systems()["hoist"], settings)
    flights, places, _ = flight.fly(what, system, duration=0.6)
    assert places["winch_left"][-1] == pytest.approx([-6.0, 0.3, 30.0])
    assert np.all(places["winch_right"] == places["winch_right"][0])
    assert places["right"][0, 2] - places["right"][-1, 2] > 0.3
    assert np.array_equal(flights["rope_left"].shape[:, 0], places["winch_left"])
    assert np.allclose(flights["rope_left"].shape[:, -1], flights["beam"].shape[:, 0], rtol=0, atol=1e-9)


def test_what_is_set_of_the_flight_of_a_system_has_an_effect():
    """Wind, duration and step as by the options, and loads."""
    flight, path = example("first_flight.system_flight"), named_systems()["hoist"]
    settings = [("wind.velocity", [30.0, 0.0, 0.0]), ("duration", 0.6), ("wanted.communication_step", 0.03)]
    flights, places, _ = flight.fly(*flight.read(path, settings))
    assert flights["beam"].time[-1] == pytest.approx(0.6)
    right, *_ = flight.fly(*flight.read(path), (30.0, 0.0, 0.0), 0.6, 0.03)
    calm, *_ = flight.fly(*flight.read(path), duration=0.6, step=0.03)
    for name, each in flights.items():
        assert np.array_equal(each.ground_force, right[name].ground_force)
        assert not np.array_equal(each.ground_force, calm[name].ground_force)
    _, pushed, _ = flight.fly(*flight.read(path, [*settings, ("loads.left", [0.0, 500.0, 0.0])]))
    assert pushed["left"][-1, 1] > places["left"][-1, 1] + 0.01


def test_the_list_has_the_scenes(capsys):
    assert tetherfmu(["fly", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("eight_on_a_winch ") and "winch holds 3 kN; 40 s" in line for line in lines)
    assert any(line.startswith("slewing_crane ") for line in lines)
    assert any(line.startswith("hoist ") and "a system" in line for line in lines)
    assert len(lines) == len([*EXAMPLES.glob("*/*.toml")])


def test_the_page_shows_a_plane_flight_to_scale():
    """Its axes are as long as what they show, and rounding errors across it are none."""
    page = example("shared.flight_page")
    points = np.array([[-6.0, 1e-15, 10.0], [6.0, -1e-14, 30.0]])
    axes = page.scene(points)
    ratio, lengths = axes["aspectratio"], {name: np.ptp(axes[f"{name}axis"]["range"]) for name in "xyz"}
    assert [ratio[name] / lengths[name] for name in "xyz"] == pytest.approx([ratio["x"] / lengths["x"]] * 3)
    assert np.all(page.line(points, "", "lines", "black").y == 0.0)
    _, head = page.arrow(points[0], points[1], 0.1, "black")
    assert np.all(np.array([head.y, head.v]) == 0.0)


@pytest.mark.parametrize("name", [*named_scenes(), *named_systems()])
def test_an_included_flight_warns_of_nothing(name, tmp_path, capfd, monkeypatch):
    """Those of `tetherfmu fly --list`: their ropes do not push, hang through or tear."""
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda *given, **options: None)
    assert tetherfmu(["fly", name, "--out", str(tmp_path)]) == 0
    said = capfd.readouterr().err
    assert "cannot" not in said
    assert "check" not in said
    assert "ground_height" not in said
