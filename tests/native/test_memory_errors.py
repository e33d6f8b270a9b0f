"""No read or write beside what is the shell's own, no undefined behaviour, no leak: sanitizers watch.

`python tests/benchmarks/native_sessions.py` runs many more sessions.
"""

import subprocess
from pathlib import Path

import pytest

from native import programs

DRIVER, SESSIONS = Path(__file__).with_name("driver.c"), 500


@pytest.mark.skipif(not programs.available(), reason="needs gcc on 64-bit Linux")
@pytest.mark.parametrize(("variant", "fmi"), [("dynamic_free", 2), ("catenary", 3)])
def test_random_sessions_under_sanitizers(tmp_path, variant, fmi):
    """40 random calls each, legal and illegal; the program checks the state after each, see `driver.c`."""
    program = programs.compiled(tmp_path, variant, fmi, DRIVER, programs.SANITIZED)
    done = subprocess.run([program, "1", str(SESSIONS)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{SESSIONS} sessions done")
