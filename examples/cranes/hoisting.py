"""How does an electric motor lift a load, and what holds it when the motor is off?

    python examples/cranes/hoisting.py

A load of 500 kg hangs on 60 m of wire. Motor and drum are known by their torque and their inertia: the force of the motor at
the wire, torque over radius, is `winch_force` (`winch_control` = force), and a PI controller of the speed, every 20 ms, is
all that there is outside the tether. The worm gear of the hoist has more friction than the load has weight. The load is lifted
by 20 m, then the motor is switched off, and the friction holds the load where it is.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu import TetherDynamicFree, tether_of
from tetherfmu.console.colours import BLUE, GREEN, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder

LOAD, LENGTH, LIFT, GRAVITY, STEP, DURATION = 500.0, 60.0, 20.0, 9.81, 0.02, 32.0  # kg, m, m, m/s2, s, s
RADIUS, INERTIA, FRICTION, LARGEST = (
    0.2,
    24.0,
    6000.0,
    3000.0,
)  # drum [m], [kg m2]; at the wire [N]; torque of the motor [N m]
DRUM = INERTIA / RADIUS**2  # mass at the wire [kg]
SPEED, BEGIN, RAMP = 1.0, 1.0, 2.0  # lifting [m/s], begin [s], time to speed up and to slow down [s]
OFF = BEGIN + RAMP + LIFT / SPEED + 1.0  # motor off [s]
GAIN, RESET = 10.0 * DRUM, 0.5  # of the controller [N s/m], [s]
DAMPING_RATIO = 0.01  # of the load that bounces on its wire, over critical damping


def wanted(t):
    """Speed of lifting [m/s]."""
    return float(np.interp(t, np.cumsum((BEGIN, RAMP, LIFT / SPEED - RAMP, RAMP)), (0.0, SPEED, SPEED, 0.0)))


def controlled(error, integral, most):
    """Torque of the motor [N m] and the integral of the error [m], which waits while the torque is at its limit."""
    torque = GAIN * RADIUS * (error + (integral + error * STEP) / RESET)
    return (torque, integral + error * STEP) if abs(torque) < most else (np.clip(torque, -most, most), integral)


def fly():
    """Time [s], height of the load [m], speed of the drum [m/s], torque of the motor [N m], tension [N], rows."""
    wire = tether_of("steel", 0.012, initial_length=LENGTH)
    wire = replace(wire, axial_damping=2.0 * DAMPING_RATIO * np.sqrt(LOAD * LENGTH * wire.axial_stiffness))
    stretch = (LOAD + 0.5 * wire.mass_per_meter * LENGTH) * GRAVITY * LENGTH / wire.axial_stiffness
    drum = {"winch_control": "force", "winch_mass": DRUM, "winch_friction": FRICTION, "input_continuation": "held"}
    hoist, rows, integral, speed = TetherDynamicFree(wire, segments=8, kite_mass=LOAD, **drum), [], 0.0, 0.0
    hoist.initialize(kite_position=(0.0, 0.0, -LENGTH - stretch))
    for k in range(round(DURATION / STEP)):
        t, torque = k * STEP, 0.0
        if BEGIN <= t < OFF:
            torque, integral = controlled(wanted(t) - speed, integral, LARGEST)
        found = hoist.step(STEP, winch_force=torque / RADIUS)
        speed = -found.winch_speed
        rows.append((t + STEP, found.kite_position[2], speed, torque, found.ground_tension))
    return np.transpose(rows)


@command
def main(arguments=None):
    """Print lift, work and tension, draw them."""
    parser, where = Parser(description="lift a load by an electric motor"), Path("plots")
    parser.add_argument("--out", type=folder, default=where, metavar="DIR", help="folder of the figure (default: plots)")
    file = parser.parse_args(arguments).out / "hoisting.png"
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    time, height, speed, torque, tension = fly()
    work = STEP / RADIUS * np.sum(torque * 0.5 * (speed + np.append(0.0, speed[:-1])))
    print(f"lifted by {height[-1] - height[0]:.2f} m, tension at most {tension.max():.0f} N")
    print(
        f"work of the motor {1e-3 * work:.0f} kJ, of it {1e-3 * LOAD * GRAVITY * (height[-1] - height[0]):.0f} kJ in the load"
    )
    print(f"motor off: the drum turns at {speed[-1]:g} m/s")
    shown = (
        (height - height[0], "load lifted [m]"),
        (speed, "drum [m/s]"),
        (torque, "torque [N m]"),
        (tension, "tension [N]"),
    )
    figure, panels = plt.subplots(len(shown), 1, figsize=(9.0, 7.0), sharex=True, layout="constrained")
    for axes, (values, label) in zip(panels, shown, strict=True):
        axes.plot(time, values, color=BLUE)
        axes.set_ylabel(label)
        axes.grid(alpha=0.4)
    panels[-1].set_xlabel("time [s]")
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
