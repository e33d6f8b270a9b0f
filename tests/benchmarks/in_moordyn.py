"""Tethers in MoorDyn, which its water surrounds as air does, for `moordyn_ground.py` and `moordyn_systems.py`.

The water has the density of air and its surface is far above; a stronger gravity makes up for the buoyancy.
"""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from time import process_time

import numpy as np
from as_script import REFERENCE, print_csv

from tetherfmu import Environment

AIR = Environment()
FINE, EVERY = 0.001, 0.1  # converged communication step and time between rows of a file [s]
NO_SPRING = 1e-12  # of a slack segment, which keeps its damper, as in MoorDyn
FILE = """--- MoorDyn input
tethers
--- LINE TYPES
Name Diam MassDen EA BA EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s) (N-m^2) (-) (-) (-) (-)
tether {rope.diameter} {rope.mass_per_length} {rope.axial_stiffness} {rope.axial_damping} 0 {rope.drag_coefficient} 0 0 0
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
{scheme} tScheme
{gravity} g
{density} WtrDnsty
{depth} WtrDpth
{more}
0.02 dtIC
200 TmaxIC
0 writeLog
1 disableOutput
--- END
"""


def ramp(time):
    """From 0 to 1 while the time goes from 0 to 1, without jumps of speed or acceleration."""
    part = np.clip(time, 0.0, 1.0)
    return part**3 * (10.0 - 15.0 * part + 6.0 * part**2)


@contextmanager
def silence():
    """Send what a library prints to nowhere."""
    kept = os.dup(1), os.dup(2)
    with open(os.devnull, "wb") as nowhere:
        for each in (1, 2):
            os.dup2(nowhere.fileno(), each)
    try:
        yield
    finally:
        for each, former in zip((1, 2), kept, strict=True):
            os.dup2(former, each)
            os.close(former)


def density(rope):
    """Of a `Tether` [kg/m3]: the volume that it displaces is that of its diameter."""
    return rope.mass_per_length / (0.25 * np.pi * rope.diameter**2)


class MoorDyn:
    """Tethers in MoorDyn, at their start."""

    def __init__(self, rope, points, lines, places, depth, step, scheme="RK4", **more):
        """`step` : inside MoorDyn [s].

        rope : `Tether` of all lines.  points : (type, mass [kg], place [m]) of each.  lines : numbers of both points from 1
        on, unstretched length [m] and segments of each.  places : function of the time, places of the driven points (k, 3).
        depth : of the origin below the surface [m].  more : options of the file.
        """
        import moordyn

        self.library, self.places, self.depth = moordyn, places, np.array((0.0, 0.0, depth))
        self.counts = [segments for *_, segments in lines]
        displaced = ((kind, *(place - self.depth), mass, mass / density(rope)) for kind, mass, place in points)
        text = FILE.format(
            rope=rope,
            points="\n".join(f"{k} {' '.join(map(str, each))} 0 0" for k, each in enumerate(displaced, 1)),
            lines="\n".join(f"{k} tether {' '.join(map(str, each))} -" for k, each in enumerate(lines, 1)),
            step=step,
            scheme=scheme,
            gravity=AIR.gravity * density(rope) / (density(rope) - AIR.air_density),
            density=AIR.air_density,
            depth=depth,
            more="\n".join(f"{value} {name}" for name, value in more.items()),
        )
        with silence(), tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "tethers.txt"
            file.write_text(text)
            self.system = moordyn.Create(str(file))
            moordyn.Init(self.system, *self.driven(0.0, FINE))
            self.lines = [moordyn.GetLine(self.system, k + 1) for k in range(len(lines))]

    def driven(self, time, step):
        """Positions of the driven points [m], and their mean velocities [m/s] over a step."""
        now, then = self.places(time), self.places(time + step)
        return (now - self.depth).ravel().tolist(), ((then - now) / step).ravel().tolist()

    def nodes(self):
        """Positions [m] and velocities [m/s] of the nodes, (segments + 1, 3), of each line."""
        for line, count in zip(self.lines, self.counts, strict=True):
            x, v = (
                np.array([of(line, i) for i in range(count + 1)])
                for of in (self.library.GetLineNodePos, self.library.GetLineNodeVel)
            )
            yield x + self.depth, v

    def fly(self, row, duration, step=FINE):
        """Rows every `EVERY` seconds, each of row(time, nodes), and the processor time of the steps [s]."""
        rows, every, seconds = [row(0.0, [*self.nodes()])], round(EVERY / step), 0.0
        with silence():
            for k in range(round(duration / step)):
                given, start = self.driven(k * step, step), process_time()
                self.library.Step(self.system, *given, k * step, step)
                seconds += process_time() - start
                if (k + 1) % every == 0:
                    rows.append(row((k + 1) * step, [*self.nodes()]))
        self.library.Close(self.system)
        return np.array(rows), seconds


def write(name, columns, rows):
    """Write a reference file."""
    path = REFERENCE / f"moordyn_{name}.csv"
    np.savetxt(path, rows, fmt="%.8g", delimiter=",", header=",".join(columns), comments="")


def sizes(*gaps):
    """Root mean square and largest of each gap."""
    return [each for gap in gaps for each in (np.sqrt(np.mean(gap**2)), np.abs(gap).max())]


def print_errors(*what, errors):
    """Print a row of a table."""
    print_csv(*what, *(f"{each:.2g}" for each in errors))


def raced(ways, repeats):
    """What each way has flown, and its least time [s]; all take turns.

    ways : name, and function that returns rows and seconds.  One that ends in an error, as an explicit method does whose
    steps are too long, has an infinite time and no rows.
    """
    found, least = {}, dict.fromkeys(ways, np.inf)
    for _ in range(repeats):
        for name, fly in ways.items():
            try:
                found[name], seconds = fly()
            except RuntimeError:
                continue
            least[name] = min(least[name], seconds)
    return found, least
