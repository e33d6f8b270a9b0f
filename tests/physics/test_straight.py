"""The straight line: its tension, how it shares weight and drag between its ends, and that taut tethers tend to it.

    tension EA max(c/L - 1, 0);   weight: half at each end;   drag f(xi) per length: (1 - xi) at the ground, xi at the kite

Turning about the ground end in still air with the speed v at the kite, f = 1/2 rho cd d (xi v)^2. With D = rho cd d c v^2/2

    kite: integral xi xi^2 D = D/4 (the classical quarter),    ground: integral (1 - xi) xi^2 D = D/12.

A chain under the same loads has the moment of its segments' midpoints, sum of m^3/n with m = (s + 1/2)/n:
D/4 (1 - 1/(2 n^2)) at the kite.
"""

import numpy as np
import pytest

from mechanics import line_density
from tetherfmu import Environment, Tether
from tetherfmu.python import models

KITE = np.array([300.0, 0.0, 400.0])
ALONG = KITE / 500.0
ACROSS = np.array([0.0, 1.0, 0.0])


def fly(variant, environment=Environment(), speed=0.0, wind=(0.0, 0.0, 0.0), **tether):  # noqa: B008 (a constant record)
    model = getattr(models, variant)(Tether(**tether), environment)
    return model.initialize(kite_position=KITE, kite_velocity=speed * ACROSS, wind_velocity=wind)


def drag(speed, tether=Tether()):  # noqa: B008
    return 0.5 * 1.225 * tether.drag_coefficient * tether.diameter * 500.0 * speed**2


@pytest.mark.parametrize("speed", [1.0, 40.0])
@pytest.mark.parametrize("length", [495.0, 520.0])
def test_quarter_of_the_drag_comes_to_the_kite(length, speed):
    outputs = fly("TetherStraight", speed=speed, initial_length=length)
    # the Gauss points are exact for these polynomials; a digit or two go with the tension
    assert np.isclose(outputs.kite_force @ ACROSS, -drag(speed) / 4.0, rtol=1e-11)
    assert np.isclose(outputs.ground_force @ ACROSS, -drag(speed) / 12.0, rtol=1e-11)


@pytest.mark.parametrize("n", [10, 20, 40])
def test_quarter_of_the_drag_is_the_limit_of_the_chain(n):
    speed = 40.0
    tether = {"segments": n, "initial_length": 499.0, "axial_stiffness": 1e9}
    outputs = fly("TetherQuasiSteady", Environment(gravity=0.0), speed, **tether)
    # EA is so large that the sag turns the forces by 1e-4 and changes the moments by the square of that
    assert np.isclose(outputs.kite_force @ ACROSS, -drag(speed) / 4.0 * (1.0 - 0.5 / n**2), rtol=1e-6)


@pytest.mark.parametrize("length", [450.0, 499.999, 500.0, 500.001, 600.0])
def test_tension_and_weight(length):
    tether = Tether(initial_length=length)
    outputs = fly("TetherStraight", initial_length=length)
    tension = tether.axial_stiffness * max(500.0 / length - 1.0, 0.0)
    half_weight = np.array([0.0, 0.0, -0.5 * line_density(tether) * length * 9.81])
    assert np.allclose(outputs.ground_force, tension * ALONG + half_weight, rtol=1e-12, atol=1e-9)
    assert np.allclose(outputs.kite_force, -tension * ALONG + half_weight, rtol=1e-12, atol=1e-9)
    # 0.8 of half the weight is along the line: it pulls at the upper end, and rests on the lower one if there is no tension
    along = 0.8 * half_weight[2]
    assert outputs.ground_tension == pytest.approx(tension + along, rel=1e-12, abs=1e-9)
    assert outputs.kite_tension == pytest.approx(tension - along, rel=1e-12, abs=1e-9)
    assert outputs.slack_segments == (length > 500.0)
    assert outputs.sag == 0.0


@pytest.mark.parametrize("variant", ["TetherDynamic", "TetherQuasiSteady", "TetherCatenary"])
def test_taut_tethers_tend_to_it(variant):
    """The load q c across stretches a line by (q c/T)^2 c/24, so T differs by EA (q c)^2/(24 T^2): as 1/EA.

    That is at a given strain. The angle of the line to its chord turns the load, 1/EA too. The catenary has its drag per
    unstretched length, so its sum is smaller by the strain, 0.2 %.
    """
    wind, stiffness = (8.0, 6.0, 0.0), 3e6 * 2.0 ** np.arange(4)
    differences = []
    for each in stiffness:
        tether = {"initial_length": 499.0, "axial_stiffness": each}
        forces, expected = fly(variant, wind=wind, **tether), fly("TetherStraight", wind=wind, **tether)
        differences.append([np.linalg.norm(forces.ground_force - expected.ground_force)])
        differences[-1].append(np.linalg.norm(forces.kite_force - expected.kite_force))
    differences = np.array(differences)
    orders = np.log2(differences[:-1] / differences[1:])
    assert np.allclose(orders, 1.0, atol=0.1)
    assert (differences[-1] < 2e-4 * stiffness[-1] * 0.002).all()
