"""Systems as files: what a file says is what records say; one clear line for each mistake."""

import re
from pathlib import Path

import numpy as np
import pytest

from tetherfmu import Environment, Ground, Line, Point, Solver, TetherSystem, Winch, tether_of
from tetherfmu.files import system_files as files

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "systems").glob("*.toml"))
SYSTEM = """
name = "Crane"
[points.hook]
position = [0, "1 km", 30]
[points.load]
mass = "500 kg"
[points.drone]
position = [5, 1000, 30]
velocity = ["36 km/h", 0, 0]
[lines.rope]
from = "hook"
to = "load"
material = "steel"
diameter = "10 mm"
initial_length = "20 m"
segments = 4
reel_out_speed = "0.5 m/s"
winch_control = "force"
winch_mass = "20 kg"
longest_length = "40 m"
[lines.tag]
from = "drone"
to = "load"
initial_length = 22
segments = 3
[environment]
gravity = 9.8
[ground]
contact = "flat"
height = "-2 m"
[solver]
initial_shape = "straight"
"""
WRONG = {
    "no TOML": ("name =.*", "name =", "is not a TOML file"),
    "nested": ("name =.*", "name = " + "[" * 5000, "nested too deeply"),
    "unknown table": (r"\[solver\]", "[solvers]", "unknown key solvers; did you mean solver?"),
    "nearest key": ("segments = 4", "segment = 4", "unknown key lines.rope.segment; did you mean segments?"),
    "no near key": ("segments = 4", "xyz = 4", "unknown key lines.rope.xyz; known are from, to, material, segments"),
    "wrong before missing": ("initial_length = 22", "length = 22",
        "unknown key lines.tag.length; did you mean initial_length?"),
    "long name": (r"\[lines.tag\]", f"[lines.{'t' * 300}]",
        "name of a line is 'tttttttttttttttttttt'... (300 characters); it must"),
    "long name of a point": (r"\[points.drone\]", f"[points.{'d' * 300}]",
        "'dddddddddddddddddddd'... (300 characters); it must"),
    "long name of the system": ('"Crane"', f'"{"C" * 300}"',
        "the name of a system is 'CCCCCCCCCCCCCCCCCCCC'... (300 characters)"),
    "mass and density": ("segments = 4", "density = 700\nmass_per_length = 1",
        "lines.rope.mass_per_length and density are both given"),
    "heavy": ("segments = 4", "mass_per_length = '1e7 kg/m'",
        "lines.rope.mass_per_length is 10000000.0; it must be at least"),
    "wrong unit": ("20 m", "20 kg", "lines.rope.initial_length is '20 kg'; it must be a number with one of the units m, mm"),
    "not a number": ("initial_length = 22", "initial_length = nan", "lines.tag.initial_length is nan; it must be at least"),
    "half a segment": ("segments = 4", "segments = 4.5", "lines.rope.segments is 4.5; it must be a whole number"),
    "two numbers": (r"\[5, 1000, 30\]", "[5, 30]", "points.drone.position is [5, 30]; it must be three numbers [x, y, z]"),
    "NaN in a vector": (r"\[5, 1000", "[nan, 1000", "points.drone.position is [nan, 1000, 30]; each must be a finite"),
    "negative mass": ("500 kg", "-5 kg", "points.load.mass is '-5 kg'; it must be at least 0 kg"),
    "no position": (r'mass = "500 kg"', "", "the key points.load.position is missing"),
    "no length": ("initial_length = 22", "", "the key lines.tag.initial_length is missing"),
    "unknown material": ('"steel"', '"string"', "lines.rope.material is 'string'; it must be one of dyneema_sk75"),
    "no name of a point": ('to = "load"', "to = 3", "lines.rope.to is 3; it must be the name of a point"),
    "unknown point": ('to = "load"', 'to = "lode"', "the line rope goes to the point lode, which does not exist"),
    "to itself": ('to = "load"', 'to = "hook"', "the line rope goes from the point hook to itself"),
    "idle point": (r"\[points.load\]", "[points.idle]\nmass = 1\n[points.load]", "no line goes to the point idle"),
    "point and line": (r"\[lines.tag\]", "[lines.hook]", "the name hook is given twice"),
    "point twice": (r"\[points.drone\]", "[points.load]", "is not a TOML file"),
    "taken name": (r"\[lines.tag\]", "[lines.gravity]", "lines.gravity: gravity is a name of the whole system"),
    "no structured name": (r"\[lines.tag\]", '[lines."a.b"]', "the name of a line is 'a.b'; it must be letters"),
    "name of the model": ('"Crane"', '"My Crane"', "the name of a system is 'My Crane'; it must be letters"),
    "number as name": ('"Crane"', "3", "name is 3; it must be a text"),
    "list of materials": ('"steel"', '["steel"]', "lines.rope.material is ['steel']; did you mean steel?"),
    "number as point": (r"\[points.drone\]", "drone = 3\n[points.more]", "unknown key points.load.drone"),
    "short segments": ("initial_length = 22", "initial_length = 0.02", "the line tag: initial_length is 0.02 m for 3"),
    "unknown control": ('"force"', '"torque"', "lines.rope.winch_control is 'torque'; it must be"),
    "light drum": ('"20 kg"', '"-20 kg"', "lines.rope.winch_mass is '-20 kg'; it must be at least 0 kg"),
    "stops crossed": ('longest_length = "40 m"', "longest_length = 9\nshortest_length = 10",
        "lines.rope.shortest_length is 10"),
    "unknown ground": ('contact = "flat"', "", "the key ground.contact is missing"),
    "mark of a winch": (r"\[ground\]", '[winches."my drum"]\nlines = {tag = 1}\n[ground]',
        "the name of a winch is 'my drum'; it must be letters"),
    "scene": (r"\[ground\]", "[flight]\n[ground]", "describes a scene, not a system of tethers; use tetherfmu fly, advise"),
    "name over sheaves": ("initial_length = 22", 'initial_length = 22\nthrough = "hook"',
        "lines.tag.through is 'hook'; it must be a list of names of points"),
    "short portion": ("initial_length = 22", 'initial_length = 22\nthrough = ["hook"]\ninitial_portions = [21.99, 0.01]',
        "tag.initial_portions is [21.99, 0.01]; each must be at least 0.03 m, 0.01 m for each of its 3 segments"),
    "no table": (r"\[environment\]\ngravity = 9.8", "", "environment is 3; it must be a table [environment]"),
}  # fmt: skip


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "system.toml"
    file.write_text(SYSTEM, encoding="utf-8")
    return file


def test_a_file_says_what_records_say(path):
    found = files.load(path)
    assert found.name == "Crane"
    assert found.points == (
        Point("hook", (0.0, 1000.0, 30.0)),
        Point("load", mass=500.0),
        Point("drone", (5.0, 1000.0, 30.0), (10.0, 0.0, 0.0)),
    )
    rope, tag = found.lines
    steel = tether_of("steel", 0.01, initial_length=20.0, segments=4)
    winch = Winch(winch_control="force", winch_mass=20.0, longest_length=40.0)
    assert rope == Line("rope", "hook", "load", steel, 0.5, winch)
    assert (tag.start, tag.end, tag.tether.initial_length, tag.tether.segments) == ("drone", "load", 22, 3)
    assert found.environment == Environment(gravity=9.8)
    assert found.ground == Ground(ground_contact="flat", ground_height=-2.0)
    assert found.solver == Solver(initial_shape="straight")


@pytest.mark.parametrize(("pattern", "replacement", "says"), WRONG.values(), ids=WRONG)
def test_a_wrong_file_is_told_in_one_line(path, pattern, replacement, says):
    text = re.sub(pattern, replacement, SYSTEM, count=1)
    path.write_text(("environment = 3\n" if says.startswith("environment is") else "") + text, encoding="utf-8")
    with pytest.raises(ValueError, match="^" + re.escape(f"{path}: ")) as refused:
        TetherSystem.from_file(path)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_as_windows_writes_it(path):
    """With a byte order mark and CR LF."""
    plain = files.load(path)
    path.write_bytes(b"\xef\xbb\xbf" + SYSTEM.replace("\n", "\r\n").encode())
    assert files.load(path) == plain


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(ValueError, match=r"nowhere\.toml: cannot be read"):
        TetherSystem.from_file(tmp_path / "nowhere.toml")


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_free_points_of_the_examples_balance(file):
    """Lines hold the weight of a free point that was found at rest; the start and each line leave 1e-9 of the forces."""
    system = TetherSystem.from_file(file)
    outputs = system.initialize()
    for point in system.points:
        if point.position is None:
            force = outputs.points[point.name].force
            np.testing.assert_allclose(force, (0.0, 0.0, 9.81 * point.mass), atol=1e-6 * np.linalg.norm(force) + 1e-4)
