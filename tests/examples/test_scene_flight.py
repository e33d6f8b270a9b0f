"""`tetherfmu fly SCENE`: an FMU flies the scene as the Python API does, bit for bit; what cannot be flown is named."""

import pytest
from running import EXAMPLES, assert_is_drawn, run_code

from tetherfmu.__main__ import main as tetherfmu

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


def test_turbulence_is_that_of_python(tmp_path):
    """Its FMU has wind points; it is built."""
    done = run_code(SAME, tmp_path, "parked_in_turbulence")
    assert done.returncode == 0, done.stderr


def test_prints_and_draws_as_the_circle_does(fmu_folder, tmp_path):
    fly = "import sys; from tetherfmu.commands.fly import main; sys.exit(main(sys.argv[1:]))"
    changed = ("--set", "winch.force=5 kN", "--set", "segments=6", "--duration", 0.6)
    options = (*changed, "--fmus", fmu_folder, "--out", tmp_path)
    done = run_code(fly, "eight_on_a_winch", *options)
    assert done.returncode == 0, done.stderr
    first, *paths = done.stdout.splitlines()
    assert first.startswith("TetherDynamic: |ground| 50")  # 5 kN
    assert "; 30 steps; " in first
    assert paths == [str(tmp_path / f"{name}.png") for name in ("first_shape", "forces", "shapes")]
    for path in paths:
        assert_is_drawn(tmp_path / path)


def test_the_list_has_the_scenes(capsys):
    assert tetherfmu(["fly", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("eight_on_a_winch ") and "winch holds 3 kN; 40 s" in line for line in lines)
    assert any(line.startswith("slewing_crane ") for line in lines)
    assert len(lines) == len([*EXAMPLES.glob("scenes/*.toml")]) + 3


WRONG = {
    "eight_on_a_wimch": "did you mean eight_on_a_winch?",
    "none.toml": "none.toml: cannot be read (No such file or directory)",
    "parked --wind 8 0 0": "--wind is not for a scene: --set 'wind.velocity=[WX, WY, WZ]'",
    "parked --start straight": "--start is not for a scene",
    "parked --set wind.sped=3": "a scene has no wind.sped; did you mean wind.speed?",
    "parked --set segments=0": "--set: segments is 0.0; it must be at least 1",
    "parked --set end_velocities=1": "--set: end_velocities follows from the scene",
    "parked --step 30": "the flight of 24 s is shorter than a communication step of 30 s",
    "slewing_crane --tether straight": "the free end of slewing_crane is moved by TetherDynamicFree only",
    "logged --duration 30": "duration is 30.0; it must be at most 20 s",
}


@pytest.mark.parametrize("options", WRONG)
def test_wrong_use_is_named_in_one_line(options, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    try:
        status = tetherfmu(["fly", *options.split()])
    except SystemExit as end:
        status = end.code
    assert status == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert WRONG[options] in line
