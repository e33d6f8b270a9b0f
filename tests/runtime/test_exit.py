"""A process ends cleanly with PythonFMU's library loaded, in Python and in C, however it leaves.

Every host runs with `poison.c` preloaded: what is freed twice crashes each time, not by chance.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from runtime import clients
from runtime.host import shared_folder

FMU = "TetherDynamicFree.fmu"  # what ends is PythonFMU's library, which all have


@pytest.mark.parametrize("end", ["handler", "nothing", "free", "unload"])
def test_python_host(poison, fmu_folder, end):
    command = [sys.executable, Path(__file__).parent / "leave.py", shared_folder(fmu_folder / FMU), end]
    environment = {**os.environ, "LD_PRELOAD": str(poison)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("end", ["finalize", "stay", "unload", "abandon"])
def test_c_host(poison, c_host_program, fmu_folder, tmp_path, end):
    assert len(clients.c_host(c_host_program, fmu_folder / FMU, tmp_path, "alone", end, [poison])) == 1
