"""What do the settings change? One of them: the law of the damper while the tether is reeled out.

All settings are records of constants, `Tether`, `Environment`, `Solver`, checked and with units. Here one is replaced. The
damper of a material sees the rate of the strain, (dl/dt - (l/l0) dl0/dt)/l0, that of Tethers.jl dl/dt alone. Material that
is paid out makes a segment longer without straining it, and that damper pulls: D v/L = 18.9 N at 50 m and 2 m/s.
"""

from dataclasses import replace

import numpy as np
from lessons import DURATION, STEP, TIMES, Lesson, command_line, curve, panels, timed

from tetherfmu import Environment, Solver, Tether, TetherDynamic
from tetherfmu.console.colours import COLOUR, SKY_BLUE

TETHER = Tether(segments=5, initial_length=50.0, slack_stiffness_ratio=0.01 / 1.01, drag_coefficient=0.0)
SETTINGS = {
    "strain rate (material)": (TETHER, COLOUR["dynamic"]),
    "stretch rate (Tethers.jl)": (replace(TETHER, damping_law="stretch_rate"), SKY_BLUE),
}
SPEED, STRAIN = 2.0, 1e-4  # m/s, -


def reel_out_hanging(tether):
    """Longest segment over its unstretched length [mm], array (rows,), of a tether that hangs while it is reeled out."""
    model = TetherDynamic(tether, Environment(), Solver(initial_shape="quasi_steady"), free_ends=(False, True))
    model.initialize((0.0, 0.0, -50.0), (0.0, 0.0, -SPEED), reel_out_speed=SPEED)
    stretches = []
    for _ in range(round(DURATION / STEP)):
        outputs = model.step(STEP, reel_out_speed=SPEED)
        stretches.append(1e3 * (model.segment_lengths - outputs.tether_length / tether.segments).max())
    return np.array(stretches)


def reel_out_strained(tether):
    """Tension [N], array (rows,), of a tether whose end leaves so that its strain stays 1e-4; no gravity."""
    model = TetherDynamic(tether, Environment(gravity=0.0, air_density=0.0), Solver(initial_shape="quasi_steady"))
    way, velocity = np.array([1.0 + STRAIN, 0.0, 0.0]), (SPEED * (1.0 + STRAIN), 0.0, 0.0)
    model.initialize(50.0 * way, velocity, reel_out_speed=SPEED)
    ends = (50.0 + SPEED * TIMES[:-1, None]) * way
    return np.array([model.step(STEP, end, velocity, reel_out_speed=SPEED).kite_tension for end in ends])


def lesson():
    """Both motions with both laws."""
    figure, (left, right) = panels(1, 2)
    for name, (tether, colour) in SETTINGS.items():
        stretch, seconds = timed(reel_out_hanging, tether)
        tension = reel_out_strained(tether)
        curve(left, TIMES[1:], stretch, name, at=250, side="above", shift=20 - 40 * (tether is TETHER), color=colour)
        curve(right, TIMES[1:], tension, color=colour)
    right.text(5.0, 614600.0 * STRAIN + 0.4, "61.5 N = EA times strain", color=COLOUR["dynamic"], ha="center")
    right.text(4.0, 78.5, "+ D v/L", color=SKY_BLUE)
    left.set(xlabel="time [s]", ylabel="[mm]", title="Hanging: stretch of the longest segment")
    right.set(xlabel="time [s]", ylabel="[N]", title="At a constant strain of 1e-4: tension")
    answer = f"the damper of Tethers.jl adds {tension[0] - 614600.0 * STRAIN:.1f} N that no material has"
    return Lesson(answer, figure, DURATION, seconds)


main = command_line(lesson)
