"""Errors of a flight, each by its formula, on flights made up for it; and references that are ten times finer, or say so."""

from types import SimpleNamespace

import numpy as np
import pytest

from study.scenes_of_tests import SCENE, written
from tetherfmu import Flown
from tetherfmu.files.scene_files import OUTPUTS, load
from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring import errors as measuring
from tetherfmu.study.measuring.errors import FINER, errors, fine_enough, judging, settled
from tetherfmu.study.measuring.runs import SHAPE_POINTS
from tetherfmu.study.measuring.tables import known


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


def references(finest):
    """A stand-in of `converged` whose own error is the target, or the finest that can be reached; and its targets."""
    targets = []

    def converged(_scene, target, _names):
        targets.append(target)
        return SimpleNamespace(own_error=lambda _names: max(target, finest), run=SimpleNamespace(flown=target))

    return converged, targets


@pytest.mark.parametrize(("finest", "good"), [(1e-9, True), (1e-3, False)])
def test_refined_until_it_is_ten_times_finer_or_the_finest(monkeypatch, finest, good):
    """The errors found depend on the reference, and the first one is as large as they are."""
    converged, targets = references(finest)
    monkeypatch.setattr(measuring, "converged", converged)
    reference, found = judging(None, lambda target: [4e-3 - 0.2 * target, 0.1], ("kite_force",), 4e-3)
    assert targets[0] == 4e-3
    assert targets[1] == pytest.approx((4e-3 - 0.2 * 4e-3) / FINER)
    assert fine_enough(reference.own_error(None), found) is good
    assert found[0] == pytest.approx(4e-3, rel=0.1)


@pytest.mark.parametrize(("own", "text"), [(1e-4, "0.61 %"), (1e-3, "0.61 ± 0.1 %")])
def test_an_error_that_a_coarse_reference_judges_says_so(own, text):
    assert known(0.0061, own) == text
