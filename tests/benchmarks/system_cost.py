"""What systems of tethers cost: time over that of single tethers with the same segments, printed as a table.

    python tests/benchmarks/system_cost.py [--fixed-step H] [--force] [--rounds 7] [--only TEXT]

Each system flies 4 s in communication steps of 20 ms at the tolerance 1e-4 while its driven points move; then each of its
lines flies alone, as a dynamic tether whose two ends are driven along the way of its points. The columns: processor time of
the system over that of its single tethers, the same for an internal step (the system takes the steps of its worst line, and
a single tether its own), and the time of an internal step for each line. Smallest of several flights that take turns.

With --fixed-step all take such steps [s] of order 2; with --force the winch of each line, with a mass, is told the tension
that it has at the start. With --only those systems whose name has this text.
"""

from dataclasses import replace
from itertools import pairwise
from time import process_time

import numpy as np
import pandas as pd
from as_script import options

from tetherfmu import Line, Point, Solver, Tether, TetherDynamic, TetherSystem, Winch
from tetherfmu.python import compiled_flight
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.layout import INPUTS
from tetherfmu.study.measuring.tables import circumstances, markdown

STEP, STEPS, WIND = 0.02, 200, (8.0, 1.0, 0.0)
DRUM = Winch(winch_control="force", winch_mass=50.0, winch_damping=20.0)


def tether(segments, length):
    """A tether of so many segments that is 0.1 % longer than the distance it spans [m]."""
    return Tether(segments=segments, initial_length=1.001 * length)


def fan(kites, segments):
    """Points and lines of a main tether to a knot, from which each kite has an arm."""
    angles = 2.0 * np.pi * np.arange(kites) / kites
    ends = [Point(f"kite{k}", (25.0 * np.cos(a), 25.0 * np.sin(a), 130.0)) for k, a in enumerate(angles)]
    arm = tether(segments, np.hypot(25.0, 30.0))
    lines = [Line("main", "winch", "knot", tether(segments, 100.0))]
    lines += [Line(f"arm{k}", "knot", end.name, arm) for k, end in enumerate(ends)]
    return [Point("winch", (0.0, 0.0, 0.0)), Point("knot", (0.0, 0.0, 100.0), mass=2.0), *ends], lines


def chain(count, segments):
    """Points and lines of so many lines of 20 m in a row, which rise from the winch to one kite."""
    way = np.array((12.0, 0.0, 16.0))
    points = [Point(f"p{k}", k * way, mass=0.5 if 0 < k < count else None) for k in range(count + 1)]
    return points, [Line(f"l{k}", a.name, b.name, tether(segments, 20.0)) for k, (a, b) in enumerate(pairwise(points))]


def ladder(rungs, segments):
    """Points and lines of two chains side by side with rungs between them: loops."""
    points = [
        Point(f"p{side}{k}", (10.0 * side, 0.0, 50.0 + 15.0 * k), mass=0.5 if 0 < k < rungs else None)
        for k in range(rungs + 1)
        for side in range(2)
    ]
    names = [point.name for point in points]
    sides = [(a, b, 15.0) for a, b in zip(names, names[2:], strict=False)]
    across = [(names[2 * k], names[2 * k + 1], 10.0) for k in range(1, rungs)]
    return points, [Line(f"l{k}", a, b, tether(segments, length)) for k, (a, b, length) in enumerate([*sides, *across])]


SYSTEMS = {
    "Y, 3 lines": (fan, 2),
    "fan, 9 lines": (fan, 8),
    "fan, 20 lines": (fan, 19),
    "chain, 5 lines": (chain, 5),
    "chain, 20 lines": (chain, 20),
    "ladder, 20 lines": (ladder, 7),
    "chain, 50 lines": (chain, 50),
    "chain, 100 lines": (chain, 100),
    "chain, 200 lines": (chain, 200),
    "ladder, 200 lines": (ladder, 67),
}
ROWS = [("Y, 3 lines", n) for n in (5, 10, 20, 50)] + [(name, 5) for name in SYSTEMS if name != "Y, 3 lines"]
ROWS += [("chain, 20 lines", 20), ("fan, 20 lines", 20)]


def motions(points):
    """Positions and velocities of the driven points at the start of each step, by name: circles of 2 m, slow at first."""
    time = STEP * np.arange(STEPS)
    angle, rate = 1.5 * time**3 / (time**2 + 1.0), 1.5 * time**2 * (time**2 + 3.0) / (time**2 + 1.0) ** 2
    moves = 2.0 * np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.0 * angle], axis=1)
    rates = 2.0 * rate[:, None] * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    moving = [point for point in points if point.is_driven and point.position[2] > 0.0]
    return {point.name: point.position + moves for point in moving}, {point.name: rates for point in moving}


class Flight:
    """A flight that can be repeated: `fly` gives its seconds, `steps` the internal steps of the last time."""

    def __init__(self, model, fly):
        self.model, self._fly, self._start = model, fly, model.get_state()

    def fly(self):
        self.model.set_state(self._start)
        return self._fly().seconds

    @property
    def steps(self):
        return self.model.counters["steps"] + self.model.counters["rejections"]


def singles(system, given, points, solver):
    """A `Flight` of each line alone along the way of its points, known after each step; given : to the system."""
    flown = system.fly(STEPS, STEP, **given)
    flights = []
    for line in system.lines:
        inputs = np.zeros((STEPS, INPUTS))
        rows = by_name(inputs)
        for end, name in (("ground", line.start), ("kite", line.end)):
            point = next(point for point in points if point.name == name)
            x, v = flown.points[name].position, flown.points[name].velocity
            rows[f"{end}_position"][:] = np.vstack([point.position, x[:-1]])
            rows[f"{end}_velocity"][:] = np.vstack([point.velocity, v[:-1]])
        rows["wind_velocity"][:] = WIND
        rows["winch_force"][:] = given["winch_forces"].get(line.name, 0.0)
        model = TetherDynamic(line.tether, solver=solver, winch=line.winch)
        first = {name: rows[name][0] for name in ("ground_position", "kite_position", "wind_velocity")}
        model.initialize(**first)
        fly = lambda model=model, inputs=inputs: model.fly(inputs, STEP, every=0, outputs=False)  # noqa: E731
        flights.append(Flight(model, fly))
    return flights


def measured(kind, segments, rounds, solver, by_force):
    """A row of the table."""
    make, count = SYSTEMS[kind]
    points, lines = make(count, segments)
    if by_force:
        lines = [replace(line, winch=DRUM) for line in lines]
    positions, velocities = motions(points)
    system = TetherSystem(points, lines, solver=solver)
    start = system.initialize(WIND)
    forces = {line.name: float(start.lines[line.name].ground_tension) for line in lines if by_force}
    given = {"positions": positions, "velocities": velocities, "winch_forces": forces}
    whole = Flight(system, lambda: system.fly(STEPS, STEP, **given, every=0))
    parts = singles(system, given, points, solver)
    seconds, alone = np.inf, np.full(len(lines), np.inf)
    for _ in range(rounds):
        seconds = min(seconds, whole.fly())
        alone = np.minimum(alone, [part.fly() for part in parts])
    each = seconds / whole.steps
    return {
        "system": kind,
        "segments of a line": segments,
        "internal steps": whole.steps,
        "of a single tether": float(np.mean([part.steps for part in parts])),
        "time over that of the single tethers": seconds / alone.sum(),
        "the same for an internal step": each / np.sum([a / part.steps for a, part in zip(alone, parts, strict=True)]),
        "for an internal step and line [us]": 1e6 * each / len(lines),
    }


def main():
    """Print the table, or the rows that are wanted."""
    given = options(__doc__, rounds=7, only="", fixed_step=0.0, force=False)
    solver = Solver(relative_tolerance=1e-4, fixed_step=given.fixed_step)
    compiled_flight.perf_counter = process_time  # other work on the machine does not count
    wanted = [(kind, n) for kind, n in ROWS if given.only in f"{kind}, n = {n}"]
    rows = [measured(kind, n, given.rounds, solver, given.force) for kind, n in wanted]
    print(f"{markdown(pd.DataFrame(rows))}\n\n{circumstances()}")


if __name__ == "__main__":
    main()
