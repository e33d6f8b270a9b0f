"""How fast does a tether recoil that breaks while its kite flies a loop, and where does it fall?

    python examples/ground/breaking_tether.py

A kite flies loops at 505 m of tether and pulls hardest at their bottom. The tether breaks at 4 kN near the kite, and its end
recoils behind an elastic wave at the speed of a rope that had the tension T everywhere,

    v = T/sqrt(EA mu)

with EA and the mass per length mu. Then it falls, and lies on the ground.
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu import Ground, Tether, TetherDynamic, kite_at
from tetherfmu.console.colours import BLACK, BLUE, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from shared.ropes import NO_PUSH

LENGTH, STRENGTH, SEGMENTS = 505.0, 4000.0, 50  # m, N, -
RATE, WIDTH, MIDDLE = 0.9, 0.12, 0.6  # of the loop: rad/s, rad, elevation in rad
PULL = 0.0055, 0.0025  # strain of the tether in the middle of the loop, and what its bottom adds
STEP, FINE, LONGEST, FALL = 0.02, 0.001, 10.0, 20.0  # s
ECHO = 0.05  # s after the break, in which the wave does not come back to the end
SHOWN = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 20.0)  # times after the break of the shapes that are drawn [s]


def kite(time):
    """Position of the kite [m] at a time [s], and its velocity [m/s]."""
    phase, near = RATE * time, 1e-6

    def place(phase):
        stretched = 1.0 + PULL[0] - PULL[1] * np.cos(phase)
        return np.array(kite_at(MIDDLE + WIDTH * np.cos(phase), WIDTH * np.sin(phase), LENGTH * stretched))

    return place(phase), RATE * (place(phase + near) - place(phase - near)) / (2.0 * near)


def made():
    """The tether, over a ground."""
    tether = Tether(initial_length=LENGTH, segments=SEGMENTS, breaking_force=STRENGTH, **NO_PUSH)
    return TetherDynamic(tether, ground=Ground(ground_contact="flat"))


def fly():
    """Time of the break [s], speeds of the end that is left at times after it, and shapes at times after it [m].

    Returns the time, the number of the segment, pairs (time, speed) and pairs (time, positions of the nodes).
    """
    tether = made()
    tether.initialize(*kite(0.0))
    time, outputs = 0.0, None
    while outputs is None or not outputs.broken:
        before = tether.velocities
        if time > LONGEST:
            raise RuntimeError(f"the tether has not broken in {LONGEST:g} s")
        outputs = tether.step(FINE, *kite(time))
        time += FINE
    at_break = outputs.break_time
    gaps = np.linalg.norm(np.diff(tether.positions, axis=0), axis=1)
    broken = int(np.argmax(gaps))  # the ends of the broken segment move apart
    speeds, shapes = [], [(0.0, tether.positions[: broken + 1])]
    down = tether.positions[broken - 1] - tether.positions[broken]
    down /= np.linalg.norm(down)
    while time - at_break < FALL:
        step = FINE if time - at_break < ECHO else STEP
        tether.step(step, *kite(time))
        time += step
        speeds.append((time - at_break, float((tether.velocities[broken] - before[broken]) @ down)))
        if any(abs(time - at_break - each) < 0.5 * step for each in SHOWN[1:]):
            shapes.append((time - at_break, tether.positions[: broken + 1]))
    return at_break, broken + 1, np.array(speeds), shapes


def recoil():
    """Speed of the end by the formula [m/s]."""
    rope = Tether(initial_length=LENGTH)
    mass = rope.density * 0.25 * np.pi * rope.diameter**2
    return STRENGTH / np.sqrt(rope.axial_stiffness * mass)


def draw(speeds, shapes, path):
    """Speed of the end after the break with that of the formula, and shapes as the tether falls, to a file."""
    import matplotlib.pyplot as plt

    figure, (ends, space) = plt.subplots(1, 2, figsize=(11.0, 4.4), layout="constrained", width_ratios=(1.0, 1.6))
    early = speeds[:, 0] < ECHO
    ends.plot(1e3 * speeds[early, 0], speeds[early, 1], color=BLACK, label="flight")
    ends.axhline(recoil(), color=VERMILLION, linestyle="--", label="$T/\\sqrt{EA\\,\\mu}$")
    ends.set(xlabel="time after the break [ms]", ylabel="speed of the end gains [m/s]")
    ends.grid(alpha=0.3)
    ends.legend()
    for k, (time, positions) in enumerate(shapes):
        space.plot(positions[:, 0], positions[:, 2], color=BLUE, alpha=0.3 + 0.7 * k / len(shapes))
        space.annotate(f"{time:.1f} s", positions[-1, [0, 2]], fontsize=8)
    space.axhline(0.0, color=BLACK, linewidth=0.8)
    space.set(xlabel="x [m]", ylabel="z [m]")
    space.set_aspect("equal")
    figure.savefig(path, dpi=100)
    plt.close(figure)


@command
def main(arguments=None):
    """Print when the tether breaks and how fast its end recoils, write the figure."""
    parser = Parser(description="break a tether in a loop")
    parser.add_out()
    file = parser.parse_args(arguments).out / "breaking_tether.png"
    at_break, segment, speeds, shapes = fly()
    early = speeds[speeds[:, 0] < ECHO]
    print(f"segment {segment} of {SEGMENTS} breaks after {at_break:.3f} s under {STRENGTH:.0f} N")
    print(f"its end recoils at {np.median(early[:, 1]):.1f} m/s, by the formula {recoil():.1f} m/s")
    print(f"{FALL:.0f} s later it lies up to {shapes[-1][1][:, 0].max():.0f} m from the station")
    file.parent.mkdir(parents=True, exist_ok=True)
    draw(speeds, shapes, file)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
