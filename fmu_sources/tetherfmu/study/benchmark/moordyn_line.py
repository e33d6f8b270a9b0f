"""Peer: MoorDyn flies the circle.

Its water stands for the air: density 1.225 kg/m3, 50 km deep, the scene far below its surface. Buoyancy is made up for by
a stronger gravity. Wind: both ends move against it through air at rest, which is the same flight seen from the air. Drag is
taken at nodes instead of at segments and slack segments have no stiffness, so the forces differ by 1 to 4 percent: an
error against our reference would compare the models. What is compared is the cost at the largest step that is stable.
"""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

import moordyn
import numpy as np

from tetherfmu.study.scenes.standard import STEP, circle

DEPTH = 50_000.0
SCHEMES = (("RK2", 0.002), ("RK4", 0.004))  # the largest that divide 20 ms and are stable at 20 segments
INPUT = """--- MoorDyn input
circle
--- LINE TYPES
Name Diam MassDen EA BA EI Cd Ca CdAx CaAx
(-) (m) (kg/m) (N) (N-s) (N-m^2) (-) (-) (-) (-)
tether {diameter} {line_density} {stiffness} {damping} 0 {drag} 0 0 0
--- POINTS
ID Type X Y Z Mass Volume CdA Ca
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Coupled 0 0 {ground} 0 0 0 0
2 Coupled {kite} 0 0 0 0
--- LINES
ID LineType AttachA AttachB UnstrLen NumSegs Outputs
(-) (-) (-) (-) (m) (-) (-)
1 tether 1 2 {length} {segments} -
--- OPTIONS
{step} dtM
{scheme} tScheme
{gravity} g
{density} WtrDnsty
{depth} WtrDpth
0 kBot
0 cBot
0.02 dtIC
60 TmaxIC
0.001 threshIC
0 writeLog
1 disableOutput
--- END
"""


@contextmanager
def silence():
    """Send what a library prints to nowhere."""
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def ends(scene, time):
    """Positions and velocities of both ends for MoorDyn, lists of six numbers."""
    position, velocity = map(np.array, circle(time))
    drift = -np.array(scene.wind)
    below = np.array([0.0, 0.0, -DEPTH / 2.0]) + drift * time
    return [*below, *(below + position)], [*drift, *(velocity + drift)]


class Flight:
    """The circle in MoorDyn, after its initial relaxation."""

    def __init__(self, scene, scheme, step):
        tether, air = scene.tether, scene.environment
        text = INPUT.format(
            diameter=tether.diameter,
            line_density=tether.density * np.pi * tether.diameter**2 / 4.0,
            stiffness=tether.axial_stiffness,
            damping=tether.axial_damping,
            drag=tether.drag_coefficient,
            ground=-DEPTH / 2.0,
            kite=" ".join(str(float(value)) for value in ends(scene, 0.0)[0][3:]),
            length=tether.initial_length,
            segments=tether.segments,
            step=step,
            scheme=scheme,
            gravity=air.gravity * tether.density / (tether.density - air.air_density),
            density=air.air_density,
            depth=DEPTH,
        )
        self.motion = [ends(scene, k * STEP) for k in range(round(scene.duration / STEP))]
        self.done = 0
        with silence(), tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "line.txt"
            file.write_text(text)
            self.system = moordyn.Create(str(file))
            moordyn.Init(self.system, *ends(scene, 0.0))

    def fly(self, steps):
        """So many communication steps more; returns the force on the kite [N] at the end of each, array (steps, 3)."""
        forces = []
        for k in range(self.done, self.done + steps):
            forces.append(moordyn.Step(self.system, *self.motion[k], k * STEP, STEP)[3:])
        self.done += steps
        return np.array(forces)
