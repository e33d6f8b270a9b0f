"""The examples on tethers at rest: each runs in a process of its own, prints its forces, draws, and ends cleanly."""

import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
HALF_NODE = 0.08925189330624916 * 853.0240324867758 / 44.0  # weight of an end node of 22 segments [N]
PUBLISHED = {  # forces on the ground station and on the kite [N]: exact catenary; chain, without its end nodes
    "catenary": [1.97642, 1.97642, -1.57910, -1.97642, -1.97642, -74.55491],
    "22 segments": [1.92751, 1.92751, 0.04248 - HALF_NODE, -1.92751, -1.92751, -72.71586 - HALF_NODE],
}


def run(fmu_folder, code, room="."):
    """Run Python code in the folder of the examples' imports, with `find_fmu` looking into the FMUs of this test run.

    room : of those examples, whose modules can be imported, too.
    """
    find = f"fmu_tools.find_fmu = lambda name: {str(fmu_folder)!r} + f'/{{name}}.fmu'"
    code = f"import fmu_tools\n{find}\nimport circular_flight\n{code}"
    path = os.pathsep.join([str(EXAMPLES), str(EXAMPLES / room), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def assert_is_drawn(file):
    colors = plt.imread(file)[:, :, :3]
    assert np.count_nonzero(np.ptp(colors, axis=-1) > 0.2) > 1000  # coloured pixels; empty axes have none


def test_catenary(fmu_folder, tmp_path):
    printed = run(fmu_folder, f"import catenary; catenary.main(['--out', {str(tmp_path)!r}])")
    found = {
        line.split(":")[0]: [float(each) for each in re.findall(r"-?\d+\.\d{3}", line)] for line in printed.splitlines()
    }
    assert list(found) == ["catenary", "5 segments", "22 segments"]
    for name, expected in PUBLISHED.items():
        assert np.allclose(found[name], expected, atol=1e-3)  # printed with three digits
    assert_is_drawn(tmp_path / "catenary.png")


def test_forces_over_wind_and_slack(fmu_folder, tmp_path):
    """Dynamic and quasi-steady forces are the same; the lines come close where the tether is taut; wind pulls."""
    printed = run(
        fmu_folder,
        f"""
import numpy as np
from forces_over_wind_and_slack import main, survey
main(["--out", {str(tmp_path)!r}])
forces = survey(slacks=(-0.01, 0.02), winds=(0.0, 10.0, 20.0))
assert np.array_equal(forces["dynamic"], forces["quasi_steady"])
assert np.allclose(forces["catenary"][0], forces["dynamic"][0], rtol=0.01)
assert np.allclose(forces["straight"][0], forces["dynamic"][0], rtol=0.1)
assert all((np.diff(each[:, 1:, 1], axis=1) > 0.0).all() for each in forces.values())
""",
    )
    names = [line.split(":")[0] for line in printed.splitlines()]
    assert names == ["dynamic", "quasi_steady", "catenary", "straight"]
    assert_is_drawn(tmp_path / "forces_over_wind_and_slack.png")
