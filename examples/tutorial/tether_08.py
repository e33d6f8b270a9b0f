"""What does a tether do between any two points, and when one of its ends is let go?

70 m and 10 segments between (0, 0, 0) and (-40, 0, -47) m in a wind of 2 m/s: first at rest, then the lower end is released
while the tether is reeled out at 0.3 m/s. Holding a tether until it rests would be another simulation; here the start is
an equilibrium, which Newton's method finds: `initial_shape="static_equilibrium"`, the default.
"""

import numpy as np
from lessons import MEDIUM, Lesson, Movie, command_line, draw_motion, follow, panels, timed

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, REFERENCE

ENDS, WIND, REEL_OUT, DURATION = np.array([[0.0, 0.0, 0.0], [-40.0, 0.0, -47.0]]), (2.0, 0.0, 0.0), 0.3, 30.0  # m, m/s, s
TETHER = {
    "segments": 10,
    "initial_length": 70.0,
    "ground_height": -100.0,
    "slack_stiffness_ratio": 0.01 / 1.01,
    "free_ends": (False, True),
}
SHOWN, EVERY = 501, 50  # rows, and rows between two shapes


def simulate(ends=ENDS, **options):
    """Node positions [m], array (rows, 11, 3)."""
    ground, kite = ends
    tether = TetherDynamic(**TETHER, **options)
    tether.initialize(kite, ground_position=ground, wind_velocity=WIND)
    return follow(tether, DURATION, reel_out_speed=REEL_OUT, wind_velocity=WIND, ground_position=ground)


def lesson():
    """Shapes every second; and the start between five other points."""
    positions, seconds = timed(simulate)
    figure, (left, right) = panels(1, 2, size=MEDIUM)
    draw_motion(left, positions[:SHOWN], EVERY, "Released: every second of ten", COLOUR["dynamic"], labelled=False)
    left.plot(*positions[0, :, [0, 2]], "o-", markersize=3, color=BLACK)
    left.annotate("at rest", positions[0, 9, [0, 2]], (-6, 6), textcoords="offset points", color=BLACK, ha="center")
    left.annotate("10 s", positions[SHOWN - 1, -1, [0, 2]], (6, 0), textcoords="offset points", color=COLOUR["dynamic"])
    for turn in np.radians((0.0, 30.0, 60.0, 90.0, 130.0)):
        kite = 61.0 * np.array([-np.sin(turn), 0.0, -np.cos(turn)])
        tether = TetherDynamic(**TETHER)
        tether.initialize(kite, wind_velocity=WIND)
        right.plot(*tether.positions[:, [0, 2]].T, "o-", markersize=3, color=BLACK)
        right.plot([0.0, kite[0]], [0.0, kite[2]], color=REFERENCE, linewidth=0.6)
    left.set(ylabel="height [m]")
    right.set(xlabel="x [m]", title="At rest between other points", aspect="equal")
    answer = f"the released end sweeps {np.ptp(positions[:, -1, 0]):.0f} m sideways"
    return Lesson(answer, figure, DURATION, seconds, Movie(positions, "Released"))


main = command_line(lesson)
