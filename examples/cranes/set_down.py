"""How hard does a crane pull when it takes up a load that stands on the deck? First it sets the load down.

    python examples/cranes/set_down.py

500 kg on 40 m of wire hang 1 m above the deck, which is the ground of the tether (`ground_contact` = flat). The hoist lowers
them until the wire is slack, waits, and hoists at the speed v before the wire is taut. The load stays on the deck until the
wire carries its weight W = m g. Then the hoist moves away from it at v, and the wire, a spring of stiffness k = EA/L, pulls
with

    T = W + W_wire + v sqrt(k m)

at most, if nothing damps it. The wire is not only a spring: a wave of v sqrt(EA mu) runs up and down in it,
sqrt(m_wire/m) of the last term, by which the tension may be larger or smaller.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu import Ground, TetherDynamicFree, tether_of
from tetherfmu.console.colours import BLACK, OTHERS
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from shared.ropes import NO_PUSH

LOAD, LENGTH, ABOVE, STEP, GRAVITY = 500.0, 40.0, 1.0, 0.01, 9.81  # kg, m, m above the deck, s, m/s2
LOWERED, LOWERING, RAMP = 1.2, 0.25, 0.5  # wire paid out [m], at [m/s], which is reached in [s]
BEGIN, TAKE_UP, START_UP, DURATION = 1.0, 12.0, 0.05, 16.0  # of lowering, of hoisting [s]; to speed in [s]; in all [s]
SPEEDS = (0.1, 0.25, 0.5, 1.0)  # of the hoist [m/s]
SEGMENTS, DAMPING_RATIO = 20, 0.01  # of the wire; of the load that bounces on it, over critical damping
DECK = Ground(ground_contact="flat", ground_height=0.0)
WIRE = tether_of("steel", 0.012, initial_length=LENGTH)
DAMPING = 2.0 * DAMPING_RATIO * np.sqrt(LOAD * LENGTH * WIRE.axial_stiffness)
WIRE = replace(WIRE, segments=SEGMENTS, axial_damping=DAMPING, **NO_PUSH)
WEIGHT, OF_WIRE = LOAD * GRAVITY, WIRE.mass_per_length * LENGTH * GRAVITY  # [N]
STIFFNESS = WIRE.axial_stiffness / LENGTH  # [N/m]


def paying_out(t, speed):
    """Speed of the winch at a time [m/s]: down, still, and then up at `speed`."""
    if t < TAKE_UP:
        passed = t - BEGIN
        return LOWERING * np.clip(min(passed, LOWERED / LOWERING + RAMP - passed) / RAMP, 0.0, 1.0)
    return -speed * min(1.0, (t - TAKE_UP) / START_UP)


def expected(speed):
    """Largest tension at the winch of an undamped spring [N]."""
    return WEIGHT + OF_WIRE + speed * np.sqrt(STIFFNESS * LOAD)


def wave(speed):
    """Tension of a wave along the wire [N]."""
    return speed * np.sqrt(WIRE.axial_stiffness * WIRE.mass_per_length)


def fly(speed):
    """After each step: time [s], height of the load [m], tension at the winch [N], what the deck carries at rest [N]."""
    stretch = (WEIGHT + 0.5 * OF_WIRE) / STIFFNESS
    crane = TetherDynamicFree(WIRE, ground=DECK, kite_mass=LOAD, input_continuation="held")
    crane.initialize((0.0, 0.0, ABOVE), ground_position=(0.0, 0.0, ABOVE + LENGTH + stretch))
    rows = []
    for t in STEP * np.arange(round(DURATION / STEP)):
        found = crane.step(STEP, reel_out_speed=paying_out(t, speed))
        hanging = -found.ground_force[2]
        rows.append((t + STEP, found.kite_position[2], found.ground_tension, WEIGHT + OF_WIRE - hanging))
    return np.transpose(rows)


@command
def main(arguments=None):
    """Print what the deck carries and the largest tensions, draw heights and tensions."""
    parser = Parser(description="set a load down on a deck, and take it up again")
    parser.add_out()
    file = parser.parse_args(arguments).out / "set_down.png"
    from shared.flight_figures import draw_ground, plt

    figure, (height, tension) = plt.subplots(2, 1, figsize=(9.0, 6.5), sharex=True, layout="constrained")
    for speed, colour in zip(SPEEDS, OTHERS, strict=False):
        time, z, pull, carried = fly(speed)
        lifted, standing = time > TAKE_UP, np.searchsorted(time, TAKE_UP) - 1
        if speed == SPEEDS[0]:
            print(f"the deck carries {carried[standing]:.0f} N of the {WEIGHT + OF_WIRE:.0f} N of load and wire")
        print(
            f"hoisting at {speed:g} m/s: at most {pull[lifted].max():.0f} N, by the formula {expected(speed):.0f} N "
            f"+- {wave(speed):.0f} N"
        )
        height.plot(time, z, color=colour)
        tension.plot(time, 1e-3 * pull, color=colour, label=f"{speed:g} m/s")
        tension.axhline(1e-3 * expected(speed), color=colour, linestyle="--", linewidth=0.8)
    tension.plot([], [], "--", color=BLACK, linewidth=0.8, label="formula")
    draw_ground(height, DECK.ground_height)
    height.set(ylabel="height of the load [m]", title="A load is set down on the deck and taken up again")
    tension.set(xlabel="time [s]", ylabel="tension at the winch [kN]")
    for axes in (height, tension):
        axes.grid(alpha=0.4)
        axes.legend(loc="upper left")
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
