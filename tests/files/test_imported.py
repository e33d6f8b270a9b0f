"""Files of other programs: what they say here, what is left out, and what is refused, with its row."""

import tomllib
from math import exp, sqrt

import numpy as np
import pytest

from tetherfmu import TetherSystem
from tetherfmu.__main__ import main
from tetherfmu.files import scene_files as files
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime import layout as at

SETTINGS, MOORED = EXAMPLES / "scenes" / "settings.yaml", EXAMPLES / "systems" / "moored.txt"


def imported(path, folder, **changes):
    """Path of what an example with changes becomes, in the place of the last one, and the exit status."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    (folder / path.name).write_text(text, encoding="utf-8")
    out = folder / "made.toml"
    out.unlink(missing_ok=True)
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


def test_a_modulus_stands_for_the_stiffness(tmp_path, capsys):
    """As in newer settings, where unit_stiffness is 0: E A."""
    path, _ = imported(SETTINGS, tmp_path, stiffness=("c_spring: 350000.0", "unit_stiffness: 0.0\n    e_tether: 5.5e10"))
    assert files.load(path).tether.axial_stiffness == pytest.approx(5.5e10 * np.pi / 4.0 * 0.003**2)
    said = "tether.unit_stiffness is 0: the stiffness is e_tether times the area, 388772 N\n"
    assert said in capsys.readouterr().out


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
    assert "default used: environment.gravity = 9.81\n" in shown


def test_lists_may_stand_over_several_rows(tmp_path):
    """And comments, quotes and references of YAML where they may."""
    rows = ("l_tether: 200.0", "l_tethers:  # of all\n      - 200.0\n      - 0.0\n      - 0.0")
    quoted = ("cd_tether: 1.0", "cd_tether: &one '1.0'\n    other: *one")
    path, status = imported(SETTINGS, tmp_path, rows=rows, quoted=quoted)
    assert status == 0
    assert (files.load(path).tether.initial_length, files.load(path).tether.drag_coefficient) == (200.0, 1.0)


def test_wind_is_that_of_the_vector_where_the_file_says_so(tmp_path):
    """Downwind is x: `wind_vec` blows to the north-east and up; `upwind_elevation` is that of where the wind comes from."""
    vector = ("v_wind: 9.0", "v_wind: 9.0\n    wind_vec: [3.0, 4.0, 0.5]\n    use_wind_vec: true")
    path, _ = imported(SETTINGS, tmp_path, vector=vector)
    assert files.load(path).wind(np.zeros(1)).tolist() == [[5.0, 0.0, 0.5]]
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


def test_the_drum_of_a_winch_waits_for_a_force(tmp_path, capsys):
    """J (n/r)^2 at the rope: 0.2 kg m2 behind a gear of 6 at a drum of 0.15 m is 320 kg."""
    keys = {"inertia_total": 0.2, "gear_ratio": 6.0, "drum_radius": 0.15, "f_coulomb": 122.0, "c_vf": 30.6}
    table = "".join(f"    {name}: {value}\n" for name, value in keys.items())
    winch = ("environment:\n", f"winch:\n{table}environment:\n")
    path, _ = imported(SETTINGS, tmp_path, winch=winch)
    said = "the winch of the file is a comment, [winch]: it needs a force, with which the winch pulls\n"
    assert said in capsys.readouterr().out
    before, _, comment = path.read_text(encoding="utf-8").partition("# [winch]")
    path.write_text(f"{before}[winch]{comment.replace('# ', '')}".replace('force = ""', 'force = "2 kN"'), encoding="utf-8")
    scene = files.load(path)
    assert scene.winch_force == 2000.0
    assert scene.winch.winch_mass == pytest.approx(320.0)
    assert (scene.winch.winch_friction, scene.winch.winch_damping) == (122.0, 30.6)
    imported(SETTINGS, tmp_path, winch=winch, lines=("l_tether: 200.0", "l_tethers: [200, 201, 201]"))
    said = "the winch of the file, winch_mass = 320, winch_friction = 122, winch_damping = 30.6: a line takes it beside"
    assert said in capsys.readouterr().out


def test_what_is_missing_is_said(tmp_path, capsys):
    imported(SETTINGS, tmp_path, drag=("cd_tether: 1.0", "other: 1.0"), law=("profile_law: 2", "rule: 2"))
    missing = "gravity = 9.81, environment.wind_profile = 1\n"
    assert f"default used: tether.drag_coefficient = 0.958, environment.{missing}" in capsys.readouterr().out


def test_what_is_left_out_is_said(tmp_path, capsys):
    path, _ = imported(SETTINGS, tmp_path)
    shown = capsys.readouterr().out
    assert shown.startswith(f"{path}  a scene: tetherfmu advise {path}\n")
    assert "left out: system.segments, kite, environment.upwind_dir\n" in shown
    assert "# left out: system.segments, kite, environment.upwind_dir.\n" in path.read_text(encoding="utf-8")
    again = imported(MOORED, tmp_path, volume=("70    2.0   0 ", "70    2.0   0.3 "))[1]
    shown = capsys.readouterr().out
    assert again == 0
    assert "left out: row 13: point 3: volume 0.3 m3, which carries 3.605 N\n" in shown
    assert "left out: options dtm (row 22)\n" in shown
    assert "left out: row 6: line type rope: buoyancy, 0.169 % of its weight\n" in shown  # 1.225 pi/4 0.004^2 / 0.0091


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
    sink = 0.0091 * 9.81 / (3e6 * 0.004)  # of the rope, which sinks less than the wire
    assert table["ground"] == {"contact": "flat", "height": -120.0, "friction": 0.0, "sink": pytest.approx(sink)}
    table = tomllib.loads(imported(MOORED, tmp_path, water=("1.225   WtrDnsty", "0 other"))[0].read_text(encoding="utf-8"))
    assert "ground" not in table
    assert table["environment"]["air_density"] == 1025.0


CHAIN = (200.0, 4e8)  # mass per length [kg/m], stiffness [N]
DECK = """-------------- Line file of a test, in a fluid without density ----------
----------------------- LINE TYPES ------------------------------------------
LineType   Diam  MassDenInAir  EA   BA/-zeta  EI   Can  Cat  Cdn  Cdt
(-)        (m)   (kg/m)        (N)  (N-s/-)   (-)  (-)  (-)  (-)  (-)
chain      0.1   200.0         4e8  -1.0      5e3  1.1  0.5  0.0  0.2
idle       0.2   1.0           1e6  0         0    0    0    0    0
{tables}
---------------------- OPTIONS -----------------------------------------
9.81   gravity   as m/s^2
0.0    rho       none
{options}
------------------------- need this line --------------------------------
"""
POINTS = "------ POINTS ------\nNode Type X Y Z M V CdA CA\n(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)\n"
LINES = "------ LINES ------\nLine LineType NodeA NodeB UnstrLen NumSegs Flags\n(-) (-) (-) (-) (m) (-) (-)\n"
HANGING = "1 Fixed 0 0 0 0 0 0 0\n2 Free 10 0 -100 1e5 0 0 0\n"


def of_deck(folder, tables, options=""):
    """System that a line file with these tables becomes."""
    (folder / "deck.txt").write_text(DECK.format(tables=tables, options=options), encoding="utf-8")
    out = folder / "deck.toml"
    out.unlink(missing_ok=True)
    assert main(["import", str(folder / "deck.txt"), "--out", str(out)]) == 0
    return TetherSystem.from_file(out)


def test_a_mooring_lies_and_hangs_as_in_closed_form(tmp_path):
    """Catenary with touchdown: of the horizontal force H and the vertical one V at the top follow the places of both ends.

    x = L - V/w + H/w asinh(V/H) + H L/EA,  z = H/w (sqrt(1 + (V/H)^2) - 1) + V^2/(2 EA w)  (Jonkman 2007, 2-37, 2-38)
    """
    mass, stiffness = CHAIN
    weight, length, pull, lift = 9.81 * mass, 300.0, 4e5, 2.5e5
    hanging = pull / weight * (np.hypot(1.0, lift / pull) - 1.0) + lift**2 / (2.0 * stiffness * weight)
    away = length - lift / weight + pull / weight * np.arcsinh(lift / pull) + pull * length / stiffness
    points = f"{POINTS}1 Fixed {away} 0 -80 0 0 0 0\n2 Vessel 0 0 {hanging - 80.0} 0 0 0 0\n"
    system = of_deck(tmp_path, f"{points}{LINES}1 chain 1 2 {length} 150 -\n", "80 WtrDpth\n1e8 kb\n")
    force = system.initialize().points["p2"].force
    np.testing.assert_allclose(force, (pull, 0.0, -lift), rtol=2e-3, atol=1.0)  # 150 segments


def test_moorings_that_no_line_joins_are_one_system(tmp_path):
    """Each hangs as it does alone, at rest and in motion, to rounding."""
    one, other = "1 Fixed 0 0 0 0 0 0 0\n2 Free 0 0 -9 50 0 0 0\n", "3 Fixed 9 0 0 0 0 0 0\n4 Free 9 0 -9 9 0 0 0\n"
    lines = f"{LINES}1 chain 1 2 40 8 -\n"
    both = of_deck(tmp_path, f"{POINTS}{one}{other}{lines}2 chain 3 4 30 6 -\n", "0 kBot")
    alone = of_deck(tmp_path, f"{POINTS}{one}{lines}", "0 kBot")
    for system in (both, alone):
        system.initialize()
        system.fly(50, 0.02, loads={"p2": (1e3, 0.0, 0.0)}, every=0)
    here, there = both.outputs().points, alone.outputs().points
    assert here["p2"].position[0] > 0.01
    np.testing.assert_allclose(here["p2"].position, there["p2"].position, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(here["p3"].force, (0.0, 0.0, -9.81 * (9.0 + 200.0 * 30.0)), rtol=1e-6, atol=1e-3)


def test_points_start_where_the_file_says_without_relaxation(tmp_path):
    """`TmaxIC 0`: a pendulum of a stiff line starts beside its place of rest, and swings at the period of small swings."""
    system = of_deck(tmp_path, f"{POINTS}{HANGING}{LINES}1 chain 1 2 100.5 4 -\n", "0 TmaxIC\n0 kBot")
    assert system.initialize().points["p2"].position.tolist() == [10.0, 0.0, -100.0]
    away = system.fly(1600, 0.01).points["p2"].position[:, 0]
    crossings = 0.01 * np.flatnonzero(np.diff(np.sign(away)) != 0)
    half = np.pi * sqrt(100.5 / 9.81)  # period [s]
    assert crossings[1] - crossings[0] == pytest.approx(half, rel=0.02)  # the line has a fifth of the mass
    system = of_deck(tmp_path, f"{POINTS}{HANGING}{LINES}1, chain, 1, 2, 100.5, 4, -\n", "60, TmaxIC\n0 kBot")
    np.testing.assert_allclose(system.initialize().points["p2"].position[:2], 0.0, atol=1e-6)


def test_sections_of_a_line_hang_one_below_the_other(tmp_path, capsys):
    """CableDyn: from end A; each segment is stretched by what hangs below its middle."""
    tables = f"{POINTS}1 Fixed 0 0 0\n2 Connect 0 0 -9 500\n------ LINES ------\nID NodeA NodeB Outputs\n1 1 2 -\n"
    rope = "------ LINE TYPES ------\nName Diam\n(-) (m)\nrope 0.05 2.0 1e6 -0.5 0 9 9 9 9 1.2 0.1 1 0\n"
    sections = "------ SECTIONS ------\nLineID LineType Length NumSegs\n1 chain 20.0 10\n1 rope 30.0 10\n"
    system = of_deck(
        tmp_path, tables + rope + sections, "dynamic_solver 1e-8 30 - both\nuniform 0.5 0.0 current - m/s\n-- a comment\n"
    )
    start = system.initialize()
    below = 500.0 + 2.0 * 30.0
    stretch = 9.81 * ((below + 200.0 * 10.0) * 20.0 / 4e8 + (500.0 + 2.0 * 15.0) * 30.0 / 1e6)
    np.testing.assert_allclose(start.points["p2"].position, (0.0, 0.0, -50.0 - stretch), rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(start.points["p1"].force, (0.0, 0.0, -9.81 * (below + 200.0 * 20.0)), rtol=1e-6, atol=1e-3)
    assert [line.tether.drag_coefficient for line in system.lines] == [1.1, 1.2]  # by place, in a row with shear, too
    assert "left out: options dynamic_solver (row 27), current (row 28)\n" in capsys.readouterr().out


def test_a_failure_by_tension_is_where_a_line_breaks(tmp_path, capsys):
    failures = "------ FAILURE ------\nID Point Lines FailTime FailTen\n() () (,) (s) (N)\n"
    failures += "1 P1 1 0 1.2e6\n2 2 1 9 0\n3 1 1,1 0 5\n"
    system = of_deck(tmp_path, f"{POINTS}{HANGING}{LINES}1 chain 1 2 100.5 4 -\n{failures}")
    assert system.lines[0].tether.breaking_force == 1.2e6
    shown = capsys.readouterr().out
    assert "failure 1: the place; the line breaks where it is first pulled with 1.2e+06 N\n" in shown
    assert "failure 2: at 9 s; set the input release of the line then\n" in shown
    assert "failure 3: of the lines 1,1 at once, at 5 N\n" in shown


def test_points_of_a_driven_body_are_driven(tmp_path, capsys):
    """Turned by 90 degrees about z, then moved; a rod that is held has two ends.  Points without a line are left out."""
    bodies = "------ BODIES ------\nID Type X0 Y0 Z0 r0 p0 y0 M\n(#)\n1 Coupled 5 0 -2 0 0 90 0\n"
    rods = "------ RODS ------\nID Type At Xa Ya Za Xb Yb Zb N\n(#)\n1 can Fixed 0 0 -50 0 0 -40 1 -\n"
    points = f"{POINTS}1 Body1 3 0 0 0 0 0 0\n2 Fixed 9 9 9 0 0 0 0\n"
    system = of_deck(tmp_path, f"{bodies}{rods}{points}{LINES}1 chain R1B 1 60 4 -\n", "0 kBot")
    places = {point.name: point.position for point in system.points}
    np.testing.assert_allclose(places["p1"], (5.0, 3.0, -2.0), atol=1e-12)
    assert places["r1b"] == (0.0, 0.0, -40.0)
    shown = capsys.readouterr().out
    for said in (
        "row 10: bodies, 1 Coupled 5",
        "row 14: rods, 1 can Fixed",
        "point 2, at which no line ends",
        "types idle,",
    ):
        assert said in shown
    assert "row 6: line type chain: bending stiffness EI, 5000 N m2" not in shown
    assert "row 5: line type chain: bending stiffness EI, 5000 N m2" in shown
    assert "row 5: line type chain: drag along the line, added mass and lift: 0.5, 0.2\n" in shown


def test_a_free_body_is_refused(tmp_path, capsys):
    bodies = "------ BODIES ------\nID Type X0 Y0 Z0 r0 p0 y0 M\n(#)\n1 Free 5 0 -2 0 0 90 0\n"
    tables = f"{bodies}{POINTS}1 Body1 3 0 0\n{LINES}1 chain 1 1 9 3 -"
    (tmp_path / "deck.txt").write_text(DECK.format(tables=tables, options=""))
    assert main(["import", str(tmp_path / "deck.txt"), "--out", str(tmp_path / "deck.toml")]) == 2
    assert "row 14: it is on body 1, which is Free in row 10: points only have a mass here" in capsys.readouterr().err


WRONG = {  # of an example: what stands there, what is there instead, what is said
    SETTINGS: {
        "law": ("profile_law: 2", "profile_law: 5", "row 26: environment.profile_law is 5; it must be 0 (constant), 1"),
        "number": ("cd_tether: 1.0", "cd_tether: abc", "row 13: tether.cd_tether is 'abc'; it must be a finite"),
        "range": ("d_tether:  3.0", "d_tether: -3.0", "row 12: tether.d_tether: diameter is -0.003; it must be"),
        "several": (
            "l_tether: 200.0",
            "l_tethers: [200, 0, 199]",
            "row 6: initial.l_tethers: initial_length is 0.0; it must be at least",
        ),
        "two names": (
            "c_spring: 350000.0",
            "c_spring: 350000.0\n    axial_stiffness: 700000.0",
            "row 15: tether.c_spring is 350000.0, and tether.axial_stiffness in row 16 is 700000.0; they are names of one",
        ),
        "twice": ("cd_tether: 1.0", "cd_tether: 1.0\n    cd_tether: 1.1", "row 14: tether.cd_tether is in row 13, too"),
        "flag": ("v_wind: 9.0", "use_wind_vec: maybe", "row 18: environment.use_wind_vec is 'maybe'; it must be true or"),
        "length": ("l_tether:", "no_length:", "initial.l_tethers (l_tether), the length of the tether, is missing"),
        "program": ("\ntether:", "\nrope:", "is neither a file of settings of KiteUtils.jl"),
        "margin": ("    cd_tether: 1.0", "  cd_tether: 1.0", "row 13: it is not YAML: expected <block end>"),
        "bracket": ("l_tether: 200.0", "l_tethers: [200, 0", "it is not YAML: "),
        "tab": ("    cd_tether: 1.0", "\tcd_tether: 1.0", "row 13: it is not YAML: found character '\\t'"),
        "control": ("cd_tether: 1.0", "cd_tether: \x01", "row 13: it is not YAML: special characters are not"),
        "nested": ("cd_tether: 1.0", "cd_tether: [[1.0], 2]", "row 13: tether.cd_tether is '[1.0]'; it must be"),
        "pairs": ("cd_tether: 1.0", "cd_tether: {a: 1.0}", "row 13: tether.cd_tether is '{a: 1.0}'; it must be"),
        "deep": ("cd_tether: 1.0", f"cd_tether: {3000 * '['}", "its lists are nested too deeply"),
    },
    MOORED: {
        "body": ("4    Coupled", "4    Body1  ", "row 14: it is on body 1, which is not in this file"),
        "turbine": ("4    Coupled", "4    Turbine1", "row 14: Attachment is 'Turbine1'; it must be Fixed, Coupled, Free or"),
        "rod": ("2    rope      2  ", "2    rope      R2b  ", "row 19: it is attached to rod 2, which is not in this file"),
        "curve": ("614600   473", "curve.dat 473", "row 6: EA is 'curve.dat'; it must be a number: a tether has one"),
        "place": ("4    Coupled     0 ", "4    Coupled     x ", "row 14: X is 'x'; it must be a finite number"),
        "end": ("2    rope      2  ", "2    rope      9  ", "row 19: it is attached to 9, which is not a point of this"),
        "type": ("2    rope ", "2    cord ", "row 19: LineType is 'cord'; there are rope, wire"),
        "diameter": ("wire       0.001", "wire       thin ", "row 7: Diam is 'thin'; it must be a finite number"),
        "infinite": ("wire       0.001", "wire       inf  ", "row 7: Diam is 'inf'; it must be a finite number"),
        "segments": ("30.6      6 ", "30.6    400 ", "row 20: lines.line3.segments is 400; it must be at least 1"),
        "half": ("30.6      6 ", "30.6    6.5 ", "row 20: NumSegs is 6.5; it must be a whole number"),
        "mass": ("0.14      80000", "99 80000", "row 20: lines.line3.mass_per_length is 99.0; it must be at least"),
        "short": ("3    wire      3        4        30.6", "3 wire 3 #", "row 20: it has 3 columns; it must have at"),
        "version": (
            "473       0        0.96  0    0     0",
            "473       1.0   0.0    0.96     0",
            "row 6: it has 9 columns; it must have at least 10: Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx; MoorDyn",
        ),
        "option": ("9.81    g", "low     g", "row 23: g is 'low'; it must be a finite number"),
        "no lines": ("--- LINES ---", "--- ROPES ---", "it has no lines (v2: sections LINE TYPES, POINTS and LINES)"),
    },
}


@pytest.mark.parametrize(("path", "name"), [(path, name) for path, each in WRONG.items() for name in each])
def test_a_wrong_file_is_told_with_its_row(path, name, tmp_path, capsys):
    old, new, said = WRONG[path][name]
    out, status = imported(path, tmp_path, change=(old, new))
    assert status == 2
    assert not out.exists()
    error = capsys.readouterr().err
    assert error.startswith(f"{tmp_path / path.name}: ")
    assert said in error
    assert error.count("\n") == 1


def test_a_file_that_is_there_is_not_replaced(tmp_path, capsys):
    (tmp_path / "made.toml").write_text("mine", encoding="utf-8")
    assert main(["import", str(SETTINGS), "--out", str(tmp_path / "made.toml")]) == 2
    assert "made.toml exists already; choose another file with --out" in capsys.readouterr().err
    assert (tmp_path / "made.toml").read_text(encoding="utf-8") == "mine"
