"""Fixed steps of lines over sheaves, and numbers of adaptive ones, beside what `test_sheaves.py` tests with each solver.

orders         2 and 1 to the adaptive solution
random ropes   agree with the adaptive solution, converge to it, and their work is bounded
"""

import numpy as np
import pytest

from over_sheaves import LIGHT, STIFF, G, corner, reeved, rope
from random_sheaves import random_ropes
from solvers import METHODS, bounded_flight, fixed
from tetherfmu import Line, Point, Solver, StepRefused, Tether, TetherSystem

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # random systems at the extremes


def gained(solver):
    """Speed [m/s] that a rope gains from 0.24 to 0.5 s over a sheave with losses, up to 10 m/s."""
    system = corner(600.0, efficiency=0.8, solver=solver)
    speeds = [system.step(0.02).portions["rope"].speed[0] for _ in range(25)]
    return speeds[24] - speeds[11]


@pytest.mark.parametrize("method", METHODS)
def test_a_fast_rope_with_losses(method):
    """0.05 % is left at 10 ms; mu u^2/2 with the other sign at its end would make 0.5 %."""
    assert gained(fixed(0.01, method)) == pytest.approx(gained(Solver(relative_tolerance=1e-8)), rel=1e-3)


# --- orders


def test_orders():
    """Slopes over 20, 10 and 5 ms to the adaptive solver at 1e-9, of nodes and payouts, and of tensions."""
    exact, steps = reeved(Solver(relative_tolerance=1e-9)), np.array((0.02, 0.01, 0.005))
    for method, order, largest in (("second_order", 2.0, (1e-5, 0.02)), ("backward_euler", 1.0, (2e-3, 1.0))):
        flown = [reeved(fixed(h, method)) for h in steps]
        for k in range(2):
            errors = [np.abs(each[k] - exact[k]).max() for each in flown]
            assert errors[0] < largest[k]
            assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.05)


# --- events


@pytest.mark.parametrize("step", [0.001, 0.002])
@pytest.mark.parametrize("method", METHODS)
def test_a_sheave_at_its_stop_feels_both_pulls(method, step):
    """4 s: weights at rest below a sheave that rounding stopped up to 1e-6 of the length before its stop."""
    points = [Point("a", (0.0, 0.0, -1.0), mass=20.0), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, -4.0), mass=60.0)]
    tether = rope(5.0, 5, **LIGHT | {"axial_damping": 2e3})
    line = Line("rope", "a", "b", tether, through=["s"], initial_portions=[1.0, 4.0])
    system = TetherSystem(points, [line], solver=fixed(step, method))
    system.initialize()
    for _ in range(200):
        own = system.step(0.02).portions["rope"]
    assert own.speed[0] == 0.0
    pulls = (20.0 + 0.2 * 0.05) * G, (60.0 + 0.2 * 4.95) * G
    assert (own.tension_to[0], own.tension_from[1]) == pytest.approx(pulls, rel=5e-4)


def test_where_a_sheave_begins_to_run_a_step_is_one_of_backward_euler():
    system = corner(180.0, friction=0.3, solver=fixed(0.01, "second_order"))
    for _ in range(20):
        outputs = system.step(0.01)
    assert 1 <= system.counters["rejections"] <= 4
    assert outputs.portions["rope"].speed[0] > 0.1


# --- random ropes


def flown(scene, solver, step, count):
    """Payouts of all sheaves [m] after so many steps [s], and the system."""
    system = scene.started(solver)
    for k in range(count):
        outputs = system.step(step, **scene.told(step * k))
    return np.concatenate([each.payout for each in outputs.portions.values()]), system


@pytest.mark.parametrize("method", METHODS)
def test_random_ropes_agree_with_adaptive_steps(method):
    """Median over 24 scenes of 0.5 s, of payouts of some dm: 0.13 and 7 mm at 5 ms, 0.09 mm and a half at 2.5 ms.

    With order 2 what friction that begins to hold within a step leaves is about the same in both.
    """
    errors = []
    for seed in range(24):
        scene = random_ropes(np.random.default_rng((10, seed)), is_wild=False)
        exact, _ = flown(scene, Solver(relative_tolerance=1e-7), 0.01, 50)
        errors.append([np.abs(flown(scene, fixed(h, method), 0.01, 50)[0] - exact).max() for h in (0.005, 0.0025)])
    coarse, fine = np.median(errors, axis=0)
    assert coarse < (2e-4 if method == "second_order" else 0.015)
    assert fine < (1.2e-4 if method == "second_order" else 0.6 * coarse)


@pytest.mark.parametrize("seeds", [range(50), range(50, 100)])
@pytest.mark.parametrize("method", METHODS)
def test_wild_ropes_are_bounded(method, seeds):
    """Stiff, slack, undamped, light: all that starts goes on, all numbers are finite, the work is bounded."""
    flights = 0
    for seed in seeds:
        rng = np.random.default_rng((9, seed))
        scene, h = random_ropes(rng, is_wild=True), float(rng.choice((0.002, 0.01, 0.05)))
        try:
            system = scene.started(fixed(h, method))
        except StepRefused:  # no lengths of the portions are found
            continue
        flights += 1
        outputs = bounded_flight(system, h, scene.told)
        for line in scene.lines:
            if line.through:
                assert outputs.portions[line.name].length.min() > 0.0099 * line.tether.segments
    assert flights > 40


# --- steps that are given up


def test_a_step_that_is_given_up_is_done_with_fixed_steps():
    """8 s in one step, of a stiff rope without damping between masses that almost balance."""
    places = {"a": (20.0, -10.0), "b": (20.1, -10.0)}
    points = [Point(name, (0.0, 0.0, z), mass=mass) for name, (mass, z) in places.items()]
    points.append(Point("s", (0.0, 0.0, 0.0)))
    light = {"diameter": 0.002, "mass_per_length": 1e-3, "axial_stiffness": 1e5, "axial_damping": 0.0}
    tether = Tether(segments=20, initial_length=22.0, drag_coefficient=0.0, **light)
    system = TetherSystem(points, [Line("rope", "a", "b", tether, through=["s"], initial_portions=[11.0, 11.0])])
    system.initialize()
    outputs = system.step(8.0)
    assert any("it was done with fixed steps" in each for each in system.implausible)
    assert outputs.portions["rope"].length.sum() == pytest.approx(22.0, abs=1e-12)
    assert np.isfinite(outputs.portions["rope"].payout[0])


# --- adaptive steps

# A winch whose speed jumps at communication points costs no order. Steps of order 4 grow by 10^(1/4) a tenth of the
# tolerance: from 1e-4 to 1e-8 by 10 at most, beside what the 100 communication steps of 20 ms ask for. Bounds: 1.1 times the
# steps of a prototype that solves the same equations otherwise.
COUNT, STEP = 100, 0.02
TIMES = STEP * np.arange(COUNT)
SPEEDS = {
    "sine": (-0.3 * np.sin(2.0 * TIMES), {1e-4: 100, 1e-6: 392, 1e-8: 3086}),
    "constant": (np.full(COUNT, -0.25), {1e-4: 142, 1e-6: 319, 1e-8: 733}),
    "ramp": (-0.5 * np.minimum(1.0, TIMES), {1e-4: 100, 1e-6: 247, 1e-8: 643}),
}


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("speed", SPEEDS)
def test_steps_of_a_hoist(speed, tolerance):
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0)), Point("block", mass=2000.0)]
    line = Line("hoist", "winch", "anchor", rope(40.0, **STIFF), through=["block"], sheave_mass=3.0)
    system = TetherSystem(points, [line], solver=Solver(relative_tolerance=tolerance))
    system.initialize()
    speeds, steps = SPEEDS[speed]
    before = system.counters["steps"]
    system.fly(COUNT, STEP, reel_out_speeds={"hoist": speeds}, every=0)
    assert system.counters["steps"] - before <= 1.1 * steps[tolerance]
