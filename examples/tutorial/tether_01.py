"""How high does a mass fly that is thrown upwards at 50 m/s, and when is it at the top?

z'' = -g, from z = 0. This is the whole machinery of the next four lessons: a function that gives the rates of change, the
solver `solve_ivp` of SciPy, and an event (the speed is zero), which the solver locates to rounding between its steps.
"""

from lessons import DURATION, GRAVITY, TIMES, Lesson, command_line, curve, over_time, timed
from scipy.integrate import solve_ivp

from tetherfmu.console.colours import REFERENCE, SKY_BLUE, VERMILLION

SPEED = 50.0  # at the start [m/s]


def rates(time, state):
    """Rates of change of height [m] and speed [m/s]."""
    _, speed = state
    return speed, -GRAVITY


def at_the_top(time, state):
    """Zero when the mass is."""
    return state[1]


def simulate():
    """Height [m] and speed [m/s], array (2, rows), and the time at the top [s]."""
    solved = solve_ivp(rates, (0.0, DURATION), (0.0, SPEED), "DOP853", TIMES, events=at_the_top, rtol=1e-10)
    return solved.y, solved.t_events[0][0]


def lesson():
    """Height over time, and how far it is from the formula."""
    ((height, _), top), seconds = timed(simulate)
    formula = SPEED * TIMES - 0.5 * GRAVITY * TIMES**2
    labels = "height [m]", "solver minus\nformula [pm]"
    figure, above, below = over_time("A mass thrown upwards at 50 m/s", *labels, height_ratios=(3, 1))
    curve(above, TIMES, height, "height of the mass", at=360, color=SKY_BLUE, linewidth=2.0)
    above.plot(top, height.max(), "o", color=VERMILLION)
    beside = {"xytext": (0, -36), "textcoords": "offset points", "ha": "center"}
    above.annotate(f"speed 0,\nlocated at {top:.4f} s", (top, height.max()), **beside)
    curve(below, TIMES, 1e12 * (height - formula), color=REFERENCE)
    return Lesson(f"{height.max():.2f} m high after {top:.4f} s", figure, DURATION, seconds)


main = command_line(lesson)
