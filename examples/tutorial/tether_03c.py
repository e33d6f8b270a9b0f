"""What does it cost to locate the events, and what is it worth?

The motion of lessons 03 and 03b at tolerances from 1e-3 to 1e-10: each solver's error over its computing time. Published
times of this scene, on another machine: Julia 0.606 ms without and 0.741 ms with a callback for the events, Python 20 ms
and 31 ms.
"""

import sys

import numpy as np
from lessons import Lesson, command_line, curve, error_over_time, panels, timed
from tether_02 import DURATION
from tether_03 import product
from tether_03 import simulate as without_events
from tether_03b import EXACT
from tether_03b import simulate as with_events

from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

TOLERANCES = 10.0 ** -np.arange(3, 11)
PRINTED = 3  # index of the tolerance whose times are printed, 1e-6
PUBLISHED = {"without events": "Julia 0.606 ms, Python 20 ms", "with events": "Julia 0.741 ms, Python 31 ms"}
SOLVERS = {
    "solve_ivp without events": (without_events, SKY_BLUE),
    "solve_ivp with events": (lambda tolerance: with_events(tolerance)[0], BLACK),
    "TetherDynamic": (product, COLOUR["dynamic"]),
}


def measure():
    """Dict solver -> array (tolerances, 2) of computing time [s] and largest error [m]."""
    exact, _ = with_events(EXACT)
    found = {}
    for name, (solver, _) in SOLVERS.items():
        runs = (timed(solver, tolerance, repeats=3) for tolerance in TOLERANCES)
        found[name] = np.array([(seconds, np.abs(height - exact).max()) for height, seconds in runs])
    return found


def lesson():
    """Error over computing time."""
    runs = measure()
    figure, axes = panels()
    for name, values in runs.items():
        curve(axes, *(values * (1e3, 1.0)).T, name, marker="o", markersize=4, color=SOLVERS[name][1])
        seconds, error = values[PRINTED]
        published = PUBLISHED.get(name.removeprefix("solve_ivp "))
        print(f"{name}: {1e3 * seconds:.2f} ms, error {error:.1e} m{f' (published: {published})' if published else ''}")
    error_over_time(axes)
    axes.set_title("Ten seconds of a mass on a spring that cannot push")
    plain, located = (runs[f"solve_ivp {each} events"][PRINTED] for each in ("without", "with"))
    answer = (
        f"located events divide the error by {plain[1] / located[1]:.0f}, for {located[0] / plain[0]:.2f} times the time"
    )
    return Lesson(answer, figure, DURATION, runs["TetherDynamic"][PRINTED][0])


main = command_line(lesson)
if __name__ == "__main__":
    sys.exit(main())
