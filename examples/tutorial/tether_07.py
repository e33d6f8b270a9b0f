"""How does the air stop the swing of a tether?

Lesson 06 with drag and a wind of 2 m/s, for 30 s; the tether starts while it shrinks, its end at 2 m/s. Nothing is written
for it: TetherDynamic takes the drag of each segment across its direction, in the wind that it feels, and `wind_velocity` is
an input.
"""

import numpy as np
from lessons import Lesson, command_line, curve, follow, panels, timed
from tether_06 import DYNEEMA, END, LENGTH, REEL_OUT

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

WIND, DURATION = (2.0, 0.0, 0.0), 30.0  # m/s, s
VELOCITY = 2.0 / LENGTH * END  # of the end at the start [m/s]
CASES = {
    "no air": (0.0, (0.0, 0.0, 0.0), BLACK),
    "still air": (0.958, (0.0, 0.0, 0.0), SKY_BLUE),
    "wind of 2 m/s": (0.958, WIND, COLOUR["dynamic"]),
}


def simulate(drag_coefficient=0.958, wind=WIND, duration=DURATION, **options):
    """Node positions [m], array (rows, 6, 3)."""
    tether = TetherDynamic(**DYNEEMA, drag_coefficient=drag_coefficient, **options)
    tether.initialize(END, VELOCITY, reel_out_speed=REEL_OUT, wind_velocity=wind)
    return follow(tether, duration, reel_out_speed=REEL_OUT, wind_velocity=wind)


def angle(positions):
    """Angle of the free end off the vertical [deg], array (rows,)."""
    return np.degrees(np.arctan2(positions[:, -1, 0], -positions[:, -1, 2]))


def lesson():
    """Angle of the free end over 30 s, without air, in still air and in wind."""
    figure, axes = panels()
    for name, (drag_coefficient, wind, colour) in CASES.items():
        positions, seconds = timed(simulate, drag_coefficient, wind)
        swing = angle(positions)
        curve(axes, np.linspace(0.0, DURATION, len(swing)), swing, name, color=colour)
    axes.set(xlabel="time [s]", ylabel="free end off the vertical [deg]", title="A tether of 50 m, 2 m/s are reeled out")
    left = np.ptp(swing[-500:])
    return Lesson(f"in the last 10 s the end turns by {left:.2f} deg, at the start by 27 deg", figure, DURATION, seconds)


main = command_line(lesson)
