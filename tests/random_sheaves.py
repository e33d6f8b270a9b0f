"""Random systems of ropes over sheaves, to be flown with any solver."""

from itertools import pairwise

import numpy as np

from tetherfmu import Environment, Ground, Line, Point, Solver, Tether, TetherSystem, Winch

MOST_STOPS = 5  # points of a rope
BY_LENGTH = Winch(winch_control="length").winch_control


def _point(rng, name, place, is_wild):
    """A point that is driven, or free with a mass; wild ones are light, too."""
    if rng.random() < 0.4:
        return Point(name, place, rng.normal(0.0, 0.5, 3))
    return Point(name, place, mass=float(10.0 ** rng.uniform(-1.0 if is_wild else 0.7, 2.0)))


def _rope(rng, number, stops, is_wild):
    """A rope over the points `stops`, some of them with friction or an efficiency, taut, or slack where it is wild."""
    span = sum(float(np.linalg.norm(np.subtract(a.position, b.position))) for a, b in pairwise(stops))
    ratio = rng.uniform(0.97, 1.3) if is_wild else rng.uniform(0.985, 0.999)
    stiffness = 10.0 ** rng.uniform(3.0, 7.5 if is_wild else 5.0)
    tether = Tether(
        segments=int(rng.integers(1, 6)),
        initial_length=span * float(ratio),
        diameter=float(rng.uniform(0.002, 0.02)),
        axial_stiffness=float(stiffness),
        axial_damping=float(stiffness * rng.choice((0.0, 1e-3, 0.02)) if is_wild else stiffness * 0.02),
        slack_damping_ratio=float(rng.choice((0.1, 1.0))),
    )
    count = len(stops) - 2
    losses = ({}, {"sheave_friction": rng.uniform(0.0, 0.5, count).tolist()})
    loss = (*losses, {"sheave_efficiency": rng.uniform(0.9, 1.0, count).tolist()})[int(rng.integers(3))]
    mass = {"sheave_mass": float(rng.choice((0.0, 0.5, 20.0)))}
    winch = Winch(winch_control=str(rng.choice(("speed", "length"))))
    names = [each.name for each in stops]
    return Line(f"r{number}", names[0], names[-1], tether, 0.0, winch, through=names[1:-1], **loss, **mass)


def random_ropes(rng, *, is_wild):
    """Points, lines, environment and ground of one or two ropes over up to three sheaves each, and a line beside them."""
    count = int(rng.integers(3, 8))
    places = rng.uniform((-20.0, -20.0, 5.0), (20.0, 20.0, 40.0), (count, 3))
    points = [_point(rng, f"p{k}", place, is_wild) for k, place in enumerate(places)]
    points[0] = Point("p0", places[0], rng.normal(0.0, 0.5, 3))
    lines = []
    for number in range(int(rng.integers(1, 3))):
        stops = rng.choice(count, int(rng.integers(3, min(count, MOST_STOPS) + 1)), replace=False)
        lines.append(_rope(rng, number, [points[k] for k in stops], is_wild))
    for k, line in enumerate(list(lines)):  # all are connected
        if "p0" not in (line.start, line.end, *line.through):
            end = points[int(line.end[1:])]
            distance = float(np.linalg.norm(np.subtract(end.position, places[0])))
            tether = Tether(segments=3, initial_length=1.02 * distance, axial_stiffness=1e4, axial_damping=200.0)
            lines.append(Line(f"l{k}", "p0", end.name, tether))
    used = {name for line in lines for name in (line.start, line.end, *line.through)}
    ground = Ground(ground_contact="flat") if is_wild and rng.random() < 0.3 else Ground()
    return [each for each in points if each.name in used], lines, Environment(), ground


def started(network, solver=Solver(), wind=(6.0, 2.0, 0.0)):  # noqa: B008 (a constant record)
    """The system, from its given points."""
    points, lines, environment, ground = network
    system = TetherSystem(points, lines, environment, solver, ground)
    lengths = {each.name: each.tether.initial_length for each in lines if each.winch.winch_control == BY_LENGTH}
    system.initialize(wind, winch_lengths=lengths or None)
    return system


def told(network, time):
    """Inputs at a time [s]: driven points go straight on, winches reel to and fro."""
    points, lines, _, _ = network
    driven = [each for each in points if each.is_driven]
    paid = {each.name: 0.3 * np.sin(3.0 * time + k) for k, each in enumerate(lines)}
    lengths = {each.name: each.tether.initial_length + 0.1 * (1.0 - np.cos(3.0 * time)) for each in lines}
    by_length = {each.name for each in lines if each.winch.winch_control == BY_LENGTH}
    return {
        "positions": {each.name: np.add(each.position, time * np.array(each.velocity)) for each in driven},
        "velocities": {each.name: each.velocity for each in driven},
        "reel_out_speeds": {name: value for name, value in paid.items() if name not in by_length},
        "winch_lengths": {name: lengths[name] for name in by_length},
    }
