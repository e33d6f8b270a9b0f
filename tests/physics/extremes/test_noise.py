"""White noise on the kite's inputs, 1 mm and 1 cm/s at 20 ms, makes white noise in the forces, of a size that follows
from linear theory: along a taut line, nodes of mass m on springs k and dampers c, m du_i/dt^2 = k (u_(i-1) - 2 u_i +
u_(i+1)) + c (...)'. The end moves along the cubic of docs/models/theory.md, "Driven ends", over which the linear system is
solved exactly, by a matrix exponential.

The straight line has no waves: its noise is EA/L times that of the end's target p + v h + a h^2/2, a = (v - v_last)/h,

    sigma_T = EA/L sqrt(sigma_p^2 + (1.5^2 + 0.5^2) sigma_v^2 h^2)

and the quasi-steady tether and the catenary have less, because their sag gives way.
"""

import numpy as np
import pytest
from scipy.linalg import expm

from mechanics import line_density
from tetherfmu import Solver, Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight

STEP, POSITION_NOISE, VELOCITY_NOISE = 0.02, 1e-3, 1e-2
LENGTH, STRAIN = 500.0, 5e-4
ALONG = np.array([0.6, 0.0, 0.8])
TETHER = Tether(initial_length=LENGTH)


def noise(count):
    random = np.random.default_rng(1)
    return POSITION_NOISE * random.normal(size=(count, 3)), VELOCITY_NOISE * random.normal(size=(count, 3))


def force_noise(count, variant=TetherDynamic, solver=Solver()):  # noqa: B008 (a constant record)
    """Change of the forces on kite and ground along the line [N] at every step, array (count, 2); and the model."""
    model = variant(TETHER, solver=solver)
    kite = LENGTH * (1.0 + STRAIN) * ALONG
    start = model.initialize(kite)
    result = np.empty((count, 2))
    for k, (position, velocity) in enumerate(zip(*noise(count), strict=True)):
        out = model.step(STEP, kite + position, velocity)
        result[k] = (out.kite_force - start.kite_force) @ ALONG, (out.ground_force - start.ground_force) @ ALONG
    return result, model


def end_states(count):
    """Position and velocity [m, m/s] of the kite end along the line, and c2, c3 of its cubic in each step."""
    position, velocity = (values @ ALONG for values in noise(count))
    x0 = v0 = last = 0.0
    rows = []
    for k in range(count):
        a = (velocity[k] - last) / STEP if k else 0.0
        x1, v1 = position[k] + velocity[k] * STEP + 0.5 * a * STEP**2, velocity[k] + a * STEP
        s = (x1 - x0) / STEP
        rows.append((x0, v0, (3.0 * s - 2.0 * v0 - v1) / STEP, (v0 + v1 - 2.0 * s) / STEP**2, x1, v1))
        x0, v0, last = x1, v1, velocity[k]
    return np.array(rows)


def linear_noise(count):
    """The forces of `force_noise` by the linear theory of the axial motion."""
    n = TETHER.segments
    mass, k, c = line_density(TETHER) * LENGTH / n, TETHER.axial_stiffness * n / LENGTH, TETHER.axial_damping * n / LENGTH
    coupling = np.eye(n - 1, k=1) + np.eye(n - 1, k=-1) - 2.0 * np.eye(n - 1)
    free = 2 * (n - 1)
    system = np.zeros((free + 4, free + 4))  # displacements, velocities; then the cubic x, x', x'', x''' of the end
    system[: n - 1, n - 1 : free] = np.eye(n - 1)
    system[n - 1 : free, : n - 1] = k / mass * coupling
    system[n - 1 : free, n - 1 : free] = c / mass * coupling
    system[free - 1, free], system[free - 1, free + 1] = k / mass, c / mass
    system[free:, free:] = np.eye(4, k=1)
    advance = expm(system * STEP)
    state, result = np.zeros(free + 4), []
    for x0, v0, c2, c3, x1, v1 in end_states(count):
        state[free:] = x0, v0, 2.0 * c2, 6.0 * c3
        state = advance @ state
        kite = k * (x1 - state[n - 2]) + c * (v1 - state[free - 1])
        result.append((-kite, k * state[0] + c * state[n - 1]))
    return np.array(result)


@pytest.mark.parametrize(("tolerance", "allowed"), [(0.0, 0.03), (1e-6, 0.01)])
def test_noise_of_the_dynamic_tether_is_that_of_linear_theory(tolerance, allowed):
    count = 3000
    found, _ = force_noise(count, solver=Solver(relative_tolerance=tolerance))
    expected = linear_noise(count)
    # 1e-4 of a segment of 25 m is more than the noise itself, yet the solver makes 2 % of it; sag is left out: 0.1 %
    np.testing.assert_allclose(found.std(axis=0), expected.std(axis=0), rtol=allowed)
    assert np.all((found - expected).std(axis=0) < 0.1 * expected.std(axis=0))  # the same noise, not only as much
    np.testing.assert_allclose(expected.std(axis=0), 10.0, rtol=0.05)  # the floor of this tether [N]


def test_no_drift_in_ten_minutes():
    """An hour of it: `python tests/benchmarks/extremes.py --long`."""
    found, model = force_noise(30000)
    parts = found.reshape(10, -1, 2)
    # a standard deviation from 3000 correlated samples scatters by 5 %; the first mode rings through some 10 of them
    np.testing.assert_allclose(parts.std(axis=1), found.std(axis=0) + np.zeros((10, 2)), rtol=0.2)
    np.testing.assert_allclose(parts.mean(axis=1), 0.0, atol=0.1)
    assert np.abs(found).max() < 6.0 * found.std()
    assert model.counters["rejections"] < 10


@pytest.mark.parametrize("fixed_step", [0.02, 0.005])
def test_fixed_step_makes_less_of_it(fixed_step):
    found, _ = force_noise(10000, solver=Solver(fixed_step=fixed_step, fixed_step_method="backward_euler"))
    assert np.all(found.std(axis=0) < 5.5)  # Euler's method damps the waves
    assert np.abs(found).max() < 25.0


def test_tethers_without_waves():
    noise_of_target = np.hypot(POSITION_NOISE, np.sqrt(2.5) * VELOCITY_NOISE * STEP)
    rigid = TETHER.axial_stiffness / LENGTH * noise_of_target
    found = {
        variant: force_noise(10000, variant=variant)[0].std(axis=0)
        for variant in (TetherStraight, TetherCatenary, TetherQuasiSteady)
    }
    np.testing.assert_allclose(found[TetherStraight], rigid, rtol=0.03)  # 10000 samples: 0.7 %
    np.testing.assert_allclose(found[TetherQuasiSteady], found[TetherCatenary], rtol=0.01)
    assert np.all(found[TetherCatenary] < rigid)
