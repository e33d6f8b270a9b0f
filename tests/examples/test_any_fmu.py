"""The examples take any tether FMU, one of a scene with few inputs and outputs, too, or say what it lacks."""

import re
import sys
from importlib import import_module

import pytest

from running import EXAMPLES, run, run_code, run_python
from study.scenes_of_tests import SCENE, written
from tetherfmu.commands.build import main as build

UNDRAWN = "from matplotlib.figure import Figure; Figure.savefig = lambda *given, **options: None; "
LOG = EXAMPLES / "scenes" / "logged_flight.csv"
OF_LOG = ("--length", "220.3", "--duration", "2", "--set", "wind_profile=power_law", "--set", "segments=8")


@pytest.fixture(scope="module")
def place(built_once):
    """Folder with FMUs of two scenes, which ask for the force on the kite only, one without wind; and one without shape."""

    def make(folder):
        for scene in (written(folder), written(folder, SCENE.replace("8.0", "0.0"), "calm")):
            assert build(["--scene", str(scene), "--out", str(folder)]) == 0
        assert build(["catenary", "--shape-points", "0", "--out", str(folder)]) == 0
        assert build(["quasi_steady", "--wind-points", "3", "--out", str(folder)]) == 0

    return built_once("any_fmu", make)


def of_scene(place, name="short"):
    (path,) = place.glob(f"*_{name}.fmu")
    return path


def test_an_fmu_of_a_scene_flies_the_circle(place, tmp_path):
    fmu = of_scene(place)
    options = ("--fmu", fmu, "--duration", 1, "--wind", 8, 0, 0, "--out", tmp_path)
    done = run_python(EXAMPLES / "first_flight" / "circular_flight.py", *options)
    assert done.returncode == 0, done.stderr
    assert done.stderr == f"{fmu} has no output ground_force and no shape: not shown\n"
    assert re.search(r"_short: \|kite\| \d+\.\d N at most; 50 steps", done.stdout)
    assert [path.name for path in tmp_path.iterdir()] == ["forces.png"]


@pytest.mark.parametrize(
    ("arguments", "ignored"),
    [
        (["fly", "--wind", "8", "0", "0"], "wind_velocity"),
        (["fly", str(LOG), "--length", "220.3"], "wind_velocity"),
        (["fly", "no_wind.csv", "--length", "220.3", "--set", "wind_profile=power_law"], "wind_profile"),
    ],
    ids=["circle", "log", "profile"],
)
def test_an_fmu_with_wind_at_points_does_not_fly_as_if_without_wind(arguments, ignored, place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with LOG.open() as log:
        kept = [",".join(line.split(",")[:4]) for line in log.read().splitlines()]
    (tmp_path / "no_wind.csv").write_text("\n".join(kept))
    fmu = place / "TetherQuasiSteady.fmu"
    done = run_python("-m", "tetherfmu", *arguments, "--fmu", fmu, "--out", tmp_path / "out")
    assert done.returncode == 2
    refusal = f"{fmu} has inputs wind_at and ignores {ignored}; take one built without --wind-points"
    assert done.stderr.splitlines()[-1] == refusal  # after the line of the log about stretch, if any


def test_an_fmu_without_shape_is_held_in_the_wind(fmu_folder, place, tmp_path):
    own = place / "TetherCatenary.fmu"
    options = ["--fmu", str(own), "--out", str(tmp_path)]
    said = run(fmu_folder, f"from at_rest import forces_over_wind_and_slack as e; e.main({options})")
    names = [line.split(":")[0] for line in said.splitlines() if "the load on the shape" not in line]
    assert names == ["dynamic", "TetherCatenary"]
    assert (tmp_path / "forces_over_wind_and_slack.png").exists()


def test_an_fmu_of_ones_own_beside_the_catenary(fmu_folder, tmp_path):
    options = ["--fmu", str(fmu_folder / "TetherDynamic.fmu"), "--out", str(tmp_path)]
    said = run(fmu_folder, f"from at_rest import catenary; catenary.main({options})")
    assert [line.split(":")[0] for line in said.splitlines()] == ["catenary", "TetherDynamic"]


def test_what_an_fmu_lacks_is_named(dist, place, monkeypatch, capsys):
    """Nothing is loaded before that."""
    monkeypatch.chdir(dist.parent)
    for name, options, wrong, words in (
        ("at_rest.catenary", (), dist / "TetherDynamicFree.fmu", "free kite end"),
        ("at_rest.forces_over_wind_and_slack", (), of_scene(place), "has no variable ground_force"),
        ("first_flight.logged_flight", (str(LOG), *OF_LOG), of_scene(place, "calm"), "has no variable wind_velocity"),
        ("coupling.mooring", (), dist / "TetherDynamicFree.fmu", "has a free kite end"),
        ("coupling.iterated_master", (), dist / "TetherDynamicFree.fmu", "has a free kite end"),
        ("power_system.pumping_cycle", (), dist / "TetherDynamic.fmu", "has no free kite end"),
    ):
        assert import_module(name).main([*options, "--fmu", str(wrong)]) == 2
        assert words in capsys.readouterr().err
    assert "fmpy.fmi2" in sys.modules


def test_a_mooring_with_legs_of_ones_own(fmu_folder):
    options = ["--fmu", str(fmu_folder / "TetherQuasiSteady.fmu"), "--quick"]
    *_, last = run(fmu_folder, f"from coupling import mooring; mooring.main({options})").splitlines()
    assert float(re.search(r"([\d.]+) %", last)[1]) > 1.0  # its legs carry no waves; those of TetherDynamic have 0.4 %


@pytest.mark.parametrize(
    ("name", "tether", "options"),
    [
        ("first_flight.circular_flight", "TetherDynamic", ("--duration", "2", "--wind", "8", "0", "0", "--out", "plots")),
        ("first_flight.logged_flight", "TetherDynamic", (LOG, *OF_LOG, "--out", "plots")),
        ("at_rest.catenary", "TetherCatenary", ("--out", "plots")),
        ("coupling.mooring", "TetherQuasiSteady", ("--quick",)),
        ("coupling.iterated_master", "TetherStraight", ("--duration", "0.1")),
    ],
)
def test_fmi_3_gives_the_numbers_of_fmi_2(dist, native_folder, fmi3_folder, name, tether, options):
    """What each example prints of an FMU of one's own, but for how fast it was."""
    said = []
    for folder in (native_folder, fmi3_folder):
        code = f"{UNDRAWN}import sys; from {name} import main; sys.exit(main(sys.argv[1:]))"
        done = run_code(code, "--fmu", folder / f"{tether}.fmu", *options, cwd=dist.parent)
        assert done.returncode == 0, done.stderr
        said.append(re.sub(r"[\d.]+ times real time|\d+ ms for a second", "", done.stdout))
    assert said[0] == said[1]
    assert re.search(r"\d\.\d", said[0])
