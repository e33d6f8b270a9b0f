"""A wind that is given at each node: a segment meets the mean of the winds at its two nodes, whatever the profile says."""

import numpy as np
import pytest

from kernels.chain_problem import ChainProblem
from mechanics import air_velocities, drags, wind_factor
from tetherfmu import StepRefused, TetherCatenary, TetherDynamic, TetherQuasiSteady
from tetherfmu.kernels.line.step_control import allowed_errors
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Environment, Solver, Tether

GROUND, KITE = np.array([0.0, 0.0, 60.0]), np.array([240.0, 50.0, 380.0])
CHORD = np.linalg.norm(KITE - GROUND)
WIND = (9.0, -4.0, 1.0)
WITH_NODES = pytest.mark.parametrize("kind", [TetherDynamic, TetherQuasiSteady])


def tether_of(n):
    return Tether(segments=n, initial_length=1.02 * CHORD)


def gusts(n, seed=1):
    """Another wind at each node (n + 1, 3) [m/s]."""
    return np.array([12.0, 0.0, 0.0]) + 5.0 * np.random.default_rng(seed).normal(size=(n + 1, 3))


def at_rest(model, wind):
    """Outputs at the start between the ends at rest."""
    return model.initialize(KITE, ground_position=GROUND, wind_velocity=wind)


def flown(model, wind):
    """All states and energies of a kite that speeds up while the tether reels out."""
    model.initialize(KITE, (0.0, 12.0, 0.0), GROUND, reel_out_speed=1.0, wind_velocity=wind)
    rows = []
    for k in range(50):
        time = 0.02 * k
        position = KITE + np.array([0.0, 12.0 * time + 5.0 * time**2, 0.0])
        model.step(0.02, position, (0.0, 12.0 + 10.0 * time, 0.0), GROUND, reel_out_speed=1.0, wind_velocity=wind)
        now = model.energy()
        rows.append(np.concatenate([model.positions.ravel(), model.velocities.ravel(), [now.wind_power, now.drag_loss]]))
    return np.array(rows)


@pytest.mark.parametrize("scale_height", [0.0, 8550.0])
@pytest.mark.parametrize(
    ("kind", "solver"),
    [
        (TetherDynamic, Solver(initial_shape=2)),
        (TetherDynamic, Solver(initial_shape=2, fixed_step=0.005)),
        (TetherQuasiSteady, Solver()),
    ],
    ids=["adaptive", "fixed_step", "quasi_steady"],
)
def test_the_same_wind_at_all_nodes_is_the_uniform_wind(kind, solver, scale_height):
    n, air = 9, Environment(air_density_scale_height=scale_height)
    expected = flown(kind(tether_of(n), air, solver), WIND)
    model = kind(tether_of(n), air, solver)
    rounding = 1e-12  # of each number and of the largest one
    atol = rounding * np.abs(expected).max()
    np.testing.assert_allclose(flown(model, np.tile(WIND, (n + 1, 1))), expected, rtol=rounding, atol=atol)
    np.testing.assert_array_equal(flown(model, WIND), expected)


@WITH_NODES
def test_a_profile_sampled_at_the_nodes_is_the_profile_to_second_order(kind):
    """The mean of f at two nodes differs from f between them by f'' (dz)^2/8, so the forces by 1/n^2."""
    air = Environment(wind_profile=2, wind_exponent=0.3)
    difference = []
    for n in (10, 20, 40, 80):
        model = kind(tether_of(n), air)
        expected = at_rest(model, WIND)
        winds = wind_factor(model.positions[:, 2], air)[:, None] * np.array(WIND)
        difference.append(np.linalg.norm(at_rest(model, winds).kite_force - expected.kite_force))
    # 1 N at n = 10 down to 1e-2 N; the equilibrium is found to 1e-8 N
    np.testing.assert_allclose(-np.diff(np.log2(difference)), 2.0, atol=0.1)


@pytest.mark.parametrize("solver", [Solver(), Solver(fixed_step=0.01)], ids=["adaptive", "fixed_step"])
def test_dynamic_and_quasi_steady_tether_agree_at_rest(solver):
    """They start with the same forces, and the dynamic one stays there."""
    n, winds = 12, gusts(12)
    expected = at_rest(TetherQuasiSteady(tether_of(n)), winds)
    model = TetherDynamic(tether_of(n), solver=solver)
    start = at_rest(model, winds)
    np.testing.assert_allclose(start.kite_force, expected.kite_force, rtol=1e-12, atol=1e-7)  # see `test_balance.py`
    for _ in range(50):
        later = model.step(0.02)
    # what the residual of 1e-7 N may do within a second to nodes of 0.3 kg
    np.testing.assert_allclose(later.shape, expected.shape, atol=1e-6)
    np.testing.assert_allclose(later.kite_force, expected.kite_force, atol=1e-4)


def test_powers_of_the_wind_are_those_of_the_formula():
    """wind_power = sum 2 F . air, drag_loss = sum 2 F . (air - (v_p + v_q)/2)."""
    tether, air, winds = tether_of(8), Environment(air_density_scale_height=8550.0), gusts(8)
    model = TetherDynamic(tether, air, Solver(initial_shape=3))
    model.initialize(KITE, (5.0, 20.0, -3.0), GROUND, (1.0, 0.0, 0.0), wind_velocity=winds)
    x, v = model.positions, model.velocities
    force, air_velocity = drags(x, v, winds, tether, air), air_velocities(x, winds, air)
    now = model.energy()
    assert now.wind_power == pytest.approx(np.sum(force * air_velocity), rel=1e-12)  # rounding
    assert now.drag_loss == pytest.approx(np.sum(force * (air_velocity - 0.5 * (v[1:] + v[:-1]))), rel=1e-12)


def test_the_largest_wind_at_a_node_is_the_scale_of_the_allowed_errors():
    problem = ChainProblem(wind_profile=at.AT_NODES)
    place = at.node_winds_at(problem.n)
    winds = np.zeros((3, problem.n + 1))
    winds[:, 3] = 30.0, -40.0, 120.0
    problem.parameters[place : place + winds.size] = winds.ravel()
    for frame in (0.0, 200.0):  # a motion of all of it changes nothing
        problem.parameters[place : place + winds.size] = (winds + frame).ravel()
        _, velocity = allowed_errors(problem.conditions, np.full_like(problem.v, frame))
        assert velocity == pytest.approx(1e-6 * 130.0, rel=1e-5)  # 1e-12 m/s is added


@pytest.mark.parametrize(
    ("kind", "winds", "said"),
    [
        (TetherDynamic, np.zeros((4, 3)), r"\(5, 3\)"),
        (TetherDynamic, np.full((5, 3), np.nan), "finite"),
        (TetherCatenary, np.zeros((2, 3)), r"\(2, 3\); it must be \(3,\)$"),
    ],
    ids=["shape", "finite", "no_nodes"],
)
def test_winds_that_cannot_be(kind, winds, said):
    with pytest.raises(ValueError, match=said):
        kind(tether_of(4)).initialize(wind_velocity=winds)


@WITH_NODES
def test_winds_at_nodes_stay_like_any_input(kind):
    """Until a wind is given again; a refused step keeps those of before."""
    kept, given = kind(tether_of(4)), kind(tether_of(4))
    for tether in (kept, given):
        at_rest(tether, gusts(4))
    with pytest.raises(StepRefused):
        kept.step(0.02, reel_out_speed=-1e6, wind_velocity=gusts(4, seed=2))
    expected = given.step(0.02, wind_velocity=gusts(4))
    np.testing.assert_array_equal(kept.step(0.02).shape, expected.shape)
    for tether in (kept, given):
        back = tether.step(0.02, wind_velocity=WIND)
    np.testing.assert_array_equal(back.kite_force, kept.outputs().kite_force)
