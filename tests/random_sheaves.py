"""Random systems of ropes over sheaves, and of drums that hold several lines beside them, to be flown with any solver."""

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from tetherfmu import Environment, Ground, Line, Point, SharedWinch, Tether, TetherSystem, Winch

MOST_STOPS = 5  # points of a rope
BY_FORCE, BY_LENGTH = (Winch(winch_control=name).winch_control for name in ("force", "length"))


@dataclass
class Scene:
    """Points, lines, ground and winches of a system."""

    points: list
    lines: list
    ground: Ground = field(default_factory=Ground)
    winches: list = ()

    def started(self, solver):
        """The system, from its given points."""
        system = TetherSystem(self.points, self.lines, Environment(), solver, self.ground, winches=self.winches)
        lengths = {each.name: each.initial_length for each in self.lines if each.winch.winch_control == BY_LENGTH}
        system.initialize((6.0, 2.0, 0.0), winch_lengths=lengths or None)
        return system

    def told(self, time):
        """Inputs at a time [s]: driven points go straight on, drums pull more and less, other winches reel to and fro."""
        driven = [each for each in self.points if each.is_driven]
        held = {name for each in self.winches for name in each.lines}
        by = {each.name: each.winch.winch_control for each in self.lines if each.name not in held}
        drums = [*(name for name, control in by.items() if control == BY_FORCE), *(each.name for each in self.winches)]
        lengths = {each.name: each.initial_length for each in self.lines if by.get(each.name) == BY_LENGTH}
        speeds = [name for name, control in by.items() if control not in (BY_FORCE, BY_LENGTH)]
        return {
            "positions": {each.name: np.add(each.position, time * np.array(each.velocity)) for each in driven},
            "velocities": {each.name: each.velocity for each in driven},
            "winch_forces": {name: 150.0 + 120.0 * np.sin(4.0 * time + k) for k, name in enumerate(drums)},
            "reel_out_speeds": {name: 0.3 * np.sin(3.0 * time + k) for k, name in enumerate(speeds)},
            "winch_lengths": {name: length + 0.1 * (1.0 - np.cos(3.0 * time)) for name, length in lengths.items()},
        }


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
    """`Scene` of one or two ropes over up to three sheaves each, and a line beside them."""
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
    return Scene([each for each in points if each.name in used], lines, ground)


def _of_drum(rng):
    """Quantities of a drum."""
    return {
        "winch_mass": float(rng.choice((0.0, 2.0, 20.0))),
        "winch_damping": float(rng.choice((0.0, 50.0))),
        "winch_friction": float(rng.choice((0.0, 40.0))),
    }


def random_winches(rng):
    """`Scene` of ropes over sheaves, some with drums, and a load on two lines that up to two drums hold."""
    ropes = random_ropes(rng, is_wild=False)
    points, lines = (
        ropes.points,
        [
            replace(line, winch=Winch(winch_control="force", **_of_drum(rng)) if rng.random() < 0.5 else Winch())
            for line in ropes.lines
        ],
    )
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
    return Scene(points, lines, winches=winches)
