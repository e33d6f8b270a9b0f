"""How fast do two masses on one rope run over a sheave, and what does a hook block on two or four falls do?

    python examples/systems/sheaves.py

`atwood.toml` is Atwood's machine: 20 kg and 30 kg at a rope of 1 kg/m over a sheave of 5 kg. The rope hardly stretches,
and its payout grows as a hyperbolic cosine, as more and more of it is on the heavy side.

`two_fall_hoist.toml` hauls in the rope of a hook block. On n falls the block rises with 1/n of the speed of the rope. The
sheave loses 2 %, so that the fall at the winch pulls more than the other one.

`clothes_line.toml` is a basket on a pulley between two points: it rolls to where the tensions on both sides are the same.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu import Point, TetherSystem
from tetherfmu.console.colours import BLACK, BLUE, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

FOLDER = Path(__file__).parent
GRAVITY, STEP = 9.81, 0.02  # [m/s2], [s]
LIGHT, HEAVY, SHEAVE, DENSITY, SIDE = 20.0, 30.0, 5.0, 1.0, 10.0  # of the file: kg, kg, kg, kg/m, m
SPEED, RAMP, LIFT = 0.4, 2.0, 8.0  # at which the hoist hauls in [m/s], after so long, and how long it does [s]


def payout_of_atwood(time):
    """Rope that has run over the sheave [m] at times [s]: (m1 + m2 + mu L + J/r2) a = (m2 - m1 + mu (L2 - L1)) g."""
    whole = LIGHT + HEAVY + 2.0 * DENSITY * SIDE + SHEAVE
    rate = np.sqrt(2.0 * DENSITY * GRAVITY / whole)
    return (HEAVY - LIGHT) * GRAVITY / whole / rate**2 * (np.cosh(rate * time) - 1.0)


def fly_atwood(duration=2.0):
    """Times [s] after each step, rope that has run over the sheave [m], and tensions at both of its sides (steps, 2) [N]."""
    system = TetherSystem.from_file(FOLDER / "atwood.toml")
    system.initialize()
    found = system.fly(round(duration / STEP), STEP)
    rope = found.portions["rope"]
    return found.time, rope.payout[:, 0], np.stack([rope.tension_to[:, 0], rope.tension_from[:, 1]], axis=1)


def hoist(falls):
    """The hoist of the file, on two falls or on four."""
    system = TetherSystem.from_file(FOLDER / "two_fall_hoist.toml")
    if falls == 2:
        return system
    (line,) = system.lines
    longer = replace(line.tether, initial_length=2.0 * line.tether.initial_length)
    line = replace(line, tether=longer, through=("block", "crown", "block"))
    return TetherSystem((*system.points, Point("crown", (0.5, 0.0, 30.0))), [line])


def fly_hoist(falls):
    """Times [s] after each step, rise of the block [m], rope hauled in [m], and tensions of the falls at the block [N]."""
    system = hoist(falls)
    start = system.initialize().points["block"].position[2]
    time = STEP * np.arange(round((RAMP + LIFT) / STEP))
    found = system.fly(len(time), STEP, reel_out_speeds={"hoist": -SPEED * np.minimum(1.0, time / RAMP)})
    own = found.portions["hoist"]
    hauled = own.length[0].sum() - own.length.sum(axis=1)
    tensions = np.stack([own.tension_to[:, k] if k % 2 == 0 else own.tension_from[:, k] for k in range(falls)], axis=1)
    return found.time, found.points["block"].position[:, 2] - start, hauled, tensions


def hang():
    """Position of the pulley of the clothes line [m], and the tensions on both of its sides [N], at rest."""
    start = TetherSystem.from_file(FOLDER / "clothes_line.toml").initialize()
    own = start.portions["line"]
    return start.points["pulley"].position, np.array([own.tension_to[0], own.tension_from[1]])


def draw(atwood, hoists, path):
    """Payout of Atwood's machine beside its formula, and rise of the block over the rope, to a file."""
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    time, payout, _ = atwood
    left.plot(time, payout, color=BLACK, label="flight")
    left.plot(time[::10], payout_of_atwood(time[::10]), "o", color=VERMILLION, markersize=4.0, label="formula")
    left.set(xlabel="time [s]", ylabel="rope over the sheave [m]", title="Atwood's machine")
    for (falls, (_, rise, hauled, _)), colour in zip(hoists.items(), (BLUE, VERMILLION), strict=True):
        right.plot(hauled, rise, color=colour, label=f"{falls} falls")
    right.set(xlabel="rope hauled in [m]", ylabel="rise of the block [m]", title="Hook block")
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


@command
def main(arguments=None):
    """Print what comes of all three, write the figure."""
    parser = Parser(description="ropes that run over sheaves")
    parser.add_out()
    file = parser.parse_args(arguments).out / "sheaves.png"
    atwood = fly_atwood()
    time, payout, _ = atwood
    print(f"Atwood's machine: {payout[-1]:.3f} m in {time[-1]:g} s, by the formula {payout_of_atwood(time[-1]):.3f} m")
    hoists = {falls: fly_hoist(falls) for falls in (2, 4)}
    for falls, (_, rise, hauled, tensions) in hoists.items():
        pulls = ", ".join(f"{each:.0f}" for each in tensions[-100:].mean(axis=0))
        print(f"{falls} falls: the block rises {rise[-1]:.3f} m for {hauled[-1]:.3f} m of rope; the falls pull {pulls} N")
    place, pulls = hang()
    print(f"clothes line: the pulley hangs at x = {place[0]:.3f} m, both sides pull {pulls[0]:.1f} N and {pulls[1]:.1f} N")
    file.parent.mkdir(parents=True, exist_ok=True)
    draw(atwood, hoists, file)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
