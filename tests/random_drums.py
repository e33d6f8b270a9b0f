"""Random systems whose winches turn in fixed steps, and what backward Euler must leave of the equations of nodes and drums.

Without air and damping nothing in a step of h but springs, weights, loads and drums pulls, all at its end:

    M1 (v1 - v0)/h = sum k (l1 - l0) e - M1 g + load + f,    l0 = L1/n, M1 of the lengths then, f of rope that flows
    m (u1 - u0)/h = T - W - c u1 - F sign(u1),               at rest: the left side less the right one is at most F

Nodes and numbers are those of `networks.py`.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from networks import Network, rope_tension
from random_systems import random_network
from tetherfmu import Environment, TetherSystem, Winch
from tetherfmu.runtime.limits import MIN_SEGMENT_LENGTH

ROUNDING = 1e-11  # of positions [m]
WITHOUT_AIR = Environment(air_density=0.0)


class Left(NamedTuple):
    """What is left of the equations after a step, of the nodes and of the drums, over the largest force."""

    nodes: float
    drums: float


def random_drums(rng, *, bare=True):
    """A `Network` with winches, and what they are told: forces [N], speeds [m/s] and lengths [m].

    bare : without air and damping.
    """
    network = random_network(rng)
    lines, told = [], {"winch_forces": {}, "reel_out_speeds": {}, "winch_lengths": {}}
    for line in network.lines:
        tether = replace(line.tether, axial_damping=0.0, drag_coefficient=0.0) if bare else line.tether
        kind, length = rng.choice(("force", "force", "speed", "length")), tether.initial_length
        winch = Winch(winch_control=kind, **(_drum(rng, length) if kind == "force" else {}))
        lines.append(replace(line, tether=tether, winch=winch))
        if kind == "force":
            told["winch_forces"][line.name] = float(rng.uniform(0.0, 400.0))
        elif kind == "speed":
            told["reel_out_speeds"][line.name] = float(rng.uniform(-0.5, 0.5))
        else:
            told["winch_lengths"][line.name] = length
    air = (WITHOUT_AIR, np.zeros(3)) if bare else (network.environment, network.wind)
    return Network(network.points, lines, *air, network.motions, network.loads), told


def _drum(rng, length):
    """Quantities of a drum: with and without mass, damping, friction and stops."""
    drum = {"winch_mass": float(rng.choice((0.0, rng.uniform(1.0, 100.0))))}
    drum["winch_damping"] = float(rng.choice((0.0, rng.uniform(1.0, 100.0))))
    drum["winch_friction"] = float(rng.choice((0.0, rng.uniform(1.0, 100.0))))
    if rng.random() < 0.5:
        drum |= {"shortest_length": length * float(rng.uniform(0.95, 1.0)), "longest_length": length * 1.02}
    return drum


def started(network, told, solver):
    """System of a network whose winches are told this, initialized."""
    system = TetherSystem(network.points, network.lines, network.environment, solver)
    system.initialize(network.wind, loads=network.loads, **told)
    return system


def step(network, told, system, number, h):
    """Step `number` of h [s] of a system with the driven points on their ways; its outputs."""
    ways = {name: motion(number * h) for name, motion in network.motions.items()}
    positions, velocities = ({name: way[k] for name, way in ways.items()} for k in range(2))
    return system.step(h, positions=positions, velocities=velocities, **told)


def left(network, told, system, number, h):
    """`Left` after such a step, or None if the system has taken it in parts: then x1 - x0 is not h v1."""
    before, x0, v0 = system.outputs(), network.gathered(system.positions), network.gathered(system.velocities)
    after = step(network, told, system, number, h)
    x, v = network.gathered(system.positions), network.gathered(system.velocities)
    if np.abs(x - x0 - h * v)[network.free].max() > ROUNDING:
        return None
    _lengthen(network, after)
    _, tension, _ = network.segments(0.0, x, v)
    force, drums = network.forces(0.0, x, v), []
    accelerations = (v - v0) / h
    for line in network.lines:
        old, new = before.lines[line.name], after.lines[line.name]
        speed = new.winch_speed
        if line.name in told["winch_forces"]:  # in the step, after which a stop may have taken it
            speed = (new.tether_length - old.tether_length) / h
        nodes, flowing, column, pull, inertia = network.flow(line.name, x, v, new.tether_length, speed)
        gained = (speed - old.winch_speed) / h
        if line.name in told["winch_lengths"]:  # the end of a cubic polynomial
            mean = (new.tether_length - old.tether_length) / h
            gained = (2.0 * old.winch_speed + 4.0 * new.winch_speed - 6.0 * mean) / h
        np.add.at(force, nodes, flowing + gained * column)
        if line.name in told["winch_forces"]:
            pull += (column * accelerations[nodes]).sum() - inertia * gained
            stiffness = line.tether.axial_stiffness
            tension = rope_tension(stiffness, pull)
            drums.append(_left_of_drum(line, tension, told, old, new, h))
    rest = force - network.masses(0.0)[:, None] * accelerations
    largest = max(1.0, np.abs(tension).max(), np.abs(network.forces(0.0, x, v)[network.free]).max())
    return Left(np.abs(rest[network.free]).max() / largest, max(drums, default=0.0) / largest)


def _lengthen(network, outputs):
    """Let the segments of a network have the unstretched lengths of its lines now; they keep these in the formulas."""
    rest = [[outputs.lines[each.name].tether_length / each.tether.segments] * each.tether.segments for each in network.lines]
    network.rest, network.speeds = np.concatenate(rest), np.zeros(len(network.p))


def _left_of_drum(line, tension, told, before, after, h):
    """What is left of the equation of a drum [N]; 0 at a stop, and where friction lets it rest before it turns round."""
    winch, speed = line.winch, after.winch_speed
    is_brought_to_rest = speed == 0.0 != before.winch_speed
    stops = winch.shortest_length, winch.longest_length, MIN_SEGMENT_LENGTH * line.tether.segments
    if is_brought_to_rest or after.tether_length in stops:
        return 0.0
    turning = winch.winch_mass * (speed - before.winch_speed) / h + winch.winch_damping * speed
    rest = tension - told["winch_forces"][line.name] - turning
    if speed == 0.0:
        return max(0.0, abs(rest) - winch.winch_friction)
    return abs(rest - np.sign(speed) * winch.winch_friction)
