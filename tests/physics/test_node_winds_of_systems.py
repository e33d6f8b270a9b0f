"""The wind at each node of the lines of a system: as of a tether alone, part of the state, refused where it cannot be."""

import numpy as np
import pytest

from tetherfmu import Environment, Line, Point, Solver, StepRefused, Tether, TetherDynamic, TetherSystem

N, STEP, LENGTH = 5, 0.02, 101.0
KITE = (60.0, 0.0, 80.0)
TETHER = Tether(segments=N, initial_length=LENGTH)


def winds(k):
    """Wind at the nodes before step k [m/s]: it grows along the tether, and turns."""
    share = np.linspace(0.2, 1.0, N + 1)[:, None]
    return share * (10.0 * np.cos(0.1 * k), 10.0 * np.sin(0.1 * k), 0.5)


def system(wind_points=0):
    """Two driven points and a line between them, and beside it another one."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", KITE), Point("other", (0.0, 60.0, 80.0))]
    lines = [Line("a", "ground", "kite", TETHER), Line("b", "ground", "other", TETHER)]
    air = Environment() if wind_points else Environment(wind_profile="power_law")
    return TetherSystem(points, lines, air, wind_points=wind_points)


def test_is_that_of_a_tether_alone():
    """Bit for bit; the other line feels none, and a wind at the reference height counts again when it comes."""
    both, alone = system(), TetherDynamic(TETHER, Environment(wind_profile="power_law"))
    still = TetherDynamic(TETHER, Environment(wind_profile="power_law"))
    found = both.initialize({"a": winds(0)})
    wanted = alone.initialize(KITE, wind_velocity=winds(0))
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
