"""A scene through FMPy: the FMU gives the force that the Python API gives, bit for bit, and its cost is measured."""

import pytest

from benchmark.hosted import hosted
from study.scenes_of_tests import written
from tetherfmu.files.scene_files import load
from tetherfmu.study.measuring.fmus import fmus_in
from tetherfmu.study.measuring.runs import Config, fmu_of, run


@pytest.mark.parametrize("config", [Config("catenary", 0, 0.0, 0.02), Config("dynamic", 6, 1e-3, 0.02)])
def test_fmu_flies_the_scene_as_the_python_api_does(fmu_folder, tmp_path, config):
    scene = load(written(tmp_path))
    ((_, costs, force),) = hosted(fmus_in(fmu_folder)[fmu_of(scene, config)], scene, config)
    assert force == run(scene, config).flown.kite_force[-1].tolist()
    assert 0.0 < costs.sum() < scene.duration
