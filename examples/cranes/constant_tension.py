"""How well does a winch hold the tension of a wire to a ship that heaves? Beside a winch that holds the length.

    python examples/cranes/constant_tension.py

A crane on a quay is hooked to a load on the deck, 40 m below its tip; the deck heaves by 0.5 m. The motor pulls with a
constant force W, `winch_control` = force. What turns a drum of mass m and dry friction F comes from the wire:

    |T - W| <= F + m a    of a drum that follows the deck, whose largest acceleration is a
    |T - W| <= F + m a + sqrt((m a)^2 + 4 m a F)    with the bounce that begins when a drum breaks away

Where the deck turns back, the drum is stuck until the tension has changed by 2 F. The deck then moves at v = sqrt(4 a F/k),
k the stiffness of the wire, and the drum bounces on the wire about m a with the amplitude sqrt((m a)^2 + m k v^2).
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu import MovingEnd, TetherDynamic, inputs_along, tether_of
from tetherfmu.console.colours import OTHERS
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from shared.ropes import NO_PUSH

TIP, DEPTH, FORCE, STEP, DURATION = (0.0, 0.0, 60.0), 40.0, 20e3, 0.02, 30.0  # m, m, N, s, s
HEAVE, PERIOD = 0.5, 6.0  # amplitude [m], grown to within the first period [s]
RATE, ACCELERATION = 2.0 * np.pi / PERIOD, HEAVE * (2.0 * np.pi / PERIOD) ** 2  # [rad/s], largest of the deck [m/s2]
HEAVY, DAMPING_RATIO = 3000.0, 0.05  # drum [kg] that bounces on the wire with this damping, over critical damping
DRUMS = {  # name: mass [kg], dry friction [N]; None: the winch holds the length
    "constant length": None,
    "drum of 3000 kg, 500 N of friction": (HEAVY, 500.0),
    "drum of 1000 kg, 100 N of friction": (1000.0, 100.0),
    "no drum": (0.0, 0.0),
}


def deck(t):
    """Position of the hook at the load [m]."""
    return 0.0, 0.0, TIP[2] - DEPTH - HEAVE * min(1.0, t / PERIOD) * np.sin(RATE * t)


def bounds(mass, friction):
    """Largest deviation of the tension [N]: of a drum that follows the deck; with the bounce after it has been stuck."""
    inertia = mass * ACCELERATION
    return friction + inertia, friction + inertia + np.sqrt(inertia * (inertia + 4.0 * friction))


def fly(drum):
    """Tension at the drum [N] after each step; drum : mass [kg] and friction [N], or None."""
    wire = tether_of("steel", 0.016)
    damping = 2.0 * DAMPING_RATIO * np.sqrt(HEAVY * DEPTH * wire.axial_stiffness)
    wire = replace(wire, initial_length=DEPTH / (1.0 + FORCE / wire.axial_stiffness), axial_damping=damping, **NO_PUSH)
    by_force = {"winch_control": "force", "winch_mass": drum[0], "winch_friction": drum[1]} if drum else {}
    tether = TetherDynamic(wire, segments=5, **by_force)
    tether.initialize(deck(0.0), ground_position=TIP)
    inputs = inputs_along(round(DURATION / STEP), STEP, MovingEnd(deck), TIP, winch_force=FORCE if drum else 0.0)
    return tether.fly(inputs, STEP).of("ground_tension")


@command
def main(arguments=None):
    """Print the tensions, draw them."""
    parser = Parser(description="hold the tension of a wire to a ship that heaves")
    parser.add_out()
    file = parser.parse_args(arguments).out / "constant_tension.png"
    from shared.flight_figures import plt

    figure, (of_length, of_force) = plt.subplots(2, 1, figsize=(9.0, 6.0), sharex=True, layout="constrained")
    for (name, drum), colour in zip(DRUMS.items(), OTHERS, strict=False):
        tension = fly(drum)
        off, (smooth, bounce) = np.abs(tension - FORCE).max(), bounds(*drum) if drum else (0.0, 0.0)
        held = f", off by {off:.0f} N; F + m a is {smooth:.0f} N, with bounce {bounce:.0f} N" if drum else ""
        print(f"{name}: at most {tension.max():.0f} N{held}")
        axes = of_force if drum else of_length
        axes.plot(STEP * np.arange(1, len(tension) + 1), 1e-3 * tension, color=colour, label=name)
        axes.set(ylabel="tension at the drum [kN]", xlabel="time [s]" if drum else "")
    for axes in (of_length, of_force):
        axes.grid(alpha=0.4)
        axes.legend(loc="upper left", ncols=3)
    of_force.set_ylim(15.0, 25.0)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
