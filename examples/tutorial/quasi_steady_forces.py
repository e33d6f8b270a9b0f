"""How much of the force on a kite is missing in a tether without waves?

Both ends over one turn of the circle: the force of TetherQuasiSteady, and what TetherDynamic adds to it.
"""

import numpy as np
from lessons import STEP, Lesson, command_line, curve, panels
from quasi_steady_circle import STEPS, fly
from tether_11 import AXES

from tetherfmu import TetherDynamic, TetherQuasiSteady
from tetherfmu.console.colours import BLACK


def lesson():
    """Components of the forces at both ends, and the difference from TetherDynamic."""
    steady, dynamic = fly(TetherQuasiSteady), fly(TetherDynamic)
    time = STEP * np.arange(1, STEPS + 1)
    figure, found = panels(2, 2, sharex=True, height_ratios=(2, 1))
    for (above, below), end, title in zip(found.T, ("kite_force", "ground_force"), ("kite", "ground station"), strict=True):
        force, missing = getattr(steady, end), getattr(dynamic, end) - getattr(steady, end)
        last = np.argsort(np.argsort(missing[-1]))  # place of a component among those at the end, from below
        for i, (name, colour) in enumerate(AXES.items()):
            curve(above, time, force[:, i], name, color=colour)
            curve(below, time, missing[:, i], name, shift=5.0 * (last[i] - 1), color=colour)
        curve(above, time, np.linalg.norm(force, axis=1), "magnitude", color=BLACK)
        above.set(title=f"Force on the {title}")
        below.set(xlabel="time [s]")
    found[0, 0].set(ylabel="TetherQuasiSteady [N]")
    found[1, 0].set(ylabel="TetherDynamic\nminus that [N]")
    part = (
        np.linalg.norm(dynamic.kite_force - steady.kite_force, axis=1).max()
        / np.linalg.norm(dynamic.kite_force, axis=1).max()
    )
    return Lesson(f"at most {100 * part:.1f} % of the largest force", figure, STEPS * STEP, steady.seconds)


main = command_line(lesson)
