"""What does a communication step of each tether cost?

The circle of lesson 11, 20 segments, steps of 20 ms: in compiled code (`fly`, all inputs known), and step by step from
Python (`step`, the price of feedback in Python).
"""

import numpy as np
from lessons import STEP, Lesson, command_line, panels, timed_from_here
from quasi_steady_circle import KITE, TETHER

import tetherfmu
from tetherfmu import inputs_along
from tetherfmu.console.colours import COLOUR, REFERENCE
from tetherfmu.runtime.variants import VARIANTS, class_name

STEPS = 1000
INPUTS = inputs_along(STEPS, STEP, kite=KITE)


def compiled(tether):
    """Fly in compiled code."""
    tether.fly(INPUTS, STEP, every=0)


def from_python(tether):
    """Fly step by step."""
    for row in INPUTS:
        tether.step(STEP, row[:3], row[3:6])


def measure(way):
    """Microseconds of a communication step of each variant, array (4,)."""
    found = []
    for variant in VARIANTS:
        tether = getattr(tetherfmu, class_name(variant))(**TETHER)
        tether.initialize(*KITE.at(0.0))
        _, seconds = timed_from_here(tether, way, repeats=5)
        found.append(1e6 * seconds / STEPS)
    return np.array(found)


def lesson():
    """Bars of the cost in compiled code, and what Python adds."""
    costs, in_python = measure(compiled), measure(from_python)
    figure, axes = panels()
    names = [class_name(variant) for variant in VARIANTS]
    axes.barh(names, in_python, color=REFERENCE, height=0.3, alpha=0.5)
    axes.barh(names, costs, color=[COLOUR[variant] for variant in VARIANTS], height=0.6)
    for name, cost, outside in zip(names, costs, in_python, strict=True):
        text = f"{cost:.1f} µs, from Python {outside:.1f} µs"
        axes.annotate(text, (outside, name), (6, 0), textcoords="offset points", va="center")
    axes.set(xlabel="a communication step of 20 ms [µs]", title="Cost of the tethers (grey: with a call from Python)")
    axes.margins(x=0.4)
    axes.grid(visible=False, axis="y")
    dynamic = costs[VARIANTS.index("dynamic")]
    answer = f"TetherDynamic costs {dynamic / costs.min():.0f} times as much as the cheapest"
    return Lesson(answer, figure, STEPS * STEP, 1e-6 * STEPS * dynamic)


main = command_line(lesson)
