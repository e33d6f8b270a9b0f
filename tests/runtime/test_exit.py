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
from tetherfmu.export.archive import SLAVES


def with_each(*ends):
    """Each FMU with the first end, and one FMU with each other: PythonFMU's library, which all have, is what ends."""
    return pytest.mark.parametrize(
        ("name", "end"), [*((name, ends[0]) for name in SLAVES), *(("TetherDynamicFree", end) for end in ends[1:])]
    )


@with_each("handler", "nothing", "free", "unload")
def test_python_host(poison, fmu_folder, name, end):
    command = [sys.executable, Path(__file__).parent / "leave.py", shared_folder(fmu_folder / f"{name}.fmu"), end]
    done = subprocess.run(
        command, env={**os.environ, "LD_PRELOAD": str(poison)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@with_each("finalize", "stay", "unload", "abandon")
def test_c_host(poison, c_host_program, fmu_folder, tmp_path, name, end):
    assert len(clients.c_host(c_host_program, fmu_folder / f"{name}.fmu", tmp_path, "alone", end, [poison])) == 1
