"""The host in C of the examples prints the forces that the Python API computes with the same inputs."""

import re
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from native.programs import WARNINGS, available
from tetherfmu import TetherDynamic
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native.fmus import build

ROOT = Path(__file__).resolve().parents[2]
SOURCE, PAGE = ROOT / "examples" / "hosts" / "fly_from_c.c", ROOT / "docs" / "use" / "importing.md"
HEADERS = Path(fmpy.__file__).parent / "c-code"
STEP, SPEED, ROUNDING = 0.02, 5.0, 0.5e-3  # s, m/s, N: three digits are printed

pytestmark = pytest.mark.skipif(not available(), reason="needs gcc on 64-bit Linux")


def compiled(source, tmp_path, native_folder):
    """Path of the program that the example becomes."""
    places = (f"-I{native_folder}", f"-I{HEADERS}")
    command = ["gcc", "-std=c99", *WARNINGS, source, *places, "-ldl", "-o", tmp_path / "fly_from_c"]
    subprocess.run([*map(str, command)], check=True)
    return tmp_path / "fly_from_c"


@pytest.fixture
def program(tmp_path, native_folder):
    """Path of the compiled example."""
    return compiled(SOURCE, tmp_path, native_folder)


def test_forces_are_those_of_the_python_api(program, native_folder, tmp_path):
    with zipfile.ZipFile(native_folder / "TetherDynamic.fmu") as archive:
        archive.extractall(tmp_path / "TetherDynamic")
    printed = subprocess.run([program, tmp_path / "TetherDynamic"], capture_output=True, text=True, check=True).stdout
    rows = [[float(number) for number in re.findall(r"-?\d+\.\d+", line)] for line in printed.splitlines()]
    tether = TetherDynamic()
    tether.initialize((300.0, 0.0, 400.0), (0.0, SPEED, 0.0))
    forces = [
        tether.step(STEP, (300.0, SPEED * STEP * k, 400.0), (0.0, SPEED, 0.0)).kite_force for k in range(round(10.0 / STEP))
    ]
    assert [time for time, *_ in rows] == [2.0, 4.0, 6.0, 8.0, 10.0]
    assert np.allclose([force for _, *force in rows], forces[99::100], rtol=0.0, atol=ROUNDING)
    on_the_page = re.findall(r"^ ?[\d.]+ s: .* N$", PAGE.read_text("utf-8"), re.MULTILINE)
    shown = [[float(number) for number in re.findall(r"-?\d+\.\d+", line)] for line in on_the_page]
    np.testing.assert_allclose(shown, rows, rtol=0.0, atol=2.0 * ROUNDING)


def test_a_refused_step_ends_it_with_the_sentence(native_folder, tmp_path):
    """A kite that leaves the allowed inputs, 1e9 in magnitude, after some steps."""
    source = tmp_path / "too_fast.c"
    source.write_text(SOURCE.read_text("utf-8").replace("speed = 5.0", "speed = 6e8"))
    program = compiled(source, tmp_path, native_folder)
    with zipfile.ZipFile(native_folder / "TetherDynamic.fmu") as archive:
        archive.extractall(tmp_path / "TetherDynamic")
    done = subprocess.run([program, tmp_path / "TetherDynamic"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert re.search(r"fmi2DoStep: the step from .* s is refused: ", done.stderr)
    assert done.stderr.endswith("fly_from_c: the FMU refused a call; its message says why\n")


def test_a_folder_without_an_fmu_is_refused_in_one_line(program, tmp_path):
    done = subprocess.run([program, tmp_path], capture_output=True, text=True, check=False)
    (said,) = done.stderr.splitlines()
    assert done.returncode == 1
    assert said.startswith(f"fly_from_c: {tmp_path}/binaries/linux64/TetherDynamic.so: cannot open")


def test_an_fmu_of_another_build_is_refused(program, tmp_path):
    """The header belongs to one build: the guid tells, and the FMU says so."""
    path = build("TetherDynamic", tmp_path / "other", BuildOptions(shape_points=5))
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "TetherDynamic")
    done = subprocess.run([program, tmp_path / "TetherDynamic"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "the guid or token is {" in done.stderr
    assert done.stderr.endswith("fly_from_c: the FMU gives no instance\n")
