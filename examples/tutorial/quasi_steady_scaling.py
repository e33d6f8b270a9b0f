"""How does the cost grow with the number of segments, and what do they buy?

Four seconds of the circle of lesson 11 with 5 to 160 segments in compiled code: the time of a communication step of 20 ms,
and how far the force on the kite is from that with 300 segments, the most there may be.
"""

import numpy as np
from lessons import STEP, Lesson, command_line, curve, panels, timed_from_here
from quasi_steady_circle import KITE, TETHER

from tetherfmu import TetherDynamic, TetherQuasiSteady, inputs_along
from tetherfmu.console.colours import COLOUR, REFERENCE

SEGMENTS, FINEST, STEPS = np.array([5, 10, 20, 40, 80, 160]), 300, 200
MODELS = {"quasi_steady": TetherQuasiSteady, "dynamic": TetherDynamic}
INPUTS = inputs_along(STEPS, STEP, kite=KITE)


def run(model, segments):
    """Force on the kite [N] after each step, array (STEPS, 3), and the time of the flight [s]."""
    tether = model(segments=int(segments), relative_tolerance=1e-6, **TETHER)
    tether.initialize(*KITE.at(0.0))
    return timed_from_here(tether, lambda tether: tether.fly(INPUTS, STEP).kite_force, repeats=4)


def lesson():
    """Cost and error over the number of segments, on logarithmic axes."""
    figure, (left, right) = panels(1, 2)
    for name, model in MODELS.items():
        finest, _ = run(model, FINEST)
        runs = [run(model, segments) for segments in SEGMENTS]
        seconds = [seconds for _, seconds in runs]
        errors = [np.linalg.norm(force - finest, axis=1).max() for force, _ in runs]
        style = {"marker": "o", "markersize": 4, "color": COLOUR[name]}
        curve(left, SEGMENTS, 1e6 * np.array(seconds) / STEPS, name, shift=8 if name == "dynamic" else -8, **style)
        curve(right, SEGMENTS, errors, name, shift=6 if name == "dynamic" else 0, **style)
    axes_of_slope = ((left, 0.05, 1, "n"), (right, 12.0, -2, "1/n²"))
    for axes, factor, power, text in axes_of_slope:
        curve(axes, SEGMENTS, factor * SEGMENTS.astype(float) ** power, text, color=REFERENCE, linewidth=0.8, linestyle="--")
        axes.set(xscale="log", yscale="log", xlabel="segments", xticks=SEGMENTS, xticklabels=SEGMENTS)
        axes.minorticks_off()
    left.set(ylabel="[µs]", title="Cost of a communication step")
    right.set(ylabel="[N]", title="Error of the force on the kite")
    answer = f"with 20 segments the force is within {errors[2]:.3f} N of that with {FINEST}"
    return Lesson(answer, figure, STEPS * STEP, seconds[2])


main = command_line(lesson)
