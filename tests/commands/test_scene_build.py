"""The FMU of one scene has no more than the scene needs, and gives the force that the Python API gives."""

import zipfile

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from build_fmus import main
from isolation import in_own_process
from study.scenes_of_tests import SCENE, written
from tetherfmu.files.scene_files import load
from tetherfmu.study.advice.scene_advice import advise
from tetherfmu.study.advice.scene_build import needed
from tetherfmu.study.measuring.runs import run
from tetherfmu.study.measuring.scene_fmus import inputs_of
from tetherfmu.wiring.variables import variables

WINCH = ("reel_out_speed", "winch_force", "winch_length")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene_build")
    assert main(["--scene", str(written(folder)), "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def fmu(folder):
    (path,) = folder.glob("*_short.fmu")
    return path


def test_a_scene_that_asks_for_power_keeps_what_it_is_made_of():
    """Tension and speed at the winch; without `winch_speed` nobody could compute it."""
    scene = load("reel")
    assert "power" in scene.wanted.outputs
    _, asked = needed(scene, inputs_of(scene, 0.1), variables("dynamic", 0))
    assert {"ground_tension", "winch_speed", "kite_force"} <= {*asked}


def test_only_what_the_scene_needs(fmu):
    """The circle has wind and a fixed ground end, and asks for the force on the kite; a winch may be controlled any way."""
    description = read_model_description(fmu)
    names = {"input": set(), "output": set(), "local": set(), "parameter": set()}
    for variable in description.modelVariables:
        names[variable.causality].add(variable.name.partition("[")[0])
    assert names["input"] == {"kite_position", "kite_velocity", "wind_velocity", *WINCH}
    assert (names["output"], names["local"]) == ({"kite_force"}, set())
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        assert "documentation/licenses/license.txt" in archive.namelist()


def test_start_values_are_those_of_the_scene(fmu):
    start = {variable.name: variable.start for variable in read_model_description(fmu).modelVariables}
    assert float(start["initial_length"]) == 505.0
    assert float(start["wind_velocity[1]"]) == 8.0
    assert start["initial_shape"] == "2"
    assert all(len(value.lstrip("-").replace(".", "")) <= 12 for value in start.values() if value)


def test_the_default_experiment_is_the_scene(folder, fmu):
    scene, experiment = load(folder / "short.toml"), read_model_description(fmu).defaultExperiment
    assert float(experiment.stopTime) == scene.duration != 10.0


@in_own_process
@pytest.mark.parametrize(
    "control", [{"winch_control": 2, "winch_start": 2, "winch_force": 900.0}, {"winch_control": 3, "winch_length": 505.0}]
)
def test_any_control_of_the_winch_works(fmu, control):
    from runtime.host import Host

    host = Host(fmu).start(**control)
    host.step(0.02)
    assert host.messages == []


def test_description_says_what_was_left_out(fmu):
    description = read_model_description(fmu).description
    for words in ("scene short", "expected error", "Left out", "ground_velocity", "ground_force"):
        assert words in description
    with zipfile.ZipFile(fmu) as archive:
        page = archive.read("documentation/index.html").decode("utf-8")
    assert "measured against dynamic" in page
    for name in ("wind_velocity[1..3]", "winch_force", "kite_force[1..3]", "axial_stiffness"):
        assert f"<td><code>{name}</code></td>" in page
    assert "$" not in page


@in_own_process
def test_it_flies_as_the_python_api_does(folder, fmu):
    from runtime.host import Host

    scene = load(folder / "short.toml")
    config = advise(scene).point.config
    rows = scene.inputs(config.step)
    host = Host(fmu).start(kite_position=rows[0][0:3], kite_velocity=rows[0][3:6])  # its own have 12 digits
    for row in rows:
        host.step(config.step, kite_position=row[0:3], kite_velocity=row[3:6])
    assert host.get("kite_force") == run(scene, config).flown.kite_force[-1].tolist()


def test_a_wrong_scene_is_told(tmp_path, capsys):
    assert main(["--scene", str(written(tmp_path, SCENE.replace("505 m", "5 kg")))]) == 2
    assert "tether.initial_length is '5 kg'" in capsys.readouterr().err


def test_a_setting_is_one_of_the_scene(tmp_path, capsys):
    """A diameter scales the stiffness of the tether that is advised; what a scene has is not set behind its back."""
    scene = written(tmp_path)
    assert main(["--scene", str(scene), "--set", "diameter=5 mm", "--inputs", "motion", "--out", str(tmp_path)]) == 0
    (path,) = tmp_path.glob("*_short.fmu")
    start = {each.name: each.start for each in read_model_description(path).modelVariables}
    assert float(start["axial_stiffness"]) == pytest.approx(614600.0 * (5.0 / 4.0) ** 2, rel=1e-9)
    assert "wind_velocity[1]" not in start
    scene.write_text(scene.read_text() + "\n[build.set]\ndiameter = 0.005\n")
    assert main(["--scene", str(scene), "--out", str(tmp_path)]) == 2
    assert "build.set has diameter, which is tether.diameter in a scene: set it there" in capsys.readouterr().err
