"""What changes when the spring cannot push, as a tether cannot?

The mass of lesson 02 starts upwards at 4 m/s. Its spring pulls only where it is longer than L; the damper always acts. The
force now has a kink, which the solver steps over without knowing. TetherDynamic gets the same tether, with no stiffness
when slack.
"""

import sys

from lessons import GRAVITY, Lesson, command_line, curve, follow, panels, timed, times
from scipy.integrate import solve_ivp
from tether_02 import DAMPING, DURATION, LENGTH, MASS, SPRING, STIFFNESS

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

SPEED = 4.0  # of the mass at the start, upwards [m/s]
TOLERANCE = 1e-6


def rates(time, state):
    """Rates of change of height [m] and speed [m/s] of the mass."""
    height, speed = state
    stretch = -height - LENGTH
    spring = STIFFNESS * stretch if stretch > 0.0 else 0.0
    return speed, -GRAVITY + (spring - DAMPING * speed) / MASS


def simulate(tolerance=TOLERANCE):
    """Height of the mass [m], array (rows,)."""
    start = (-LENGTH, SPEED)
    return solve_ivp(rates, (0.0, DURATION), start, "DOP853", times(501), rtol=tolerance, atol=tolerance).y[0]


def product(tolerance=TOLERANCE):
    """The same from TetherDynamic."""
    tether = TetherDynamic(**SPRING, slack_stiffness_ratio=0.0, relative_tolerance=tolerance)
    tether.initialize((0.0, 0.0, -LENGTH), (0.0, 0.0, SPEED))
    return follow(tether, DURATION)[:, 1, 2]


def lesson():
    """Height over time, and the difference of the two solvers."""
    height, seconds = timed(simulate)
    time = times(501)
    figure, (above, below) = panels(2, sharex=True)
    above.fill_between(
        time, -10.6, height.max(), where=height > -LENGTH, color=SKY_BLUE, alpha=0.25, linewidth=0.0, step="mid"
    )
    above.text(0.5, -10.5, "slack", color=SKY_BLUE, ha="center", weight="bold")
    curve(above, time, height, color=BLACK)
    above.set(ylabel="height [m]", title="1 kg on a spring that cannot push")
    curve(below, time, 1e3 * (product() - height), color=COLOUR["dynamic"])
    below.set(xlabel="time [s]", ylabel="TetherDynamic minus\nsolve_ivp [mm]")
    slack = (height > -LENGTH).mean()
    return Lesson(f"slack for {100 * slack:.0f} % of the time", figure, DURATION, seconds)


main = command_line(lesson)
if __name__ == "__main__":
    sys.exit(main())
