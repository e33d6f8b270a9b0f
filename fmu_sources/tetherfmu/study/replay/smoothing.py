"""Smooth motion from noisy positions and velocities, a Rauch-Tung-Striebel smoother of a point that is shaken."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import LinAlgError, solveh_banded

from tetherfmu.files.toml_files import WrongUse

STATES = 3  # position, velocity, acceleration
RESOLVED = 0.02, 0.1  # of the times in which shaking exceeds the noise of a position, of a velocity: rows closer are joined
FEWEST_NODES = 10
LOST = 0.01  # of the noise of a position: mean residual, which is 0 without rounding


class Smoothed(NamedTuple):
    """Motion at the times of the measurements, arrays (times, 3), and the remaining noise."""

    position: np.ndarray  # [m]
    velocity: np.ndarray  # [m/s]
    acceleration: np.ndarray  # [m/s2]
    deviation: float  # standard deviation of a smoothed position, in the middle of the flight [m]


def smooth(time, positions, velocities, noise):
    """Most probable motion, `Smoothed`, from positions [m] and velocities [m/s], arrays (times, 3); NaN: not measured.

    time : (times,) [s], increasing.  noise : `columns.Smoothing`.

    The acceleration of the point is a Wiener process, s' = (v, a, white noise) for s = (x, v, a). Its most probable motion
    is the result of the smoother of Rauch, Tung and Striebel (AIAA J. 3, 1965); here it is a single least squares problem
    of all deviations over their standard deviations, a banded system, the same for all axes. Its unknowns are the states at
    the rows of `nodes_of`; measurements after a node, and before the next one, are compared with x + v d + a d^2/2 and
    v + a d. WrongUse if the noise levels are too far apart for the arithmetic.
    """
    nodes = nodes_of(time, noise)
    bands, right = _transitions(np.diff(time[nodes]), noise.acceleration_change), np.zeros((STATES * len(nodes), 3))
    node = np.searchsorted(nodes, np.arange(len(time)), side="right") - 1
    late = time - time[nodes[node]]
    sees = np.stack([np.ones_like(late), late, late**2 / 2.0]), np.stack([np.zeros_like(late), np.ones_like(late), late])
    deviations = noise.position_noise, noise.velocity_noise
    for seen, measured, deviation in zip(sees, (positions, velocities), deviations, strict=True):
        weights = np.isfinite(measured).all(axis=1) * seen / deviation**2
        for row in range(STATES):
            np.add.at(right, STATES * node + row, weights[row][:, None] * np.nan_to_num(measured))
            for column in range(row + 1):
                np.add.at(bands[row - column], STATES * node + column, weights[row] * seen[column])
    middle = np.zeros((len(right), 1))
    middle[len(nodes) // 2 * STATES] = 1.0
    try:
        found = solveh_banded(bands, np.hstack([right, middle]), lower=True)
    except LinAlgError:
        found = np.full((len(right), 4), np.nan)
    motion = found[:, :3].reshape(len(nodes), STATES, 3).transpose(1, 0, 2)
    if len(nodes) < len(time):
        curve = CubicHermiteSpline(time[nodes], *motion[:2])
        shaken = np.column_stack([np.interp(time, time[nodes], axis) for axis in motion[2].T])
        motion = np.stack([curve(time), curve(time, 1), shaken])
    refuse_rounding((positions - motion[0])[np.isfinite(positions).all(axis=1)], noise)
    return Smoothed(*motion, float(np.sqrt(found[len(nodes) // 2 * STATES, 3])))


def nodes_of(time, noise):
    """Rows with the state as an unknown, array (nodes,): the first, the last, and all that are not too close together.

    The weight of a transition over h is 720 / (q^2 h^5) for shaking q, the weight of a position 1 / r^2; within a few
    hundredths of (r/q)^(2/5), in which shaking moves the kite by r, rounding would cancel the second.
    """
    of_position = (noise.position_noise / noise.acceleration_change) ** 0.4
    of_velocity = (noise.velocity_noise / noise.acceleration_change) ** (2.0 / 3.0)
    closest = min(RESOLVED[0] * of_position, RESOLVED[1] * of_velocity, (time[-1] - time[0]) / FEWEST_NODES)
    if np.diff(time).min() >= closest:
        return np.arange(len(time))
    nodes = [0]
    for row, each in enumerate(time.tolist()):
        if each - time[nodes[-1]] >= closest:
            nodes.append(row)
    nodes[-1] = len(time) - 1
    return np.array(nodes)


def refuse_rounding(residuals, noise):
    """WrongUse if the residuals of the positions [m], array (known, 3), have a mean, which a shift of the motion removes."""
    if not np.abs(residuals.mean(axis=0)).max() < LOST * noise.position_noise:
        raise WrongUse(
            f"positions cannot be smoothed with smoothing.position_noise {noise.position_noise:g} m, velocity_noise "
            f"{noise.velocity_noise:g} m/s and acceleration_change {noise.acceleration_change:g} m/s2: they are too far "
            "apart"
        )


def _transitions(steps, strength):
    """Lower bands, array (6, 3 times), of the sum of e Q^-1 e over all steps [s], e = s_new - F s_old.

    F, Q : of an acceleration that is a Wiener process of this strength [m/s2/sqrt(s)] (Bar-Shalom, Li and Kirubarajan,
    Estimation with Applications to Tracking and Navigation, 2001, 6.2.3).
    """
    h, zero, one = steps, np.zeros_like(steps), np.ones_like(steps)
    forward = np.moveaxis(np.array([[one, h, h**2 / 2.0], [zero, one, h], [zero, zero, one]]), -1, 0)
    spread = [[h**5 / 20.0, h**4 / 8.0, h**3 / 6.0], [h**4 / 8.0, h**3 / 3.0, h**2 / 2.0], [h**3 / 6.0, h**2 / 2.0, h]]
    weight = np.linalg.inv(np.moveaxis(np.array(spread), -1, 0)) / strength**2
    across = -weight @ forward
    old = -forward.transpose(0, 2, 1) @ across
    bands = np.zeros((2 * STATES, STATES * (len(steps) + 1)))
    for row in range(STATES):
        for column in range(STATES):
            if row >= column:
                bands[row - column, column:-STATES:STATES] += old[:, row, column]
                bands[row - column, STATES + column :: STATES] += weight[:, row, column]
            bands[STATES + row - column, column:-STATES:STATES] += across[:, row, column]
    return bands
