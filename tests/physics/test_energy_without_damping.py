"""An undamped tether does not swing itself up: where its segments go slack and become taut, energy is kept.

A mass m on a segment of stiffness k, slack s k, without weight: half periods pi sqrt(m/k) taut and pi sqrt(m/(s k)) slack;
the speed at the kink is sqrt(k/m) times the amplitude taut, the amplitude slack that over sqrt(s).
"""

import numpy as np
import pytest

from mechanics import energy, node_masses
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Environment, Solver, Tether

TOLERANCE = 1e-4  # of the solver, its default


def released(tether, kite, gravity=9.81):
    """A straight, undamped tether in still air of density 0 whose kite end is let go at rest."""
    environment = Environment(gravity=gravity, air_density=0.0)
    solver = Solver(relative_tolerance=TOLERANCE, initial_shape=3)
    model = TetherDynamic(tether, environment, solver, free_ends=(False, True))
    model.initialize(kite_position=kite)
    return model


FALLS = {  # tether without damping, start of the kite [m], communication step [s], duration [s]
    "one segment": (
        dict(segments=1, initial_length=6.437352, axial_stiffness=339554.7, diameter=0.001539),
        (4.924, -4.17),
        0.1,
        20,
    ),
    "one, stiffer": (
        dict(segments=1, initial_length=15.261, axial_stiffness=427570.0, diameter=0.0018),
        (10.763, -11.232),
        0.1,
        20,
    ),
    "no slack stiffness": (dict(segments=5, initial_length=50.0, slack_stiffness_ratio=0.0), (0.0, -50.3), 0.02, 30),
    "stretched": (dict(segments=8, initial_length=50.0), (50.2, 0.0), 0.02, 10),
}


def fall(name, duration=None):
    """Total and kinetic energy [J] at the communication steps of a fall, for a duration [s] other than its own."""
    properties, (x, z), step, usual = FALLS[name]
    tether = Tether(axial_damping=0.0, **properties)
    model = released(tether, (x, 0.0, z))
    total, kinetic = [], []
    for _ in range(round((duration or usual) / step)):
        total.append(energy(model.positions, model.velocities, tether))
        kinetic.append(0.5 * node_masses(tether) @ np.sum(model.velocities**2, axis=1))
        model.step(step)
    return np.array(total), np.array(kinetic)


@pytest.mark.parametrize("name", FALLS)
def test_no_gain(name):
    """Without `kink.keep_energy` they gained 21, 5.9, 1.2 and 0.5 % of the kinetic energy."""
    total, kinetic = fall(name)
    assert total.max() - total[0] < TOLERANCE * kinetic.max()
    assert total[-1] > total[0] - 0.01 * kinetic.max()  # and they lose little, 0.2 % at most


@pytest.mark.parametrize("ratio", [0.01, 0.25])
def test_amplitudes_and_period_of_a_bouncing_mass(ratio):
    tether = Tether(segments=1, initial_length=10.0, axial_damping=0.0, slack_stiffness_ratio=ratio)
    amplitude = 0.02
    model = released(tether, (10.0 + amplitude, 0.0, 0.0), gravity=0.0)
    omega = np.sqrt(tether.axial_stiffness / tether.initial_length / node_masses(tether)[-1])
    period = np.pi / omega * (1.0 + 1.0 / np.sqrt(ratio))
    bounces = 20
    step = period / 40
    stretch = []
    for _ in range(40 * bounces):
        model.step(step)
        stretch.append(model.positions[1, 0] - 10.0)
    last = np.array(stretch[-40:])
    # a bounce takes some 20 steps, each with an error of the tolerance times 10 m/20 mm of the amplitude at most
    assert last.max() == pytest.approx(amplitude, rel=0.02)
    assert -last.min() == pytest.approx(amplitude / np.sqrt(ratio), rel=0.02)
    assert last[-1] == pytest.approx(amplitude, rel=0.05)  # after whole periods it is back
