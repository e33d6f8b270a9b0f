"""Does a chain get more exact if the solver stops wherever a segment becomes slack or taut?

The chain of lesson 05, with an event for each segment, against the same chain without events, and TetherDynamic, which
needs none: its steps keep each segment's law and are taken back if they go too far over a kink. At loose tolerances a
solver with events misses some: a segment that is taut for a moment between two steps changes no sign. One such pair is
worth more than all others.
"""

import sys

import numpy as np
from lessons import GRAVITY, Lesson, command_line, curve, error_over_time, follow, panels, timed, times
from scipy.integrate import solve_ivp
from tether_05 import DAMPING, DURATION, LENGTH, MASSES, SEGMENTS, START, STIFFNESS, tether
from tether_05 import simulate as without_events

from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

TOLERANCES, EXACT = 10.0 ** -np.arange(4, 9), 1e-11


def stretches(state):
    """Length of each segment over its unstretched length [m], array (5, 1), and its direction, array (5, 3)."""
    r = np.diff(state.reshape(START.shape)[0], axis=0)
    length = np.linalg.norm(r, axis=1, keepdims=True)
    return length - LENGTH, r / length


def rates(time, state, taut):
    """Rates of change of lesson 05; taut : which segments are, array (5, 1)."""
    v = state.reshape(START.shape)[1]
    stretch, along = stretches(state)
    pull = (taut * STIFFNESS * stretch + DAMPING * (along * np.diff(v, axis=0)).sum(axis=1, keepdims=True)) * along
    nothing = np.zeros((1, 3))
    acceleration = np.diff(np.concatenate((nothing, pull, nothing)), axis=0) / MASSES - (0.0, 0.0, GRAVITY)
    acceleration[0] = 0.0  # held
    return np.concatenate((v, acceleration)).ravel()


def event(segment, taut):
    """Function that is zero where a segment becomes slack, or taut."""

    def stretch(time, state, taut):
        return stretches(state)[0][segment, 0]

    stretch.terminal, stretch.direction = True, -1.0 if taut[segment] else 1.0
    return stretch


def with_events(tolerance):
    """Positions of the masses [m], array (rows, 6, 3), and the number of events."""
    time, state, taut = 0.0, START.ravel(), np.zeros((SEGMENTS, 1), bool)
    rows, count = [], 0
    while time < DURATION:
        options = {"rtol": tolerance, "atol": tolerance, "t_eval": times(501)[times(501) >= time], "args": (taut,)}
        events = [event(segment, taut) for segment in range(SEGMENTS)]
        solved = solve_ivp(rates, (time, DURATION), state, "DOP853", events=events, **options)
        rows.append(np.reshape(solved.y, (state.size, -1)).T)
        if solved.status != 1:
            break
        happened = next(segment for segment, found in enumerate(solved.t_events) if len(found))
        time, state = solved.t_events[happened][0], solved.y_events[happened][0]
        taut[happened] ^= True
        count += 1
    return np.concatenate(rows).reshape(-1, *START.shape)[:, 0], count


def lesson():
    """Error over computing time, with the number of events that were found."""
    solvers = {
        "solve_ivp without events": (without_events, SKY_BLUE),
        "solve_ivp with events": (lambda tolerance: with_events(tolerance)[0], BLACK),
        "TetherDynamic": (lambda tolerance: follow(tether(tolerance), DURATION), COLOUR["dynamic"]),
    }
    exact, all_events = with_events(EXACT)
    tether()  # loads the kernels
    figure, axes = panels()
    for name, (solver, colour) in solvers.items():
        runs = [timed(solver, tolerance, repeats=1) for tolerance in TOLERANCES]
        seconds, errors = np.transpose([(each, np.abs(positions - exact).max()) for positions, each in runs])
        curve(axes, 1e3 * seconds, errors, name, marker="o", markersize=4, color=colour)
    error_over_time(axes)
    axes.set_title(f"Five segments, ten seconds, tolerances 1e-4 to 1e-8, {all_events} events")
    missed = all_events - with_events(1e-6)[1]
    return Lesson(f"at 1e-6 the solver misses {missed} of {all_events} events", figure, DURATION, seconds[2])


main = command_line(lesson)
if __name__ == "__main__":
    sys.exit(main())
