"""Random systems of tethers, and what their forces, momenta and energies must add up to.

Equations and numbers of the balances are those of `networks.py`; motions, and forces on driven points, are the system's.
"""

from typing import NamedTuple

import numpy as np

from networks import Network
from tetherfmu import Environment, Line, Point, Solver, Tether, TetherSystem

MOST_POINTS, MOST_LINES = 12, 20
DEFAULT = Solver()
TIGHT = Solver(relative_tolerance=1e-9)
WEIGHTS = np.array((7.0, 32.0, 12.0, 32.0, 7.0)) * 4.0 / 90.0  # Boole's rule, over 4 steps: error of order 7 in the step


class Errors(NamedTuple):
    """What is left of two balances over a flight, each divided by the largest of its terms."""

    momentum: float
    energy: float


def random_network(rng, *, taut=False):
    """A `Network` of up to 12 points and 20 lines: a tree and, in most, loops; one to four points driven straight on.

    taut : lines that pull, soft and damped, so that nothing in the balances has a kink.
    """
    count = int(rng.integers(3, MOST_POINTS + 1))
    places = rng.uniform((-100.0, -100.0, 20.0), (100.0, 100.0, 150.0), (count, 3))
    driven = set(rng.choice(count, int(rng.integers(1, min(4, count - 1) + 1)), replace=False))
    points = [
        Point(f"p{k}", place, rng.normal(0.0, 1.0, 3), mass=None if k in driven else _mass(rng, taut))
        for k, place in enumerate(places)
    ]
    pairs = [(int(rng.integers(k)), k) for k in range(1, count)]
    others = [(i, k) for i in range(count) for k in range(i + 1, count) if (i, k) not in pairs]
    rng.shuffle(others)
    most = min(MOST_LINES - len(pairs), len(others))
    pairs += [tuple(map(int, pair)) for pair in others[: int(rng.integers(most + 1))]]
    lines = [_line(rng, f"l{k}", points[i], points[j], taut) for k, (i, j) in enumerate(pairs)]
    motions = {each.name: _straight(each) for each in points if each.is_driven}
    loads = {each.name: rng.normal(0.0, 30.0, 3) for each in points if not each.is_driven}
    wind = (*rng.normal(0.0, 6.0, 2), 0.0)
    return Network(points, lines, Environment(), np.array(wind), motions, loads)


def _mass(rng, taut):
    """Mass of a free point [kg]; some have none."""
    return float(rng.uniform(0.5, 20.0)) if taut or rng.random() < 0.8 else 0.0


def _line(rng, name, start, end, taut):
    """A line between two points, slack or taut by up to a hundredth; in any direction."""
    distance = float(np.linalg.norm(np.subtract(end.position, start.position)))
    segments = int(rng.integers(1, 9))
    ratio = 1.0 / rng.uniform(1.05, 1.15) if taut else rng.uniform(0.99, 1.3)
    soft = {"axial_stiffness": 2000.0, "axial_damping": 40.0} if taut else {}
    tether = Tether(segments=segments, initial_length=distance * float(ratio), **soft)
    ends = (start.name, end.name) if rng.random() < 0.5 else (end.name, start.name)
    return Line(name, *ends, tether)


def _straight(point):
    """Motion of a point at constant velocity: function of time to position and velocity."""
    return lambda time: (np.add(point.position, time * np.array(point.velocity)), np.array(point.velocity))


def started(network, solver=DEFAULT):
    """System of a network, initialized with its wind and loads."""
    system = TetherSystem(network.points, network.lines, network.environment, solver)
    system.initialize(network.wind, loads=network.loads)
    return system


def fly(network, system, steps, step):
    """`SystemFlown` with the driven points on their ways."""
    times = step * np.arange(steps)
    ways = {name: [motion(time) for time in times] for name, motion in network.motions.items()}
    return system.fly(
        steps,
        step,
        positions={name: np.array([x for x, _ in way]) for name, way in ways.items()},
        velocities={name: np.array([v for _, v in way]) for name, way in ways.items()},
    )


def errors_of_balances(network, steps, step):
    """`Errors` of momentum and energy over a flight of a multiple of 4 steps [s] at a tolerance of 1e-9, without reeling."""
    system = started(network, TIGHT)
    momenta, forces, energies, powers = [], [], [], []
    for k in range(steps + 1):
        force, power = _from_outside(network, system)
        forces.append(force)
        powers.append(power)
        momentum, energy = _held_inside(network, system)
        momenta.append(momentum)
        energies.append(energy)
        ways = {name: motion(k * step) for name, motion in network.motions.items()}
        positions, velocities = ({name: way[j] for name, way in ways.items()} for j in range(2))
        system.step(step, positions=positions, velocities=velocities)
    return Errors(_left(momenta, forces, step), _left(energies, powers, step))


def _from_outside(network, system):
    """Sum of forces from outside on free nodes [N], and the power of all that gives or takes energy [W]."""
    x, v = network.gathered(system.positions), network.gathered(system.velocities)
    e, _, drag = network.segments(0.0, x, v)
    u = np.sum(e * (v[network.q] - v[network.p]), axis=1)
    weight = -network.environment.gravity * np.sum(network.masses(0.0)) * np.array((0.0, 0.0, 1.0))
    points = system.outputs().points
    held = {name: points[name].force for name in network.motions}
    loads = sum(network.loads.values(), np.zeros(3))
    force = weight + 2.0 * drag.sum(axis=0) + loads - sum(held.values())
    power = np.sum(drag * (v[network.p] + v[network.q])) - np.sum(network.damping / network.rest * u * u)
    power -= sum(held[name] @ points[name].velocity for name in held)
    power += sum(load @ points[name].velocity for name, load in network.loads.items())
    return force, power


def _held_inside(network, system):
    """Momentum of free nodes [kg m/s], and the energy of all [J]: of motion, of springs, of weight."""
    x, v = network.gathered(system.positions), network.gathered(system.velocities)
    mass, free = network.masses(0.0), network.free
    length = np.linalg.norm(x[network.q] - x[network.p], axis=1)
    elastic = 0.5 * np.sum(network.stiffness / network.rest * (length - network.rest) ** 2)
    kinetic = 0.5 * np.sum(mass[free, None] * v[free] ** 2)
    return mass[free] @ v[free], kinetic + elastic + network.environment.gravity * mass @ x[:, 2]


def _left(values, rates, step):
    """Change of values less the integral of rates, over the largest of both and of what went back and forth."""
    values, rates = np.array(values), np.array(rates)
    weights = np.zeros(len(rates))
    for first in range(0, len(rates) - 1, 4):
        weights[first : first + 5] += WEIGHTS * step
    change, integral = values[-1] - values[0], np.tensordot(weights, rates, 1)
    largest = max(np.abs(values - values[0]).max(), np.tensordot(weights, np.abs(rates), 1).max())
    return float(np.abs(change - integral).max() / largest)
