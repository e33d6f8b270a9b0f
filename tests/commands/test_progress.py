"""What takes long is told on stderr, on a terminal only."""

import os
import subprocess
import sys

import pytest


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such terminals")
@pytest.mark.parametrize("terminal", [True, False])
def test_only_a_terminal_is_told_what_begins(fmu_folder, terminal):
    reader, writer = os.openpty() if terminal else os.pipe()
    command = [sys.executable, "-m", "tetherfmu", "check", str(fmu_folder / "TetherStraight.fmu")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, stderr=writer, check=True)
    os.write(writer, b"end\n")
    said = b""
    while b"end" not in said:
        said += os.read(reader, 1000)
    assert said.decode().splitlines() == [f"checking {fmu_folder / 'TetherStraight.fmu'} ...", "end"][not terminal :]
