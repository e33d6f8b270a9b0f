"""Smooth motion from noisy positions and velocities, a Rauch-Tung-Striebel smoother of a point that is shaken."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import solveh_banded

STATES = 3  # position, velocity, acceleration


class Noise(NamedTuple):
    """Standard deviations that the smoother is told."""

    position: float  # of a measured position [m]
    velocity: float  # of a measured velocity [m/s]
    acceleration: float  # by which the acceleration of the kite changes in one second [m/s2]


class Smoothed(NamedTuple):
    """Motion at the times of the measurements, arrays (times, 3), and what is left of the noise."""

    position: np.ndarray  # [m]
    velocity: np.ndarray  # [m/s]
    acceleration: np.ndarray  # [m/s2]
    deviation: float  # standard deviation of a smoothed position, in the middle of the flight [m]


def smooth(time, positions, velocities, noise):
    """Most probable motion, `Smoothed`, from positions [m] and velocities [m/s], arrays (times, 3); NaN: not measured.

    time : (times,) [s], growing.  noise : `Noise`.

    The acceleration of the point is a Wiener process, s' = (v, a, white noise) for s = (x, v, a). Its most probable motion
    is what the smoother of Rauch, Tung and Striebel (AIAA J. 3, 1965) gives; here it is found at once, as the least squares
    of all deviations over their standard deviations, a banded system. All axes have the same one.
    """
    bands, right = _transitions(np.diff(time), noise.acceleration), np.zeros((STATES * len(time), 3))
    for state, (measured, deviation) in enumerate([(positions, noise.position), (velocities, noise.velocity)]):
        known = np.isfinite(measured).all(axis=1)
        bands[0, state::STATES] += known / deviation**2
        right[state::STATES] = np.where(known[:, None], measured, 0.0) / deviation**2
    middle = np.zeros((len(right), 1))
    middle[len(time) // 2 * STATES] = 1.0
    found = solveh_banded(bands, np.hstack([right, middle]), lower=True)
    motion = found[:, :3].reshape(len(time), STATES, 3)
    return Smoothed(*motion.transpose(1, 0, 2), float(np.sqrt(found[len(time) // 2 * STATES, 3])))


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
