"""The Windows libraries give the numbers of Linux: run under wine, where that is installed."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, circle
from tetherfmu.libraries import ready
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import file_name
from tetherfmu.runtime.packing import pack_records
from tetherfmu.runtime.parameters import Environment, Solver
from tetherfmu.runtime.variants import VARIANTS

STEPS, STEP, POINTS = 100, 0.02, 5
# the mathematical libraries differ in the last bit of log1p, asinh, ...; a step of the solver does not amplify that
SAME = 1e-12

pytestmark = pytest.mark.skipif(shutil.which("wine") is None, reason="wine is not installed")


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """The host program and the libraries, in one folder."""
    folder = tmp_path_factory.mktemp("windows")
    for variant, compiled in ready.folders(VARIANTS, ["x86_64-windows"]).items():
        shutil.copy(compiled / file_name(variant, "x86_64-windows"), folder)
    source = str(Path(__file__).parent / "windows_host.c")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu", "-O1", "-fno-sanitize=all"]
    subprocess.run([*zig, "-fno-stack-protector", "-c", "-o", "host.obj", source], cwd=folder, check=True)
    subprocess.run([*zig, "-nostdlib", "-Wl,-e,start", "-lkernel32", "-o", "host.exe", "host.obj"], cwd=folder, check=True)
    return folder


@pytest.mark.parametrize("variant", VARIANTS)
def test_windows_equals_linux(host, variant):
    n, parameters = pack_records(ready.kernels(variant), (CIRCLE_TETHER,), Environment(), Solver())
    parameters = np.array(parameters)
    rows = np.zeros((STEPS + 1, at.INPUTS))
    for k in range(STEPS + 1):  # row 0 initializes, row k + 1 starts step k
        rows[k, :3], rows[k, 3:6] = circle(max(0, k - 1) * STEP)
    linux = ready.kernels(variant)
    state, before, work = np.zeros(at.state_size(n)), np.zeros(at.state_size(n)), np.zeros(linux.work_size(n))
    outputs = np.zeros(at.outputs_size(POINTS))
    head = [n, len(parameters), len(state), len(work), len(outputs), STEPS, STEP, POINTS]
    (host / "in.bin").write_bytes(np.concatenate([head, parameters, rows.ravel()]).astype("<f8").tobytes())
    library = file_name(variant, "x86_64-windows")
    subprocess.run(["wine", "host.exe", library, variant, "in.bin", "out.bin"], cwd=host, check=True, capture_output=True)
    found = np.frombuffer((host / "out.bin").read_bytes()).reshape(STEPS + 1, -1)

    p, s, b, w, o = (array.ctypes.data for array in (parameters, state, before, work, outputs))
    for k in range(STEPS + 1):
        u = rows[k : k + 1].ctypes.data
        starts = k == 0
        assert (
            linux.initialize(n, p, u, s, POINTS, o, w) if starts else linux.advance(n, p, u, STEP, s, b, POINTS, o, w)
        ) == 0
        np.testing.assert_allclose(found[k], outputs, rtol=SAME, atol=SAME * np.abs(outputs).max())
