"""The closed loop of a kite in Python with the free tether: it comes to rest where the forces on the kite balance."""

import ast
import re
import sys

import numpy as np
import pytest

from manual import page
from running import EXAMPLES, run_code, run_python
from tetherfmu.runtime.parameters import Tether

SCRIPT = EXAMPLES / "first_flight" / "fly_your_kite.py"


def elevation(up, along, drag_of_tether=1.0, weight_of_tether=1.0):
    """Elevation [deg] of a kite with these forces [N] on a straight tether: half of the tether's loads act at the kite.

    Drag of a line across the wind: rho cd d L v^2/2 sin(b)^2 along (sin b, -cos b), b its elevation; other arguments: parts
    of the tether's drag and weight that count.
    """
    tether, length, angle = Tether(), 200.0, 1.0
    drag = drag_of_tether * 0.5 * 1.225 * tether.drag_coefficient * tether.diameter * length * 8.0**2
    weight = weight_of_tether * tether.mass_per_length * length * 9.81
    for _ in range(50):
        across = 0.5 * drag * np.sin(angle) ** 2
        angle = np.arctan2(up - 0.5 * weight - across * np.cos(angle), along + across * np.sin(angle))
    return np.degrees(angle)


def test_the_kite_finds_its_elevation(fmu_folder, tmp_path):
    (tmp_path / "dist").symlink_to(fmu_folder)
    code = f"""
import numpy, runpy
rows = numpy.array(runpy.run_path({str(SCRIPT)!r}, run_name="__main__")["rows"])
print(*numpy.mean(rows[-1000:], axis=0))
"""
    done = run_code(code, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    _, x, y, z, *velocity, tension = map(float, done.stdout.split()[-8:])
    pressure = 0.5 * 1.225 * 10.0 * 8.0**2
    lift, drag = 0.7 * pressure, 0.15 * pressure
    weight = 10.0 * 9.81
    found = np.degrees(np.arctan2(z, x))
    assert found == pytest.approx(elevation(lift - weight, drag), abs=0.3)  # a straight tether: no sag
    without = np.degrees(np.arctan2(lift - weight, drag))
    assert f"comes to rest {found:.1f} degrees above the horizon" in page("use/start")
    assert f"Without the tether it would rest at {without:.1f} degrees" in page("use/start")
    light = elevation(lift - weight, drag, 0.0), elevation(lift - weight, drag, 1.0, 0.0)
    assert [round(each - found) for each in light] == [4, 1]  # degrees, as the page says
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
    done = run_python("mine.py", cwd=tmp_path)
    assert done.returncode == 1
    assert why in done.stdout
    assert "Traceback" not in done.stderr
    assert re.search(rf"^The flight ended at {time} s: fmi2\w+ failed with status", done.stderr, re.MULTILINE)
