"""Within a communication step the reel-out speed and the load of a free kite, or point, go on as before, or are held.

    linear   L grows by s h + a h^2/2,  a = (s - s_last)/max(h_last, h/4),  0 in the first step
    held     L grows by s h

With smooth inputs the error is of order 2 in h, and of order 1 if they are held. A jump of D leaves D h/2.
"""

from itertools import pairwise

import numpy as np
import pytest

from solvers import MODELS
from tetherfmu import Environment, Line, Point, Solver, StepRefused, Tether, TetherDynamic, TetherDynamicFree, TetherSystem

KITE = (30.0, 0.0, 40.0)
SLACK = Tether(segments=5, initial_length=52.0)
UNEQUAL = np.resize((0.02, 0.05, 0.001, 0.03, 0.02), 40)  # communication steps [s]


def started(variant=TetherDynamic, tether=SLACK, **solver):
    model = variant(tether, solver=Solver(**solver))
    model.initialize(KITE)
    return model


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@pytest.mark.parametrize("variant", MODELS)
def test_a_speed_that_grows_linearly_is_followed_exactly(variant, fixed_step):
    model = started(variant, fixed_step=fixed_step)
    times = np.cumsum([0.0, 0.02, 0.05, 0.001, 0.03, 0.001, 0.001, 0.02])
    for now, then in pairwise(times):
        out = model.step(then - now, reel_out_speed=1.0 + 20.0 * now)
    # the first step knows no acceleration: 20 m/s2 (0.02 s)^2/2 is missing
    expected = 52.0 + then + 10.0 * then**2 - 10.0 * 0.02**2
    assert out.tether_length == pytest.approx(expected, rel=1e-14)


def test_a_jump_leaves_half_a_step():
    model, held = started(), started(input_continuation="held")
    for each in (model, held):
        for speed in (0.0, 0.0, 2.0, 2.0, 2.0):
            out = each.step(0.02, reel_out_speed=speed)
    assert model.outputs().tether_length == pytest.approx(52.0 + 3 * 0.04 + 2.0 * 0.02 / 2.0, rel=1e-14)
    assert out.tether_length == pytest.approx(52.0 + 3 * 0.04, rel=1e-14)


def test_a_jump_after_a_short_step_is_not_blown_up():
    model = started()
    model.step(0.001, reel_out_speed=0.0)
    # a = 1 m/s over a quarter of 0.1 s
    assert model.step(0.1, reel_out_speed=1.0).tether_length == pytest.approx(52.0 + 0.1 + 0.5 * 40.0 * 0.01, rel=1e-14)


def test_the_shortest_length_within_a_step_counts():
    model = started(tether=Tether(segments=1, initial_length=0.1))
    model.step(0.02, reel_out_speed=-2.0)  # 60 mm
    before = model.get_state()
    with pytest.raises(StepRefused, match="reel_out_speed"):
        model.step(0.12, reel_out_speed=-1.45)  # falls to 3 mm, below the 10 mm that are allowed, and ends at 18 mm
    np.testing.assert_array_equal(model.get_state(), before)


@pytest.mark.parametrize(("continuation", "order"), [("linear", 2.0), ("held", 1.0)])
def test_order_of_the_force(continuation, order):
    """A taut tether between fixed ends is reeled to and fro: its force follows the length."""

    def forces(step):
        model = started(
            tether=Tether(segments=5, initial_length=49.9), input_continuation=continuation, relative_tolerance=1e-8
        )
        kept = []
        for k in range(round(2.0 / step)):
            out = model.step(step, reel_out_speed=0.05 * np.sin(3.0 * k * step))
            kept.append(out.ground_tension)
        return np.array(kept)[round(0.08 / step) - 1 :: round(0.08 / step)]

    fine = forces(0.0025)
    errors = [np.sqrt(np.mean((forces(step) - fine) ** 2)) for step in (0.08, 0.04, 0.02)]
    assert -np.diff(np.log2(errors)) == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("fixed_step", [0.0, 1e-4])
def test_a_load_that_grows_linearly(fixed_step):
    """A mass m that nothing holds but the load f t: m v = f t^2/2, m x = f t^3/6; the first step holds the load 0.

    In unequal steps, too, which know each load exactly.
    """
    tether = Tether(segments=1, initial_length=50.0, slack_stiffness_ratio=0.0, axial_damping=0.0)
    solver = Solver(fixed_step=fixed_step, relative_tolerance=1e-8)
    void = Environment(gravity=0.0, air_density=0.0)
    model = TetherDynamic(tether, void, solver, free_ends=(False, True), point_masses={1: 10.0})
    model.initialize((30.0, 0.0, 0.0))
    mass = 10.0 + 0.5 * tether.mass_per_length * 50.0
    rate, end = np.array([4.0, -3.0, 5.0]), 0.0
    for step in UNEQUAL:
        model.step(step, kite_load=rate * end)
        end += step
    step = UNEQUAL[0]
    first = 0.5 * rate * step**2 / mass  # velocity that the first step lacks

    # backward Euler of 0.1 ms: relative error of the velocity (steps/time), of the position twice that
    accuracy = 1e-9 if fixed_step == 0.0 else 5e-4
    velocity = 0.5 * rate * end**2 / mass - first
    position = rate * end**3 / 6.0 / mass - first * (end - step) - rate * step**3 / 6.0 / mass
    np.testing.assert_allclose(model.velocities[1], velocity, rtol=accuracy)
    np.testing.assert_allclose(model.positions[1] - [30.0, 0.0, 0.0], position, rtol=accuracy)


PULLED = Tether(segments=5, initial_length=49.9)


def load_at(time):
    """Load on what ends a line at a time [s]."""
    return np.array((60.0 + 30.0 * np.sin(3.0 * time), 20.0 * np.cos(2.0 * time), 90.0))


def systems_with_a_free_point(solver):
    """A line that ends in a free point, and one that begins there: each system, and position of the point."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", KITE, mass=5.0)]
    for ends in (("ground", "kite"), ("kite", "ground")):
        system = TetherSystem(points, [Line("line", *ends, PULLED)], solver=solver)
        system.initialize(loads={"kite": load_at(0.0)})
        yield system


@pytest.mark.parametrize("continuation", ["linear", "held"])
@pytest.mark.parametrize("fixed_step", [0.0, 0.005])
def test_the_load_on_a_point_goes_on_as_that_of_a_kite(continuation, fixed_step):
    """Same tether, same load: another elimination, so other rounding, which iterations of fixed steps may let grow."""
    solver = Solver(input_continuation=continuation, fixed_step=fixed_step, relative_tolerance=1e-6)
    kite = TetherDynamicFree(PULLED, solver=solver, kite_mass=5.0)
    kite.initialize(KITE)
    forward, backward = systems_with_a_free_point(solver)
    for time, step in zip(np.cumsum(UNEQUAL) - UNEQUAL, UNEQUAL, strict=True):
        kite.step(step, kite_load=load_at(time))
        for system in (forward, backward):
            system.step(step, loads={"kite": load_at(time)})
    one, other = kite.energy(), forward.energy()
    assert other.loads["kite"] == pytest.approx(one.kite_power, rel=1e-6)
    assert (other.total, other.power) == pytest.approx((one.total, one.power), rel=1e-6)
    np.testing.assert_allclose(forward.positions["line"], kite.positions, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(backward.positions["line"][::-1], kite.positions, rtol=0.0, atol=1e-9)
