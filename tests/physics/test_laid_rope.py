"""A vehicle lays rope on the ground as fast as it drives: the rope rests there, so that friction does nothing.

scipy's Radau solves the same chain, written here once more, with Coulomb friction on v_i + c_i r/l0. Without c_i, the nodes,
which follow the vehicle, would be dragged: half of the friction coefficient times the weight.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from audited import run
from tetherfmu import Ground, Solver, Tether, TetherDynamic, Winch

LENGTH, DURATION, HEIGHT, SPAN = 20.0, 4.0, 0.05, 19.99
EA, DAMPING, DENSITY, FRICTION, SINK, CREEP, G = 2e4, 200.0, 724.0 * np.pi / 4.0 * 0.01**2, 0.5, 0.002, 2e-4, 9.81
ROPE = {"initial_length": LENGTH, "diameter": 0.01, "axial_stiffness": EA, "axial_damping": DAMPING}
SLACK = {"drag_coefficient": 0.0, "slack_stiffness_ratio": 0.0, "slack_damping_ratio": 0.0}


def way(time):
    """Way [m], speed [m/s] and acceleration [m/s2] of the vehicle, which has 1 m/s after 1 s."""
    if time >= 1.0:
        return time - 0.5, 1.0, 0.0
    return (
        0.5 * (time - np.sin(np.pi * time) / np.pi),
        0.5 * (1.0 - np.cos(np.pi * time)),
        0.5 * np.pi * np.sin(np.pi * time),
    )


def inputs(time):
    passed, speed, _ = way(time)
    ends = {"ground_position": (-passed, 0.0, HEIGHT), "kite_position": (SPAN, 0.0, -0.001)}
    return ends | {"ground_velocity": (-speed, 0.0, 0.0), "kite_velocity": (0.0, 0.0, 0.0)}


def laid(solver, segments, **winch):
    ground = Ground(ground_contact="flat", ground_friction=FRICTION, ground_sink=SINK)
    return TetherDynamic(Tether(segments=segments, **ROPE, **SLACK), ground=ground, solver=solver, **winch)


def rates(time, y):
    """Rates of the inner nodes: x, z, v_x, v_z of each."""
    return _rates_and_pull(time, y)[0]


def _rates_and_pull(time, y):
    n, (passed, speed, gain) = len(y) // 4 + 1, way(time)
    x, v = np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    x[0], x[n], v[0] = (-passed, HEIGHT), (SPAN, -0.001), (-speed, 0.0)
    x[1:n], v[1:n] = y.reshape(2, n - 1, 2)
    rest, growth = (LENGTH + passed) / n, speed / (LENGTH + passed)
    past = (1.0 - np.arange(n + 1) / n)[:, None]  # c_i over L'
    r, u = np.diff(x, axis=0), np.diff(v, axis=0)
    length = np.linalg.norm(r, axis=1)[:, None]
    rate = (r * u).sum(axis=1)[:, None] / length
    tension = np.where(length > rest, EA * (length / rest - 1.0) + DAMPING * (rate - growth * length) / rest, 0.0)
    pull, c, squares = tension * r / length, past * speed, (past[:-1] ** 2 + past[1:] ** 2) * speed**2 / rest
    both = 0.5 * DENSITY * (c[:-1] + c[1:]) * u
    force = np.zeros((n + 1, 2))
    force[:-1] += pull - both - 0.5 * DENSITY * (past[:-1] * gain + squares) * r
    force[1:] += -pull - both - 0.5 * DENSITY * (past[1:] * gain - squares) * r
    mass = DENSITY * rest
    force[:, 1] -= mass * G
    normal = mass * G / SINK * np.maximum(-x[1:n, 1], 0.0) * np.maximum(1.0 - 2.0 * v[1:n, 1] / np.sqrt(G * SINK), 0.0)
    slide = v[1:n, 0] + c[1:n, 0] * (x[2:, 0] - x[:-2, 0]) / (2.0 * rest)
    force[1:n, 1] += normal
    force[1:n, 0] -= FRICTION * normal * slide / np.hypot(slide, CREEP)
    return np.concatenate((v[1:n].ravel(), force[1:n].ravel() / mass)), pull[0] - both[0] + 0.5 * DENSITY * r[0] * (
        growth * (c[0] + c[1]) - gain
    )


@pytest.fixture(scope="module", params=[6, 60])
def expected(request):
    """Segments; horizontal force of the rope on the vehicle [N], and positions of the inner nodes [m], at the end."""
    n = request.param
    tether = laid(Solver(), n)
    tether.initialize(**inputs(0.0), reel_out_speed=0.0)
    start = np.concatenate((tether.positions[1:n, [0, 2]].ravel(), np.zeros(2 * (n - 1))))
    node = np.arange(len(start)) // 2 % (n - 1)
    near = np.abs(node[:, None] - node) < 2
    found = solve_ivp(rates, (0.0, DURATION), start, "Radau", rtol=1e-7, atol=1e-8, max_step=0.02, jac_sparsity=near)
    _, pull = _rates_and_pull(DURATION, found.y[:, -1])
    return n, pull[0], found.y[: 2 * (n - 1), -1].reshape(-1, 2)


@pytest.mark.parametrize("solver", [(0.0, 1), (0.005, 1), (0.0025, 2)])
def test_laid_rope_rests(solver, expected):
    n, force, positions = expected
    winch = Winch(winch_control="length")
    tether = laid(Solver(fixed_step=solver[0], fixed_step_method=solver[1]), n, winch=winch)
    tether.initialize(**inputs(0.0), winch_length=LENGTH)
    for k in range(round(DURATION / 0.02)):
        outputs = tether.step(0.02, **inputs(0.02 * k), winch_length=LENGTH + way(0.02 * k)[0])
    assert outputs.ground_force[0] == pytest.approx(force, abs=0.02)
    np.testing.assert_allclose(tether.positions[1:n, [0, 2]], positions, atol=1e-3)
    assert tether.energy().sliding_loss < 1e-2  # [W]; dragged nodes lose 2 to 3


@pytest.mark.parametrize("winch", [{"winch_control": "speed"}, {"winch_control": "force", "winch_mass": 2.0}])
@pytest.mark.parametrize("fixed", [0.0, 0.002])
def test_energy_of_rope_that_slides(winch, fixed):
    """A person walks away with the rope, which the winch pays out at the same speed, or under 8 N."""
    tether = laid(Solver(fixed_step=fixed, relative_tolerance=1e-6), segments=12, winch=Winch(**winch))

    def at(time):
        passed, speed, _ = way(time + 0.005)
        ends = {"ground_position": (0.0, 0.0, HEIGHT), "kite_position": (SPAN + passed, 0.0, HEIGHT)}
        ends |= {"kite_velocity": (speed, 0.0, 0.0)}
        return ends | ({"winch_force": 8.0} if "winch_mass" in winch else {"reel_out_speed": speed})

    tether.initialize(**at(-0.005))
    found = run(tether, at, 0.005, 600)
    lying = found.outputs[-1].grounded_length
    assert found.energies[-1].sliding_loss == pytest.approx(FRICTION * DENSITY * G * lying * 1.0, rel=0.1)
    assert np.abs(found.residual).max() < 0.005 * found.turnover
