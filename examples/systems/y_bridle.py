"""How far does a kite on a Y-bridle roll when its load turns and moves from one tip to the other?

    python examples/systems/y_bridle.py

The main tether of 200 m ends in a knot, and two bridle lines of 10 m go on to the tips of the wing, 6 m apart. Knot and tips
are free points. The lift of 2 kN turns to the left and to the right within a minute, as on a kite that sweeps through the
wind window; every 20 s its share moves from tip to tip by 15 %, as of a wing that is steered. The canopy spreads the
tips with 0.5 kN.

Knot and tips are a triangle, of height h above a wing of width b, that turns about the knot: at rest, with a part s of the
lift F more at one half than at the mean and tips that are spread with P, it rolls by

    tan(roll) = s (b/2) / (h + b P/F)

and by s F l^3/(h^2 b EA) more, as the lines of length l stretch: one by more than the other.
"""

import sys
from dataclasses import replace

import numpy as np

from tetherfmu import Line, Point, Tether, TetherSystem
from tetherfmu.console.colours import BLACK, BLUE, GREY, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.runtime.layout import GROUND_TENSION

MAIN, BRIDLE, WIDTH = 200.0, 10.0, 6.0  # m
LIFT, SPREAD, TIP_MASS, KNOT_MASS = 2000.0, 500.0, 2.0, 0.5  # N, N, kg, kg
ELEVATION, AZIMUTH, SHIFT = np.radians(45.0), np.radians(30.0), 0.3  # of the lift; largest part s [-]
ROPE = Tether(diameter=2.5e-3)  # of the bridle
TURN, STEERING, DURATION, STEP = 60.0, 20.0, 60.0, 0.02  # periods [s], s, s
COLOURS = {"main": BLACK, "bridle_left": BLUE, "bridle_right": VERMILLION}


def directions(time):
    """Unit vectors at times [s], (..., 3): of the lift, and from the left to the right tip if the wing does not roll."""
    azimuth = AZIMUTH * np.cos(2.0 * np.pi * np.asarray(time) / TURN)
    along, aside, none = np.cos(azimuth), np.sin(azimuth), np.zeros_like(azimuth)
    lift = np.cos(ELEVATION) * np.stack([along, aside, none + np.tan(ELEVATION)], axis=-1)
    return lift, np.stack([-aside, along, none], axis=-1)


def shift(time):
    """Part s [-] by which the right tip carries more than half of the lift, over that half, at times [s]."""
    return SHIFT * np.sin(2.0 * np.pi * np.asarray(time) / STEERING)


def loads(time):
    """Forces [N] on the tips at times [s], by name, (..., 3)."""
    lift, wing = directions(time)
    half, moved = 0.5 * LIFT * lift, shift(time)[..., None]
    return {"left": (1.0 - moved) * half - SPREAD * wing, "right": (1.0 + moved) * half + SPREAD * wing}


def kite_on_bridle():
    """The system at rest under the first load."""

    def line(name, start, end, length, segments, rope):
        return Line(name, start, end, replace(rope, segments=segments, initial_length=length))

    points = [Point("ground", (0.0, 0.0, 0.0)), Point("knot", mass=KNOT_MASS)]
    points += [Point(name, mass=TIP_MASS) for name in ("left", "right")]  # without positions: in equilibrium
    lines = [line("main", "ground", "knot", MAIN, 12, Tether()), line("wing", "left", "right", WIDTH, 2, Tether())]
    lines += [line(f"bridle_{name}", "knot", name, BRIDLE, 3, ROPE) for name in ("left", "right")]
    system = TetherSystem(points, lines)
    system.initialize(loads=loads(0.0))
    return system


def fly():
    """Times [s] after each step, and the flight (`SystemFlown`)."""
    times = STEP * np.arange(round(DURATION / STEP))
    return times + STEP, kite_on_bridle().fly(len(times), STEP, loads=loads(times))


def roll_of(flown, time):
    """Angle [rad] of the wing out of the plane across the lift, positive if the right tip is ahead, at times [s]."""
    wing = flown.points["right"].position - flown.points["left"].position
    lift, level = directions(time)
    return np.arctan2(np.sum(wing * lift, axis=-1), np.sum(wing * level, axis=-1))


def roll_at_rest(time):
    """The same [rad] by statics."""
    height = np.sqrt(BRIDLE**2 - 0.25 * WIDTH**2)
    stretched = LIFT * BRIDLE**3 / (height**2 * WIDTH * ROPE.axial_stiffness)
    return np.arctan(shift(time) * 0.5 * WIDTH / (height + WIDTH * SPREAD / LIFT)) + shift(time) * stretched


def draw(time, flown, path):
    """The kite at three rolls, seen across lift and wing; roll and tensions over time, to a file."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(10.0, 4.6), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.6))
    side = figure.add_subplot(grid[:, 0])
    last = round((DURATION - STEERING) / STEP)
    for row in last + np.round(STEERING / STEP * np.array([0.25, 0.5, 0.75])).astype(int):
        lift, level = directions(time[row])
        for name, colour in {**COLOURS, "wing": GREY}.items():
            line = flown.positions[name][row] - flown.points["knot"].position[row]
            side.plot(line @ level, line @ lift, color=colour, linewidth=2.5 if name == "wing" else 1.2)
    side.set(xlabel="along the level wing [m]", ylabel="along the lift [m]", ylim=(-4.0, 12.0), aspect="equal")
    side.set_title("At the largest rolls")
    above = figure.add_subplot(grid[0, 1])
    above.plot(time, np.degrees(roll_of(flown, time)), color=BLACK, label="flight")
    above.plot(time, np.degrees(roll_at_rest(time)), "--", color=VERMILLION, label="statics")
    above.set(ylabel="roll [deg]")
    below = figure.add_subplot(grid[1, 1], sharex=above)
    for name, colour in COLOURS.items():
        below.plot(time, 1e-3 * flown.outputs[name][:, GROUND_TENSION], color=colour, label=name)
    below.set(xlabel="time [s]", ylabel="tension [kN]", ylim=(0.0, None))
    for axes in (side, above, below):
        axes.grid(alpha=0.3)
    for axes in (above, below):
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    figure.savefig(path, dpi=100)
    plt.close(figure)


@command
def main(arguments=None):
    """Print how far the kite rolls, by the flight and by statics, write the figure."""
    parser = Parser(description="fly a kite on a Y-bridle under a load that turns")
    parser.add_out()
    file = parser.parse_args(arguments).out / "y_bridle.png"
    time, flown = fly()
    roll, at_rest = (np.degrees(each) for each in (roll_of(flown, time), roll_at_rest(time)))
    print(f"largest roll {np.abs(roll).max():.2f} deg (at rest {np.abs(at_rest).max():.2f} deg)")
    print(f"largest difference of the flight from statics {np.abs(roll - at_rest).max():.2f} deg")
    for name in COLOURS:
        tension = flown.outputs[name][:, GROUND_TENSION]
        print(f"{name}: {tension.min():.0f} to {tension.max():.0f} N")
    file.parent.mkdir(parents=True, exist_ok=True)
    draw(time, flown, file)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
