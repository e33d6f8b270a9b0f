"""Files of other programs: what they say here, what is left out, and what is refused, with its row."""

import tomllib
from math import exp, sqrt

import numpy as np
import pytest

from tetherfmu import TetherSystem
from tetherfmu.__main__ import main
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime import layout as at
from tetherfmu.study.scenes import files

SETTINGS, MOORED = EXAMPLES / "scenes" / "settings.yaml", EXAMPLES / "systems" / "moored.txt"


def imported(path, folder, **changes):
    """Path of what an example with changes becomes, and the exit status."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    (folder / path.name).write_text(text, encoding="utf-8")
    out = folder / "made.toml"
    return out, main(["import", str(folder / path.name), "--out", str(out)])


def test_settings_are_a_scene(tmp_path):
    """Air as `calc_rho` of AtmosphericModels.jl has it: 25 degrees warm, 100 m above the sea."""
    path, status = imported(SETTINGS, tmp_path)
    scene = files.load(path)
    assert status == 0
    tether = scene.tether
    assert (tether.initial_length, tether.diameter, tether.axial_stiffness) == (200.0, pytest.approx(0.003), 350000.0)
    assert (tether.axial_damping, tether.drag_coefficient, tether.density) == (250.0, 1.0, 724.0)
    air = scene.environment
    assert air.air_density == pytest.approx(1.225 * (15.0 + 273.15) / (25.0 + 273.15) * exp(-100.0 / 8550.0), rel=1e-12)
    assert (air.wind_exponent, air.wind_reference_height, air.surface_roughness) == (0.14, 6.0, 0.0002)
    assert scene.wind(np.zeros(1)).tolist() == [[9.0, 0.0, 0.0]]
    kite = scene.flight.motion(np.zeros(1)).kite[0]
    np.testing.assert_allclose(kite, (100.0, 0.0, 200.0 * sqrt(0.75)), rtol=1e-12)  # 60 degrees high
    assert scene.duration == 30.0


@pytest.mark.parametrize(("law", "profile"), [(0, at.UNIFORM), (1, at.POWER_LAW), (2, at.LOGARITHMIC), (3, at.EXPLOG)])
def test_profile_laws_have_other_numbers(law, profile, tmp_path):
    path, _ = imported(SETTINGS, tmp_path, law=("profile_law: 2", f"profile_law: {law}"))
    assert files.load(path).environment.wind_profile == profile


def test_a_modulus_stands_for_the_stiffness(tmp_path):
    """As in newer settings, where unit_stiffness is 0: E A."""
    path, _ = imported(SETTINGS, tmp_path, stiffness=("c_spring: 350000.0", "unit_stiffness: 0.0\n    e_tether: 5.5e10"))
    assert files.load(path).tether.axial_stiffness == pytest.approx(5.5e10 * np.pi / 4.0 * 0.003**2)


def test_keys_of_kiteutils_11(tmp_path, capsys):
    """Stiffness and damping by their new names beside a modulus; of the lengths the first one, the others being 0."""
    length = ("l_tether: 200.0", "l_tethers: [200.0, 0.0, 0.0]")
    modern = ("damping: 250.0         # [Ns]\n    c_spring: 350000.0", "axial_damping: 260.0\n    axial_stiffness: 7e5")
    path, _ = imported(
        SETTINGS, tmp_path, length=length, modern=modern, modulus=("rho_tether", "e_tether: 5.5e10\n    rho_tether")
    )
    tether = files.load(path).tether
    assert (tether.initial_length, tether.axial_stiffness, tether.axial_damping) == (200.0, 7e5, 260.0)
    shown = capsys.readouterr().out
    assert "tether.e_tether" in shown
    assert "taken by default: environment.gravity = 9.81\n" in shown


def test_wind_is_that_of_the_vector_where_the_file_says_so(tmp_path):
    """Downwind is x: `wind_vec` blows to the north-east and up; `upwind_elevation` is that of where the wind comes from."""
    vector = ("v_wind: 9.0", "v_wind: 9.0\n    wind_vec: [3.0, 4.0, 0.5]\n    use_wind_vec: true")
    path, _ = imported(SETTINGS, tmp_path, vector=vector)
    assert files.load(path).wind(np.zeros(1)).tolist() == [[5.0, 0.0, 0.5]]
    path.unlink()
    path, _ = imported(SETTINGS, tmp_path, vector=("v_wind: 9.0", "v_wind: 9.0\n    upwind_elevation: 30.0"))
    np.testing.assert_allclose(files.load(path).wind(np.zeros(1)), [[9.0 * sqrt(0.75), 0.0, -4.5]], rtol=1e-12)


def test_three_lengths_are_three_lines(tmp_path, capsys):
    """At rest their weight is carried by both ends; each line has its own diameter, and the stiffness of the file."""
    lines = ("l_tether: 200.0", "l_tethers: [201.0, 202.0, 202.0]")
    diameters = ("d_tether:  3.0", "power_tether_diameter: 2\n    steering_tether_diameter: 1")
    path, status = imported(SETTINGS, tmp_path, lines=lines, diameters=diameters)
    assert status == 0
    system = TetherSystem.from_file(path)
    assert [line.tether.diameter for line in system.lines] == [0.002, 0.001, 0.001]
    assert {line.tether.axial_stiffness for line in system.lines} == {350000.0}
    start = system.initialize()
    weight = 9.81 * 724.0 * np.pi / 4.0 * (0.002**2 * 201.0 + 2 * 0.001**2 * 202.0)
    np.testing.assert_allclose(sum(each.force for each in start.points.values()), (0.0, 0.0, -weight), atol=1e-5 * weight)
    assert "wind_velocity = [9.0, 0.0, 0.0]" in capsys.readouterr().out


def test_the_drum_of_a_winch_is_said(tmp_path, capsys):
    """J (n/r)^2 at the rope: 0.2 kg m2 behind a gear of 6 at a drum of 0.15 m is 320 kg."""
    keys = (
        "winch:\n    inertia_total: 0.2\n    gear_ratio: 6.0\n    drum_radius: 0.15\n    f_coulomb: 122.0\n    c_vf: 30.6\n"
    )
    path, _ = imported(SETTINGS, tmp_path, winch=("environment:\n", f"{keys}environment:\n"))
    said = "the winch of the file, mass = 320, friction = 122, damping = 30.6: [winch] takes it beside force"
    assert said in capsys.readouterr().out
    assert said in path.read_text(encoding="utf-8")


def test_what_is_missing_is_said(tmp_path, capsys):
    imported(SETTINGS, tmp_path, drag=("cd_tether: 1.0", "other: 1.0"), law=("profile_law: 2", "rule: 2"))
    missing = "gravity = 9.81, environment.wind_profile = 1\n"
    assert f"taken by default: tether.drag_coefficient = 0.958, environment.{missing}" in capsys.readouterr().out


def test_what_is_left_out_is_said(tmp_path, capsys):
    path, _ = imported(SETTINGS, tmp_path)
    shown = capsys.readouterr().out
    assert shown.startswith(f"{path}  a scene: tetherfmu advise {path}\n")
    assert "left out: system.segments, kite, environment.upwind_dir\n" in shown
    assert "# left out: system.segments, kite, environment.upwind_dir.\n" in path.read_text(encoding="utf-8")
    path.unlink()
    again = imported(MOORED, tmp_path, volume=("70    2.0   0 ", "70    2.0   0.3 "))[1]
    shown = capsys.readouterr().out
    assert again == 0
    assert "left out: point 3: volume, drag and added mass\n" in shown
    assert "left out: options dtm, kbot\n" in shown
    assert "left out: buoyancy and added mass: of the fluid of 1.225 kg/m3 drag alone acts on the lines\n" in shown


def test_a_line_file_is_a_system_at_rest_under_its_weight(tmp_path):
    """What the driven points carry is the weight of rope, wire and knot; damping is that of MoorDyn, zeta l sqrt(EA w)."""
    path, status = imported(MOORED, tmp_path)
    system = TetherSystem.from_file(path)
    assert status == 0
    start = system.initialize()
    carried = sum(start.points[name].force for name in ("p1", "p2", "p4"))
    weight = 9.81 * (2.0 + 0.0091 * 160.0 + 0.14 * 30.6)
    np.testing.assert_allclose(carried, (0.0, 0.0, -weight), atol=1e-5 * weight)
    wire = next(line.tether for line in system.lines if line.name == "line3")
    assert wire.axial_damping == pytest.approx(0.8 * 30.6 / 6 * sqrt(80000.0 * 0.14), rel=1e-12)
    assert [line.tether.segments for line in system.lines] == [10, 10, 6]


def test_a_bottom_is_the_ground(tmp_path):
    """At the depth below z = 0; without its stiffness there is none, and without options the fluid is water."""
    deep = {"bottom": ("0       kBot ", "3e6     kBot "), "depth": ("9.81 ", "120 WtrDpth\n9.81 ")}
    table = tomllib.loads(imported(MOORED, tmp_path, **deep)[0].read_text(encoding="utf-8"))
    assert table["ground"] == {"contact": "flat", "height": -120.0, "friction": 0.0}
    (tmp_path / "made.toml").unlink()
    table = tomllib.loads(imported(MOORED, tmp_path, water=("1.225   WtrDnsty", "0 other"))[0].read_text(encoding="utf-8"))
    assert "ground" not in table
    assert table["environment"]["air_density"] == 1025.0


WRONG = {  # what stands in an example, what is there instead, what is said
    "law": (
        SETTINGS,
        "profile_law: 2",
        "profile_law: 5",
        "row 26: environment.profile_law is 5; it must be 0 (constant), 1",
    ),
    "number": (
        SETTINGS,
        "cd_tether: 1.0",
        "cd_tether: abc",
        "row 13: tether.cd_tether is 'abc'; it must be a finite",
    ),
    "range": (
        SETTINGS,
        "d_tether:  3.0",
        "d_tether: -3.0",
        "row 12: tether.d_tether: diameter is -0.003; it must be",
    ),
    "several": (
        SETTINGS,
        "l_tether: 200.0",
        "l_tethers: [200, 0, 199]",
        "row 6: initial.l_tethers: initial_length is 0.0; it must be at least",
    ),
    "two names": (
        SETTINGS,
        "c_spring: 350000.0",
        "c_spring: 350000.0\n    axial_stiffness: 700000.0",
        "row 15: tether.c_spring is 350000.0, and tether.axial_stiffness in row 16 is 700000.0; they are names of one",
    ),
    "twice": (
        SETTINGS,
        "cd_tether: 1.0",
        "cd_tether: 1.0\n    cd_tether: 1.1",
        "row 14: tether.cd_tether is in row 13, too",
    ),
    "flag": (
        SETTINGS,
        "v_wind: 9.0",
        "use_wind_vec: maybe",
        "row 18: environment.use_wind_vec is 'maybe'; it must be true or",
    ),
    "length": (SETTINGS, "l_tether:", "no_length:", "initial.l_tethers (l_tether), the length of the tether, is missing"),
    "program": (SETTINGS, "\ntether:", "\nrope:", "is neither a file of settings of KiteUtils.jl"),
    "body": (MOORED, "4    Coupled", "4    Body1  ", "row 14: Attachment is 'Body1'; it must be Fixed, Coupled or Free"),
    "place": (MOORED, "4    Coupled     0 ", "4    Coupled     x ", "row 14: X is 'x'; it must be a finite number"),
    "end": (
        MOORED,
        "2    rope      2  ",
        "2    rope      9  ",
        "row 19: it is attached to 9, which is no point of this",
    ),
    "type": (MOORED, "2    rope ", "2    cord ", "row 19: LineType is 'cord'; there are rope, wire"),
    "diameter": (MOORED, "wire       0.001", "wire       thin ", "row 7: Diam is 'thin'; it must be a finite number"),
    "infinite": (MOORED, "wire       0.001", "wire       inf  ", "row 7: Diam is 'inf'; it must be a finite number"),
    "segments": (
        MOORED,
        "30.6      6 ",
        "30.6    400 ",
        "row 20: lines.line3.segments is 400; it must be at least 1",
    ),
    "half": (MOORED, "30.6      6 ", "30.6    6.5 ", "row 20: NumSegs is 6.5; it must be a whole number"),
    "mass": (MOORED, "0.14      80000", "99 80000", "row 20: lines.line3.mass_per_length is 99.0; it must be at least"),
    "short": (
        MOORED,
        "3    wire      3        4        30.6",
        "3 wire 3 #",
        "row 20: it has 3 columns; it must have at",
    ),
    "version": (MOORED, "Cd    Ca ", "Cdn   Can ", "row 4: columns can are of MoorDyn v1; write the file for v2"),
    "option": (MOORED, "9.81    g", "low     g", "row 23: g is 'low'; it must be a finite number"),
    "no lines": (MOORED, "--- LINES ---", "--- ROPES ---", "it has no lines (v2: sections LINE TYPES, POINTS and LINES)"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_told_with_its_row(name, tmp_path, capsys):
    path, old, new, said = WRONG[name]
    out, status = imported(path, tmp_path, change=(old, new))
    assert status == 2
    assert not out.exists()
    error = capsys.readouterr().err
    assert error.startswith(f"{tmp_path / path.name}: ")
    assert said in error
    assert error.count("\n") == 1


def test_a_file_that_is_there_is_not_replaced(tmp_path, capsys):
    (tmp_path / "made.toml").write_text("mine", encoding="utf-8")
    assert imported(SETTINGS, tmp_path)[1] == 2
    assert "made.toml is there already; choose another file with --out" in capsys.readouterr().err
    assert (tmp_path / "made.toml").read_text(encoding="utf-8") == "mine"
