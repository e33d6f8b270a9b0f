"""What does a kite on a circle feel from its tether? The first lesson with an FMU.

The kite flies one turn on a cone, 500 m away, on 525 m of tether (examples/first_flight/circular_flight.py). FMPy drives
TetherDynamic.fmu, which is built if it is missing: positions and velocities of the kite go in every 20 ms, forces and
shape come out. The file replaces the Python class of lessons 06 to 10: every tool that imports FMUs gets these numbers.
"""

from functools import cache

import numpy as np
from lessons import TALL, Lesson, Movie, command_line, curve, plt, tidy

from first_flight import circular_flight
from tetherfmu.console.colours import BLACK, COLOUR, COMPONENTS, REFERENCE


@cache
def flight():
    """One turn with the FMU, a `Flight`."""
    return circular_flight.fly(circular_flight.find_fmu("TetherDynamic"))


def draw_shapes(axes, shapes, colour, count=20):
    """`count` shapes along the way of the kite, in space."""
    for shape in shapes[np.linspace(0, len(shapes) - 1, count, endpoint=False).astype(int)]:
        axes.plot(*shape.T, color=colour, linewidth=0.9)
    axes.plot(*shapes[:, -1].T, color=REFERENCE, linewidth=2.0)
    axes.plot(*shapes[0, :1].T, "s", color=BLACK)
    axes.set(xlabel="x [m]", zlabel="z [m]", xticks=(-50.0, 50.0))
    axes.set_ylabel("y [m]", labelpad=12.0)
    axes.set_box_aspect(np.ptp(shapes, axis=(0, 1)), zoom=0.85)
    axes.locator_params(nbins=3)
    axes.view_init(elev=18.0, azim=-40.0)


def lesson():
    """Shapes along the turn, and the force on the kite."""
    found = flight()
    figure = plt.figure(figsize=TALL, layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(3, 2))
    draw_shapes(left.add_subplot(projection="3d"), found.shape, COLOUR["dynamic"])
    axes = right.add_subplot()
    size = np.linalg.norm(found.kite_force, axis=1)
    for (name, colour), force in zip(COMPONENTS.items(), (*found.kite_force.T, size), strict=True):
        curve(axes, found.time, force, name, color=colour)
    axes.set(xlabel="time [s]", ylabel="[N]", title="Force on the kite")
    tidy(axes)
    answer = f"the tether pulls with {size.min():.0f} to {size.max():.0f} N at the kite"
    return Lesson(answer, figure, found.time[-1], found.wall_time, Movie(found.shape, "One turn", in_space=True, speed=20.0))


main = command_line(lesson)
