"""The catenary tether finds its tension wherever there is one, and it is the right one, taut or slack, soft or stiff.

Starts are made from their solution: from the tension at mid-length (H, V) the closed form of Irvine (1981), section 1.3,
gives the ends,

    span = H L/EA + H/w (asinh(V2/H) - asinh(V1/H)),   rise = V L/EA + (T2 - T1)/w,   V1,2 = V -+ w L/2

here with the difference of the asinh as the integral of ds/sqrt(H^2 + (V + w s)^2), which does not cancel. The tether must
give back the tension vector (H, V - w L/2) at the ground.

Where V/(w L) is just below a power of two, V + w L/2 and V - w L/2 are rounded differently. Without `exact` in
`elastic_catenary.py` some starts below 128, 256, ... are refused, and some of those that are stretched a hundred times.
"""

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from mechanics import line_density
from tetherfmu.python.models import TetherCatenary
from tetherfmu.runtime.parameters import Tether

pytestmark = pytest.mark.filterwarnings("ignore:a segment is stretched")  # far beyond what ropes bear

LENGTH, COUNT = 100.0, 2000
LOAD = line_density(Tether()) * 9.81
UNIT = LOAD * LENGTH  # weight of the tether [N]
POINTS, WEIGHTS = leggauss(40)


def span_and_rise(horizontal, vertical, axial_stiffness):
    """Ends [m] of the elastic catenary with this tension [N] at mid-length; the integral is exact to 1e-16 for H > w L."""
    along = vertical + 0.5 * UNIT * POINTS
    span = horizontal * LENGTH * (1.0 / axial_stiffness + 0.5 * WEIGHTS @ (1.0 / np.hypot(horizontal, along)))
    rise = LENGTH * (vertical / axial_stiffness + 0.5 * WEIGHTS @ (along / np.hypot(horizontal, along)))
    return span, rise


def largest_error(horizontal, vertical, axial_stiffness):
    """Largest error of the ground force of starts with these tensions [N], over the tension; none may be refused."""
    model = TetherCatenary(initial_length=LENGTH, axial_stiffness=axial_stiffness, shape_points=0)
    errors = []
    for h, v in zip(horizontal, vertical, strict=True):
        span, rise = span_and_rise(h, v, axial_stiffness)
        found = model.initialize(kite_position=(span, 0.0, rise)).ground_force
        errors.append(np.linalg.norm(found - (h, 0.0, v - 0.5 * UNIT)) / np.hypot(h, v))
    return max(errors)


# the strain is some 1e-3 and positions have errors of 1e-16 of the length: 1e-12, and ten times that for sums
@pytest.mark.parametrize("power", [5, 6, 7, 8, 9, 10])
def test_taut_below_a_power_of_two(power):
    random = np.random.default_rng(power)
    vertical = UNIT * (2.0**power - random.uniform(0.0, 0.5, COUNT))
    horizontal = vertical * 10.0 ** random.uniform(-1.0, 1.0, COUNT)
    stiffness = 100.0 * 2.0**power * UNIT
    assert largest_error(horizontal, vertical, stiffness) < 1e-11


# strain 1e-9 to 0.1 with EA up to 1e12 N; errors of 1e-16 of the length are then up to 1e-7 of the strain
@pytest.mark.parametrize("axial_stiffness", [1e3, 1e6, 1e9, 1e12])
def test_slack_to_taut(axial_stiffness):
    random = np.random.default_rng(1)
    tension = UNIT * 10.0 ** random.uniform(0.1, np.log10(0.1 * axial_stiffness / UNIT), COUNT)
    angle = random.uniform(-1.0, 1.0, COUNT)
    assert largest_error(tension * np.cos(angle), tension * np.sin(angle), axial_stiffness) < 1e-6


def test_stretched_a_hundred_times():
    random = np.random.default_rng(1)
    tension = 10.0 ** random.uniform(1.5, 2.5, COUNT)  # EA is 1 N
    angle = random.uniform(-1.5, 1.5, COUNT)
    assert largest_error(tension * np.cos(angle), tension * np.sin(angle), 1.0) < 1e-11
