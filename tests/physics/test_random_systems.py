"""Random systems of tethers: what their forces, momenta and energies must add up to, and starts in the balance of forces.

momentum:   forces on the driven points + weight + drag + loads = d/dt sum m v
energy:     power of the driven points, of loads and drag, less the heat of damping = d/dt (motion + springs + weight)
"""

import numpy as np
import pytest

from random_systems import errors_of_balances, fly, random_network, started
from tetherfmu import TetherSystem


@pytest.mark.parametrize("seed", range(5))
def test_momentum_and_energy_are_what_comes_from_outside(seed):
    # bar of 1e-6; of the fastest modes, 300 rad/s, Boole's rule leaves (0.3)^6/500
    network = random_network(np.random.default_rng(seed), taut=True)
    momentum, energy = errors_of_balances(network, steps=100, step=0.001)
    assert momentum < 1e-8
    assert energy < 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_what_is_flown_is_finite_and_one_system(seed):
    """Slack and taut, with points without mass: lines end at one point to the last bit, and a saved state goes on."""
    network = random_network(np.random.default_rng((1, seed)))
    system = started(network)
    flight = fly(network, system, 5, 0.02)
    for name in network.names:
        ends = [
            flight.positions[line.name][:, place]
            for line in network.lines
            for place, end in ((0, line.start), (-1, line.end))
            if end == name
        ]
        assert all(np.array_equal(each, ends[0]) for each in ends)
    assert all(np.all(np.isfinite(each.force)) for each in flight.points.values())
    twin = TetherSystem(network.points, network.lines, network.environment)
    twin.set_state(system.get_state())
    for each in (system, twin):
        each.fly(3, 0.02, every=0)
    assert np.array_equal(system.get_state(), twin.get_state())
