"""Systems of tethers in MoorDyn and in `TetherSystem`: two scenes side by side, and what they cost.

    pip install "moordyn>=2.7"
    python tests/benchmarks/moordyn_systems.py [--write | --cost]

Prints the differences from MoorDyn, as CSV; `--write` also writes tests/reference/moordyn_*.csv; `--cost` times both.
Tethers are 4 mm of Dyneema; slack segments have damping but no stiffness, as in MoorDyn. Its water has
the density of air and its surface is far above; a stronger gravity makes up for the buoyancy, and free points have a volume
that is buoyant like the tethers. Scenes, from rest, without wind:

    y        a knot of 2 kg on 100 m of tether from the ground and on two arms of 40 m, whose kites move by 8 m in 4 s
    drones   four points 10 m apart carry 40 kg on ropes of 15 m with 3 segments, and move by 10 m in 4 s

Drag differs: MoorDyn's acts on nodes across the mean direction of the two segments beside, ours on segments, half at each
end. So each scene is flown without and with drag (coefficient 1.2).
"""

import argparse
import sys
import tempfile
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.csv_rows import print_csv
from benchmarks.moordyn_ground import AIR, DEPTH, EVERY, REFERENCE, ramp, silence
from tetherfmu import Line, Point, Solver, Tether, TetherSystem
from tetherfmu.study.measuring.tables import circumstances

DURATION, FINE = 6.0, 0.001  # of a scene, and of the converged communication step [s]
DRAG = 1.2
NO_SPRING = 1e-12  # of a slack segment, which keeps its damper, as in MoorDyn
ROPE = Tether(slack_stiffness_ratio=NO_SPRING, drag_coefficient=0.0)
HEAD = ("scene", "drag coefficient", "from MoorDyn differs", "free point mm", "largest mm", "forces N", "largest N")
FILE = """--- MoorDyn input
system
--- LINE TYPES
Name Diam MassDen EA BA EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s) (N-m^2) (-) (-) (-) (-)
tether {d} {mass} {stiffness} {damping} 0 {drag} 0 0 0
--- POINTS
ID Type X Y Z Mass Volume CdA Ca
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
{points}
--- LINES
ID LineType AttachA AttachB UnstrLen NumSegs Outputs
(-) (-) (-) (-) (m) (-) (-)
{lines}
--- OPTIONS
{step} dtM
RK4 tScheme
{gravity} g
{density} WtrDnsty
{depth} WtrDpth
0.02 dtIC
200 TmaxIC
1e-9 threshIC
0 writeLog
1 disableOutput
--- END
"""


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


class MoorDyn:
    """A scene in MoorDyn, with the nodes where ours start."""

    def __init__(self, name, drag, step):
        """Steps `step` [s] of RK4 inside."""
        import moordyn

        self.library = moordyn
        self.ours, self.free, self.path = system_of(name, drag, Solver())
        found = self.ours.initialize().points[self.free.name].position
        self.names = [*self.path(0.0), self.free.name]
        density = ROPE.mass_per_length / (0.25 * np.pi * ROPE.diameter**2)
        text = FILE.format(
            d=ROPE.diameter,
            mass=ROPE.mass_per_length,
            stiffness=ROPE.axial_stiffness,
            damping=ROPE.axial_damping,
            drag=drag,
            points="\n".join(self._point(k, found, density) for k in range(len(self.names))),
            lines="\n".join(self._line(k, line) for k, line in enumerate(self.ours.lines)),
            step=step,
            gravity=AIR.gravity * density / (density - AIR.air_density),
            density=AIR.air_density,
            depth=2.0 * DEPTH,
        )
        with silence(), tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "system.txt"
            file.write_text(text)
            self.system = moordyn.Create(str(file))
            moordyn.Init(self.system, *self.driven(0.0, FINE))
            self.lines = [moordyn.GetLine(self.system, k + 1) for k in range(len(self.ours.lines))]

    def _point(self, k, found, density):
        """Line of the file for a point."""
        name, is_free = self.names[k], k == len(self.names) - 1
        x, y, z = found if is_free else self.path(0.0)[name]
        mass = self.free.mass if is_free else 0.0
        return f"{k + 1} {'Free' if is_free else 'Coupled'} {x} {y} {z - 2.0 * DEPTH} {mass} {mass / density} 0 0"

    def _line(self, k, line):
        """Line of the file for a line."""
        ends = " ".join(str(self.names.index(each) + 1) for each in (line.start, line.end))
        return f"{k + 1} tether {ends} {line.tether.initial_length} {line.tether.segments} -"

    def driven(self, time, step):
        """Positions of the driven points [m], and their mean velocities [m/s] over a step."""
        now, then = (np.array([*self.path(each).values()]) for each in (time, time + step))
        return (now - (0.0, 0.0, 2.0 * DEPTH)).ravel().tolist(), ((then - now) / step).ravel().tolist()

    def row(self, time):
        """Row of a file."""
        nodes = []
        for line, own in zip(self.ours.lines, self.lines, strict=True):
            x = np.array([self.library.GetLineNodePos(own, i) for i in range(line.tether.segments + 1)])
            nodes.append(x + np.array((0.0, 0.0, 2.0 * DEPTH)))
        return row(time, self.ours, self.free.name, nodes)

    def fly(self, step=FINE):
        """Rows every `EVERY` seconds, and the processor time of the steps [s]."""
        rows, every, seconds = [self.row(0.0)], round(EVERY / step), 0.0
        with silence():
            for k in range(round(DURATION / step)):
                given = self.driven(k * step, step)
                start = process_time()
                self.library.Step(self.system, *given, k * step, step)
                seconds += process_time() - start
                if (k + 1) % every == 0:
                    rows.append(self.row((k + 1) * step))
        self.library.Close(self.system)
        return np.array(rows), seconds


def differences(found, right):
    """Root mean square and largest difference of the free point [mm] and of the forces [N]."""
    gap = found - right
    return [each for part in (1e3 * gap[:, 1:4], gap[:, 4:]) for each in (np.sqrt(np.mean(part**2)), np.abs(part).max())]


def compare(step, keep):
    """Table of differences from MoorDyn with the largest step that is converged; `keep` writes its series."""
    print_csv(*HEAD)
    for name in ("y", "drones"):
        for drag in (0.0, DRAG):
            right, _ = MoorDyn(name, drag, step).fly()
            if keep and drag == 0.0:
                header = ",".join(columns(name))
                np.savetxt(REFERENCE / f"moordyn_{name}.csv", right, fmt="%.8g", delimiter=",", header=header, comments="")
            ways = {
                "TetherSystem, steps of 1 ms": ours(name, drag, FINE, 1e-8)[0],
                "TetherSystem, steps of 20 ms, default tolerance": ours(name, drag)[0],
                "MoorDyn, dtM twice as long": MoorDyn(name, drag, 2.0 * step).fly()[0],
            }
            for what, found in ways.items():
                print_csv(name, f"{drag:g}", what, *(f"{each:.2g}" for each in differences(found, right)))


def theirs(name, step):
    """What MoorDyn gives with communication steps of 20 ms, without drag."""
    return MoorDyn(name, 0.0, step).fly(0.02)


TOLERANCES, STEPS = (1e-2, 1e-3, 1e-4, 1e-5), (1e-3, 4e-4, 2e-4, 1e-4)  # of the table of costs: ours, and dtM of MoorDyn [s]


def raced(name, repeats):
    """Rows of the table of costs of a scene: a way, errors of the free point [mm] and of forces [N], processor time [s].

    All ways take turns; the least of the times of each counts. A way that ends in an error, as an explicit method does whose
    steps are too long, has an infinite time.
    """
    ways = {f"TetherSystem, tolerance {each:g}": (ours, (name, 0.0, 0.02, each)) for each in TOLERANCES}
    ways |= {f"MoorDyn RK4, dtM {1e6 * step:.0f} us": (theirs, (name, step)) for step in STEPS}
    exact = {ours: ours(name, 0.0, 0.02, 1e-8)[0], theirs: theirs(name, 2e-5)[0]}
    least, found = dict.fromkeys(ways, np.inf), {}
    for _ in range(repeats):
        for what, (fly, given) in ways.items():
            with suppress(RuntimeError):
                found[what], seconds = fly(*given)
                least[what] = min(least[what], seconds)
    for what, (fly, _) in ways.items():
        place, _, force, _ = differences(found[what], exact[fly]) if what in found else [np.nan] * 4
        yield what, place, force, least[what]


def cost(repeats):
    """Table of errors and times with steps of 20 ms, without drag; each against its own solution with small steps.

    The last column: the least time of MoorDyn with forces at least as accurate, over that of the row.
    """
    print_csv("scene", "solver", "error of the free point mm", "of forces N", "ms per simulated second", "MoorDyn over it")
    for name in ("y", "drones"):
        rows = list(raced(name, repeats))
        for what, place, force, seconds in rows:
            as_good = [t for other, _, error, t in rows if other.startswith("MoorDyn") and error <= force]
            over = f"{min(as_good) / seconds:.2g}" if as_good and what.startswith("Tether") else ""
            numbers = (f"{place:.2g}", f"{force:.2g}", f"{1e3 * seconds / DURATION:.3g}")
            print_csv(name, what, *(numbers if np.isfinite(seconds) else ("unstable", "", "")), over)


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the reference files")
    parser.add_argument("--cost", action="store_true", help="time both instead")
    parser.add_argument("--step", type=float, default=2e-5, help="dtM [s]")
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    print(circumstances(), file=sys.stderr)
    cost(given.repeats) if given.cost else compare(given.step, given.write)


if __name__ == "__main__":
    main()
