"""A wind that is given at each node: a segment meets the mean of the winds at its two nodes, whatever the profile says.

Of the lines of a system: as of a tether alone, part of the state, refused where it cannot be.
"""

import numpy as np
import pytest

from kernels.chain_problem import ChainProblem
from mechanics import air_velocities, drags
from tetherfmu import (
    Environment,
    Line,
    Point,
    Solver,
    StepRefused,
    Tether,
    TetherCatenary,
    TetherDynamic,
    TetherQuasiSteady,
    TetherSystem,
)
from tetherfmu.kernels.line.step_control import allowed_errors
from tetherfmu.runtime import layout as at

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


# --- of the lines of a system

N, STEP, LENGTH = 5, 0.02, 101.0
PLACE = (60.0, 0.0, 80.0)
TETHER = Tether(segments=N, initial_length=LENGTH)


def winds(k):
    """Wind at the nodes before step k [m/s]: it grows along the tether, and turns."""
    share = np.linspace(0.2, 1.0, N + 1)[:, None]
    return share * (10.0 * np.cos(0.1 * k), 10.0 * np.sin(0.1 * k), 0.5)


def system(wind_points=0):
    """Two driven points and a line between them, and beside it another one."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", PLACE), Point("other", (0.0, 60.0, 80.0))]
    lines = [Line("a", "ground", "kite", TETHER), Line("b", "ground", "other", TETHER)]
    air = Environment() if wind_points else Environment(wind_profile="power_law")
    return TetherSystem(points, lines, air, wind_points=wind_points)


def test_is_that_of_a_tether_alone():
    """Bit for bit; the other line feels none, and a wind at the reference height counts again when it comes."""
    both, alone = system(), TetherDynamic(TETHER, Environment(wind_profile="power_law"))
    still = TetherDynamic(TETHER, Environment(wind_profile="power_law"))
    found = both.initialize({"a": winds(0)})
    wanted = alone.initialize(PLACE, wind_velocity=winds(0))
    without = still.initialize((0.0, 60.0, 80.0))
    for k in range(20):
        np.testing.assert_array_equal(found.lines["a"].kite_force, wanted.kite_force)
        np.testing.assert_array_equal(found.lines["b"].kite_force, without.kite_force)
        found, wanted = both.step(STEP, wind_velocity={"a": winds(k)}), alone.step(STEP, wind_velocity=winds(k))
        without = still.step(STEP)
    assert np.linalg.norm(wanted.kite_force - without.kite_force) > 1.0
    found = both.step(STEP, wind_velocity=(8.0, 0.0, 0.0))
    wanted = alone.step(STEP, wind_velocity=(8.0, 0.0, 0.0))
    np.testing.assert_array_equal(found.lines["a"].kite_force, wanted.kite_force)


def test_is_part_of_the_state():
    """A state goes on with it, and one from before it without it."""
    both, other = system(), system()
    both.initialize()
    before = both.get_state()
    both.step(STEP, wind_velocity={"a": winds(3)})
    state = both.get_state()
    expected = both.step(STEP).lines["a"].kite_force
    other.set_state(state)
    np.testing.assert_array_equal(other.step(STEP).lines["a"].kite_force, expected)
    calm = system()
    calm.initialize()
    other.set_state(before)
    np.testing.assert_array_equal(other.step(STEP).lines["a"].kite_force, calm.step(STEP).lines["a"].kite_force)
    uniform = TetherSystem(both.points, both.lines, Environment())
    with pytest.raises(ValueError, match="another system"):
        uniform.set_state(before)


def test_what_cannot_be_is_refused_and_changes_nothing():
    both, twin = system(), system()
    for each in (both, twin):
        each.initialize({"a": winds(0)})
    with pytest.raises(ValueError, match=r"wind_velocity of a has the shape \(2, 3\); it must be \(6, 3\)"):
        both.step(STEP, wind_velocity={"b": winds(0), "a": np.zeros((2, 3))})
    with pytest.raises(ValueError, match="no wind_velocity of a line with the name 'c'"):
        both.step(STEP, wind_velocity={"c": winds(0)})
    with pytest.raises(ValueError, match="not finite"):
        both.step(STEP, wind_velocity={"a": np.full((N + 1, 3), np.nan)})
    with pytest.raises(ValueError, match="given at nodes; in a flight"):
        both.fly(3, STEP, wind_velocity={"a": winds(0)})
    with pytest.raises(StepRefused, match="step"):
        both.step(-1.0, wind_velocity={"a": winds(5)})
    np.testing.assert_array_equal(both.get_state(), twin.get_state())
    np.testing.assert_array_equal(both.step(STEP).lines["a"].kite_force, twin.step(STEP).lines["a"].kite_force)
    with pytest.raises(ValueError, match="with wind points; give wind_at"):
        system(wind_points=4).initialize({"a": winds(0)})


def over_sheave(wind_points, solver=None):
    """A rope over a heavy pulley between two driven points."""
    points = [Point("a", (-8.0, 0.0, 0.0)), Point("pulley", mass=60.0), Point("b", (8.0, 0.0, 1.0))]
    tether = Tether(segments=4, initial_length=24.0, diameter=0.02, axial_stiffness=1e5, axial_damping=500.0)
    lines = [Line("rope", "a", "b", tether, through=["pulley"], initial_portions=[12.0, 12.0])]
    return TetherSystem(points, lines, solver=solver or Solver(), wind_points=wind_points)


@pytest.mark.parametrize("fixed_step", [0.0, 0.005])
def test_wind_points_of_a_line_over_sheaves(fixed_step):
    """Equal winds at all points are a uniform wind, bit for bit; wind on one portion only pushes that one."""
    solver, wind = Solver(fixed_step=fixed_step), np.array((0.0, 9.0, 0.0))
    uniform, given, one_side = over_sheave(0, solver), over_sheave(3, solver), over_sheave(3, solver)
    uniform.initialize(wind)
    given.initialize(wind_at={"rope": np.tile(wind, (6, 1))})
    half = np.vstack([np.zeros((3, 3)), np.tile(wind, (3, 1))])
    one_side.initialize(wind_at={"rope": half})
    for k in range(20):
        more = 1.0 + 0.05 * k
        expected = uniform.step(STEP, wind_velocity=more * wind)
        found = given.step(STEP, wind_at={"rope": np.tile(more * wind, (6, 1))})
        np.testing.assert_array_equal(found.lines["rope"].shape, expected.lines["rope"].shape)
        assert found.portions["rope"].payout == expected.portions["rope"].payout
        half[3:] = more * wind
        pushed = one_side.step(STEP, wind_at={"rope": half})
    straight = 0.5 * (pushed.lines["rope"].shape[0] + pushed.lines["rope"].shape[4])
    assert abs(pushed.lines["rope"].shape[2, 1] - straight[1]) < 0.2 * pushed.lines["rope"].shape[6, 1]
    with pytest.raises(ValueError, match=r"rope\.wind_at has the shape \(3, 3\)"):
        given.step(STEP, wind_at={"rope": np.zeros((3, 3))})
