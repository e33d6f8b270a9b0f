"""No read or write beside what is the shell's own, no undefined behaviour, no leak: sanitizers watch, and valgrind.

`python tests/benchmarks/native_sessions.py` runs many more sessions.
"""

import shutil
import subprocess
from pathlib import Path

import pytest

from native import programs

DRIVER, SESSIONS = Path(__file__).with_name("driver.c"), 250
VALGRIND = ("valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=definite,possible")


@pytest.mark.skipif(not programs.available(), reason="needs gcc on 64-bit Linux")
@pytest.mark.parametrize(("variant", "fmi"), [("dynamic_free", 2), ("catenary", 3)])
def test_random_sessions_under_sanitizers(tmp_path, variant, fmi):
    """40 random calls each, legal and illegal; the program checks the state after each, see `driver.c`."""
    program = programs.compiled(tmp_path, variant, fmi, DRIVER, programs.SANITIZED)
    done = subprocess.run([program, "1", str(SESSIONS)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{SESSIONS} sessions done")


@pytest.mark.skipif(not programs.available() or shutil.which("valgrind") is None, reason="needs gcc, valgrind and Linux")
@pytest.mark.parametrize(("variant", "fmi"), [("dynamic_free", 2), ("dynamic", 3)])
def test_random_sessions_under_valgrind(tmp_path, variant, fmi):
    """It also sees what is read before it was written, which those sanitizers do not.

    Of seed 6, in which no step spends its whole budget: that took twenty times longer than all others together.
    """
    program = programs.compiled(tmp_path, variant, fmi, DRIVER, ("-g", "-O1"))
    done = subprocess.run([*VALGRIND, program, "6", "40"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("40 sessions done")
