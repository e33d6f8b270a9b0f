"""The host in C++ of the examples prints the forces that the Python API computes with the same inputs."""

import re
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from native.programs import available
from tetherfmu import TetherDynamic

SOURCE = Path(__file__).resolve().parents[2] / "examples" / "hosts" / "fly_from_cpp.cpp"
HEADERS = Path(fmpy.__file__).parent / "c-code"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
STEP, COUNT, ROUNDING = 0.02, 1000, 0.5e-3  # s, -, N: three digits are printed

pytestmark = pytest.mark.skipif(not available(), reason="needs gcc on 64-bit Linux")


def compiled(source, tmp_path):
    """Path of the program that the example becomes."""
    command = ["g++", "-std=c++17", *WARNINGS, source, f"-I{HEADERS}", "-ldl", "-o", tmp_path / "fly_from_cpp"]
    subprocess.run([*map(str, command)], check=True)
    return tmp_path / "fly_from_cpp"


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """Path of the compiled example."""
    return compiled(SOURCE, tmp_path_factory.mktemp("fly_from_cpp"))


def motion(time):
    """Inputs of the example: a truck that speeds up to 15 m/s in 10 s, a drone 100 m above it."""
    speed, way = (1.5 * time, 0.75 * time**2) if time < 10.0 else (15.0, 15.0 * (time - 5.0))
    velocity = (speed, 0.0, 0.0)
    return {
        "kite_position": (way, 0.0, 100.0),
        "kite_velocity": velocity,
        "ground_position": (way, 0.0, 0.0),
        "ground_velocity": velocity,
    }


def test_forces_are_those_of_the_python_api(program, fmi3_folder, tmp_path):
    with zipfile.ZipFile(fmi3_folder / "TetherDynamic.fmu") as archive:
        archive.extractall(tmp_path / "TetherDynamic")
    printed = subprocess.run([program, tmp_path / "TetherDynamic"], capture_output=True, text=True, check=True).stdout
    rows = [[float(number) for number in re.findall(r"\d+\.\d+", line)] for line in printed.splitlines()]
    wind = {"wind_profile": "power_law", "wind_reference_height": 10.0, "wind_exponent": 0.14}
    tether = TetherDynamic(initial_length=110.0, **wind)
    tether.initialize(**motion(0.0), wind_velocity=(-6.0, 0.0, 0.0))
    forces = [np.linalg.norm(tether.step(STEP, **motion(STEP * k)).kite_force) for k in range(COUNT)]
    assert [time for time, _ in rows] == [4.0, 8.0, 12.0, 16.0, 20.0]
    assert np.allclose([force for _, force in rows], forces[199::200], rtol=0.0, atol=ROUNDING)


def test_a_folder_without_an_fmu_is_refused_in_one_line(program, tmp_path):
    done = subprocess.run([program, tmp_path], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, "fly_from_cpp: the folder has no modelDescription.xml\n")


def test_a_refused_step_ends_it_with_the_sentence(fmi3_folder, tmp_path):
    """A truck that leaves the allowed inputs, 1e9 in magnitude, after 1 s."""
    source = tmp_path / "too_far.cpp"
    source.write_text(SOURCE.read_text("utf-8").replace("0.75 * time * time", "(time < 1.0 ? 0.75 * time * time : 2e9)"))
    with zipfile.ZipFile(fmi3_folder / "TetherDynamic.fmu") as archive:
        archive.extractall(tmp_path / "TetherDynamic")
    program = compiled(source, tmp_path)
    done = subprocess.run([program, tmp_path / "TetherDynamic"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "fmi3DoStep: the step from 1" in done.stderr
    assert "is refused: " in done.stderr
    assert done.stderr.endswith("fly_from_cpp: the FMU refused a call; its message says why\n")
