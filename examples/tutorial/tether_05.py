"""How does a chain of five segments swing that is let go off the vertical?

A hand-made tether: springs that cannot push, dampers along them, half of a segment's mass at each of its ends. It starts
straight, pi/10 off the vertical, and shrinks: its masses move towards its upper end, the last one at 2 m/s. TetherDynamic
has the same equations: EA = k l, D = c l, mass per metre m/l.
"""

import numpy as np
from lessons import DURATION, GRAVITY, TIMES, TOLERANCE, Lesson, Movie, beside_motion, command_line, compare, follow, timed
from scipy.integrate import solve_ivp
from tether_03 import NO_SPRING

from tetherfmu import TetherDynamic

SEGMENTS, LENGTH, MASS, STIFFNESS, DAMPING = 5, 5.0, 0.5, 50.0, 0.5  # of a segment: m, kg, N/m, N s/m
SPEED, ANGLE = 2.0, np.pi / 10.0  # m/s, rad
UP = np.array([np.sin(ANGLE), 0.0, np.cos(ANGLE)])
START = np.array([-LENGTH, SPEED / SEGMENTS])[:, None, None] * np.arange(SEGMENTS + 1.0)[:, None] * UP  # m, m/s
MASSES = MASS * np.array([[0.5], *[[1.0]] * (SEGMENTS - 1), [0.5]])
SAME = {"segments": SEGMENTS, "initial_length": SEGMENTS * LENGTH, "slack_stiffness_ratio": NO_SPRING, "air_density": 0.0}
SAME |= {"axial_stiffness": STIFFNESS * LENGTH, "axial_damping": DAMPING * LENGTH, "mass_per_length": MASS / LENGTH}


def rates(time, state, taut=None):
    """Rates of change of positions [m] and velocities [m/s] of all masses, flat array (2 * 6 * 3,)."""
    x, v = state.reshape(START.shape)
    r, u = np.diff(x, axis=0), np.diff(v, axis=0)
    length = np.linalg.norm(r, axis=1, keepdims=True)
    along = r / length
    spring = STIFFNESS * (length - LENGTH) * (length > LENGTH if taut is None else taut)  # taut : see lesson 06c
    pull = (spring + DAMPING * (along * u).sum(axis=1, keepdims=True)) * along
    acceleration = np.diff(pull, axis=0, prepend=0.0, append=0.0) / MASSES - (0.0, 0.0, GRAVITY)
    acceleration[0] = 0.0  # held
    return np.concatenate((v, acceleration)).ravel()


def simulate(tolerance=TOLERANCE):
    """Positions of the masses [m], array (rows, 6, 3)."""
    solved = solve_ivp(rates, (0.0, DURATION), START.ravel(), "DOP853", TIMES, rtol=tolerance, atol=tolerance)
    return solved.y.T.reshape(-1, *START.shape)[:, 0]


def product(tolerance=TOLERANCE):
    """The same from TetherDynamic."""
    tether = TetherDynamic(**SAME, relative_tolerance=tolerance, free_ends=(False, True))
    tether.initialize(positions=START[0], velocities=START[1])
    return follow(tether, DURATION)


def lesson():
    """Shapes every second of the first swing, and the difference from TetherDynamic."""
    (positions, seconds), (ours, our_seconds) = timed(simulate), timed(product)
    figure, right = beside_motion(positions[:201], 50, "The first swing")
    compare(right, ours, positions)
    stretch = 100.0 * (np.linalg.norm(np.diff(positions, axis=1), axis=2).max() / LENGTH - 1.0)
    answer = f"a segment is stretched by up to {stretch:.0f} %; TetherDynamic is {seconds / our_seconds:.0f} times faster"
    return Lesson(answer, figure, DURATION, seconds, Movie(positions, "Five segments let go"))


main = command_line(lesson)
