"""How does an electric motor lift a load, and what holds the load when the motor is off?

    python examples/cranes/hoisting.py

A load of 500 kg hangs on 60 m of wire. The winch is known by the torque of its motor and the inertia of its drum: torque
over radius is `winch_force` (`winch_control` = force), and all that is left outside the tether is a PI controller of the
speed, every 20 ms. The worm gear has more friction than the load has weight: after 20 m the motor is switched off, and the
friction holds the load where it is.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu import TetherDynamicFree, tether_of
from tetherfmu.console.colours import BLUE
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms

LOAD, LENGTH, LIFT, GRAVITY, STEP, DURATION = 500.0, 60.0, 20.0, 9.81, 0.02, 32.0  # kg, m, m, m/s2, s, s
RADIUS, INERTIA, FRICTION, TORQUE = 0.2, 24.0, 6000.0, 3000.0  # drum [m], [kg m2]; at the wire [N]; largest [N m]
DRUM = INERTIA / RADIUS**2  # mass at the wire [kg]
SPEED, ACCELERATION, BEGIN, CLOSE = 1.0, 0.5, 1.0, 0.002  # wanted [m/s], [m/s2]; from [s] until it is so far [m]
GAIN, RESET = 10.0 * DRUM, 0.5  # of the controller [N s/m], [s]
SEGMENTS, DAMPING_RATIO = 8, 0.01  # of the wire; of the load that bounces on it, over critical damping
WIRE = tether_of("steel", 0.012, initial_length=LENGTH)
WIRE = replace(WIRE, axial_damping=2.0 * DAMPING_RATIO * np.sqrt(LOAD * LENGTH * WIRE.axial_stiffness))


def controlled(error, integral):
    """Torque of the motor [N m] and the integral of the error [m], which waits while the torque is at its limit."""
    torque = GAIN * RADIUS * (error + (integral + error * STEP) / RESET)
    return (torque, integral + error * STEP) if abs(torque) < TORQUE else (np.copysign(TORQUE, torque), integral)


def fly():
    """After each step: time [s], height of the load [m], speed of lifting [m/s], torque of the motor [N m], tension [N]."""
    stretch = (LOAD + 0.5 * WIRE.mass_per_length * LENGTH) * GRAVITY * LENGTH / WIRE.axial_stiffness
    drum = {"winch_control": "force", "winch_mass": DRUM, "winch_friction": FRICTION, "input_continuation": "held"}
    hoist = TetherDynamicFree(WIRE, segments=SEGMENTS, kite_mass=LOAD, **drum)
    found = hoist.initialize(kite_position=(0.0, 0.0, -LENGTH - stretch))
    rows, integral, is_on = [], 0.0, True
    for t in STEP * np.arange(round(DURATION / STEP)):
        left, torque = found.tether_length - LENGTH + LIFT, 0.0
        is_on = is_on and left > CLOSE
        if is_on and t > BEGIN:
            wanted = min(SPEED, ACCELERATION * (t - BEGIN), np.sqrt(2.0 * ACCELERATION * left))
            torque, integral = controlled(wanted + found.winch_speed, integral)
        found = hoist.step(STEP, winch_force=torque / RADIUS)
        rows.append((t + STEP, found.kite_position[2], -found.winch_speed, torque, found.ground_tension))
    return np.transpose(rows)


def work(speed, torque):
    """Work of the motor [J], whose torque is held in each step."""
    return STEP / RADIUS * np.sum(torque * 0.5 * (speed + np.append(0.0, speed[:-1])))


@command
def main(arguments=None):
    """Print height, work and tension, draw them."""
    parser = Parser(description="lift a load by an electric motor")
    parser.add_out()
    file = parser.parse_args(arguments).out / "hoisting.png"
    from shared.flight_figures import plt

    time, height, speed, torque, tension = fly()
    lifted = height - height[0]
    print(f"lifted by {lifted[-1]:.2f} m, tension at most {tension.max():.0f} N, torque at most {torque.max():.0f} N m")
    print(f"work of the motor {1e-3 * work(speed, torque):.1f} kJ, to the load {1e-3 * LOAD * GRAVITY * lifted[-1]:.1f} kJ")
    print(f"with the motor off the drum turns at {abs(speed[-1]):g} m/s")
    shown = {"height gained [m]": lifted, "drum [m/s]": speed, "motor [N m]": torque, "tension [N]": tension}
    figure, panels = plt.subplots(len(shown), 1, figsize=(9.0, 7.0), sharex=True, layout="constrained")
    for axes, (label, values) in zip(panels, shown.items(), strict=True):
        axes.plot(time, values, color=BLUE)
        axes.set(ylabel=label, xlabel="time [s]" if axes is panels[-1] else "")
        axes.grid(alpha=0.4)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
