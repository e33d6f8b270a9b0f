"""What does a tether do that falls on the ground, and how hard is it to drag it away?

20 m of tether are held straight, 2 m above the ground. One end is let go, and it falls; with `ground_contact="flat"` the
ground carries what reaches it, and nothing bounces. Then the other end is laid down, and drags the tether at 1 m/s, against
the friction mu m g. Half a segment stays in the hand that pulls. What falls into folds must not push:
`slack_stiffness_ratio` and `slack_damping_ratio` are 0.
"""

import numpy as np
from lessons import DURATION, GRAVITY, MEDIUM, STEP, TIMES, Lesson, Movie, command_line, curve, draw_motion, panels, timed

from tetherfmu import MovingEnd, Tether, TetherDynamic, inputs_along
from tetherfmu.console.colours import COLOUR, GROUND, REFERENCE

LENGTH, SEGMENTS, HEIGHT, SPEED = 20.0, 20, 2.0, 1.0  # m, -, m, m/s
FRICTIONS = (0.25, 0.5, 1.0)
TETHER = Tether(initial_length=LENGTH, segments=SEGMENTS, slack_stiffness_ratio=0.0, slack_damping_ratio=0.0)


def hand(t):
    """Position of the end that is held [m]: still for 1 s, laid down within 2 s, then along x, at full speed after 3 s."""
    down = 0.5 * (1.0 - np.cos(np.pi * np.clip((t - 1.0) / 2.0, 0.0, 1.0)))
    along = np.clip(t - 3.0, 0.0, 3.0) ** 2 / 6.0 + max(0.0, t - 6.0)
    return LENGTH + SPEED * along, 0.0, HEIGHT * (1.0 - down)


def simulate(friction, **options):
    """Node positions [m], array (rows, 21, 3), and pull at the hand [N], array (rows,)."""
    ground = {"ground_contact": "flat", "ground_friction": friction}
    tether = TetherDynamic(TETHER, initial_shape="straight", free_ends=(True, False), **ground, **options)
    tether.initialize(hand(0.0), ground_position=(0.0, 0.0, HEIGHT))
    flown = tether.fly(inputs_along(len(TIMES) - 1, STEP, MovingEnd(hand)), STEP)
    start = np.linspace((0.0, 0.0, HEIGHT), hand(0.0), SEGMENTS + 1)
    return np.array([start, *flown.positions]), np.array([0.0, *np.linalg.norm(flown.kite_force, axis=1)])


def sliding(friction):
    """Pull of a tether that slides [N]."""
    return friction * TETHER.mass_per_length * LENGTH * GRAVITY * (1.0 - 0.5 / SEGMENTS)


def lesson():
    """Shapes while it falls, and the pull over time for three coefficients of friction."""
    (positions, _), seconds = timed(simulate, 0.5)
    figure, (above, below) = panels(2, size=MEDIUM, height_ratios=(1, 2))
    draw_motion(above, positions[:80], 8, "Falling: every 0.16 s", COLOUR["dynamic"], labelled=False)
    curve(above, np.array([0.0, LENGTH]), np.zeros(2), "ground", color=GROUND)
    for friction in FRICTIONS:
        pull = simulate(friction)[1]
        curve(below, TIMES[100:], pull[100:], f"friction {friction:g}", color=COLOUR["dynamic"])
        below.axhline(sliding(friction), color=REFERENCE, linestyle="--", linewidth=0.8)
    below.set(xlabel="time [s]", ylabel="pull [N]", ylim=(0.0, 3.0), title="Dragged: dashed is friction times weight")
    above.set(ylabel="height [m]", xlabel="")
    answer = f"with friction 0.5 it takes {simulate(0.5)[1][-1]:.3f} N to drag it, by the formula {sliding(0.5):.3f} N"
    return Lesson(answer, figure, DURATION, seconds, Movie(positions, "Falling, then dragged", ground=0.0))


main = command_line(lesson)
