"""The Windows libraries give the numbers of Linux: run under wine, where that is installed."""

import shutil
import subprocess
import sys
from array import array
from pathlib import Path

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, circle
from tetherfmu.libraries import ready
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.kernel_library import file_name
from tetherfmu.runtime.parameters import Environment, Solver
from tetherfmu.runtime.plan_layout import plan_size
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.wiring.packing import pack_records
from tetherfmu.wiring.variables import line_of_tether

STEPS, STEP, POINTS = 100, 0.02, 5
# the mathematical libraries differ in the last bit of log1p, asinh, ...; a step of the solver does not amplify that
SAME = 1e-12

pytestmark = [pytest.mark.release, pytest.mark.skipif(shutil.which("wine") is None, reason="wine is not installed")]


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """The host program and the libraries, in one folder."""
    folder = tmp_path_factory.mktemp("windows")
    for variant, compiled in ready.folders(VARIANTS, ["x86_64-windows"]).items():
        shutil.copy(compiled / file_name(variant, "x86_64-windows"), folder)
    source = str(Path(__file__).parent / "windows_host.c")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu", "-O1", "-fno-sanitize=all"]
    zig.append(f"-DPLAN_SIZE={plan_size(1)}")
    subprocess.run([*zig, "-fno-stack-protector", "-c", "-o", "host.obj", source], cwd=folder, check=True)
    subprocess.run([*zig, "-nostdlib", "-Wl,-e,start", "-lkernel32", "-o", "host.exe", "host.obj"], cwd=folder, check=True)
    return folder


@pytest.mark.parametrize("variant", VARIANTS)
def test_windows_equals_linux(host, variant):
    linux = Instance(ready.kernels(variant), (line_of_tether(POINTS),))
    segments, parameters = pack_records(linux.kernels, (CIRCLE_TETHER,), Environment(), Solver())
    linux.set_up((segments,), parameters)
    rows = np.zeros((STEPS + 1, at.INPUTS))
    for k in range(STEPS + 1):  # row 0 initializes, row k + 1 starts step k
        rows[k, :3], rows[k, 3:6] = circle(max(0, k - 1) * STEP)
    outputs = np.frombuffer(linux.values)[linux.outputs_at :]
    head = [len(linux.parameters), len(linux.state), len(linux.work), len(outputs), STEPS, STEP]
    numbers = np.concatenate([head, linux.parameters, rows.ravel()]).astype("<f8")
    (host / "in.bin").write_bytes(linux.plan.tobytes() + numbers.tobytes())
    library = file_name(variant, "x86_64-windows")
    subprocess.run(["wine", "host.exe", library, variant, "in.bin", "out.bin"], cwd=host, check=True, capture_output=True)
    found = np.frombuffer((host / "out.bin").read_bytes()).reshape(STEPS + 1, -1)

    for k in range(STEPS + 1):
        linux.values[: at.INPUTS] = array("d", rows[k])
        assert (linux.start() if k == 0 else linux.advance(STEP)) is None
        np.testing.assert_allclose(found[k], outputs, rtol=SAME, atol=SAME * np.abs(outputs).max())
