"""How does a chain of five segments swing that is let go off the vertical?

The hand-made model of a tether, complete: five springs of 5 m and 50 N/m that cannot push, with dampers of 0.5 N s/m along
them; the 0.5 kg of each segment is shared between its two masses. It starts straight, pi/10 off the vertical, and shrinks:
its masses move towards its upper end, the last one at 2 m/s. TetherDynamic has the same equations: EA = k l, D = c l, mass
per metre m/l.
"""

import sys

import numpy as np
from lessons import GRAVITY, STEP, Lesson, Movie, command_line, curve, follow, panels, timed, times
from scipy.integrate import solve_ivp

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, SKY_BLUE

SEGMENTS, LENGTH, MASS, STIFFNESS, DAMPING = 5, 5.0, 0.5, 50.0, 0.5  # of a segment: m, kg, N/m, N s/m
SPEED, ANGLE, DURATION, TOLERANCE = 2.0, np.pi / 10.0, 10.0, 1e-6  # m/s, rad, s
UP = np.array([np.sin(ANGLE), 0.0, np.cos(ANGLE)])
ORDER = np.arange(SEGMENTS + 1.0)[:, None]
START = np.array([-LENGTH * ORDER * UP, SPEED / SEGMENTS * ORDER * UP])  # positions and velocities
MASSES = MASS * np.array([[0.5], *[[1.0]] * (SEGMENTS - 1), [0.5]])
SAME = {  # equations of TetherDynamic
    "segments": SEGMENTS,
    "initial_length": SEGMENTS * LENGTH,
    "axial_stiffness": STIFFNESS * LENGTH,
    "axial_damping": DAMPING * LENGTH,
    "slack_stiffness_ratio": 0.0,
    "diameter": 0.01,
    "density": MASS / LENGTH / (0.25 * np.pi * 0.01**2),
    "drag_coefficient": 0.0,
}


def rates(time, state):
    """Rates of change of positions [m] and velocities [m/s] of all masses, flat array (2 * 6 * 3,)."""
    x, v = state.reshape(START.shape)
    r, u = np.diff(x, axis=0), np.diff(v, axis=0)
    length = np.linalg.norm(r, axis=1, keepdims=True)
    along = r / length
    spring = np.where(length > LENGTH, STIFFNESS * (length - LENGTH), 0.0)
    pull = (spring + DAMPING * (along * u).sum(axis=1, keepdims=True)) * along
    force = np.zeros_like(x)
    force[:-1] += pull
    force[1:] -= pull
    acceleration = force / MASSES - (0.0, 0.0, GRAVITY)
    acceleration[0] = 0.0  # held
    return np.concatenate((v, acceleration)).ravel()


def simulate(tolerance=TOLERANCE):
    """Positions of the masses [m], array (rows, 6, 3)."""
    solved = solve_ivp(rates, (0.0, DURATION), START.ravel(), "DOP853", times(501), rtol=tolerance, atol=tolerance)
    return solved.y.T.reshape(-1, *START.shape)[:, 0]


def tether(tolerance=TOLERANCE):
    """TetherDynamic with the same equations, at its start."""
    found = TetherDynamic(**SAME, relative_tolerance=tolerance, free_ends=(False, True))
    found.initialize(positions=START[0], velocities=START[1])
    return found


def lesson():
    """Shapes every second of the first swing, and the difference from TetherDynamic."""
    positions, seconds = timed(simulate)
    ours, our_seconds = timed(lambda: follow(tether(), DURATION))
    figure, (left, right) = panels(1, 2, size=(8.0, 4.6), width_ratios=(2, 3))
    left.plot(*positions[:201, -1, [0, 2]].T, color=SKY_BLUE)
    for row in range(0, 201, 50):
        left.plot(*positions[row, :, [0, 2]], "o-", markersize=3, color=BLACK, alpha=0.15 + 0.85 * row / 200)
        left.annotate(f"{row * STEP:.0f} s", positions[row, -1, [0, 2]], (0, -12), textcoords="offset points", ha="center")
    left.set(xlabel="x [m]", ylabel="height [m]", title="The first swing", aspect="equal")
    left.margins(0.12)
    curve(right, times(501), 1e3 * np.abs(ours - positions).max(axis=(1, 2)), color=COLOUR["dynamic"])
    right.set(xlabel="time [s]", ylabel="[mm]", title="TetherDynamic against solve_ivp")
    stretch = np.linalg.norm(np.diff(positions, axis=1), axis=2).max() / LENGTH - 1.0
    answer = (
        f"a segment is stretched by up to {100 * stretch:.0f} %; TetherDynamic is {seconds / our_seconds:.0f} times faster"
    )
    return Lesson(answer, figure, DURATION, seconds, Movie(positions, "Five segments let go"))


main = command_line(lesson)
if __name__ == "__main__":
    sys.exit(main())
