"""The smoother equals a Kalman filter with the backward pass of Rauch, Tung and Striebel, written here as in textbooks.

Filter (Kalman 1960): x = F x, P = F P F' + Q; K = P H' (H P H' + R)^-1, x = x + K (z - H x), P = (I - K H) P.
Smoother (Rauch, Tung, Striebel 1965): C = P F' Ppred^-1, xs = x + C (xs_next - xpred), Ps = P + C (Ps_next - Ppred) C'.
It begins with a variance so large that it knows nothing.
"""

import numpy as np
import pytest

from study.replay.known_flight import enu, flown, motions
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime.inputs import by_name
from tetherfmu.study.replay.columns import Smoothing
from tetherfmu.study.replay.flight import STEP
from tetherfmu.study.replay.smoothing import nodes_of, smooth

NOISE = Smoothing(0.8, 0.15, 4.0)
NOTHING_KNOWN = 1e9  # variance at the start; 1e-9 of a measurement's weight is left of it
SAME = 1e-6  # m, m/s, m/s2: that, times accelerations of tens of m/s2, and rounding of P after the start


def transition(step, strength):
    """F, Q of position, velocity and an acceleration that is a Wiener process, exactly integrated over a step."""
    forward = np.array([[1.0, step, step**2 / 2.0], [0.0, 1.0, step], [0.0, 0.0, 1.0]])
    # int_0^h g g' ds with g = (s^2/2, s, 1), by Gauss-Legendre quadrature, which is exact for polynomials
    nodes, weights = np.polynomial.legendre.leggauss(4)
    s = 0.5 * step * (nodes + 1.0)
    g = np.array([s**2 / 2.0, s, np.ones_like(s)])
    return forward, strength**2 * (g * (0.5 * step * weights)) @ g.T


def filtered_and_smoothed(time, positions, velocities, noise):
    """States of one axis, array (times, 3), and variances of their positions; NaN: not measured."""
    x, p = np.zeros(3), np.eye(3) * NOTHING_KNOWN
    states, variances, predicted = [], [], []
    for k in range(len(time)):
        forward = None
        if k:
            forward, q = transition(time[k] - time[k - 1], noise.acceleration_change)
            x, p = forward @ x, forward @ p @ forward.T + q
        predicted.append((x, p, forward))
        for place, (measured, deviation) in enumerate(
            [(positions[k], noise.position_noise), (velocities[k], noise.velocity_noise)]
        ):
            if np.isfinite(measured):
                h = np.eye(3)[place]
                gain = p @ h / (h @ p @ h + deviation**2)
                # the symmetric form of Joseph, which keeps P positive
                keep = np.eye(3) - np.outer(gain, h)
                x, p = x + gain * (measured - h @ x), keep @ p @ keep.T + np.outer(gain, gain) * deviation**2
        states.append(x)
        variances.append(p)
    for k in range(len(time) - 2, -1, -1):
        x_next, p_next, forward = predicted[k + 1]
        c = np.linalg.solve(p_next, forward @ variances[k]).T
        states[k] = states[k] + c @ (states[k + 1] - x_next)
        variances[k] = variances[k] + c @ (variances[k + 1] - p_next) @ c.T
    return np.array(states), np.array(variances)[:, 0, 0]


def measurements(time, seed=3):
    """A noisy flight: positions and velocities, arrays (times, 3)."""
    random, phase = np.random.default_rng(seed), np.array([0.0, 0.7, 1.9])
    positions = 40.0 * np.sin(time[:, None] * (0.5, 0.9, 0.7) + phase) + random.normal(0.0, 0.8, (len(time), 3))
    velocities = 40.0 * np.array([0.5, 0.9, 0.7]) * np.cos(time[:, None] * (0.5, 0.9, 0.7) + phase)
    return positions, velocities + random.normal(0.0, 0.15, (len(time), 3))


def regular():
    time = np.arange(0.0, 12.0, 0.1)
    return time, *measurements(time)


def irregular():
    time = np.cumsum(np.random.default_rng(5).uniform(0.02, 0.4, 80))
    return time, *measurements(time)


def with_gaps():
    time, positions, velocities = irregular()
    positions[20:35], velocities[25:30] = np.nan, np.nan
    positions[::7], velocities[::5] = np.nan, np.nan
    return time, positions, velocities


def positions_only():
    time, positions, velocities = regular()
    return time, positions, np.full_like(velocities, np.nan)


def measured_late():
    time, positions, velocities = regular()
    positions[:30], velocities[:20] = np.nan, np.nan
    positions[-10:], velocities[-15:] = np.nan, np.nan
    return time, positions, velocities


@pytest.mark.parametrize("flight", [regular, irregular, with_gaps, positions_only, measured_late])
def test_it_equals_the_textbook(flight):
    time, positions, velocities = flight()
    found = smooth(time, positions, velocities, NOISE)
    for axis in range(3):
        right, variances = filtered_and_smoothed(time, positions[:, axis], velocities[:, axis], NOISE)
        mine = np.stack([found.position[:, axis], found.velocity[:, axis], found.acceleration[:, axis]], axis=1)
        assert np.abs(mine - right).max() < SAME * max(1.0, np.abs(right).max())
        assert found.deviation == pytest.approx(np.sqrt(variances[len(time) // 2]), rel=1e-5)


def test_a_parabola_without_noise_stays_itself():
    """No process and no measurement errs: x = 3 - 2 t + 0.5 t^2 has a constant acceleration."""
    time = np.linspace(0.0, 10.0, 101) ** 1.1
    x, v = (3.0 - 2.0 * time + 0.5 * time**2), (-2.0 + time)
    found = smooth(time, np.outer(x, [1.0, 2.0, -1.0]), np.outer(v, [1.0, 2.0, -1.0]), NOISE)
    assert np.abs(found.position - np.outer(x, [1.0, 2.0, -1.0])).max() < 1e-8
    assert np.abs(found.acceleration - (1.0, 2.0, -1.0)).max() < 1e-7


def test_it_is_linear_and_the_same_along_each_axis():
    time, positions, velocities = with_gaps()
    found, mirrored = (
        smooth(time, positions, velocities, NOISE),
        smooth(time, -positions[:, ::-1], -velocities[:, ::-1], NOISE),
    )
    assert np.allclose(mirrored.position[:, ::-1], -found.position, rtol=0.0, atol=1e-9)


def test_velocities_make_a_position_better_known():
    time, positions, velocities = regular()
    alone = smooth(time, positions, np.full_like(velocities, np.nan), NOISE)
    assert smooth(time, positions, velocities, NOISE).deviation < 0.5 * alone.deviation < 0.5 * NOISE.position_noise


def test_rows_that_are_very_close_are_joined():
    """10 Hz with a second row 1 us, or 1 ms, after each: the flight of the textbook, whose P is not inverted for a step.

    Joined rows miss what shaking does in between, q h^(5/2) < 1e-6 m, and the curve between nodes some tenths of mm.
    """
    for after in (1e-6, 1e-3):
        time = np.sort(np.concatenate([np.arange(0.0, 12.0, 0.1), np.arange(0.0, 12.0, 0.1) + after]))
        positions, velocities = measurements(time)
        found = smooth(time, positions, velocities, NOISE)
        right, _ = filtered_and_smoothed(time, positions[:, 1], velocities[:, 1], NOISE)
        assert np.abs(found.position[:, 1] - right[:, 0]).max() < 1e-3
        assert np.abs(found.velocity[:, 1] - right[:, 1]).max() < 2e-2  # q h^(1/2) h of the acceleration, 4 m/s2/s^(1/2)


@pytest.mark.parametrize("step", [1.0, 0.1, 0.01, 0.003, 0.001, 0.0001])
def test_the_step_between_rows_does_no_harm(step):
    """The weight of a step grows as step^-5; a smooth flight stays right to a centimetre from 1 Hz to 10 kHz."""
    time = np.arange(0.0, 20.0, step)
    positions = 40.0 * np.sin(0.3 * time[:, None] + (0.0, 0.7, 1.9))
    velocities = 12.0 * np.cos(0.3 * time[:, None] + (0.0, 0.7, 1.9))
    found = smooth(time, positions, velocities, Smoothing(1.0, 0.2, 5.0))
    assert np.abs(found.position - positions)[5:-5].max() < 0.01
    assert np.abs(found.velocity - velocities)[5:-5].max() < 0.02


def test_the_unknowns_do_not_grow_with_the_rate():
    """20 minutes: at 100 Hz and at 1 kHz the same number of states, one in 10.5 ms at most."""
    counts = [len(nodes_of(np.arange(0.0, 1200.0, step), Smoothing(1.0, 0.2, 5.0))) for step in (0.1, 0.01, 0.001)]
    assert counts[0] == 12_000
    assert max(counts) <= 1200.0 / 0.0105 + 1.0


def test_noises_that_are_too_far_apart_are_refused():
    time = np.arange(0.0, 20.0, 0.002)
    positions = 40.0 * np.sin(0.3 * time[:, None] + (0.0, 0.7, 1.9))
    with pytest.raises(WrongUse, match=r"position_noise 0.0001 m, velocity_noise 100 m/s .* too far apart"):
        smooth(time, positions, np.full_like(positions, np.nan), Smoothing(1e-4, 1e2, 1e-3))


def test_a_length_that_drives_the_winch_has_no_quanta(tmp_path):
    """In steps of 5 cm it would accelerate the rope by a quantum over two intervals, 0.05/(0.1 0.02) = 25 m/s2."""
    logged = enu()
    logged["tether_length"] = (logged["tether_length"] / 0.05).round() * 0.05
    flight = flown(tmp_path, logged, "enu")
    length = by_name(flight.inputs("length"))["winch_length"][:, 0]
    wrong = length - motions(flight.start + STEP * np.arange(len(length)))["length"].to_numpy()
    assert np.abs(wrong).max() < 0.05
    inner = slice(round(1.0 / STEP), -round(1.0 / STEP))  # without the ends, where half of the readings are missing
    assert np.abs(np.diff(wrong, 2)[inner]).max() / STEP**2 < 2.0
