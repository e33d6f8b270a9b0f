"""How much of the force on a kite is missing in a tether without waves?

Both ends over one turn of the circle: the force of TetherQuasiSteady, and what TetherDynamic adds to it.
"""

import numpy as np
from lessons import STEP, Lesson, command_line, curve, panels
from quasi_steady_circle import STEPS, fly

from tetherfmu import TetherDynamic, TetherQuasiSteady
from tetherfmu.console.colours import COMPONENTS


def lesson():
    """Components of the forces at both ends, and the difference from TetherDynamic."""
    steady, dynamic = fly(TetherQuasiSteady), fly(TetherDynamic)
    time = STEP * np.arange(1, STEPS + 1)
    figure, found = panels(2, 2, sharex=True, height_ratios=(2, 1))
    for (above, below), end, title in zip(found.T, ("kite_force", "ground_force"), ("kite", "ground station"), strict=True):
        force, missing = getattr(steady, end), getattr(dynamic, end) - getattr(steady, end)
        size = np.linalg.norm(force, axis=1)
        last = np.argsort(np.argsort(missing[-1]))  # place of a component among those at the end, from below
        for (name, colour), component in zip(COMPONENTS.items(), (*force.T, size), strict=True):
            curve(above, time, component, name, color=colour)
        for component, (name, colour), place in zip(missing.T, COMPONENTS.items(), last, strict=False):
            curve(below, time, component, name, shift=5.0 * (place - 1), color=colour)
        above.set(title=f"Force on the {title}")
        below.set(xlabel="time [s]")
    found[0, 0].set(ylabel="TetherQuasiSteady [N]")
    found[1, 0].set(ylabel="TetherDynamic\nless that [N]")
    part = (
        np.linalg.norm(dynamic.kite_force - steady.kite_force, axis=1).max()
        / np.linalg.norm(dynamic.kite_force, axis=1).max()
    )
    return Lesson(f"at most {100 * part:.1f} % of the largest force", figure, STEPS * STEP, steady.seconds)


main = command_line(lesson)
