"""Which shapes does a tether in equilibrium take along the circle of a kite, and how far from them is one with waves?

TetherQuasiSteady over the circle of lesson 11: at each instant the shape in which weight, drag, tension and the inertia of
turning with the kite balance. The flight is one call of compiled code, `fly`, with inputs that `inputs_along` makes from
the path.
"""

import numpy as np
from lessons import STEP, TALL, Lesson, command_line, curve, plt, tidy
from tether_11 import draw_shapes

from first_flight.circular_flight import GROUND, circle
from tetherfmu import MovingEnd, TetherDynamic, TetherQuasiSteady, inputs_along
from tetherfmu.console.colours import COLOUR

RATE, STEPS = 0.05, 6283  # rad/s, communication steps: one turn
TETHER = {"initial_length": 525.0, "initial_shape": "quasi_steady", "ground_height": GROUND}
KITE = MovingEnd(lambda time: circle(time, RATE)[0], lambda time: circle(time, RATE)[1])


def fly(model, every=1):
    """One turn, a `Flown` with a row for each `every` communication steps."""
    tether = model(**TETHER)
    tether.initialize(*KITE.at(0.0))
    return tether.fly(inputs_along(STEPS, STEP, kite=KITE), STEP, every)


def lesson():
    """Shapes along the turn, and the largest distance of the nodes from those of TetherDynamic."""
    steady, dynamic = fly(TetherQuasiSteady), fly(TetherDynamic)
    figure = plt.figure(figsize=TALL, layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(3, 2))
    draw_shapes(left.add_subplot(projection="3d"), steady.shape, COLOUR["quasi_steady"])
    axes = right.add_subplot()
    distance = np.linalg.norm(steady.positions - dynamic.positions, axis=2).max(axis=1)
    curve(axes, STEP * np.arange(1, STEPS + 1), distance, color=COLOUR["dynamic"])
    axes.set(xlabel="time [s]", ylabel="[m]", title="Distance from TetherDynamic")
    tidy(axes)
    answer = f"the nodes are within {distance.max():.1f} m of those with waves"
    return Lesson(answer, figure, STEPS * STEP, steady.seconds)


main = command_line(lesson)
