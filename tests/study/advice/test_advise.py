"""The advisor: what it advises is allowed, measured anew against a finer reference, and nothing cheaper is."""

from dataclasses import replace

import pytest

from study.scenes_of_tests import SCENE, written
from tetherfmu.study.__main__ import main
from tetherfmu.study.advice.advise import advise
from tetherfmu.study.advice.tradeoff import measure
from tetherfmu.study.measuring.errors import converged
from tetherfmu.study.scenes.files import load

NAMES = ("kite_force",)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load(written(tmp_path_factory.mktemp("advise")))


@pytest.fixture(scope="module")
def reference(scene):
    return converged(scene, 3e-4, NAMES)


@pytest.mark.parametrize("allowed", [0.1, 0.01])
def test_advice_meets_what_is_allowed(scene, reference, allowed):
    asked = replace(scene, wanted=replace(scene.wanted, allowed_error=allowed))
    advice = advise(asked)
    assert advice.met
    assert measure(scene, advice.point.config, reference.run.flown).error(NAMES) <= allowed


def test_a_tenfold_demand_costs_more(scene):
    costs = [advise(replace(scene, wanted=replace(scene.wanted, allowed_error=e))).point.cost for e in (0.1, 0.01)]
    assert costs[0] < costs[1]


def test_what_cannot_be_met_is_told(tmp_path, capsys):
    """At a communication step of 0.5 s a kite at 43 m/s is led past its path; no number of segments helps."""
    path = written(tmp_path, SCENE.replace("20 ms", "500 ms").replace("3 %", "0.1 %"))
    assert main(["advise", str(path)]) == 1
    assert "No configuration reaches that" in capsys.readouterr().out
