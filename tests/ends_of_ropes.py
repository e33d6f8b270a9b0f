"""Loads that run into their sheave or drum, and winches that let go: energy that is made beyond what was given.

    gained(...) = max over the communication steps of E - E_start - W (L_start - L) - rope that leaves the winch

with the work of the winch force W, and mu u^3/2 per second in rope that leaves a winch at u. Each is divided by a work: of
the winch over 10 m, of the free fall of 1 s.
"""

from itertools import product

import numpy as np

from tetherfmu import Line, Point, Tether, TetherDynamicFree, TetherSystem, Winch

G, FALL, STEP = 9.81, 4.9, 0.01  # m/s2; of 1 s from rest [m]; communication step [s]
STIFF = {"axial_stiffness": 6.9e5, "axial_damping": 473.0, "slack_stiffness_ratio": 0.0, "diameter": 0.004}
DRUMS = [*product((1.0, 20.0, 50.0), (1, 4), (0.009, 0.1), (0.0, 10.0))]  # mass, segments, density, mass of the drum
FREE = [*product((0.002, 0.003, 0.004, 0.008), (4, 10, 20), (10.0, 50.0), (5.0, 30.0))]  # diameter, segments, length, mass


def over_a_sheave(block, weight, rope, steps, solver):
    """Largest energy [J] beyond that at the start; block, weight : position [m] and mass [kg] at 10 and 4 m of rope."""
    (at_block, of_block), (at_weight, of_weight) = block, weight
    points = [
        Point("block", at_block, mass=of_block),
        Point("top", (0.0, 0.0, 0.0)),
        Point("weight", at_weight, mass=of_weight),
    ]
    tether = Tether(initial_length=14.0, **STIFF, **rope)
    line = Line("rope", "block", "weight", tether, through=["top"], initial_portions=[10.0, 4.0])
    system = TetherSystem(points, [line], solver=solver)
    system.initialize()
    start, gained = system.energy().total, 0.0
    for _ in range(steps):
        system.step(STEP)
        gained = max(gained, system.energy().total - start)
    return gained


def on_a_drum(mass, segments, density, solver, **winch):
    """A load that hangs 10 m below a winch by force on a rope of `density` [kg/m], without drag."""
    rope = Tether(segments=segments, initial_length=10.0, mass_per_length=density, drag_coefficient=0.0, **STIFF)
    drum = Winch(winch_control="force", **winch)
    tether = TetherDynamicFree(rope, kite_mass=mass, kite_start="equilibrium", winch=drum, solver=solver)
    tether.initialize(kite_position=(0.0, 0.0, -10.0), winch_force=mass * G)
    return tether


def at_a_drum(mass, segments, density, drum, solver):
    """A load is pulled up to the stop of its winch, or runs out with a heavy rope; also the energy of that rope."""
    tether, force = on_a_drum(mass, segments, density, solver, winch_mass=drum, shortest_length=0.1), 1.3 * mass * G
    start, of_rope, speed, gained = tether.energy().total, 0.0, 0.0, 0.0
    for _ in range(500):
        outputs = tether.step(STEP, winch_force=force)
        of_rope += STEP * 0.5 * density * 0.5 * (speed**3 + outputs.winch_speed**3)
        speed = outputs.winch_speed
        gained = max(gained, tether.energy().total - start - force * (10.0 - outputs.tether_length) - of_rope)
    return gained / (force * 10.0), of_rope / (force * 10.0)


def at_a_free_winch(diameter, segments, length, mass, solver):
    """A winch without mass lets a load go, and its rope springs back and piles up; also the speed of the load [m/s]."""
    stiff = {"axial_stiffness": 3.8e10 * diameter**2, "axial_damping": 3e7 * diameter**2, "slack_stiffness_ratio": 0.0}
    rope = Tether(segments=segments, initial_length=length, diameter=diameter, **stiff)
    winch = Winch(winch_control="force")
    tether = TetherDynamicFree(rope, kite_mass=mass, kite_start="equilibrium", winch=winch, solver=solver)
    tether.initialize(kite_position=(0.0, 0.0, -length), winch_force=mass * G)
    allowed, speed, gained, density = tether.energy().total, 0.0, 0.0, 724.0 * np.pi / 4.0 * diameter**2
    for _ in range(100):
        outputs = tether.step(STEP, winch_force=0.0)
        allowed += STEP * 0.5 * density * max(speed, outputs.winch_speed) ** 3
        speed = outputs.winch_speed
        gained = max(gained, tether.energy().total - allowed)
    return gained / (mass * G * FALL), np.linalg.norm(outputs.kite_velocity)
