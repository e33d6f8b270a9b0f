"""Wind that is given at points of equal unstretched length, linear in between: node winds and loads are those of it."""

from dataclasses import replace

import numpy as np
import pytest

from mechanics import loads_on_chord, wind_factor
from tetherfmu import (
    Environment,
    Line,
    Point,
    Solver,
    StepRefused,
    Tether,
    TetherCatenary,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
    TetherStraight,
    TetherSystem,
)
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name

GROUND, KITE = np.array([0.0, 0.0, 60.0]), np.array([240.0, 50.0, 380.0])
LENGTH = 1.02 * np.linalg.norm(KITE - GROUND)
WIND = (9.0, -4.0, 1.0)
STEP, STEPS = 0.02, 30
CHAINS, LINES = (TetherDynamic, TetherQuasiSteady), (TetherCatenary, TetherStraight)
OF_EACH = (*CHAINS, TetherDynamicFree, *LINES)
EVERY_KIND = pytest.mark.parametrize("kind", OF_EACH)


def gusts(count, seed=1):
    """Another wind at each point (count, 3) [m/s]."""
    return np.array([12.0, 0.0, 0.0]) + 5.0 * np.random.default_rng(seed).normal(size=(count, 3))


def at_rest(model, **wind):
    return model.initialize(KITE, ground_position=GROUND, **wind)


def flown(model, wind, speed=12.0):
    """Numbers of all outputs after each step of a flight across the wind while the tether reels out."""
    model.initialize(KITE, (0.0, speed, 0.0), GROUND, reel_out_speed=1.0, **wind)
    rows = []
    for k in range(STEPS):
        kite = (
            {} if isinstance(model, TetherDynamicFree) else {"kite_position": KITE + np.array((0.0, speed * STEP * k, 0.0))}
        )
        rows.append(np.concatenate([np.ravel(each) for each in model.step(STEP, **kite, **wind)]))
    return np.array(rows)


@pytest.mark.parametrize("points", [2, 7])
@EVERY_KIND
def test_the_same_wind_at_all_points_is_the_uniform_wind(kind, points):
    """To the last bit; of a line with more than two points the quadrature is another one: of a straight one the same for one
    cross-wind, at rest, but for rounding; of a catenary with more than five it has the error of its own rule, found: 2e-6.
    """
    speed = 0.0 if kind in LINES and points > 2 else 12.0
    expected = flown(kind(initial_length=LENGTH, segments=9), {"wind_velocity": WIND}, speed)
    model = kind(initial_length=LENGTH, segments=9, wind_points=points)
    found = flown(model, {"wind_at": np.tile(WIND, (points, 1))}, speed)
    rounding = 1e-12 if kind is TetherStraight and points > 2 else 0.0  # of each number and of the largest one
    rounding = 1e-5 if kind is TetherCatenary and points > 5 else rounding
    np.testing.assert_allclose(found, expected, rtol=rounding, atol=rounding * np.abs(expected).max())


@EVERY_KIND
def test_points_of_the_power_law_are_the_power_law_to_second_order(kind):
    """Linear interpolation is wrong by f'' (dz)^2/8, so the forces by 1/(K - 1)^2; the chain has 200 segments, whose own
    1/n^2 is 1/150 of that with 17 points. The straight line has the air of its chord.
    """
    air = Environment(wind_profile=2, wind_exponent=0.3)
    tether = Tether(segments=200, initial_length=LENGTH)
    difference = []
    for points in (3, 5, 9, 17):
        by_law = at_rest(kind(tether, air, shape_points=points), wind_velocity=WIND)
        heights = np.linspace(GROUND, KITE, points)[:, 2] if kind is TetherStraight else by_law.shape[:, 2]
        winds = wind_factor(heights, air)[:, None] * np.array(WIND)
        found = at_rest(kind(tether, wind_points=points), wind_at=winds)
        difference.append(np.linalg.norm(found.kite_force - by_law.kite_force))
        largest = np.linalg.norm(by_law.kite_force)
    # observed: 1.6 to 2.5 % of the force with 3 points; orders from 1.94 to 2.17, which the first halving has
    assert difference[0] < 0.03 * largest
    if kind is TetherCatenary:  # beyond, the difference is that of its quadratures
        assert difference.pop() < 1e-3 * largest
    np.testing.assert_allclose(-np.diff(np.log2(difference)), 2.0, atol=0.2)


@pytest.mark.parametrize("points", [2, 5, 11, 33])
def test_winds_at_the_nodes_are_interpolated(points):
    """Between the points by the unstretched length, of unequal segments too."""
    tethers = [Tether(segments=3, initial_length=100.0), Tether(segments=7, initial_length=LENGTH - 100.0)]
    model, winds = TetherDynamic(tethers, wind_points=points), gusts(points)
    at_rest(model, wind_at=winds)
    arcs = np.concatenate([np.linspace(0.0, 100.0, 4), np.linspace(100.0, LENGTH, 8)[1:]]) / LENGTH
    expected = np.stack([np.interp(arcs, np.linspace(0.0, 1.0, points), each) for each in winds.T])
    first = at.node_winds_at(model.segments)
    found = model._parameters[first : first + 3 * (model.segments + 1)].reshape(3, -1)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)  # rounding of some 20 m/s and of the arcs


@pytest.mark.parametrize("fixed_step", [0.0, 0.005])
@pytest.mark.parametrize("kind", CHAINS)
def test_flight_with_points_is_that_with_the_winds_at_the_nodes(kind, fixed_step):
    n, winds, more = 10, gusts(6), {"fixed_step": fixed_step} if kind is TetherDynamic else {}
    nodes = np.stack([np.interp(np.linspace(0.0, 5.0, n + 1), np.arange(6), each) for each in winds.T], axis=1)
    expected = flown(kind(initial_length=LENGTH, segments=n, **more), {"wind_velocity": nodes})
    found = flown(kind(initial_length=LENGTH, segments=n, wind_points=6, **more), {"wind_at": winds})
    # rounding of the node winds, 1e-15, as the solvers pass it on: observed 4e-11 of the largest number
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def load_error(winds, velocity, scale_height, times=1):
    """Error of the loads on a straight tether, over the loads, if the same wind is given at so many times the points."""
    tether, knots = Tether(initial_length=LENGTH), np.linspace(0.0, 1.0, len(winds))

    def wind_at(xi):
        return np.stack([np.interp(xi, knots, each) for each in winds.T], axis=-1)

    same = wind_at(np.linspace(0.0, 1.0, times * (len(winds) - 1) + 1))
    still = TetherStraight(tether, Environment(air_density=0.0)).initialize(KITE, ground_position=GROUND)
    air = Environment(air_density_scale_height=scale_height)
    found = TetherStraight(tether, air, wind_points=len(same)).initialize(KITE, velocity, GROUND, wind_at=same)
    mean, moment, _ = loads_on_chord(GROUND, KITE, velocity, wind_at, knots, tether, scale_height)
    expected = np.linalg.norm(KITE - GROUND) * np.array([mean - moment, moment])
    loads = found.ground_force - still.ground_force, found.kite_force - still.kite_force
    return np.linalg.norm(loads - expected) / np.linalg.norm(expected)


@pytest.mark.parametrize("points", [6, 7])
def test_load_of_one_cross_wind_on_a_straight_tether(points):
    """Its parts 1 - xi and xi of the drag per length at xi: Simpson's rule is exact for it, a polynomial of third degree."""
    winds = np.outer(np.random.default_rng(1).uniform(3.0, 15.0, points), WIND)
    assert load_error(winds, np.zeros(3), 0.0) < 1e-12


@pytest.mark.parametrize(
    ("velocity", "points", "scale_height"),
    [(np.zeros(3), 6, 8550.0), (np.array([-3.0, 20.0, 1.0]), 6, 8550.0), (np.array([-3.0, 20.0, 1.0]), 7, 0.0)],
    ids=["at_rest", "moving", "even_number_of_pieces"],
)
def test_load_of_gusts_on_a_straight_tether(velocity, points, scale_height):
    """Where the cross-wind turns within a piece, the error is of fourth order in its width."""
    errors = [load_error(gusts(points), velocity, scale_height, times) for times in (1, 2, 4, 8)]
    assert errors[0] < 1e-3  # observed 3e-4 at most, in gusts of 5 m/s
    np.testing.assert_allclose(np.log2(np.divide(errors[1:-1], errors[2:])), 4.0, atol=0.3)


@pytest.mark.parametrize("kind", CHAINS)
def test_no_wind_at_the_points_leaves_no_strut(kind):
    """A slack tether along its load hangs, as with wind_velocity 0."""
    expected = kind(initial_length=60.0, segments=6).initialize((0.0, 0.0, 50.0))
    found = kind(initial_length=60.0, segments=6, wind_points=3).initialize((0.0, 0.0, 50.0))
    np.testing.assert_allclose(found.kite_force, expected.kite_force, rtol=0.0, atol=1e-9)


def test_soft_tether_in_a_storm():
    """Load continuation scales the wind at the nodes, too: drag stretches a soft tether to several times its length."""
    soft, storm = {"axial_stiffness": 800.0, "initial_length": 400.0}, (120.0, 40.0, 0.0)
    expected = TetherQuasiSteady(**soft).initialize((300.0, 0.0, 300.0), wind_velocity=storm)
    found = TetherQuasiSteady(**soft, wind_points=4).initialize((300.0, 0.0, 300.0), wind_at=np.tile(storm, (4, 1)))
    np.testing.assert_allclose(found.kite_force, expected.kite_force, rtol=1e-9)  # what the iteration leaves


def rows_of_flight(count):
    rows = np.zeros((count, at.INPUTS))
    columns = by_name(rows)
    columns["kite_position"][:] = KITE + np.outer(STEP * np.arange(count), (0.0, 12.0, 0.0))
    columns["kite_velocity"][:] = (0.0, 12.0, 0.0)
    columns["ground_position"][:] = GROUND
    return rows


@pytest.mark.parametrize("kind", [*CHAINS, *LINES])
def test_flight_in_rows_saved_and_continued(kind):
    """`fly` is a loop of `step`; a state goes on bit for bit, in a copy and in another tether; a refused step leaves all."""
    rows, winds = rows_of_flight(20), np.stack([gusts(4, seed) for seed in range(20)])
    one, other = (kind(initial_length=LENGTH, segments=8, wind_points=4) for _ in range(2))
    for each in (one, other):
        each.initialize(KITE, (0.0, 12.0, 0.0), GROUND, wind_at=winds[0])
    expected = one.fly(rows, STEP, wind_at=winds)
    for k in range(10):
        other.step(STEP, rows[k, :3], wind_at=winds[k])
    state, outputs = other.get_state(), other.outputs()
    with pytest.raises(StepRefused):
        other.step(STEP, reel_out_speed=-1e9, wind_at=winds[11])
    np.testing.assert_array_equal(other.outputs().kite_force, outputs.kite_force)
    third = kind(initial_length=LENGTH, segments=8, wind_points=4)
    third.set_state(state)
    np.testing.assert_array_equal(third.outputs().kite_force, outputs.kite_force)
    for each in (other, third):
        flown = each.fly(rows[10:], STEP, wind_at=winds[10:])
        np.testing.assert_array_equal(flown.outputs, expected.outputs[10:])
    held = third.fly(rows[19:], STEP)  # without a wind that of before
    np.testing.assert_array_equal(held.outputs, other.fly(rows[19:], STEP, wind_at=winds[19:]).outputs)


@pytest.mark.parametrize("solver", [Solver(), Solver(fixed_step=0.01)], ids=["adaptive", "fixed_step"])
def test_energy_account_has_the_wind_of_the_state(solver):
    """wind_power is that of a tether with the same winds at its nodes."""
    n, winds = 6, gusts(7)
    by_nodes, by_points = (TetherDynamic(Tether(segments=n, initial_length=LENGTH), solver=solver, **more)
                           for more in ({}, {"wind_points": 7}))  # fmt: skip
    flown(by_nodes, {"wind_velocity": winds})
    flown(by_points, {"wind_at": winds})
    assert by_points.energy().wind_power == pytest.approx(by_nodes.energy().wind_power, rel=1e-9)


@pytest.mark.parametrize(
    ("wind_points", "given", "said"),
    [
        (0, {"wind_at": np.zeros((3, 3))}, "wind_points=11"),
        (3, {"wind_at": np.zeros((4, 3))}, r"wind_at has the shape \(4, 3\); it must be \(3, 3\)"),
        (3, {"wind_at": np.full((3, 3), np.inf)}, "wind_at has a number that is not finite"),
        (3, {"wind_velocity": WIND}, "give wind_at"),
    ],
)
def test_winds_that_cannot_be(wind_points, given, said):
    with pytest.raises(ValueError, match=said):
        TetherStraight(wind_points=wind_points).initialize(**given)


@pytest.mark.parametrize("wind_points", [1, -2, 1002, 2.5])
def test_numbers_of_points_that_cannot_be(wind_points):
    with pytest.raises(ValueError, match="wind_points is"):
        TetherStraight(wind_points=wind_points)


def test_a_profile_beside_points_has_no_effect_and_is_refused():
    with pytest.raises(ValueError, match="wind_profile is 2 and has no effect with wind_points; it must be 1"):
        TetherStraight(wind_profile="power_law", wind_points=3)
    points = [Point("low", (0.0, 0.0, 0.0)), Point("high", (0.0, 0.0, 50.0))]
    with pytest.raises(ValueError, match="wind_profile is 3 and has no effect"):
        TetherSystem(points, [Line("a", "low", "high")], Environment(wind_profile="logarithmic"), wind_points=3)


@pytest.mark.parametrize("solver", [Solver(), Solver(fixed_step=0.01)], ids=["adaptive", "fixed steps"])
def test_lines_of_a_system_have_wind_points_of_their_own(solver):
    """Between driven points each moves as the dynamic tether does: the same arithmetic, nodes and forces equal."""
    solver, tether = replace(solver, initial_shape="static_equilibrium"), Tether(initial_length=LENGTH, segments=9)
    winds = {name: gusts(5, seed=seed) for seed, name in enumerate("ab")}
    points = [Point("ground", GROUND), Point("kite", KITE)]
    lines = [Line(name, "ground", "kite", tether) for name in winds]
    system = TetherSystem(points, lines, solver=solver, wind_points=5)
    alone = {name: TetherDynamic(tether, solver=solver, wind_points=5) for name in winds}
    system.initialize(wind_at=winds)
    for name, model in alone.items():
        model.initialize(KITE, ground_position=GROUND, wind_at=winds[name])
    drift = np.array((0.0, 5.0, 0.0))
    for k in range(STEPS):
        kite, winds = KITE + STEP * k * drift, {name: gusts(5, seed=10 + k) for name in winds if name == "b" or k < 5}
        found = system.step(STEP, {"kite": kite}, {"kite": drift}, wind_at=winds)
        for name, model in alone.items():
            expected = model.step(STEP, kite, drift, wind_at=winds.get(name))
            if solver.fixed_step:
                np.testing.assert_array_equal(system.positions[name], model.positions)
                np.testing.assert_array_equal(found.lines[name].kite_force, expected.kite_force)
            np.testing.assert_allclose(system.positions[name], model.positions, rtol=0.0, atol=1e-3)  # steps are common


def test_winds_of_a_system_that_cannot_be():
    points, line = [Point("ground", GROUND), Point("kite", KITE)], Line("a", "ground", "kite", Tether(initial_length=LENGTH))
    system = TetherSystem(points, [line], wind_points=3)
    with pytest.raises(ValueError, match="wind_velocity is given to a TetherSystem with wind points; give wind_at"):
        system.initialize((8.0, 0.0, 0.0))
    system.initialize(wind_at={"a": gusts(3)})
    with pytest.raises(ValueError, match=r"a.wind_at has the shape \(4, 3\); it must be \(3, 3\)"):
        system.step(STEP, wind_at={"a": gusts(4)})
    with pytest.raises(ValueError, match="there is no wind_at of a line with the name 'b'; there are a"):
        system.step(STEP, wind_at={"b": gusts(3)})
    with pytest.raises(StepRefused, match=r"the line a: the input a.wind_at\[2,1\] is nan"):
        system.step(STEP, wind_at={"a": [[1.0, 0.0, 0.0], [np.nan, 0.0, 0.0], [1.0, 0.0, 0.0]]})
    without = TetherSystem(points, [line])
    with pytest.raises(ValueError, match="this TetherSystem has no wind points for wind_at"):
        without.initialize(wind_at={"a": gusts(3)})
