"""What does it cost to locate the events, and what is it worth?

The motion of lessons 03 and 03b at tolerances from 1e-3 to 1e-10: each solver's error over its computing time. Published
times of this scene, on another machine: Julia 0.606 ms without and 0.741 ms with a callback for the events, Python 20 ms
and 31 ms.
"""

import numpy as np
from lessons import DURATION, Lesson, command_line, draw_race, race
from tether_03 import product, simulate
from tether_03b import EXACT, with_events

TOLERANCES = 10.0 ** -np.arange(3, 11)
PRINTED = 3  # index of the tolerance whose times are printed, 1e-6
PUBLISHED = {"without events": "Julia 0.606 ms, Python 20 ms", "with events": "Julia 0.741 ms, Python 31 ms"}
SOLVERS = {
    "solve_ivp without events": simulate,
    "solve_ivp with events": lambda tolerance: with_events(tolerance)[0],
    "TetherDynamic": product,
}


def lesson():
    """Error over computing time."""
    runs = race(SOLVERS, TOLERANCES, with_events(EXACT)[0], repeats=3)
    for name, values in runs.items():
        seconds, error = values[PRINTED]
        published = PUBLISHED.get(name.removeprefix("solve_ivp "))
        print(f"{name}: {1e3 * seconds:.2f} ms, error {error:.1e} m{f' (published: {published})' if published else ''}")
    figure = draw_race("Ten seconds of a mass on a spring that cannot push", runs)
    plain, located = (runs[f"solve_ivp {each} events"][PRINTED] for each in ("without", "with"))
    answer = (
        f"located events divide the error by {plain[1] / located[1]:.0f}, for {located[0] / plain[0]:.2f} times the time"
    )
    return Lesson(answer, figure, DURATION, runs["TetherDynamic"][PRINTED][0])


main = command_line(lesson)
