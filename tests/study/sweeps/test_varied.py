"""What a sweep varies: grids, lists and samples have the values that were written, and what cannot be meant is named."""

import re

import numpy as np
import pytest
from scipy import stats

from tetherfmu.study.sweeps.varied import all_varied, points, unit_of, varied

MEANT = {  # text: values in SI units
    "tether.diameter=3 mm..6 mm:4": (0.003, 0.004, 0.005, 0.006),
    "diameter=0.003,4 mm": (0.003, 0.004),
    "wind.seed=3..5": (3, 4, 5),
    "wind.direction=0 deg..90 deg:3": (0.0, np.pi / 4.0, np.pi / 2.0),
    "wind.velocity[3]=-1,1": (-1, 1),
    "flight.rate=6 rpm,1": (np.pi / 5.0, 1),
    "environment.wind_profile=uniform,power_law": ("uniform", "power_law"),
    "wind.file=box_*.npz": ("box_1.npz", "box_2.npz"),
}


@pytest.mark.parametrize("text", MEANT)
def test_values(text, tmp_path):
    for number in (2, 1):
        (tmp_path / f"box_{number}.npz").touch()
    found, wanted = varied(text, folder=tmp_path).values, MEANT[text]
    assert found == pytest.approx(wanted, rel=1e-12) if isinstance(wanted[0], float) else found == wanted


@pytest.mark.parametrize(
    ("text", "formula"),  # the quantile of p: the distribution, solved for its value
    [
        ("wind.speed~uniform(4 m/s, 36 km/h)", lambda p: 4.0 + 6.0 * p),
        ("wind.speed~weibull(2, 9)", lambda p: 9.0 * np.sqrt(-np.log(1.0 - p))),
        ("wind.speed~normal(9, 2)", lambda p: 9.0 + 2.0 * stats.norm.ppf(p)),
        ("wind.speed~lognormal(9, 0.2)", lambda p: 9.0 * np.exp(0.2 * stats.norm.ppf(p))),
        ("wind.speed~triangular(0, 5, 10)", lambda p: 10.0 * np.sqrt(0.5 * p)),  # p below that of the mode
    ],
)
def test_distributions(text, formula):
    assert varied(text).distribution.ppf(0.3) == pytest.approx(formula(0.3), rel=1e-12)


WRONG = {
    "wind.speed": "it must be NAME=FROM..TO:COUNT",
    "tether.diametre=1 mm,2 mm": "a scene has no tether.diametre; did you mean diameter?",
    "wind.sped=1,2": "did you mean wind.speed?",
    "flight.height=1,2": "a scene has no flight.height; flight has distance, half_angle",  # a circle
    "tether.diameter=1 kg,2": "'1 kg' is not possible; it must be a number with one of the units m, mm",
    "wind.speed=3..1": "whole numbers, from the least to the largest",
    "wind.speed=1..2:0": "it has 0 values",
    "wind.speed~weibul(2, 9)": "there is no distribution weibul; did you mean weibull?",
    "wind.speed~weibull(2)": "weibull has 2 parameters: shape, scale",
    "wind.speed~weibull(2, -9)": "its parameters shape, scale must be above 0",
    "wind.speed~uniform(9, 2)": "its parameters least, largest must be in ascending order",
    "environment.wind_profile~uniform(1, 2)": "it is not a number: give a list",
    "wind.file=none_*.npz": "no file is called none_*.npz",
}


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_named(text, tmp_path):
    with pytest.raises(ValueError, match=re.escape(WRONG[text])):
        varied(text, folder=tmp_path)


def test_each_point_of_the_grid_has_all_samples():
    quantities = all_varied(["diameter=0.003,0.004", "wind.speed~uniform(0, 8)", "gravity=9,10"], unit_of, None)
    found = points(quantities, 8, "latin_hypercube", 1)
    assert [tuple(name for name, _ in each) for each in found] == [("diameter", "wind.speed", "gravity")] * 32
    rows = np.array([[value for _, value in each] for each in found]).reshape(2, 2, 8, 3)
    assert np.all(rows[0, :, :, 0] == 0.003)
    assert np.all(rows[:, 1, :, 2] == 10)
    assert np.all(rows[..., 1] == rows[0, 0, :, 1])
    assert sorted(rows[0, 0, :, 1].astype(int)) == [0, 1, 2, 3, 4, 5, 6, 7]  # one in each eighth: a Latin hypercube


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol"])
def test_samples_are_those_of_their_seed(method):
    quantities = all_varied({"wind.speed": stats.norm(9.0, 1.0), "gravity": stats.uniform(9.0, 1.0)}, unit_of, None)
    first, same, other = (points(quantities, 4, method, seed) for seed in (1, 1, 2))
    assert first == same
    assert first != other
