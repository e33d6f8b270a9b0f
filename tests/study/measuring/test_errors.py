"""Errors of a flight: each by its formula, on flights made up for it."""

import numpy as np
import pytest

from study.scenes_of_tests import SCENE, written
from tetherfmu import Flown
from tetherfmu.files.scene_files import OUTPUTS, load
from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring.errors import errors, settled
from tetherfmu.study.measuring.runs import SHAPE_POINTS


@pytest.fixture
def scene(tmp_path):
    return load(written(tmp_path, SCENE + 'outputs = ["shape"]\n'))


def made_up(scene, force=(3.0, 0.0, 4.0), length=500.0, wave_time=0.0):
    """A flight with a constant force on the kite [N], tether length [m] and wave time [s]."""
    outputs = np.zeros((scene.count, at.outputs_size(SHAPE_POINTS)))
    for place in (at.KITE_FORCE, at.GROUND_FORCE):
        outputs[:, place : place + 3] = force
    outputs[:, at.TETHER_LENGTH], outputs[:, at.WAVE_TIME] = length, wave_time
    return Flown(outputs, np.full(scene.count, np.linalg.norm(force)), None, 0.0)


def test_a_run_against_itself_has_no_error(scene):
    assert errors(scene, made_up(scene), made_up(scene)) == dict.fromkeys(OUTPUTS, 0.0)


def test_a_larger_force_of_the_same_direction(scene):
    found = errors(scene, made_up(scene, (3.3, 0.0, 4.4)), made_up(scene))
    for name in ("kite_force", "ground_force", "peak_force", "power"):
        assert found[name] == pytest.approx(0.1)
    assert found["kite_direction"] == pytest.approx(0.0, abs=1e-12)


def test_a_turned_force_of_the_same_size(scene):
    """A turn by the angle a moves the end of a unit vector by 2 sin(a/2)."""
    angle = 0.1
    turned = (5.0 * np.cos(angle), 5.0 * np.sin(angle), 0.0)
    found = errors(scene, made_up(scene, turned), made_up(scene, (5.0, 0.0, 0.0)))
    assert found["kite_direction"] == pytest.approx(2.0 * np.sin(angle / 2.0))
    assert found["kite_force"] == pytest.approx(0.0, abs=1e-12)


def test_shape_is_relative_to_the_length(scene):
    run = made_up(scene)
    run.outputs[:, at.SHAPE :: 3] += 5.0
    assert errors(scene, run, made_up(scene))["shape"] == pytest.approx(0.01)


@pytest.mark.parametrize(("wave_time", "rows"), [(0.05, 2), (10.0, 5)])
def test_the_start_is_left_out_for_three_wave_times(scene, wave_time, rows):
    """Outputs every 0.1 s; at most a quarter of 2 s."""
    assert settled(scene, wave_time) == rows
