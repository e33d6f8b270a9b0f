"""Random systems with drums that hold several lines, or that turn beside sheaves, to be flown with any solver."""

from dataclasses import replace

import numpy as np

from random_sheaves import random_ropes
from tetherfmu import Line, Point, SharedWinch, Solver, Tether, TetherSystem, Winch


def _of_drum(rng):
    return {
        "winch_mass": float(rng.choice((0.0, 2.0, 20.0))),
        "winch_damping": float(rng.choice((0.0, 50.0))),
        "winch_friction": float(rng.choice((0.0, 40.0))),
    }


def random_winches(rng):
    """Points, lines and winches: ropes over sheaves, some with drums, and a load on two lines that up to two drums hold."""
    points, lines, environment, _ = random_ropes(rng, is_wild=False)
    lines = [
        replace(line, winch=Winch(winch_control="force", **_of_drum(rng)) if rng.random() < 0.5 else Winch())
        for line in lines
    ]
    points += [Point("top", (50.0, 0.0, 30.0)), Point("load", (52.0, 1.0, 12.0), mass=float(rng.uniform(5.0, 60.0)))]
    points.append(Point("far", (60.0, 0.0, 30.0)))
    stiffness = float(10.0 ** rng.uniform(3.5, 5.5))
    tether = Tether(segments=int(rng.integers(1, 6)), axial_stiffness=stiffness, axial_damping=0.01 * stiffness)
    for name, start, end, length in (("a", "top", "load", 18.1), ("b", "far", "load", 19.6), ("c", "top", "load", 18.2)):
        lines.append(Line(name, start, end, replace(tether, initial_length=length)))
    distance = float(np.linalg.norm(np.subtract(points[0].position, (50.0, 0.0, 30.0))))
    lines.append(Line("d", points[0].name, "top", replace(tether, initial_length=1.02 * distance)))
    ratios = float(rng.choice((-1.0, 0.5, 2.0)))
    winches = [SharedWinch("one", {"a": 1.0, "c": ratios}, "force", **_of_drum(rng))]
    if rng.random() < 0.5:
        winches.append(SharedWinch("two", {"a": 1.0, "c": 1.5}, "force", **_of_drum(rng)))
    return points, lines, environment, winches


def started(network, solver=Solver()):  # noqa: B008 (a constant record)
    points, lines, environment, winches = network
    system = TetherSystem(points, lines, environment, solver, winches=winches)
    system.initialize((6.0, 2.0, 0.0))
    return system


def told(network, time):
    """Inputs at a time [s]: driven points go straight on, drums pull more and less, other winches reel to and fro."""
    points, lines, _, winches = network
    driven = [each for each in points if each.is_driven]
    by_force = [each.name for each in lines if each.winch.winch_control == Winch(winch_control="force").winch_control]
    by_force += [each.name for each in winches]
    held = {name for each in winches for name in each.lines}
    return {
        "positions": {each.name: np.add(each.position, time * np.array(each.velocity)) for each in driven},
        "velocities": {each.name: each.velocity for each in driven},
        "winch_forces": {name: 150.0 + 120.0 * np.sin(4.0 * time + k) for k, name in enumerate(by_force)},
        "reel_out_speeds": {
            each.name: 0.2 * np.sin(3.0 * time) for each in lines if each.name not in by_force and each.name not in held
        },
    }
