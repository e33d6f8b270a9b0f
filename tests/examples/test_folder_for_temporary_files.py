"""Where temporary files have a path on which PythonFMU's library crashes, the commands refuse in one line."""

import pytest

from running import run_code

CODE = """
import os, sys, tempfile
os.environ |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), os.getcwd())
tempfile.tempdir = None  # it is looked for anew
from tetherfmu.__main__ import main
sys.exit(main(["fly", "--fmu", sys.argv[1], "--duration", "1"]))
"""


def flown(fmu_file, folder):
    """What a short flight with a folder for temporary files ends with."""
    folder.mkdir()
    return run_code(CODE, fmu_file, cwd=folder)


@pytest.mark.parametrize("name", ["Jörg", "a+b", "a#b", "50%"])
def test_an_fmu_of_pythonfmu_is_refused(fmu_folder, tmp_path, name):
    done = flown(fmu_folder / "TetherStraight.fmu", tmp_path / name)
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert "PythonFMU's library crashes on" in done.stderr
    assert "TMPDIR" in done.stderr


def test_a_native_fmu_flies(native_folder, tmp_path):
    done = flown(native_folder / "TetherStraight.fmu", tmp_path / "Jörg #1+50%")
    assert done.returncode == 0, done.stderr
    assert "times real time" in done.stdout
