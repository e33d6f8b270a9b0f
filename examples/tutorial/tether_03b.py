"""How much more exact is the spring that cannot push if the solver stops where it becomes slack or taut?

The solver integrates smooth motion up to the event, where stretch = 0, and starts anew with the other law. TetherDynamic
locates no events with this damper: its steps keep the law of their start, and a step too far over the kink is taken back.
"""

import numpy as np
from lessons import DURATION, GRAVITY, SOLVER_COLOUR, TIMES, TOLERANCE, Lesson, command_line, curve, panels, timed
from scipy.integrate import solve_ivp
from tether_02 import DAMPING, LENGTH, MASS, STIFFNESS
from tether_03 import SPEED, product, simulate

EXACT = 1e-13  # tolerance of the motion that all are compared with


def rates(time, state, taut):
    """Rates of change of height [m] and speed [m/s] of the mass."""
    height, speed = state
    spring = -STIFFNESS * (height + LENGTH) if taut else 0.0
    return speed, -GRAVITY + (spring - DAMPING * speed) / MASS


def with_events(tolerance=TOLERANCE):
    """Height of the mass [m], array (rows,), and the times of the events [s]."""
    time, state, taut = 0.0, (-LENGTH, SPEED), False
    heights, events = [], []
    while time < DURATION:

        def stretch(time, state, taut):
            return -state[0] - LENGTH

        stretch.terminal, stretch.direction = True, -1.0 if taut else 1.0
        rows = TIMES[time <= TIMES]
        options = {"events": stretch, "args": (taut,), "rtol": tolerance, "atol": tolerance}
        solved = solve_ivp(rates, (time, DURATION), state, "DOP853", rows, **options)
        heights.append(np.reshape(solved.y, (2, -1))[0])  # also where no row lies between two events
        if solved.status != 1:
            break
        time, state, taut = solved.t_events[0][0], solved.y_events[0][0], not taut
        events.append(time)
    return np.concatenate(heights), np.array(events)


def lesson():
    """Error over time of the solver without and with events, and of TetherDynamic, at the same tolerance."""
    (located, events), seconds = timed(with_events)
    exact, _ = with_events(EXACT)
    heights = {"solve_ivp without events": simulate(), "TetherDynamic": product(), "solve_ivp with events": located}
    figure, axes = panels()
    for each in events:
        axes.axvline(each, color="lightgray", linewidth=0.8)
    for name, height in heights.items():
        error = np.maximum.accumulate(np.abs(height - exact)).clip(1e-12)
        curve(axes, TIMES, error, name, color=SOLVER_COLOUR[name])
    axes.set(yscale="log", xlabel="time [s]", ylabel="largest error so far [m]")
    axes.set_title(f"A kink that is stepped over costs accuracy (grey: its {len(events)} events, tolerance {TOLERANCE:g})")
    return Lesson(f"{len(events)} events, error {np.abs(located - exact).max():.1e} m", figure, DURATION, seconds)


main = command_line(lesson)
