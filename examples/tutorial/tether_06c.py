"""Does a chain get more exact if the solver stops wherever a segment becomes slack or taut?

The chain of lesson 05 without events, with an event for each segment, and in TetherDynamic, which needs none: its steps
keep each segment's law and are taken back if they go too far over a kink. At loose tolerances a solver with events misses
some: a segment that is taut for a moment between two steps changes no sign.
"""

from math import dist

import numpy as np
from lessons import DURATION, TIMES, Lesson, command_line, draw_race, race
from scipy.integrate import solve_ivp
from tether_05 import LENGTH, SEGMENTS, START, product, rates, simulate

TOLERANCES, EXACT = (1e-4, 1e-6, 1e-8), 1e-11


def event(segment, taut):
    """Function that is zero where a segment becomes slack, or taut."""

    def stretch(time, state, taut):
        return dist(*state.reshape(START.shape)[0, segment : segment + 2]) - LENGTH

    stretch.terminal, stretch.direction = True, -1.0 if taut[segment] else 1.0
    return stretch


def with_events(tolerance):
    """Positions of the masses [m], array (rows, 6, 3), and the number of events."""
    time, state, taut = 0.0, START.ravel(), np.zeros((SEGMENTS, 1), bool)
    rows = []
    while time < DURATION:
        options = {"rtol": tolerance, "atol": tolerance, "t_eval": TIMES[time <= TIMES], "args": (taut,)}
        events = [event(segment, taut) for segment in range(SEGMENTS)]
        solved = solve_ivp(rates, (time, DURATION), state, "DOP853", events=events, **options)
        rows.append(np.reshape(solved.y, (state.size, -1)).T)
        if solved.status != 1:
            break
        happened = next(segment for segment, found in enumerate(solved.t_events) if len(found))
        time, state, taut[happened] = solved.t_events[happened][0], solved.y_events[happened][0], not taut[happened]
    return np.concatenate(rows).reshape(-1, *START.shape)[:, 0], len(rows) - 1


def lesson():
    """Error over computing time, with the number of events that were found."""
    exact, all_events = with_events(EXACT)
    solvers = {
        "solve_ivp without events": simulate,
        "solve_ivp with events": lambda tolerance: with_events(tolerance)[0],
        "TetherDynamic": product,
    }
    product()  # loads the kernels
    runs = race(solvers, TOLERANCES, exact, repeats=1)
    figure = draw_race(f"Five segments, ten seconds, tolerances 1e-4 to 1e-8, {all_events} events", runs)
    missed = all_events - with_events(1e-6)[1]
    answer = f"at 1e-6 the solver misses {missed} of {all_events} events"
    return Lesson(answer, figure, DURATION, runs["TetherDynamic"][TOLERANCES.index(1e-6), 0])


main = command_line(lesson)
