"""Nothing is implausible in the scenes that the examples and the studies fly, in no communication step.

Their paths are smooth formulas or logged flights of kites, on tethers near the distance of the kite. That some of them hang
below their station, where no ground is asked for, is said and meant so.
"""

from pathlib import Path

import pytest

from advice.random_scenes import random_scenes
from benchmark.scenes import circle_scene, figure_of_eight_scene
from tetherfmu.files.scene_files import load
from tetherfmu.study.measuring.runs import Config, run

FILES = sorted((Path(__file__).parents[2] / "examples" / "scenes").glob("*.toml"))
SCENES = [*map(load, FILES), circle_scene(10), figure_of_eight_scene(10), *random_scenes(16, seed=77)]


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
@pytest.mark.parametrize("step", [0.001, 0.02, 0.1])
def test_straight(scene, step):
    assert run(scene, Config("straight", 0, 0.0, step)).implausible == ()


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_dynamic(scene):
    said = run(scene, Config("dynamic", 8, 1e-3, 0.02)).implausible
    assert [each for each in said if "below ground_height with both ends above it" not in each] == []
