"""An end that shakes a taut line near its first eigenfrequencies, without gravity and air. Node mass m, spring k = EA/l0.

axial, kite end moved by A sin(omega t), with damping, after the start has died out: complex amplitudes u_i of the nodes

    -omega^2 m u_i = k (1 + i omega tau) (u_(i-1) - 2 u_i + u_(i+1)),  u_0 = 0, u_n = A
    ground tension k (1 + i omega tau) u_1,  tau = D/EA

    continuum: ground tension EA (1 + i omega tau) kappa/sin(kappa L) A,  kappa^2 = mu omega^2/(EA (1 + i omega tau))

transverse, without damping (string of tension T, segment length l, spring T/l): amplitude q of the first mode

    q'' + omega_1^2 q = (2/n) sin(pi (n-1)/n) T/(l m) A sin(omega t),  omega_1 = 2 sqrt(T/(l m)) sin(pi/(2 n))
    at omega = omega_1   q = f/(2 omega^2) (sin omega t - omega t cos omega t)                      grows without end
    elsewhere            q = f/(omega_1^2 - omega^2) (sin omega t - omega/omega_1 sin omega_1 t)    beats

Frequencies of free vibrations: `test_vibration.py`. Source: L. Meirovitch, Analytical Methods in Vibrations, chapters 4
and 5.
"""

import numpy as np
import pytest

from audited import VOID, run
from mechanics import line_density
from tetherfmu import Solver, Tether, TetherDynamic

LENGTH, STRAIN = 100.0, 0.005
EA, DAMPING = 614600.0, 473.0
MU = line_density(Tether())
TAU = DAMPING / EA
PER_PERIOD = 100


def first_axial(n):
    """First axial eigenfrequency [rad/s] of the undamped chain."""
    return 2.0 * np.sqrt(EA / MU) * n / LENGTH * np.sin(np.pi / (2 * n))


def shaken(n, omega, direction, amplitude, damping, periods):
    """A `Run` of a line of n segments whose kite end is moved by amplitude sin(omega t), and node positions at each step."""
    tether = Tether(segments=n, initial_length=LENGTH, axial_damping=damping)
    model = TetherDynamic(tether, VOID, Solver(relative_tolerance=1e-7, initial_shape="static_equilibrium"))
    start, direction = np.array([LENGTH * (1.0 + STRAIN), 0.0, 0.0]), np.array(direction)
    model.initialize(start, amplitude * omega * direction)
    positions = []

    def inputs(time):
        positions.append(model.positions)
        phase = omega * time
        return {
            "kite_position": start + amplitude * np.sin(phase) * direction,
            "kite_velocity": amplitude * omega * np.cos(phase) * direction,
        }

    return run(model, inputs, 2.0 * np.pi / omega / PER_PERIOD, PER_PERIOD * periods), np.array(positions)


def measured_response(n, omega, amplitude=1e-3):
    """Complex amplitude of the ground tension over that of the kite end [N/m], from the last 5 of 25 periods."""
    result, _ = shaken(n, omega, (1.0, 0.0, 0.0), amplitude, DAMPING, 25)
    tension = np.array([out.ground_tension for out in result.outputs[-5 * PER_PERIOD :]]) - EA * STRAIN
    turn = np.exp(-1j * omega * result.times[-5 * PER_PERIOD :])
    return 2j * np.mean(tension * turn) / amplitude, np.abs(result.residual).max() / result.turnover


def chain_response(n, omega):
    """The same of the linear chain."""
    mass, spring = MU * LENGTH / n, EA * n / LENGTH * (1.0 + 1j * omega * TAU)
    matrix = np.diag(np.full(n - 1, 2.0 * spring - omega**2 * mass))
    matrix -= spring * (np.eye(n - 1, k=1) + np.eye(n - 1, k=-1))
    return spring * np.linalg.solve(matrix, spring * np.eye(n - 1)[-1])[0]


def rod_response(omega):
    """The same of the continuum."""
    stiffness = EA * (1.0 + 1j * omega * TAU)
    wave_number = omega * np.sqrt(MU / stiffness)
    return stiffness * wave_number / np.sin(wave_number * LENGTH)


@pytest.mark.parametrize("part", [0.9, 1.0, 1.1])
def test_axial_resonance_of_the_chain(part):
    omega = part * first_axial(10)
    found, residual = measured_response(10, omega)
    # an end led by inputs at 100 per period is off by (2 pi/100)^3 5/12 = 1e-4
    assert found == pytest.approx(chain_response(10, omega), rel=3e-4)
    assert residual < 5e-4  # trapezoidal rule with 100 steps per period, over 25 periods


@pytest.mark.parametrize("n", [20, 40])
def test_axial_resonance_of_the_continuum(n):
    omega = np.pi / LENGTH * np.sqrt(EA / MU)
    found, _ = measured_response(n, omega)
    b = np.pi / (2 * n)
    # the chain's eigenfrequency is b^2/6 lower; at resonance that turns the response by b^2/6 over zeta = omega tau/2 = 0.1
    assert found == pytest.approx(rod_response(omega), rel=1.2 * b**2 / 6.0 / (0.5 * omega * TAU))
    assert abs(found) > 4.0 * EA / LENGTH  # far above the static stiffness


@pytest.mark.parametrize("part", [0.9, 1.0, 1.05])
def test_transverse_resonance(part):
    n, amplitude, periods = 10, 1e-4, 10
    tension, segment = EA * STRAIN, LENGTH * (1.0 + STRAIN) / n
    mass = MU * LENGTH / n
    first = 2.0 * np.sqrt(tension / (segment * mass)) * np.sin(np.pi / (2 * n))
    omega = part * first
    result, positions = shaken(n, omega, (0.0, 1.0, 0.0), amplitude, 0.0, periods)
    t = result.times - result.times[0]
    force = 2.0 / n * np.sin(np.pi * (n - 1) / n) * tension / (segment * mass) * amplitude
    if part == 1.0:
        expected = force / (2.0 * omega**2) * (np.sin(omega * t) - omega * t * np.cos(omega * t))
    else:
        expected = force / (first**2 - omega**2) * (np.sin(omega * t) - part * np.sin(first * t))
    mode = np.sin(np.pi * np.arange(n + 1) / n)
    found = 2.0 / n * positions[:, 1:-1, 1] @ mode[1:-1]
    # path of the end as above; the first velocity input has no predecessor
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-3 * np.abs(expected).max())
    assert np.abs(result.residual).max() < 5e-3 * result.turnover  # trapezoidal rule, as above
