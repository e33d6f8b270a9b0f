"""How do two masses move on two springs in series?

From one spring to a chain: positions and velocities are arrays, and each segment pulls at its two masses. Two segments of
10 m, three masses of 1 kg, the first one held; the last one starts upwards at 4 m/s, the middle one at 2 m/s. The damper
sees the whole relative velocity of its two masses, also across the segment; this motion has none.
"""

import numpy as np
from lessons import DURATION, GRAVITY, TIMES, TOLERANCE, Lesson, command_line, compare, curve, follow, over_time, timed
from scipy.integrate import solve_ivp
from tether_02 import DAMPING, LENGTH, MASS, SPRING, STIFFNESS
from tether_03 import NO_SPRING, SPEED

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, SKY_BLUE

POSITIONS = LENGTH * np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, -2.0]])
VELOCITIES = SPEED * np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.0, 0.0, 1.0]])


def rates(time, state):
    """Rates of change of positions [m] and velocities [m/s] of all masses, flat array (2 * 3 * 3,)."""
    x, v = state.reshape(2, 3, 3)
    r, u = np.diff(x, axis=0), np.diff(v, axis=0)
    length = np.linalg.norm(r, axis=1, keepdims=True)
    pull = np.where(length > LENGTH, STIFFNESS * (length - LENGTH), 0.0) * r / length + DAMPING * u
    acceleration = np.diff(pull, axis=0, prepend=0.0, append=0.0) / MASS - (0.0, 0.0, GRAVITY)
    acceleration[0] = 0.0  # held
    return np.concatenate((v, acceleration)).ravel()


def simulate(tolerance=TOLERANCE):
    """Positions of the masses [m], array (rows, 3, 3)."""
    start = np.concatenate((POSITIONS, VELOCITIES)).ravel()
    solved = solve_ivp(rates, (0.0, DURATION), start, "DOP853", TIMES, rtol=tolerance, atol=tolerance)
    return solved.y.T.reshape(-1, 2, 3, 3)[:, 0]


def product(tolerance=TOLERANCE):
    """The same from TetherDynamic."""
    both = {"segments": 2, "initial_length": 2.0 * LENGTH, "point_masses": {1: MASS, 2: MASS}}
    tether = TetherDynamic(**{**SPRING, **both}, slack_stiffness_ratio=NO_SPRING, relative_tolerance=tolerance)
    tether.initialize(positions=POSITIONS, velocities=VELOCITIES)
    return follow(tether, DURATION)


def lesson():
    """Heights over time, and the difference from TetherDynamic."""
    positions, seconds = timed(simulate)
    title = "Three masses on two springs that cannot push, the first one held"
    figure, above, below = over_time(title, "height over the start [m]")
    for node, (name, colour) in {1: ("middle mass", SKY_BLUE), 2: ("last mass", BLACK)}.items():
        curve(above, TIMES, positions[:, node, 2] - positions[0, node, 2], name, color=colour)
    compare(below, product(), positions)
    return Lesson(f"the last mass falls to {positions[:, 2, 2].min():.2f} m", figure, DURATION, seconds)


main = command_line(lesson)
