"""How hard do the mooring lines of a balloon pull while their winches move it? Three tether FMUs joined at a knot.

    python examples/coupling/mooring.py

A balloon of 10 kg is moored by three legs of some 60 m, each with its own winch, and is in balance at the start. Then one
winch holds, one pays out, one reels in, and the balloon moves sideways. The winches start at once, so the balloon bounces
on its legs, several times in a second: what is printed are the least and the largest pull of each interval. The legs meet
in a point, the knot. One leg is a `TetherDynamicFree` that carries the balloon; to it, the other two, each a
`TetherDynamic`, are part of the load: their `kite_force` is the force on the knot. Their half segments move with the knot,
so that `kite_mass` contains their `kite_end_mass`; its weight is in their forces already.

The forces of the two are delayed by one communication step, so the step must suit a knot of this mass on legs of this
stiffness: h < 0.2 sqrt(M/k), docs/use/coupling.md, "Knots". The example also prints how far the forces are from the exact
ones.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, number
from tetherfmu.console.progress import now
from tetherfmu.runtime.parameters import Tether

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from coupling.ways_of_coupling import UP, Leg, Scene, started, total
from shared.fmu_tools import add_fmu, find_fmu, variables_of
from shared.named_fmu import all_running

MASS, GRAVITY, SEGMENTS = 10.0, 9.81, 5  # kg, m/s2
KNOT, RADIUS = np.array([1.0, 0.5, 52.0]), 30.0  # about where the knot is, distance of the winches from the middle [m]
SPEEDS = (0.0, 0.3, -0.2)  # of reeling out [m/s]
SLACK_RATIOS = (0.01, 0.01, 0.1)  # slack_stiffness_ratio: the last leg is a stiffer rope
TAUT = 0.9997  # unstretched length over the distance of `KNOT`
IN_BALANCE, PARTS = 1e-3, 4  # [N] of the force on the knot at the start; intervals that are printed


def buoyancy(_position, _velocity):
    """Lift of the balloon and what the wind does to it [N], constant."""
    return np.array([40.0, 10.0, 600.0])


def balanced(scene):
    """The scene with its mass where legs, weight and load are in balance; RuntimeError if there is no such place nearby."""
    from scipy.optimize import root

    def force(position):
        _, outputs = started(scene._replace(position=position))
        weight = -scene.mass * scene.environment.gravity * UP
        return total(outputs) + weight + scene.load(position, np.zeros(3))

    found = root(force, scene.position)
    if not np.linalg.norm(found.fun) < IN_BALANCE:
        raise RuntimeError(f"the balance of the moored mass was not found: {found.message}")
    return scene._replace(position=found.x)


def mooring(duration, wind=(8.0, 0.0, 0.0)):
    """The `Scene`: three legs, their winches on a circle, and the balloon in balance."""
    legs = []
    for angle, speed, ratio in zip(np.radians([90.0, 210.0, 330.0]), SPEEDS, SLACK_RATIOS, strict=True):
        anchor = RADIUS * np.array([np.cos(angle), np.sin(angle), 0.0])
        length = TAUT * float(np.linalg.norm(KNOT - anchor))
        tether = Tether(segments=SEGMENTS, initial_length=length, slack_stiffness_ratio=ratio)
        legs.append(Leg(tether, tuple(anchor), speed))
    return balanced(Scene(tuple(legs), MASS, KNOT, buoyancy, np.array(wind), duration))


def fly(scene, free_fmu, driven_fmu, step):
    """Forces of the legs on the knot [N], array (rows, legs, 3), and its positions [m], (rows, 3), every step [s]."""
    with all_running([free_fmu] + [driven_fmu] * (len(scene.legs) - 1)) as ((first, *others), stop_if_pressed):
        fmus = [first, *others]
        common = [{"wind_velocity": scene.wind, "ground_position": leg.anchor} for leg in scene.legs]
        records = [
            {name: getattr(leg.tether, name) for name in ("segments", "initial_length", "slack_stiffness_ratio")}
            for leg in scene.legs
        ]
        for fmu, inputs, parameters in zip(others, common[1:], records[1:], strict=True):
            fmu.start(inputs | {"kite_position": scene.position}, **parameters)
        carried = sum(fmu.get("kite_end_mass") for fmu in others)
        first.start(common[0], kite_mass=scene.mass + carried, initial_kite_position=scene.position, **records[0])
        for fmu, leg in zip(fmus, scene.legs, strict=True):
            fmu.set(reel_out_speed=leg.reel_out_speed)
        forces, positions = [[fmu.get("kite_force") for fmu in fmus]], [first.get("kite_position")]
        for k in range(round(scene.duration / step)):
            x, v = first.get("kite_position"), first.get("kite_velocity")  # 1. The knot at the start of a step.
            load = scene.load(x, v) + np.sum(forces[-1][1:], axis=0) + carried * GRAVITY * UP  # 2. What pulls at it.
            first.set(kite_load=load)
            for fmu in others:
                fmu.set(kite_position=x, kite_velocity=v)
            for fmu in fmus:  # 3. All go to the end of the step.
                fmu.step(k * step, step)
            forces.append([fmu.get("kite_force") for fmu in fmus])
            positions.append(first.get("kite_position"))
            stop_if_pressed()
    return np.array(forces), np.array(positions)


@command
def main(arguments=None):
    """Print where the knot is and how hard the legs pull, and the error of their forces."""
    parser = Parser(description="move a balloon that is moored by three legs")
    allowed = number(1e-4, 0.05, "s")
    parser.add_argument("--step", type=allowed, default=0.002, metavar="H", help="communication step [s] (default: 0.002)")
    parser.add_argument("--quick", action="store_true", help="a fifth of a second instead of two seconds")
    add_fmu(parser, "TetherDynamic, in dist/ or else in a cache of yours; for the two legs that do not carry the balloon")
    given = parser.parse_args(arguments)
    if given.fmu:
        variables_of(given.fmu)  # before others are built
    from coupling.monolithic import exact  # before the flight, which would be in vain without scipy

    scene = mooring(0.2 if given.quick else 2.0)
    forces, positions = fly(scene, find_fmu("TetherDynamicFree"), given.fmu or find_fmu("TetherDynamic"), given.step)
    pulls = np.linalg.norm(forces, axis=2)
    print(f"at rest: knot at ({place(positions[0])}) m, legs pull with {', '.join(f'{pull:.0f}' for pull in pulls[0])} N")
    for begin, end in pairwise(np.linspace(0, len(positions) - 1, PARTS + 1).round().astype(int)):
        part = pulls[begin : end + 1]
        found = ", ".join(f"{low:.0f} to {high:.0f}" for low, high in zip(part.min(axis=0), part.max(axis=0), strict=True))
        when = f"{begin * given.step:4.2f} to {end * given.step:4.2f} s"
        print(f"{when}: legs pull with {found} N, knot then at ({place(positions[end])}) m")
    now("solving the whole mooring at once")
    expected, _ = exact(scene, np.arange(len(positions)) * given.step, 1e-8)
    error = np.linalg.norm(forces - expected) / np.linalg.norm(expected)
    print(f"error of the forces: {100.0 * error:.2g} %")


def place(position):
    """Coordinates [m] in words."""
    return ", ".join(f"{each:.2f}" for each in position)


if __name__ == "__main__":
    sys.exit(main())
