"""Random systems of tethers: what their forces, momenta and energies must add up to, and starts in the balance of forces.

momentum:   forces on the driven points + weight + drag + loads = d/dt sum m v
energy:     power of the driven points, of loads and drag, less the heat of damping = d/dt (motion + springs + weight)
ground:     free points are found on flat ground, balanced by the forces of `networks.py`, at rest, and seldom refused;
            it presses on each node with m g (depth/ground_sink). Vertical: sum of forces + pressure = 0, horizontal:
            |sum of forces| <= mu pressure. There is more than one equilibrium: the forces are the oracle, not the places.
"""

from dataclasses import replace

import numpy as np
import pytest

from random_systems import errors_of_balances, fly, random_network, started
from tetherfmu import Ground, StepRefused, TetherSystem


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


# --- on the ground

GROUND = Ground(ground_contact="flat")
# systems of `benchmarks/random_systems_started.py --ground`, in wind, that are not found without a search in thinner air,
# and with it are, in winds that differ by 1e-15 to 1e-9: each 20 of 20 times (of some others rounding decides)
REFUSED_ONCE = (26, 386, 422, 472, 620)


def found(number):
    """System `number` of the benchmark with all free points found, and its `Network` with the loads and wind it has."""
    drawn = random_network(np.random.default_rng((1, number)))
    loads = drawn.loads if number % 2 else {}
    network = replace(drawn, loads=loads, wind=drawn.wind if number % 3 else np.zeros(3))
    system = TetherSystem(network.points, network.lines, network.environment, ground=GROUND)
    free = {point.name: None for point in network.points if not point.is_driven}
    still = {point.name: (0.0, 0.0, 0.0) for point in network.points}
    system.initialize(network.wind, positions=free, velocities=still, loads=loads)
    return network, system


def unbalanced(network, system):
    """Largest force on a free node that neither pressure nor friction of the ground balances, over the largest tension."""
    x = network.gathered(system.positions)
    force = network.forces(0.0, x, np.zeros_like(x))
    depth = np.maximum(0.0, GROUND.ground_height - x[:, 2])
    pressure = network.masses(0.0) * network.environment.gravity * depth / GROUND.ground_sink
    sideways = np.maximum(0.0, np.hypot(force[:, 0], force[:, 1]) - GROUND.ground_friction * pressure)
    left = np.hypot(sideways, force[:, 2] + pressure)[network.free]
    return left.max() / largest_tension(network, x)


def rounding(network, system):
    """What rounding of the positions to the nearest number changes in the force on a free node, over the largest tension."""
    x = network.gathered(system.positions)
    rng = np.random.default_rng(0)
    moved = [x + rng.choice((-0.5, 0.5), x.shape) * np.spacing(np.abs(x)) for _ in range(20)]
    forces = [network.forces(0.0, each, np.zeros_like(x))[network.free] for each in (x, *moved)]
    return max(np.abs(each - forces[0]).max() for each in forces[1:]) / largest_tension(network, x)


def largest_tension(network, x):
    """Largest tension of the segments between nodes at these places [m], in N."""
    _, tension, _ = network.segments(0.0, x, np.zeros_like(x))
    return tension.max()


@pytest.mark.parametrize("number", REFUSED_ONCE)
def test_what_was_refused_is_balanced_and_stays(number):
    network, system = found(number)
    assert unbalanced(network, system) < 1e-9  # as single tethers; 2e-11 observed
    before = system.positions
    system.fly(10, 0.02, every=0)
    # friction creeps: 1 mm/s under 98 % of it, up to 8 mm/s where it just holds (v_r T/sqrt(F^2 - T^2))
    moved = max(np.abs(each - before[name]).max() for name, each in system.positions.items())
    assert moved < 8e-3 * 0.2


def test_few_are_refused():
    """Of the first 40 of the benchmark, of which 2 were refused without that search: at most one."""
    refused = 0
    for number in range(40):
        try:
            network, system = found(number)
        except StepRefused:
            refused += 1
            continue
        # 9e-10 observed; 18, whose lines pull with 9 N only, has 6e-9, four times its rounding
        assert unbalanced(network, system) < max(1e-9, 10.0 * rounding(network, system))
    assert refused <= 1
