"""Systems of tethers in MoorDyn and in `TetherSystem`: two scenes side by side, and what they cost.

    pip install "moordyn>=2.7"
    python tests/benchmarks/moordyn_systems.py [--write | --cost] [--step 2e-5] [--repeats 3]

Prints the differences from MoorDyn with steps (dtM [s]) inside, as CSV; `--write` also writes tests/reference/moordyn_*.csv;
`--cost` times both. Tethers are 4 mm of Dyneema; slack segments have damping but no stiffness, as in MoorDyn, whose air is
that of `in_moordyn.py`; free points have a volume that is buoyant like the tethers. Scenes, from rest, without wind:

    y        a knot of 2 kg on 100 m of tether from the ground and on two arms of 40 m, whose kites move by 8 m in 4 s
    drones   four points 10 m apart carry 40 kg on ropes of 15 m with 3 segments, and move by 10 m in 4 s

Drag differs: MoorDyn's acts on nodes across the mean direction of the two segments beside, ours on segments, half at each
end. So each scene is flown without and with drag (coefficient 1.2).
"""

import sys
from dataclasses import replace
from functools import partial
from time import process_time

import numpy as np
from as_script import options, print_csv
from in_moordyn import AIR, EVERY, FINE, NO_SPRING, MoorDyn, print_errors, raced, ramp, sizes, write

from tetherfmu import Line, Point, Solver, Tether, TetherSystem
from tetherfmu.study.measuring.tables import circumstances

DURATION, DEPTH = 6.0, 200.0  # of a scene [s], of the origin below MoorDyn's surface [m]
DRAG = 1.2
ROPE = Tether(slack_stiffness_ratio=NO_SPRING, drag_coefficient=0.0)
HEAD = ("scene", "drag coefficient", "from MoorDyn differs", "free point mm", "largest mm", "forces N", "largest N")


def y(time):
    """Places of the driven points: winch, left kite, right kite."""
    way = ramp(time / 4.0)
    return {"winch": (0.0, 0.0, 0.0), "left": (-24.0, 8.0 * way, 132.0), "right": (24.0, -8.0 * way, 132.0 + 1.0 * way)}


def drones(time):
    """Places of the four drones."""
    way = 10.0 * ramp(time / 4.0)
    corners = {"d1": (5.0, 5.0), "d2": (-5.0, 5.0), "d3": (-5.0, -5.0), "d4": (5.0, -5.0)}
    return {name: (a + way, b, 50.0) for name, (a, b) in corners.items()}


def system_of(name, drag, solver):
    """`TetherSystem` of a scene at its start, in equilibrium, and the function that leads it."""
    rope = replace(ROPE, drag_coefficient=drag)
    path = {"y": y, "drones": drones}[name]
    driven = [Point(each, place) for each, place in path(0.0).items()]
    if name == "y":
        arm = replace(rope, initial_length=39.9, segments=4)
        lines = [Line("main", "winch", "knot", replace(rope, initial_length=99.9, segments=10))]
        lines += [Line("a", "knot", "left", arm), Line("b", "knot", "right", arm)]
        free = Point("knot", mass=2.0)
    else:
        short = replace(rope, initial_length=15.0, segments=3)
        lines = [Line(f"l{each.name}", each.name, "load", short) for each in driven]
        free = Point("load", mass=40.0)
    system = TetherSystem([*driven, free], lines, AIR, solver)
    return system, free, path


def row(time, system, free, nodes):
    """Row of a file: time [s], place of the free point [m], springs' force in the first segment of each line [N].

    nodes : positions of the nodes of each line, arrays (segments + 1, 3), in their order.
    """
    line, place = next(
        (k, end) for k, each in enumerate(system.lines) for end in (0, -1) if free == (each.start, each.end)[end]
    )
    rest = [each.tether.initial_length / each.tether.segments for each in system.lines]
    stretch = [max(np.linalg.norm(x[1] - x[0]) / each - 1.0, 0.0) for x, each in zip(nodes, rest, strict=True)]
    return [time, *nodes[line][place], *(ROPE.axial_stiffness * each for each in stretch)]


def columns(name):
    """Names of the columns of a file."""
    system, *_ = system_of(name, 0.0, Solver())
    return ["time", "x", "y", "z", *(f"force_{line.name}" for line in system.lines)]


def ours(name, drag=0.0, step=0.02, tolerance=0.0):
    """Rows every `EVERY` seconds, and the processor time of the steps [s]."""
    system, free, path = system_of(name, drag, Solver(relative_tolerance=tolerance))
    steps = round(DURATION / step)
    times = step * np.arange(steps)
    places = {each: np.array([path(time)[each] for time in times]) for each in path(0.0)}
    speeds = {each: np.array([velocity(path, time, each) for time in times]) for each in places}
    system.initialize()
    rows = [row(0.0, system, free.name, [*system.positions.values()])]
    start = process_time()
    flight = system.fly(steps, step, positions=places, velocities=speeds, every=round(EVERY / step))
    seconds = process_time() - start
    for k in range(round(DURATION / EVERY)):
        nodes = [each[k] for each in flight.positions.values()]
        rows.append(row((k + 1) * EVERY, system, free.name, nodes))
    return np.array(rows), seconds


def velocity(path, time, name, short=1e-5):
    """Velocity of a driven point [m/s]."""
    return np.subtract(path(time + short)[name], path(time - short)[name]) / (2.0 * short)


def theirs(name, drag, step, every=FINE):
    """As `ours`, by MoorDyn with the nodes where ours start; steps `step` [s] inside, communication steps `every` [s]."""
    system, free, path = system_of(name, drag, Solver())
    found = system.initialize().points[free.name].position
    names = [*path(0.0), free.name]
    points = [*(("Coupled", 0.0, np.array(place)) for place in path(0.0).values()), ("Free", free.mass, np.array(found))]
    lines = [
        (names.index(each.start) + 1, names.index(each.end) + 1, each.tether.initial_length, each.tether.segments)
        for each in system.lines
    ]
    places = lambda time: np.array([*path(time).values()])  # noqa: E731
    rope = replace(ROPE, drag_coefficient=drag)
    moordyn = MoorDyn(rope, points, lines, places, DEPTH, step, threshIC=1e-9)
    return moordyn.fly(lambda time, nodes: row(time, system, free.name, [x for x, _ in nodes]), DURATION, every)


def differences(found, right):
    """Root mean square and largest difference of the free point [mm] and of the forces [N]."""
    gap = found - right
    return sizes(1e3 * gap[:, 1:4], gap[:, 4:])


def compare(step, keep):
    """Table of differences from MoorDyn with the largest step that is converged; `keep` writes its series."""
    print_csv(*HEAD)
    for name in ("y", "drones"):
        for drag in (0.0, DRAG):
            right, _ = theirs(name, drag, step)
            if keep and drag == 0.0:
                write(name, columns(name), right)
            ways = {
                "TetherSystem, steps of 1 ms": ours(name, drag, FINE, 1e-8)[0],
                "TetherSystem, steps of 20 ms, default tolerance": ours(name, drag)[0],
                "MoorDyn, dtM twice as long": theirs(name, drag, 2.0 * step)[0],
            }
            for what, found in ways.items():
                print_errors(name, f"{drag:g}", what, errors=differences(found, right))


def cost(repeats):
    """Table of errors and times with steps of 20 ms, without drag; each against its own solution with small steps.

    The last column: the least time of MoorDyn with forces at least as accurate, over that of the row.
    """
    print_csv("scene", "solver", "error of the free point mm", "of forces N", "ms per simulated second", "MoorDyn over it")
    for name in ("y", "drones"):
        ways = {f"TetherSystem, tolerance {r:g}": partial(ours, name, 0.0, 0.02, r) for r in (1e-2, 1e-3, 1e-4, 1e-5)}
        steps = (1e-3, 4e-4, 2e-4, 1e-4)  # dtM [s]
        ways |= {f"MoorDyn RK4, dtM {1e6 * step:.0f} us": partial(theirs, name, 0.0, step, 0.02) for step in steps}
        exact = {True: ours(name, 0.0, 0.02, 1e-8)[0], False: theirs(name, 0.0, 2e-5, 0.02)[0]}
        found, least = raced(ways, repeats)
        errors = {what: differences(each, exact[what.startswith("Tether")]) for what, each in found.items()}
        for what, seconds in least.items():
            if what not in errors:
                print_csv(name, what, "unstable", "", "", "")
                continue
            place, _, force, _ = errors[what]
            as_good = [least[other] for other, each in errors.items() if other.startswith("MoorDyn") and each[2] <= force]
            over = f"{min(as_good) / seconds:.2g}" if as_good and what.startswith("Tether") else ""
            print_csv(name, what, f"{place:.2g}", f"{force:.2g}", f"{1e3 * seconds / DURATION:.3g}", over)


def main():
    """Print the tables."""
    given = options(__doc__, write=False, cost=False, step=2e-5, repeats=3)
    print(circumstances(), file=sys.stderr)
    cost(given.repeats) if given.cost else compare(given.step, given.write)


if __name__ == "__main__":
    main()
