"""How fast may four drones move their load before a rope goes slack? As fast as it leans no further than the ropes.

    python examples/systems/four_drones.py

`four_drones.toml` is a load of 12 kg on four ropes of 12 m below drones at the corners of a square of 8 m. They fly 40 m
along x, from rest to rest with the least jerk, in 14, 10 and 7 s. Four ropes that lean outwards leave the load no play: it
does not swing, it leans. With half the side b of the square, the ropes' height h and their length l, an acceleration a of
the formation along a side is carried by

    (m l/4) (g/h + a/b)  in each rope ahead of the load,   (m l/4) (g/h - a/b)  in each behind it,

so the ropes behind go slack at a = g b/h.
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu import TetherSystem
from tetherfmu.console.colours import BLACK, BLUE, GREY, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.runtime.layout import GROUND_TENSION

FILE = Path(__file__).with_name("four_drones.toml")
DRONES = {"drone_1": (4.0, 4.0), "drone_2": (-4.0, 4.0), "drone_3": (-4.0, -4.0), "drone_4": (4.0, -4.0)}  # of the file [m]
HEIGHT, HALF_SIDE, ROPE, LOAD, GRAVITY = 20.0, 4.0, 12.0, 12.0, 9.81  # m, m, m, kg, m/s2
BELOW = np.sqrt(ROPE**2 - 2.0 * HALF_SIDE**2)  # of the load under the drones [m]
WAY, DURATIONS, AFTER, STEP = 40.0, (14.0, 10.0, 7.0), 4.0, 0.02  # m, s, s, s
AHEAD, BEHIND = ("rope_1", "rope_4"), ("rope_2", "rope_3")


def motion(time, duration):
    """Way [m], speed [m/s] and acceleration [m/s2] of the formation along x at times [s], each an array like `time`."""
    s = np.clip(np.asarray(time) / duration, 0.0, 1.0)
    way = WAY * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    speed = WAY / duration * 30.0 * (s * (1.0 - s)) ** 2
    return way, speed, WAY / duration**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)


def fly(duration):
    """Times [s] after each step, and the flight (`SystemFlown`)."""
    time = STEP * np.arange(round((duration + AFTER) / STEP))
    way, speed, _ = motion(time, duration)
    level = np.zeros_like(way)
    system = TetherSystem.from_file(FILE)
    system.initialize()
    positions = {name: np.stack([x + way, y + level, HEIGHT + level], axis=1) for name, (x, y) in DRONES.items()}
    velocities = dict.fromkeys(DRONES, np.stack([speed, level, level], axis=1))
    return time + STEP, system.fly(len(time), STEP, positions=positions, velocities=velocities)


def tension(flown, ropes):
    """Mean tension [N] of two ropes at the drones, array (rows,)."""
    return np.mean([flown.outputs[name][:, GROUND_TENSION] for name in ropes], axis=0)


def tension_by_statics(acceleration, side):
    """Tension of a rope without weight [N]; acceleration [m/s2] along x; side : 1 for ropes ahead of the load, else -1."""
    return 0.25 * LOAD * ROPE * (GRAVITY / BELOW + side * acceleration / HALF_SIDE)


def draw(time, flown, duration, path):
    """Ropes from the side, and tensions over time, to a file."""
    import matplotlib.pyplot as plt

    figure, (space, pulls) = plt.subplots(2, 1, figsize=(10.0, 6.0), layout="constrained")
    for row in range(0, len(time), round(1.0 / STEP)):
        for name, colour in {**dict.fromkeys(AHEAD, VERMILLION), **dict.fromkeys(BEHIND, BLUE)}.items():
            space.plot(*flown.positions[name][row][:, ::2].T, color=colour, linewidth=0.9)
        space.plot(*flown.points["load"].position[row][::2], "o", color=BLACK, markersize=5)
    space.set(xlabel="x [m]", ylabel="z [m]", title=f"40 m in {duration:g} s, every second", aspect="equal")
    acceleration = motion(time, duration)[2]
    for ropes, side, colour, text in ((AHEAD, 1, VERMILLION, "ropes ahead"), (BEHIND, -1, BLUE, "ropes behind")):
        pulls.plot(time, tension(flown, ropes), color=colour, label=text)
        pulls.plot(time, tension_by_statics(acceleration, side), "--", color=GREY, linewidth=0.9)
    pulls.set(xlabel="time [s]", ylabel="tension of a rope [N]", title="Dashed: statics")
    for axes in (space, pulls):
        axes.grid(alpha=0.3)
    pulls.legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


@command
def main(arguments=None):
    """Print accelerations and tensions of the flights, write a figure of each."""
    parser = Parser(description="fly four drones that carry a load along a path")
    parser.add_out("the figures")
    out = parser.parse_args(arguments).out
    out.mkdir(parents=True, exist_ok=True)
    print(f"a rope goes slack at {GRAVITY * HALF_SIDE / BELOW:.2f} m/s2")
    for duration in DURATIONS:
        time, flown = fly(duration)
        largest = np.abs(motion(time, duration)[2]).max()
        pulls = np.array([tension(flown, each) for each in (AHEAD, BEHIND)])
        least, most = pulls.min(), pulls.max()
        expected = tension_by_statics(largest, -1)
        found = f"least tension {least:.1f} N (statics {expected:.1f} N)" if expected > 0.0 else "ropes go slack and snap"
        print(f"{WAY:g} m in {duration:g} s, at most {largest:.2f} m/s2: {found}, largest {most:.0f} N")
        file = out / f"four_drones_{duration:g}s.png"
        draw(time, flown, duration, file)
        print(file)


if __name__ == "__main__":
    sys.exit(main())
