"""The forecast of the fast advice: its numbers by formulas, its thresholds in order, its step error as measured."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from study.scenes_of_tests import SCENE, written
from tetherfmu.study.__main__ import main
from tetherfmu.study.advice.forecast import fast_advice, forecast, group_error, thresholds_at
from tetherfmu.study.advice.numbers import lead_error, numbers
from tetherfmu.study.advice.thresholds import (
    LEVELS,
    SWEEPS,
    TABLE,
    crossing,
    drag_scene,
    read,
    slack_scene,
    wave_scene,
    weight_scene,
    write,
)
from tetherfmu.study.advice.tradeoff import measure
from tetherfmu.study.measuring.errors import converged
from tetherfmu.study.measuring.runs import Config
from tetherfmu.study.scenes.files import load
from tetherfmu.study.scenes.random_scenes import random_scenes

STRAIGHT, CATENARY = Config("straight", 0, 0.0, 0.02), Config("catenary", 0, 0.0, 0.02)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load(written(tmp_path_factory.mktemp("forecast")))


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


def test_mass_per_meter():
    """mu = rho pi d^2/4"""
    assert wave_scene(60.0).tether.mass_per_meter == pytest.approx(724.0 * np.pi * 0.004**2 / 4.0)


def test_error_of_a_held_reel_is_forecast(tmp_path):
    """A winch at 8 m/s, inputs every 20 ms: the length is late by up to 8 cm; a stiff tether feels it."""
    text = SCENE.replace('kind = "circle"\nrate = "0.5 rad/s"', 'kind = "reel"\nphase_time = "4 s"\nramp_time = "1 s"')
    reel = load(written(tmp_path, text.replace("505 m", "199 m")))
    reference = converged(reel, 1e-3, ("kite_force",)).run.flown
    measured = measure(reel, Config("dynamic", 16, 1e-4, 0.02), reference).errors["kite_force"]
    assert lead_error(reel, 0.02, numbers(reel)) == pytest.approx(measured, rel=0.2)


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
    write(read(), read(SWEEPS), tmp_path / "thresholds.csv", tmp_path / "sweeps.csv")
    assert (tmp_path / "thresholds.csv").read_bytes() == TABLE.read_bytes()
    assert (tmp_path / "sweeps.csv").read_bytes() == SWEEPS.read_bytes()


def test_forecast_sums_the_groups(scene):
    found = numbers(scene)
    made = forecast(CATENARY, found, {0.02: 0.001})
    groups = sum(group_error(group, CATENARY, found) for group in ("weight", "drag", "slack", "wave"))
    assert sum(made.values()) == pytest.approx(groups + 0.001)


def test_fast_advice_asks_for_more_where_less_is_allowed(scene):
    few, many = (fast_advice(replace(scene, wanted=replace(scene.wanted, allowed_error=e))) for e in (0.1, 0.01))
    assert few.expected > many.expected


def test_fast_command_tells_what_to_use(scene, tmp_path, capsys):
    assert main(["advise", "--fast", str(written(tmp_path))]) == 0
    said = capsys.readouterr().out
    for words in (".fmu", "communication step 20 ms", "expect", "numbers", "not checked"):
        assert words in said


def test_random_scenes_are_always_the_same():
    first, again = random_scenes(7), random_scenes(7)
    assert [scene.digest for scene in first] == [scene.digest for scene in again]
    assert len({scene.digest for scene in first}) == 7
