"""The flight of a CSV file: FMUs fly it as the Python API does, whatever leads its winch; what cannot be used is named."""

import base64
import json
import re
import shutil

import numpy as np
import pytest

from first_flight.logged_flight import given_inputs, scene_of
from running import EXAMPLES, assert_is_drawn, run_code, status_of
from study.scenes_of_tests import swaying, write_series

LOG = EXAMPLES / "scenes" / "logged_flight.csv"  # 20 s at 4 Hz, with reel-out speed and wind
FLY = "import sys; from tetherfmu.commands.fly import main; sys.exit(main(sys.argv[1:]))"
TIME = np.arange(0.0, 4.01, 0.1)
HEAVE = 0.5  # m
SHIP = np.column_stack([5.0 * TIME, 0.0 * TIME, 2.0 + HEAVE * np.sin(TIME)])
KITE, VELOCITY = swaying(TIME)
LOGS = {  # columns of files
    "plain": {"kite_position": KITE},
    "length": {"kite_position": KITE, "winch_length": 502.0 + 0.4 * np.sin(TIME)},
    "logged length": {"kite_position": KITE, "kite_velocity": VELOCITY, "tether_length": 502.0 + 0.4 * np.sin(TIME)},
    "force": {"kite_position": KITE, "winch_force": 400.0 + 30.0 * np.sin(TIME)},
    "ship": {"kite_position": KITE + SHIP, "ground_position": SHIP, "reel_out_speed": 0.2 * np.cos(TIME)},
    "released": {"kite_position": KITE, "release": (TIME > 1.95) * 1.0},
    "drone": {"kite_position": np.column_stack([0.0 * TIME, 0.0 * TIME, 30.0 + TIME]), "winch_length": 30.5 + TIME},
}


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Folder with a file of each of `LOGS`."""
    folder = tmp_path_factory.mktemp("logs")
    for name, columns in LOGS.items():
        write_series(folder / f"{name}.csv", TIME, columns)
    return folder


def done(code, *arguments, cwd=None):
    """What code prints in a process of its own, which must end cleanly."""
    finished = run_code(code, *arguments, cwd=cwd)
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


# --- the numbers

AS_IN_PYTHON = """
import json, sys
import numpy as np
from first_flight import logged_flight
from tetherfmu.runtime.variants import class_name
from tetherfmu.study.measuring.start import tether_at_start

folder, log, length, wind, settings, variants = map(json.loads, sys.argv[1:])
scene = logged_flight.scene_of(log, length, wind)
settings = dict(map(logged_flight.setting, settings))
inputs = scene.inputs(0.02)
for variant in variants:
    given = logged_flight.given_inputs(scene.flight, wind is not None or scene.flight.wind is not None)
    parameters = logged_flight.parameters_of(scene) | settings
    flight = logged_flight.fly(f"{folder}/{class_name(variant)}.fmu", scene, given, parameters)
    tether = tether_at_start(scene, 0.0, variant, inputs[0], winch_control=parameters["winch_control"], **settings)
    flown = tether.fly(inputs, 0.02)
    assert np.array_equal(flight.time, 0.02 * np.arange(len(inputs) + 1))
    for end in ("kite_force", "ground_force"):  # bit for bit: the same kernels
        assert np.array_equal(getattr(flight, end)[1:], getattr(flown, end)), (variant, end)
    print(json.dumps([flown.of("tether_length").tolist(), flown.of("ground_tension").tolist()]))
"""


def as_in_python(folder, log, length=None, wind=None, settings=(), variants=("dynamic", "catenary")):
    """Lengths [m] and tensions at the ground [N] after the steps of 20 ms of variants, which FMU and Python agree on."""
    arguments = map(json.dumps, (str(folder), str(log), length, wind, settings, variants))
    lines = [line for line in done(AS_IN_PYTHON, *arguments).splitlines() if not line.startswith("[WARNING]")]
    return [map(np.array, json.loads(line)) for line in lines]


def test_the_forces_are_those_of_python(fmu_folder):
    ((lengths, _), _) = as_in_python(fmu_folder, LOG, 220.3)
    assert len(lengths) == 1000
    speed = np.loadtxt(LOG, delimiter=",", skiprows=1, usecols=4)
    assert lengths[-1] == pytest.approx(220.3 + np.trapezoid(speed, dx=0.25), abs=0.05)  # of the curves between the rows


def test_parameters_of_the_fmu_can_be_set(fmu_folder, logs):
    settings = ["diameter=0.006", "segments=8", "wind_profile=power_law", "wind_exponent=0.2", "gravity=9.7"]
    as_in_python(fmu_folder, logs / "plain.csv", 501.0, (8.0, 1.0, 0.0), settings)


@pytest.mark.parametrize("name", ["length", "logged length"])
def test_the_winch_follows_a_length(fmu_folder, logs, name):
    for lengths, _ in as_in_python(fmu_folder, logs / f"{name}.csv"):
        due = 502.0 + 0.4 * np.sin(0.02 * np.arange(1, 201))
        np.testing.assert_allclose(lengths, due, rtol=0, atol=2e-3)  # of the curve between the rows


def test_the_winch_follows_a_force(fmu_folder, logs):
    for _, tensions in as_in_python(fmu_folder, logs / "force.csv", 502.0):
        due = 400.0 + 30.0 * np.sin(0.02 * np.arange(2, 201))  # from the second step on: nobody knows the rate in the first
        # within a step of h the force goes on linearly, h^2 30 N/s2; and the curve between the rows is not the sine
        np.testing.assert_allclose(tensions[1:], due, rtol=0, atol=0.02**2 * 30.0 + 0.05)


def test_the_kite_is_let_go(fmu_folder, logs):
    """From the row on whose release is 1: the winch then holds a rope that falls, an end of which pulls at nobody."""
    ((_, tensions),) = as_in_python(fmu_folder, logs / "released.csv", 500.0, variants=["dynamic"])
    assert tensions[:100].min() > 100.0  # N: taut until 2 s
    # the rope whips, but once the waves have passed, what falls pulls with less than its weight in the mean
    assert np.abs(tensions[120:]).mean() < 0.25 * np.pi * 0.004**2 * 724.0 * 500.0 * 9.81


def test_the_ground_station_moves(fmu_folder, logs):
    ((lengths, _),) = as_in_python(fmu_folder, logs / "ship.csv", 502.0, variants=["dynamic"])
    assert lengths[-1] == pytest.approx(502.0 + 0.2 * np.sin(4.0), abs=1e-3)  # of the curve between the rows


def test_inputs_without_columns_are_left_to_the_fmu(logs):
    kite = ["kite_position", "kite_velocity"]
    assert given_inputs(scene_of(logs / "plain.csv", 502.0).flight, False) == kite
    by_length = given_inputs(scene_of(logs / "length.csv").flight, True)
    assert by_length == [*kite, "reel_out_speed", "winch_length", "wind_velocity"]
    ship = scene_of(logs / "ship.csv", 502.0).flight
    assert given_inputs(ship, False) == [*kite, "ground_position", "ground_velocity", "reel_out_speed"]


# --- what is written


def curves(page):
    """Dict name -> array (n, 3) of the curves in space that a page shows first."""
    text = page.read_text(encoding="utf-8")
    traces, _ = json.JSONDecoder().raw_decode(text, text.index("[", text.index("Plotly.newPlot(")))

    def numbers(column):
        packed = isinstance(column, dict)
        return np.frombuffer(base64.b64decode(column["bdata"]), column["dtype"]) if packed else np.array(column)

    return {each.get("name"): np.column_stack([numbers(each[axis]) for axis in "xyz"]) for each in traces}


def test_all_tethers_share_figures_and_a_page_with_the_path(fmu_folder, tmp_path):
    (tmp_path / "dist").symlink_to(fmu_folder, target_is_directory=True)
    options = ("--length", 220.3, "--duration", 5, "--tether", "all", "--html", "--ground", "--out", "out")
    *lines, first_shape, forces, shapes, page = done(FLY, LOG, *options, cwd=tmp_path).splitlines()
    said = [re.sub(r"[\d.]+ N|\d+ times", "#", line) for line in lines if not line.startswith(" ")]
    tethers = ("TetherDynamic", "TetherQuasiSteady", "TetherCatenary", "TetherStraight")
    assert said == [f"{name}: |ground| #, |kite| # at most; 250 steps; # real time" for name in tethers]
    assert [first_shape, forces, shapes] == [f"out/{name}.png" for name in ("first_shape", "forces", "shapes")]
    for figure in (first_shape, forces, shapes):
        assert_is_drawn(tmp_path / figure)
    assert page == "out/logged_flight.html"
    shown = curves(tmp_path / page)
    assert set(shown) >= {*tethers, "ground", "path of the kite"}
    assert "<title>Tether along the flight of logged_flight.csv</title>" in (tmp_path / page).read_text(encoding="utf-8")
    rows = np.loadtxt(LOG, delimiter=",", skiprows=1)[:21, 1:4]
    # In the first step the kite is led to where its velocity takes it, without the acceleration a: a h^2/2 = 1 mm.
    np.testing.assert_allclose(shown["path of the kite"][::25], rows[::2], rtol=0, atol=2e-3)
    assert np.all(shown["ground"][:, 2] == 0.0)


def test_the_ground_is_where_the_station_is_and_its_path_is_drawn(fmu_folder, logs, tmp_path):
    """A name with characters that HTML needs is shown as it is; a height of one's own moves the ground."""
    odd = shutil.copy(logs / "ship.csv", tmp_path / "a&b.csv")
    fmu = ("--fmu", fmu_folder / "TetherDynamic.fmu", "--length", 510.0, "--ground", "--html", "--duration", 3)
    done(FLY, odd, *fmu, "--out", tmp_path)
    done(FLY, odd, *fmu, "--set", "ground_height=-20", "--out", tmp_path / "lower")
    shown = curves(tmp_path / "a&b.html")
    assert np.all(shown["ground"][:, 2] == 2.0)
    np.testing.assert_allclose(np.ptp(shown["path of the ground station"], axis=0), [15.0, 0.0, HEAVE], atol=1e-3)
    assert "<h1>Tether along the flight of a&amp;b.csv</h1>" in (tmp_path / "a&b.html").read_text(encoding="utf-8")
    assert np.all(curves(tmp_path / "lower" / "a&b.html")["ground"][:, 2] == -20.0)


def test_a_kite_above_its_winch_is_drawn(fmu_folder, logs, tmp_path):
    """There is no vertical plane through both; nothing is divided by its length."""
    strict = f"import warnings; warnings.simplefilter('error', RuntimeWarning); {FLY}"
    done(strict, logs / "drone.csv", "--fmu", fmu_folder / "TetherDynamic.fmu", "--wind", 6, 0, 0, "--out", tmp_path)
    for name in ("first_shape", "forces", "shapes"):
        assert_is_drawn(tmp_path / f"{name}.png")


def test_noise_is_told(fmu_folder, tmp_path):
    noisy = {"kite_position": KITE + 0.02 * np.random.default_rng(1).normal(size=KITE.shape)}
    options = ("--fmu", fmu_folder / "TetherStraight.fmu", "--length", 501, "--out", tmp_path)
    finished = run_code(FLY, write_series(tmp_path / "noise.csv", TIME, noisy), *options)
    assert finished.returncode == 0
    (line,) = finished.stderr.splitlines()
    assert re.search(r"noise\.csv: the positions scatter by about 0\.0\d+ m from row to row, which shakes .* smooth", line)


# --- what cannot be flown

WRONG = [  # what is typed behind `tetherfmu fly`, what must be said
    ("none.csv --length 505", ("none.csv", "No such file")),
    ("folder --length 505", ("folder", "not a regular file")),
    ("text.csv --length 505", ("text.csv", "row 5, column kite_position[1] has no number")),
    ("plain.csv", ("plain.csv", "no column winch_length", "--length")),
    ("length.csv --length 505", ("length.csv", "begins with 502 m", "--length")),
    ("column.csv --length 505", ("column.csv", "unknown column 'kite_height[3]'", "kite_position[3]")),
    ("plain.csv --length 505 --rate 1", ("tetherfmu fly", "--rate", "FLIGHT.csv")),
    ("plain.csv --length 505 --set diametre=0.01", ("--set", "'diametre=0.01'", "did you mean diameter?")),
    ("plain.csv --length 505 --set diameter", ("--set", "diameter is ''", "at most 10 m")),
    ("plain.csv --length 505 --set diameter=40", ("--set", "diameter is 40.0", "at most 10 m")),
    ("plain.csv --length 505 --set segments=8.5", ("--set", "segments is 8.5", "whole number")),
    ("plain.csv --length 505 --set wind_profile=linear", ("--set", "wind_profile is 'linear'", "2 (power_law)")),
    ("plain.csv --length 505 --set winch_control=2", ("--set", "winch_control", "columns of FLIGHT.csv")),
    ("plain.csv --length 505 --step 0", ("--step", "'0'", "at least 1e-06 s")),
    ("plain.csv --length 505 --step 30", ("flight of 4 s", "communication step of 30 s")),
    ("plain.csv --length 505 --duration 30", ("plain.csv", "flight of 4 s", "--duration is 30 s")),
    ("plain.csv --length 0.001", ("plain.csv", "initial_length is 0.001", "at least 0.01 m")),
    ("plain.csv --length 505 --segments 3", ("there is no option --segments; did you mean --set?",)),
    ("plain.csv other.csv --length 505", ("unrecognized arguments: other.csv",)),
    ("wind.csv --length 220.3 --wind 8 0 0", ("wind.csv", "wind_velocity", "--wind")),
    ("empty.csv --length 505", ("empty.csv", "has 0 lines", "a header row")),
    ("head.csv --length 505", ("head.csv", "has 1 lines", "at least 4 rows")),
    ("twice.csv --length 505", ("twice.csv", "column kite_position[1] appears twice")),
    ("far.csv --length 505", ("far.csv", "row 2, column kite_position[1]", "at most 1e+09")),
    ("--set initial_length=510", ("tetherfmu fly", "--set", "initial_length follows from --length")),
]


@pytest.fixture(scope="module")
def place(logs, tmp_path_factory):
    """Folder with files that can be used, and others."""
    place = tmp_path_factory.mktemp("wrong") / "place"
    shutil.copytree(logs, place)
    shutil.copy(LOG, place / "wind.csv")
    (place / "folder").mkdir()
    lines = (logs / "plain.csv").read_text().splitlines()
    head, first = lines[0], lines[1].split(",")
    broken = {
        "text": [*lines[:4], lines[4].replace(",", ",fog", 1), *lines[5:]],
        "column": [head.replace("kite_position[3]", "kite_height[3]"), *lines[1:]],
        "empty": [],
        "head": [head],
        "twice": [f"{line},{line.split(',')[1]}" for line in lines],
        "far": [head, ",".join([first[0], "1e300", *first[2:]]), *lines[2:]],
    }
    for name, written in broken.items():
        (place / f"{name}.csv").write_text("".join(f"{line}\n" for line in written))
    return place


@pytest.mark.parametrize(("line", "says"), WRONG, ids=[line for line, _ in WRONG])
def test_wrong_use_is_told_in_one_line(place, monkeypatch, capsys, line, says):
    monkeypatch.chdir(place)
    before = sorted(place.rglob("*"))
    assert status_of("fly", *line.split(" ")) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1, said
    assert all(each in said for each in says), said
    assert sorted(place.rglob("*")) == before


def test_help_has_both_flights(capsys):
    assert status_of("fly", "--help") == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "along a circle, a scene, or the flight of a CSV file" in said
    assert "kite_position[3]" in said
    assert "--rate" in said
