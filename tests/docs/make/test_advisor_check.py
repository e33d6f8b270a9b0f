"""The advisor keeps its word in scenes that it has not seen; all 40 are judged in docs/use/quality_of_advice.md."""

import pytest

from advice.page import unseen
from advice.random_scenes import random_scenes

QUICK = (3, 7, 9, 15, 31)  # a launch, a circle, a parked kite, a figure of eight, a launch


@pytest.mark.parametrize("number", QUICK)
def test_advice_for_an_unseen_scene(number):
    verdict = unseen(random_scenes(number + 1)[number])
    assert verdict["own_error"] < 0.2 * verdict["allowed"]
    assert verdict["met"]
    assert verdict["error"] <= verdict["expected"] + verdict["own_error"]
