"""Snap load: an end that pulls away from a taut line at the speed v feels Z v, Z = sqrt(EA mu), at once: EA v/c with the
wave speed c = sqrt(EA/mu). A held far end reflects the wave and feels 2 Z v. With damping (a Kelvin-Voigt rod, tau =
D/EA) the end of a semi-infinite rod whose speed rises linearly within r feels

    T = Z v (R(t) - R(t - r))/r,    R(t) = tau ((y + 1/2) erf(sqrt y) + sqrt(y/pi) exp(-y)),   y = max(t, 0)/tau

the inverse of the transform Z v sqrt(1 + s tau)/s^2 over r. Source of Z v: K. F. Graff, Wave Motion in Elastic Solids, 2.1.

A released end of a taut line of strain eps recoils at eps c; the unloading front reaches the other end after L/c:

    no damping:     at L/c all of the elastic energy EA eps^2 L/2 is kinetic
    damping:        way of the end  eps c tau ((y - 1/2) erf(sqrt y) + sqrt(y/pi) exp(-y)),  y = t/tau

the second from the transform eps c/(s^2 sqrt(1 + s tau)) of a semi-infinite Kelvin-Voigt rod.

A lumped chain cannot carry waves shorter than two segments and rings at a jump of the speed, so v is reached within a few
segments' travel time l0/c.
"""

import numpy as np
import pytest
from scipy.special import erf

from audited import VOID, held, run
from mechanics import line_density
from tetherfmu import Solver, Tether, TetherDynamic

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


# --- a released end

STRAIN = 0.005


def recoil(n, damping):
    """Way of the end within L/c and that of the formula [m]; kinetic energy and residual over the elastic energy."""
    tether = Tether(segments=n, initial_length=LENGTH, axial_damping=damping)
    model = TetherDynamic(tether, VOID, Solver(relative_tolerance=1e-6, initial_shape=3), free_ends=(False, True))
    model.initialize((LENGTH * (1.0 + STRAIN), 0.0, 0.0))
    speed = np.sqrt(tether.axial_stiffness / line_density(tether))
    stored = 0.5 * tether.axial_stiffness * STRAIN**2 * LENGTH
    result = run(model, held(), 0.5 * LENGTH / n / speed, 2 * n)
    tau = max(damping / tether.axial_stiffness, 1e-9)
    y = LENGTH / speed / tau
    way = STRAIN * speed * tau * ((y - 0.5) * erf(np.sqrt(y)) + np.sqrt(y / np.pi) * np.exp(-y))
    found = LENGTH * (1.0 + STRAIN) - model.positions[-1, 0]
    return found, way, result.energies[-1].kinetic / stored, result.residual / stored


@pytest.mark.parametrize("n", [50, 100])
def test_all_elastic_energy_becomes_kinetic(n):
    _, _, kinetic, residual = recoil(n, 0.0)
    # the front is spread over (n/8)^(1/3) segments, a part n^(-2/3)/2 of the line: 3.7 and 2.3 %
    assert kinetic == pytest.approx(1.0, abs=0.5 * n ** (-2.0 / 3.0))
    assert np.abs(residual).max() < 1e-5  # tolerance 1e-6, 10 steps deep


@pytest.mark.parametrize("n", [20, 100])
def test_way_of_a_damped_end(n):
    found, way, kinetic, residual = recoil(n, 473.0)
    # tau c is 6 m: the front is wider than a segment; observed 3e-6 of 0.968
    assert found == pytest.approx(way, rel=1e-4)
    assert way == pytest.approx(0.968 * STRAIN * LENGTH, rel=1e-3)
    assert kinetic < 0.75  # the rest is heat
    assert np.abs(residual).max() < 2e-3  # trapezoidal rule: the release is a jump of the damper's force
