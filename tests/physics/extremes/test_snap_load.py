"""Snap load: an end that pulls away from a taut line at the speed v feels Z v, Z = sqrt(EA mu), at once: EA v/c with the
wave speed c = sqrt(EA/mu). A held far end reflects the wave and feels 2 Z v. With damping (a Kelvin-Voigt rod, tau =
D/EA) the end of a semi-infinite rod whose speed rises linearly within r feels

    T = Z v (R(t) - R(t - r))/r,    R(t) = tau ((y + 1/2) erf(sqrt y) + sqrt(y/pi) exp(-y)),   y = max(t, 0)/tau

the inverse of the transform Z v sqrt(1 + s tau)/s^2 over r. Source of Z v: K. F. Graff, Wave Motion in Elastic Solids, 2.1.

A lumped chain cannot carry waves shorter than two segments and rings at a jump of the speed, so v is reached within a few
segments' travel time l0/c.
"""

import numpy as np
import pytest
from scipy.special import erf

from audited import VOID, run
from mechanics import line_density
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Solver, Tether

LENGTH, SPEED = 100.0, 5.0
STIFFNESS = Tether().axial_stiffness
WAVE_SPEED = np.sqrt(STIFFNESS / line_density(Tether()))
IMPEDANCE = STIFFNESS / WAVE_SPEED
TRAVEL = LENGTH / WAVE_SPEED


def pulled(n, damping, velocity, duration):
    """Pull the kite end with velocity(t), a polynomial until it is constant; a `Run` with two steps per l0/c."""
    model = TetherDynamic(
        Tether(segments=n, initial_length=LENGTH, axial_damping=damping),
        VOID,
        Solver(relative_tolerance=1e-6, initial_shape=3),
    )
    model.initialize((LENGTH, 0.0, 0.0))
    step = 0.5 * TRAVEL / n

    def inputs(time):
        position, speed = velocity(time)
        return {"kite_position": (LENGTH + position, 0.0, 0.0), "kite_velocity": (speed, 0.0, 0.0)}

    return run(model, inputs, step, round(duration / step))


def smooth_rise(rise):
    """Speed that rises as 3 s^2 - 2 s^3, s = t/rise."""

    def velocity(time):
        s = min(time / rise, 1.0)
        return SPEED * (rise * (s**3 - 0.5 * s**4) + max(0.0, time - rise)), SPEED * (3.0 * s**2 - 2.0 * s**3)

    return velocity


def linear_rise(rise):
    """Speed that rises as t/rise."""

    def velocity(time):
        early = min(time, rise)
        return SPEED * (0.5 * early**2 / rise + max(0.0, time - rise)), SPEED * early / rise

    return velocity


def peaks(n, rise_segments):
    """Largest tension at the kite and at the held end over Z v, and energy from nowhere over the turnover."""
    result = pulled(n, 0.0, smooth_rise(rise_segments * TRAVEL / n), 1.9 * TRAVEL)
    kite = max(out.kite_tension for out in result.outputs)
    ground = max(out.ground_tension for out in result.outputs)
    return np.array([kite, ground]) / (IMPEDANCE * SPEED), np.abs(result.residual).max() / result.turnover


def with_damping(n, rise):
    """Tension of the kite end over Z v of chain and rod until L/c; the reflected wave, spread by damping, comes later."""
    result = pulled(n, Tether().axial_damping, linear_rise(rise), TRAVEL)
    tau = Tether().axial_damping / STIFFNESS

    def ramp(t):
        y = np.maximum(t, 0.0) / tau
        return tau * ((y + 0.5) * erf(np.sqrt(y)) + np.sqrt(y / np.pi) * np.exp(-y))

    chain = np.array([out.kite_tension for out in result.outputs]) / (IMPEDANCE * SPEED)
    return chain, (ramp(result.times) - ramp(result.times - rise)) / rise


@pytest.mark.parametrize("n", [50, 100])
def test_peak_at_the_end_that_pulls(n):
    (kite, _), residual = peaks(n, 10)
    # the bar is 2 %; ringing falls with the square of segments per rise: 0.6, 0.2, 0.06 % for 5, 10, 20 at n = 50
    assert kite == pytest.approx(1.0, abs=0.003)
    # trapezoidal rule with 20 steps per rise
    assert residual < 1e-3


def test_the_held_end_feels_twice_that():
    (_, ground), _ = peaks(100, 40)
    # on its way the wave disperses over (n/8)^(1/3) = 2.3 segments and rings behind its front: 2 % are left here
    assert ground == pytest.approx(2.0, rel=0.02)


@pytest.mark.parametrize("rise", [5e-4, 1e-3, 2e-3])
def test_peak_with_damping(rise):
    chain, rod = with_damping(100, rise)
    assert chain.max() == pytest.approx(rod.max(), rel=0.02)  # observed 0.8, 0.15, 0.01 %
    # after the kinks of the speed, where a rod answers with a square root of time, both are the same
    late = slice(round(0.5 * len(rod)), None)
    np.testing.assert_allclose(chain[late], rod[late], rtol=5e-3)
