"""The advisor with fixed steps: what it tells is true of a flight with them, and it keeps to the time of a step."""

from dataclasses import replace

import pytest

from study.scenes_of_tests import SCENE, written
from tetherfmu.__main__ import main
from tetherfmu.files.scene_files import load
from tetherfmu.runtime.limits import STAGES, WORST_WORK
from tetherfmu.study.advice.fixed_step_advice import Fixed, candidates, fly
from tetherfmu.study.advice.scene_advice import FAST_BUDGET, advise_in_words
from tetherfmu.study.measuring.errors import converged

NAMES = ("kite_force",)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    found = load(written(tmp_path_factory.mktemp("fixed"), SCENE + "fixed = true\n"))
    return replace(found, duration=10.0)


def test_advice_meets_error_and_time(scene):
    """Measured anew against another reference; the time of a communication step is that of its iterations."""
    advice, text = advise_in_words(scene, FAST_BUDGET)
    reference = converged(scene, 0.1 * scene.wanted.allowed_error, NAMES)
    again = fly(scene, advice.point.config, reference.run.flown)
    assert advice.met
    assert again.error(NAMES) <= scene.wanted.allowed_error
    assert again.iterations == advice.point.iterations >= STAGES
    assert f"fixed_step = {advice.point.config.fixed_step:g}" in text
    assert f"{WORST_WORK * advice.point.config.parts} factorizations" in text


def test_no_candidate_takes_longer_than_allowed(scene):
    """Smooth steps of three iterations; without a limit there are configurations above it."""
    most = 20e-6
    asked = replace(scene, wanted=replace(scene.wanted, time_per_step=most))
    assert max(each.smooth_time for each in candidates(asked)) <= most
    assert max(each.smooth_time for each in candidates(scene)) > most
    assert Fixed(20, 0.02, 4).time(12) > 3.0 * Fixed(20, 0.02, 1).time(3)
    assert Fixed(20, 0.02, 4).smooth_time == Fixed(20, 0.02, 1).time(4 * STAGES)


def test_a_time_alone_that_cannot_be_met_is_told(scene):
    """No step takes a nanosecond, whatever its error."""
    asked = replace(scene, wanted=replace(scene.wanted, allowed_error=0.5, time_per_step=1e-9))
    advice, text = advise_in_words(asked, FAST_BUDGET)
    assert advice.point.error(NAMES) < 0.4
    assert not advice.met
    assert "No configuration is known to reach that" in text


def test_what_cannot_be_met_is_told(tmp_path, capsys):
    path = written(tmp_path, SCENE.replace("3 %", "0.1 %") + "fixed = true\ntime_per_step = 2e-6\n")
    assert main(["advise", "--fast", str(path)]) == 1
    said = capsys.readouterr().out
    assert "with fixed steps, 2 us for a communication step" in said
    assert "No configuration is known to reach that" in said


def test_true_or_false(tmp_path, capsys):
    assert main(["advise", str(written(tmp_path, SCENE + "fixed = 1\n"))]) == 2
    assert "wanted.fixed is 1; it must be true or false" in capsys.readouterr().err
