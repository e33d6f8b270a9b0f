"""The kite in C of the examples: forces of the Python API, equal bits loaded and linked, refused and late steps.

For Windows it is only compiled: nothing here runs its programs.
"""

import re
import resource
import shutil
import subprocess
import sys
import zipfile
from math import atan2, cos, pi, remainder, sin

import numpy as np
import pytest

from fmus.aerodynamics import Wing, angle_of, dot, load, norm, rightward, turn_rate, turned, unit
from manual import page
from native.programs import available
from running import EXAMPLES
from tetherfmu import TetherDynamicFree
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native.host_header import PREFIX
from tetherfmu.export.native.native_fmus import build
from tetherfmu.libraries.linking import TARGETS

SOURCE = EXAMPLES / "hosts" / "closed_loop"
NAME, STEP, DURATION, ROUNDING = "TetherDynamicFree", 0.005, 10, 0.0501  # -, s, s, printed with one digit
ELEVATION, RADIUS, LOOK_AHEAD, GAIN, SLOWEST = 0.5, 0.35, 0.5, 1.5, 3.0  # of kite.c
WIND, FILES = (9.0, 0.0, 0.0), ("closed_loop.c", "kite.c", "platform.c")
WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")

pytestmark = pytest.mark.skipif(
    not available() or shutil.which("cmake") is None, reason="needs gcc on 64-bit Linux, and cmake"
)


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    """Folder with the FMU, extracted, and its header."""
    folder = tmp_path_factory.mktemp("closed_loop")
    path = build(NAME, folder, fmi=3, with_header=PREFIX, with_sources=True)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder / NAME)
    return folder


def built(folder, native, *options, source=SOURCE):
    """Path of the program that cmake makes in a folder, all warnings being errors."""
    given = (f"-DNATIVE={native}", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-Werror", *options)
    for command in (["cmake", "-S", source, "-B", folder, *given], ["cmake", "--build", folder]):
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder / "closed_loop"


@pytest.fixture(scope="module")
def program(native):
    """Path of the program that loads the FMU."""
    return built(native / "loaded", native)


def run(program, *options, status=0):
    """What a program prints, and its messages."""
    done = subprocess.run([*map(str, (program, *options))], capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    return done.stdout, done.stderr


def rows(printed):
    """Second, height, speed, force on the kite and tension at the ground, a row for each line."""
    lines = [line for line in printed.splitlines() if " s  height " in line]
    return np.array([[float(number) for number in re.findall(r"[\d.]+", line)] for line in lines])


def checksum(printed):
    return re.search(r"^checksum .* ([0-9a-f]{16})$", printed, re.MULTILINE)[1]


class Air(Wing):
    """The wing of the example FMUs in uniform air."""

    air_density, air_density_scale_height = 1.225, 0.0


def on_circle(angle):
    """Direction to a point of the circle."""
    along, right, up = cos(RADIUS), sin(RADIUS) * cos(angle), sin(RADIUS) * sin(angle)
    return along * cos(ELEVATION) - up * sin(ELEVATION), -right, along * sin(ELEVATION) + up * cos(ELEVATION)


def ahead(r):
    return on_circle(atan2(r[2] * cos(ELEVATION) - r[0] * sin(ELEVATION), -r[1]) + LOOK_AHEAD)


def flown_in_python(seconds):
    """The rows of the same flight, with the kite of the example FMUs."""
    position, wing = tuple(200.8 * each for each in on_circle(0.0)), Air()
    r, target = unit(position), ahead(unit(position))
    heading = unit([a - dot(target, r) * b for a, b in zip(target, r, strict=True)])
    tether = TetherDynamicFree(initial_length=200.0, segments=10, kite_mass=19.6, fixed_step=STEP)
    velocity, found = [20.0 * each for each in heading], []
    tether.initialize(position, velocity, wind_velocity=WIND)
    for k in range(1, round(seconds / STEP) + 1):
        r, felt = unit(position), [w - v for w, v in zip(WIND, velocity, strict=True)]
        speed = max(norm(felt), SLOWEST)
        error = remainder(angle_of(ahead(r), r) - angle_of(heading, r), 2.0 * pi)
        by_weight = wing.turning_by_weight / speed * rightward(heading, r)
        steering = min(max((GAIN * error - by_weight) / (wing.turning * speed), -1.0), 1.0)
        outputs = tether.step(STEP, load(position, heading, felt, steering, 0.0, wing))
        position, velocity = outputs.kite_position.tolist(), outputs.kite_velocity.tolist()
        heading = turned(heading, unit(position), STEP * turn_rate(r, heading, felt, steering, wing))
        if k % round(1.0 / STEP) == 0:
            found.append((STEP * k, position[2], norm(velocity), norm(outputs.kite_force), outputs.ground_tension))
    return found


def test_forces_are_those_of_the_python_api(program, native):
    """With the kite of the example FMUs; the page shows the first and the last lines of a minute."""
    printed, _ = run(program, native / NAME, "--fast")
    np.testing.assert_allclose(rows(printed)[:DURATION], flown_in_python(DURATION), rtol=0.0, atol=ROUNDING)
    shown = rows(page("use/importing"))
    assert len(shown) >= 3
    np.testing.assert_allclose(shown, rows(printed)[shown[:, 0].astype(int) - 1], rtol=0.0, atol=2.0 * ROUNDING)
    assert "12000 steps of 5 ms, 0 refused and repeated" in printed


def test_linked_equals_loaded_to_the_bit(program, native):
    """The checksum is of the force after each step. The linked program loads nothing."""
    linked, options = built(native / "linked", native, "-DLINKED=ON"), ("--fast", "--duration", DURATION)
    assert run(linked, *options) == run(program, native / NAME, *options)
    assert b"dlopen" not in linked.read_bytes()


def test_a_refused_step_is_repeated(program, native):
    """With the load of the step before; the flight goes on, and 5 ms of an older load change the forces little."""
    printed, said = run(program, native / NAME, "--fast", "--duration", DURATION, "--refuse", 2)
    (sentence,) = said.splitlines()
    undisturbed, _ = run(program, native / NAME, "--fast", "--duration", DURATION)
    assert "fmi3DoStep: the step from 2.0 s is refused: the input kite_load[1] is nan" in sentence
    assert "2000 steps of 5 ms, 1 refused and repeated" in printed
    np.testing.assert_allclose(rows(printed), rows(undisturbed), rtol=1e-3, atol=ROUNDING)
    assert checksum(printed) != checksum(undisturbed)


def test_without_the_rollback_the_load_is_refused_again(native, tmp_path):
    source = changed(tmp_path, "check(fmu.SetFMUState(tether, *before));", "")
    program = built(tmp_path / "build", native, source=source)
    _, said = run(program, native / NAME, "--fast", "--refuse", 2, status=1)
    assert said.count("is refused") == 2
    assert said.endswith("closed_loop: the FMU refused a call; its message says why\n")


def changed(folder, old, new):
    """A copy of the example with another text in its main file."""
    copy = shutil.copytree(SOURCE, folder / "changed")
    text = (SOURCE / "closed_loop.c").read_text("utf-8")
    assert old in text
    (copy / "closed_loop.c").write_text(text.replace(old, new))
    return copy


def test_late_steps_are_counted(native, tmp_path):
    """A flight that began a minute ago is late in every step, and sleeps in none; its numbers are those of any other."""
    program = built(tmp_path / "build", native, source=changed(tmp_path, "began = now()", "began = now() - 60.0"))
    printed, _ = run(program, native / NAME, "--duration", 1)
    assert "200 late steps, the latest by " in printed
    assert checksum(printed) == checksum(run(program, native / NAME, "--duration", 1, "--fast")[0])


def test_in_real_time_it_waits_in_each_step(program, native):
    """Each step that is not late gives the processor back, which the system counts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_nvcsw
    printed, _ = run(program, native / NAME, "--duration", 1)
    (late,) = re.findall(r"^(\d+) late steps, the latest by \d+\.\d{3} ms$", printed, re.MULTILINE)
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_nvcsw - before >= 200 - int(late)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ((), "give the folder of an extracted TetherDynamicFree.fmu"),
        (("nowhere",), "nowhere/binaries/x86_64-linux/TetherDynamicFree.so cannot be loaded"),
        (("nowhere", "--refuse", "soon"), "a time is from 0 to 1e6 s"),
        (("nowhere", "--slow"), "options: --duration S, --fast, --refuse S"),
    ],
)
def test_what_is_wrong_is_one_line(program, options, sentence):
    assert run(program, *options, status=1) == ("", f"closed_loop: {sentence}\n")


def test_an_fmu_of_another_build_is_refused(program, tmp_path):
    """The header belongs to one build: the token tells, and the FMU says so."""
    path = build(NAME, tmp_path, BuildOptions(shape_points=5), fmi=3)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / NAME)
    _, said = run(program, tmp_path / NAME, status=1)
    assert "the guid or token is {" in said
    assert said.endswith("closed_loop: the FMU gives no instance\n")


@pytest.mark.parametrize("options", [(), ("-DLINKED",)])
def test_it_compiles_for_windows(native, tmp_path, options):
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", TARGETS["x86_64-windows"], *WARNINGS, *options, "-c"]
    places = (f"-I{native}", "-isystem", native / NAME / "sources")
    for file in FILES:
        command = [*zig, *places, SOURCE / file, "-o", tmp_path / f"{file}.obj"]
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
