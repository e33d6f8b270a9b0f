"""The FMU of one scene has no more than the scene needs, and gives the force that the Python API gives."""

import zipfile

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from build_fmus import main
from isolation import in_own_process
from study.scenes_of_tests import SCENE, written
from tetherfmu.study.advice.advise import advise
from tetherfmu.study.measuring.runs import run
from tetherfmu.study.scenes.files import load


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene_build")
    assert main(["--scene", str(written(folder)), "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def fmu(folder):
    (path,) = folder.glob("*_short.fmu")
    return path


def test_only_what_the_scene_needs(fmu):
    """The circle has wind, a fixed ground end and no reel, and asks for the force on the kite."""
    description = read_model_description(fmu)
    names = {"input": set(), "output": set(), "parameter": set()}
    for variable in description.modelVariables:
        names[variable.causality].add(variable.name.partition("[")[0])
    assert names["input"] == {"kite_position", "kite_velocity", "wind_velocity"}
    assert names["output"] == {"kite_force"}
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        assert "documentation/licenses/license.txt" in archive.namelist()


def test_start_values_are_those_of_the_scene(fmu):
    start = {variable.name: variable.start for variable in read_model_description(fmu).modelVariables}
    assert float(start["initial_length"]) == 505.0
    assert float(start["wind_velocity[1]"]) == 8.0
    assert start["initial_shape"] == "2"


def test_description_says_what_was_left_out(fmu):
    description = read_model_description(fmu).description
    for words in ("scene short", "expected error", "Left out", "reel_out_speed", "ground_force"):
        assert words in description
    with zipfile.ZipFile(fmu) as archive:
        assert "measured against dynamic" in archive.read("documentation/index.html").decode("utf-8")


@in_own_process
def test_it_flies_as_the_python_api_does(folder, fmu):
    from runtime.host import Host

    scene = load(folder / "short.toml")
    config = advise(scene).point.config
    host = Host(fmu).start()
    for row in scene.inputs(config.step):
        host.step(config.step, kite_position=row[0:3], kite_velocity=row[3:6])
    assert host.get("kite_force") == run(scene, config).flown.kite_force[-1].tolist()


def test_a_wrong_scene_is_told(tmp_path, capsys):
    assert main(["--scene", str(written(tmp_path, SCENE.replace("505 m", "5 kg")))]) == 2
    assert "tether.initial_length is '5 kg'" in capsys.readouterr().err
