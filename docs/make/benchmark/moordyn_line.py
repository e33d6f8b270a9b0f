"""Peer: MoorDyn flies the circle.

Its water stands for the air, far below its surface. Buoyancy is made up for by a stronger gravity. Wind: both ends move
against it through air at rest, which is the same flight seen from the air. Drag is taken at nodes and slack segments have no
stiffness: an error against our reference would compare the models, so the cost at the largest stable steps is compared.
"""

import os
import tempfile
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import moordyn
import numpy as np
import pandas as pd

from tetherfmu.study.measuring.tables import page

from .races import DEFAULT, OURS, interleaved, our_run
from .scenes import STEP, circle_scene

DEPTH = 50_000.0
WARM_UP, PART = 250, 50  # communication steps, 5 s and 1 s
SCHEMES = (("RK2", 0.002), ("RK4", 0.004))  # the largest that divide 20 ms and are stable at 20 segments


@contextmanager
def silence():
    """Send what a library prints to nowhere."""
    kept = os.dup(1)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def ends(scene, time):
    """Positions and velocities of both ends for MoorDyn, lists of six numbers."""
    position, velocity = scene.flight.motion(time)[:2]
    drift = -np.array(scene.wind.velocity)
    below = np.array([0.0, 0.0, -DEPTH / 2.0]) + drift * time
    return [*below, *(below + position)], [*drift, *(velocity + drift)]


def moordyn_flight(scene, scheme, step):
    """The circle in MoorDyn after its initial relaxation, as a function that flies so many communication steps more."""
    tether, air = scene.tether, scene.environment
    gravity = air.gravity * tether.density / (tether.density - air.air_density)
    facts = {"tether": tether, "air": air, "gravity": gravity, "kite": ends(scene, 0.0)[0][3:]}
    motion = iter([(*ends(scene, k * STEP), k * STEP, STEP) for k in range(round(scene.duration / STEP))])
    with silence(), tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "line.txt"
        file.write_text(page("moordyn.txt.j2", Path(__file__).parent, scheme=scheme, step=step, depth=DEPTH, **facts))
        system = moordyn.Create(str(file))
        moordyn.Init(system, *ends(scene, 0.0))

    def fly(steps):
        for _ in range(steps):
            moordyn.Step(system, *next(motion))

    return fly


def moordyn_table(quick):
    """The circle in MoorDyn at its largest stable steps, and in our tether; a DataFrame."""
    scene = circle_scene(20, 6.0 if quick else 40.0)
    jobs = {}
    for scheme, step in SCHEMES:
        fly = moordyn_flight(scene, scheme, step)
        fly(PART if quick else WARM_UP)
        jobs[f"MoorDyn {scheme}, {1000 * step:.3g} ms"] = partial(fly, PART)
    jobs[OURS] = our_run(circle_scene(20, PART * STEP), STEP, DEFAULT, {})
    times = pd.Series(interleaved(jobs, 2 if quick else 20)[0])
    table = pd.DataFrame({"us per step": 1e6 * times / PART, "ratio": times / times[OURS]})
    return table.rename_axis("solver").reset_index()
