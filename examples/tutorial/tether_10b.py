"""How are tethers composed into a system that branches, and what does composing change?

A `TetherSystem` is made of points and of lines between them. A driven point follows its inputs; a point with a mass is
free, and several lines may meet there. A rope of 24 m hangs from a mast, and its lower end is driven. As one line it is a
tether of lesson 10; cut in two and knotted without mass it is the same. With a third line, from a second mast, it is a Y.
"""

import numpy as np
from lessons import STEP, Lesson, command_line, draw_motion, panels, timed

from tetherfmu import Line, MovingEnd, Point, Solver, Tether, TetherDynamic, TetherSystem, inputs_along
from tetherfmu.console.colours import BLACK, BLUE, COLOUR, GREEN

DURATION, ROWS = 6.0, 300
HAND = MovingEnd(lambda time: (8.0 + 3.0 * np.sin(2.0 * time), 0.0, -21.0 + 0.0 * time))
MAST, OTHER, LOWER = Point("mast", (0, 0, 0)), Point("other", (20, 0, 0)), Point("hand", HAND.at(0.0)[0])
WHOLE = {"whole": ("mast", "hand", 12)}  # two points, and number of segments of 2 m
HALVES = {"upper": ("mast", "knot", 5), "lower": ("knot", "hand", 7)}
SOLVER = Solver(relative_tolerance=1e-7)  # so that differences are not its own


def rope(segments):
    """A tether with segments of 2 m."""
    return Tether(segments=segments, initial_length=2.0 * segments)


def single():
    """Node positions [m], array (rows, 13, 3), of the whole rope."""
    tether = TetherDynamic(rope(12), solver=SOLVER)
    tether.initialize(*HAND.at(0.0))
    return tether.fly(inputs_along(ROWS, STEP, HAND), STEP).positions


def composed(points, lines):
    """Node positions [m] by line, arrays (rows, segments + 1, 3), while the hand moves."""
    ropes = [Line(name, start, end, rope(segments)) for name, (start, end, segments) in lines.items()]
    system = TetherSystem(points, ropes, solver=SOLVER)
    system.initialize(velocities={"hand": HAND.at(0.0)[1]})
    way = np.array([HAND.at(STEP * row) for row in range(ROWS)])
    return system.fly(ROWS, STEP, positions={"hand": way[:, 0]}, velocities={"hand": way[:, 1]}).positions


def lesson():
    """Shapes of the rope, of its halves and of the Y, and how far what is composed is from a single tether."""
    whole, seconds = timed(composed, [MAST, LOWER], WHOLE, repeats=1)
    halves = composed([MAST, Point("knot", mass=0.0), LOWER], HALVES)
    y = composed([MAST, OTHER, Point("knot", mass=0.5), LOWER], {**HALVES, "third": ("other", "knot", 10)})
    figure, found = panels(1, 3, size=(8.0, 4.0), sharex=True, sharey=True)
    for axes, lines, title in zip(found, (whole, halves, y), ("one line", "two lines and a knot", "a Y"), strict=True):
        for positions, colour in zip(lines.values(), (COLOUR["dynamic"], BLUE, GREEN), strict=False):
            draw_motion(axes, positions[-157:], 39, title, colour, labelled=False)
    found[2].plot(*y["upper"][-1, -1, [0, 2]], "o", color=BLACK)
    found[0].set(ylabel="height [m]")
    alone, cut = single(), np.concatenate([halves["upper"], halves["lower"][:, 1:]], axis=1)
    same, near = (np.abs(each - alone).max() for each in (whole["whole"], cut))
    answer = f"a line between two points is a TetherDynamic within {same:.1g} m, two with a knot of 0 kg within {near:.1g} m"
    return Lesson(answer, figure, DURATION, seconds)


main = command_line(lesson)
