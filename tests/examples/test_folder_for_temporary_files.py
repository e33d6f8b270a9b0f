"""Where temporary files have a path on which PythonFMU's library crashes, the commands refuse in one line."""

import os
import subprocess
import sys

import pytest

CODE = "import sys; from tetherfmu.__main__ import main; sys.exit(main(sys.argv[1:]))"


def flown(fmu_file, folder):
    """What a short flight with a folder for temporary files ends with."""
    folder.mkdir()
    places = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(folder))
    environment = {**os.environ, **places, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", CODE, "fly", "--fmu", str(fmu_file), "--duration", "1"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


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
