"""Which ends may a tether have, and are two tethers with a knot the same as one?

A tether is a component: each end is fixed, moves along a path (`MovingEnd`), or is free (`free_ends`). Tethers in a list
are joined in series, and `point_masses` puts a knot between them. That replaces a system of equations put together anew for
each arrangement of ends. Here the lower end of 50 m moves on an ellipse for 30 s.
"""

import numpy as np
from lessons import STEP, Lesson, command_line, draw_motion, follow, panels, timed

from tetherfmu import MovingEnd, Tether, TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

DURATION, ONE = 30.0, Tether(segments=10, initial_length=50.0)
KNOT, TWO = 4, [Tether(segments=4, initial_length=20.0), Tether(segments=6, initial_length=30.0)]
ELLIPSE = MovingEnd(lambda time: (25.0 + 8.0 * np.cos(time), 0.0, -30.0 + 4.0 * np.sin(time)))


def moving(tethers, **options):
    """Node positions [m], array (rows, 11, 3), with one end fixed and one led along the ellipse."""
    model = TetherDynamic(tethers, **options)
    model.initialize(*ELLIPSE.at(0.0))
    positions = [model.positions]
    for row in range(round(DURATION / STEP)):
        model.step(STEP, *ELLIPSE.at(row * STEP))
        positions.append(model.positions)
    return np.array(positions)


def free():
    """The same from the same start with the lower end let go."""
    model = TetherDynamic(ONE, free_ends=(False, True))
    model.initialize(ELLIPSE.at(0.0)[0])
    return follow(model, 3.0)


def lesson():
    """Shapes over one turn of the ellipse, with and without a heavy knot, and with a free end."""
    one, seconds = timed(moving, ONE)
    two, heavy = moving(TWO, point_masses={KNOT: 0.0}), moving(TWO, point_masses={KNOT: 1.0})
    figure, found = panels(1, 3, size=(8.0, 4.2), sharex=True, sharey=True)
    cases = {
        "lower end led along an ellipse": (one[-315:], 39, COLOUR["dynamic"]),
        "with a knot of 1 kg": (heavy[-315:], 39, COLOUR["dynamic"]),
        "lower end let go: 3 s": (free(), 25, SKY_BLUE),
    }
    for axes, (title, (positions, every, colour)) in zip(found, cases.items(), strict=True):
        draw_motion(axes, positions, every, title, colour, labelled=False)
        axes.plot(*positions[:, -1, [0, 2]].T, color=BLACK, linewidth=0.8)
        axes.plot(0.0, 0.0, "s", color=BLACK)
    found[1].plot(*heavy[-1, KNOT, [0, 2]], "o", color=BLACK, markersize=8)
    found[0].set(ylabel="height [m]")
    difference = 1e3 * np.abs(two - one).max()
    return Lesson(f"two tethers and a knot of 0 kg are one within {difference:.1g} mm", figure, DURATION, seconds)


main = command_line(lesson)
