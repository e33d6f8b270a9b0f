"""Reasons of an advice: the numbers of a scene by formulas, thresholds in order."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from advice.random_scenes import random_scenes
from advice.thresholds import SWEEPS, crossing, drag_scene, slack_scene, wave_scene, weight_scene, write
from tetherfmu.study.advice.reasons import LEVELS, TABLE, numbers, thresholds_at


@pytest.mark.parametrize(("load", "stretch"), [(0.01, 1e-2), (0.03, 1e-3)])
def test_weight_and_stretch_of_a_tether_at_rest(load, stretch):
    """q = mu g L/T and s = T/EA as the sweep was made; the kite carries up to half of the weight more than T: q/4 here."""
    found = numbers(weight_scene(load, stretch))
    assert found.weight == pytest.approx(load, rel=0.02)
    assert found.stretch == pytest.approx(stretch, rel=0.02)
    assert found.drag == pytest.approx(0.0, abs=1e-6)
    assert found.wave == pytest.approx(0.0, abs=1e-6)


def test_drag_of_a_circling_tether():
    """1/6 rho cd d L v^2 over T = s EA: a tether that turns about one end; sag is of second order."""
    assert numbers(drag_scene(0.03, 1e-3)).drag == pytest.approx(0.03, rel=0.02)


def test_slack_is_length_over_distance():
    assert numbers(slack_scene(0.05)).slack == pytest.approx(0.05, rel=1e-6)


def test_wave_number_grows_with_the_rate_of_the_flight():
    slow, fast = (numbers(wave_scene(lap)) for lap in (60.0, 20.0))
    assert fast.wave > 2.0 * slow.wave


def test_mass_per_length():
    """mu = rho pi d^2/4"""
    assert wave_scene(60.0).tether.mass_per_length == pytest.approx(724.0 * np.pi * 0.004**2 / 4.0)


@pytest.mark.parametrize("variant", ["straight", "catenary", "quasi_steady"])
def test_thresholds_grow_with_the_level(variant):
    segments = 8 if variant == "quasi_steady" else 0
    for group in ("weight", "drag", "slack"):
        values = thresholds_at(group, variant, segments, 1e-3)
        assert all(a <= b for a, b in pairwise(values))


def test_straight_fails_at_less_load_than_catenary():
    """In still air the catenary is exact; the straight line is wrong by q^2/(24 s), so by 1 % at q^2 = 0.24 s."""
    straight, catenary = (thresholds_at("weight", variant, 0, 1e-3) for variant in ("straight", "catenary"))
    assert straight[LEVELS.index(0.01)] == pytest.approx(np.sqrt(0.24 * 1e-3), rel=0.2)
    assert all(catenary > 100.0 * straight)


def test_crossing_is_interpolated_on_logarithmic_axes():
    """e = x^2 passes 0.01 at x = 0.1, also between 0.05 and 0.2."""
    values = np.array([0.01, 0.05, 0.2, 1.0])
    assert crossing(values, values**2, 0.01) == pytest.approx(0.1)
    assert crossing(values, values**2, 2.0) == float("inf")


def test_tables_are_stored_as_they_were_read(tmp_path):
    write(pd.read_csv(TABLE), pd.read_csv(SWEEPS), tmp_path / "thresholds.csv", tmp_path / "sweeps.csv")
    assert (tmp_path / "thresholds.csv").read_bytes() == TABLE.read_bytes()
    assert (tmp_path / "sweeps.csv").read_bytes() == SWEEPS.read_bytes()


def test_random_scenes_are_always_the_same():
    first, again = random_scenes(7), random_scenes(7)
    assert [scene.digest for scene in first] == [scene.digest for scene in again]
    assert len({scene.digest for scene in first}) == 7
