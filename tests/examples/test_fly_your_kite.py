"""The closed loop of a kite in Python with the free tether: it comes to rest where the forces on the kite balance."""

import ast
import re
import subprocess
import sys

import numpy as np
import pytest
from running import EXAMPLES, run

from tetherfmu.runtime.parameters import Tether

SCRIPT = EXAMPLES / "first_flight" / "fly_your_kite.py"


def test_the_kite_finds_its_elevation(fmu_folder, tmp_path):
    (tmp_path / "dist").symlink_to(fmu_folder)
    said = run(
        fmu_folder,
        "import numpy, os, runpy\n"
        f"os.chdir({str(tmp_path)!r})\n"
        f"rows = numpy.array(runpy.run_path({str(SCRIPT)!r}, run_name='__main__')['rows'])\n"
        "print(*numpy.mean(rows[-1000:], axis=0), numpy.ptp(rows[-1000:, 1:4]))\n",
    )
    _, x, y, z, *velocity, tension, _ = map(float, said.split()[-9:])
    pressure = 0.5 * 1.225 * 10.0 * 8.0**2
    lift, drag = 0.7 * pressure, 0.15 * pressure
    weight, tether = 10.0 * 9.81, Tether().mass_per_meter * 200.0 * 9.81
    # weight and drag of the tether (a few N) turn the chord down from the direction at the kite
    steepest = np.arctan2(lift - weight, drag)
    flattest = np.arctan2(lift - weight - tether, drag + 20.0)
    assert flattest < np.arctan2(z, x) < steepest
    assert abs(y) < 1e-6
    assert tension == pytest.approx(np.hypot(lift - weight, drag), rel=0.1)
    np.testing.assert_allclose(velocity, 0.0, atol=0.3)  # it still swings a little


def test_it_is_short_and_needs_numpy_and_fmpy_only():
    """What is copied first: the file fits on a screen, and runs where TetherFMU is not installed."""
    text = SCRIPT.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 45
    nodes = list(ast.walk(ast.parse(text)))
    imported = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    assert imported - sys.stdlib_module_names == {"numpy", "fmpy"}


@pytest.mark.parametrize(
    ("good", "bad", "time", "why"),
    [
        ("return 0.5", "return (np.nan if position[2] > 121.0 else 1.0) * 0.5", r"0\.\d\d", "kite_load[1] is nan"),
        ('"kite_mass": 10.0', '"kite_mass": -1.0', r"0\.00", "kite_mass is -1.0; it must be at least 0 kg"),
    ],
    ids=["step", "parameter"],
)
def test_a_refusal_ends_it_in_words(fmu_folder, tmp_path, good, bad, time, why):
    """As in a copy that someone has changed: when, and from the FMU why."""
    (tmp_path / "dist").symlink_to(fmu_folder)
    text = SCRIPT.read_text(encoding="utf-8")
    assert text.count(good) == 1
    (tmp_path / "mine.py").write_text(text.replace(good, bad), encoding="utf-8")
    done = subprocess.run([sys.executable, "mine.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert why in done.stdout
    assert "Traceback" not in done.stderr
    assert re.search(rf"^The flight ended at {time} s: fmi2\w+ failed with status", done.stderr, re.MULTILINE)
