"""What changes when the spring cannot push, as a tether cannot?

The mass of lesson 02 starts upwards at 4 m/s. Its spring pulls only where it is longer than L; the damper always acts. The
force now has a kink, which the solver steps over without knowing. TetherDynamic gets the same tether, with no stiffness
when slack.
"""

from lessons import DURATION, GRAVITY, TIMES, TOLERANCE, Lesson, command_line, curve, follow, over_time, timed
from scipy.integrate import solve_ivp
from tether_02 import DAMPING, LENGTH, MASS, SPRING, STIFFNESS

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

NO_SPRING = 1e-12  # `slack_stiffness_ratio` of a segment that keeps its damper when slack, as here
SPEED = 4.0  # of the mass at the start, upwards [m/s]


def rates(time, state):
    """Rates of change of height [m] and speed [m/s] of the mass."""
    height, speed = state
    stretch = -height - LENGTH
    spring = STIFFNESS * stretch if stretch > 0.0 else 0.0
    return speed, -GRAVITY + (spring - DAMPING * speed) / MASS


def simulate(tolerance=TOLERANCE):
    """Height of the mass [m], array (rows,)."""
    start = (-LENGTH, SPEED)
    return solve_ivp(rates, (0.0, DURATION), start, "DOP853", TIMES, rtol=tolerance, atol=tolerance).y[0]


def product(tolerance=TOLERANCE):
    """The same from TetherDynamic."""
    tether = TetherDynamic(**SPRING, slack_stiffness_ratio=NO_SPRING, relative_tolerance=tolerance)
    tether.initialize((0.0, 0.0, -LENGTH), (0.0, 0.0, SPEED))
    return follow(tether, DURATION)[:, 1, 2]


def lesson():
    """Height over time, and the difference of the two solvers."""
    height, seconds = timed(simulate)
    slack = height > -LENGTH
    labels = "height [m]", "TetherDynamic minus\nsolve_ivp [mm]"
    figure, above, below = over_time("1 kg on a spring that cannot push", *labels)
    above.fill_between(TIMES, -10.6, height.max(), slack, color=SKY_BLUE, alpha=0.25, linewidth=0.0, step="mid")
    above.text(0.5, -10.5, "slack", color=SKY_BLUE, ha="center", weight="bold")
    curve(above, TIMES, height, color=BLACK)
    curve(below, TIMES, 1e3 * (product() - height), color=COLOUR["dynamic"])
    return Lesson(f"slack for {100 * slack.mean():.0f} % of the time", figure, DURATION, seconds)


main = command_line(lesson)
