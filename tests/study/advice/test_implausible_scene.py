"""The advice for a scene that no tether can be in says so."""

from dataclasses import replace
from pathlib import Path

from tetherfmu.files.scene_files import load
from tetherfmu.study.advice.advise import FAST_BUDGET, advise, explain

SCENE = load(Path(__file__).parents[3] / "examples" / "scenes" / "parked.toml")


def warnings_in(scene):
    return [line for line in explain(scene, advise(scene, FAST_BUDGET)).splitlines() if line.startswith("  warning   ")]


def test_a_tether_of_a_fifth_of_the_distance():
    scene = replace(SCENE, tether=replace(SCENE.tether, initial_length=SCENE.tether.initial_length / 5.0))
    (line,) = warnings_in(scene)
    assert "a segment is stretched by" in line


def test_a_plausible_scene():
    assert warnings_in(SCENE) == []
