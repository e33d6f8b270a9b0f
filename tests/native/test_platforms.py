"""Native FMUs for all platforms from one build: what is in them, what their libraries need, and that Windows runs them."""

import shutil
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

from isolation import own_process
from libraries.test_symbols import dynamic_symbols
from runtime.host import Host
from scenes import circle, kite_inputs
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native import native_fmus as native
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.libraries.linking import MATHEMATICS

LARGEST = 2_000_000  # bytes of an FMU
STEPS, STEP = 100, 0.02
SAME = 1e-12  # as in export/test_windows.py: the mathematical libraries differ in the last bit
C_LIBRARY = {"calloc", "free", "memcpy", "memset", "memcmp", "bcmp", "strchr", "strcmp", "strcspn", "strlen", "strncmp"}
C_LIBRARY |= {"strtod", "strtol", "vsnprintf", "fputs", "stderr", "floor", *MATHEMATICS}
UNIVERSAL, PROCESSORS = 0xCAFEBABE, {0x01000007, 0x0100000C}  # Apple's mach-o/fat.h and mach/machine.h
NAME = "TetherDynamicFree"

pytestmark = pytest.mark.release


@pytest.fixture(scope="module")
def everywhere(built_once):
    """Folder with a native FMU for FMI 2 and all platforms."""

    def build(folder):
        native.build(NAME, folder, BuildOptions(platforms=tuple(TARGETS)))

    return built_once("native_everywhere", build)


def binaries(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name.startswith("binaries/")}


def test_a_library_for_each_platform(everywhere):
    path = everywhere / f"{NAME}.fmu"
    places = ("aarch64-linux/{}.so", "darwin64/{}.dylib", "linux64/{}.so", "win64/{}.dll")
    assert list(binaries(path)) == [f"binaries/{place.format(NAME)}" for place in places]
    assert path.stat().st_size < LARGEST


def test_platforms_of_fmi3(tmp_path):
    platforms = ("aarch64-linux", "x86_64-windows")
    path = native.build("TetherStraight", tmp_path, BuildOptions(platforms=platforms), fmi=3)
    assert tuple(place.split("/")[1] for place in binaries(path)) == platforms


def test_one_processor_takes_the_place_of_its_system(tmp_path):
    path = native.build("TetherStraight", tmp_path, BuildOptions(platforms=("aarch64-linux", "aarch64-darwin")))
    assert list(binaries(path)) == ["binaries/darwin64/TetherStraight.dylib", "binaries/linux64/TetherStraight.so"]


def test_the_c_library_is_all_that_linux_needs(everywhere, tmp_path):
    """And all that is offered are functions of FMI."""
    library = tmp_path / "library.so"
    library.write_bytes(binaries(everywhere / f"{NAME}.fmu")[f"binaries/linux64/{NAME}.so"])
    needed, offered = dynamic_symbols(library)
    assert needed <= C_LIBRARY
    assert offered == set(native.functions_of(2))


def test_macos_finds_its_processor(everywhere):
    """A universal library: for both processors, each part where its page begins and as long as the file says."""
    content = binaries(everywhere / f"{NAME}.fmu")[f"binaries/darwin64/{NAME}.dylib"]
    magic, count = struct.unpack_from(">2I", content)
    parts = [struct.unpack_from(">5I", content, 8 + 20 * k) for k in range(count)]
    assert magic == UNIVERSAL
    assert {part[0] for part in parts} == PROCESSORS
    for processor, _, start, size, alignment in parts:
        assert start % 2**alignment == 0
        assert start + size <= len(content)
        assert struct.unpack_from("<2I", content, start) == (0xFEEDFACF, processor)


def test_equal_options_give_equal_bytes(everywhere, tmp_path):
    paths = everywhere / f"{NAME}.fmu", native.build(NAME, tmp_path / "b", BuildOptions(platforms=tuple(TARGETS)))
    assert paths[0].read_bytes() == paths[1].read_bytes()
    other = native.build("TetherStraight", tmp_path / "c", BuildOptions(platforms=("x86_64-linux",), shape_points=7))
    tokens = [read_model_description(str(path)).guid for path in (*paths, other)]
    assert tokens[0] == tokens[1] != tokens[2]


# --- Windows

needs_wine = pytest.mark.skipif(shutil.which("wine") is None, reason="wine is not installed")


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """Folder with the host program."""
    folder, source = tmp_path_factory.mktemp("windows"), str(Path(__file__).parent / "windows_fmi_host.c")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu", "-O1", "-fno-sanitize=all"]
    subprocess.run([*zig, "-fno-stack-protector", "-c", "-o", "host.obj", source], cwd=folder, check=True)
    subprocess.run([*zig, "-nostdlib", "-Wl,-e,start", "-lkernel32", "-o", "host.exe", "host.obj"], cwd=folder, check=True)
    return folder


def flown_here(path, rows):
    """Outputs at the start and after each step, what is said to a step that is refused, references of outputs and inputs."""
    host = Host(path)
    names = list(kite_inputs(host.name, *circle(0.0)))
    host.start(**dict(zip(names, np.reshape(rows[0], (-1, 3)), strict=True)))
    found = [host.all_outputs()]
    for row in rows:
        host.step(STEP, **dict(zip(names, np.reshape(row, (-1, 3)), strict=True)))
        found.append(host.all_outputs())
    host.time = STEPS * STEP  # not the sum of the steps, which is in the message
    host.refuses(lambda: host.fmu.doStep(host.time, -0.1 - 0.2), "-0.30000000000000004 s")
    inputs = [host.reference[f"{each}[{i}]"] for each in names for i in (1, 2, 3)]
    return found, host.messages[-1], host.real_outputs, inputs


@needs_wine
def test_windows_equals_linux(everywhere, native_folder, host):
    path = everywhere / f"{NAME}.fmu"
    (host / "tether.dll").write_bytes(binaries(path)[f"binaries/win64/{NAME}.dll"])
    rows = [np.ravel(list(kite_inputs(NAME, *circle(k * STEP)).values())) for k in range(STEPS)]
    expected, said, outputs, inputs = own_process(flown_here, path=native_folder / f"{NAME}.fmu", rows=rows)
    head = [len(inputs), len(outputs), STEPS, STEP, *inputs, *outputs]
    (host / "in.bin").write_bytes(np.concatenate([head, np.ravel(rows)]).astype("<f8").tobytes())
    token = read_model_description(str(path)).guid
    command = ["wine", "host.exe", "tether.dll", token, "in.bin", "out.bin"]
    done = subprocess.run(command, cwd=host, check=True, capture_output=True, text=True)
    found = np.frombuffer((host / "out.bin").read_bytes()).reshape(STEPS + 1, -1)
    np.testing.assert_allclose(found, expected, rtol=SAME, atol=SAME * np.abs(expected).max())
    assert done.stdout.splitlines()[-1] == f"tether 2 logStatusError {said}"
