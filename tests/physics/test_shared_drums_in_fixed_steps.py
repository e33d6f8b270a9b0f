"""Winches that hold several lines by force, and force control beside sheaves, in fixed steps, beside what
`test_shared_drums.py` tests with each solver.

orders     slopes to the adaptive solver at 1e-9: 2 and 1; with stiff damping less, as of the drum of one line
one line   a winch that holds one line with ratio 1 is the line's own winch in the same fixed steps
"""

import numpy as np
import pytest

import shared_winches as scenes
from random_shared_drums import random_winches, started, told
from shared_winches import LIGHT, follows_atwood, own_or_shared, rope
from solvers import METHODS, bounded_flight, fixed
from tetherfmu import Line, Point, SharedWinch, Solver, StepRefused, TetherSystem, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # random systems at the extremes


# --- formulas


@pytest.mark.parametrize(
    ("ratios", "mass", "force"), [((1.0, -1.0), 20.0, 0.0), ((0.5, 1.5), 20.0, 300.0), ((-1.0, 0.5), 0.0, -30.0)]
)
def test_atwood(ratios, mass, force):
    """As `test_shared_drums.test_atwood`, with steps of 5 ms of order 2."""
    _, _, payout, _ = follows_atwood(ratios, mass, force, fixed(0.005, "second_order"), (3e-4, 1e-3))
    assert abs(payout) > 0.4


@pytest.mark.parametrize("friction", [0.0, 50.0])
@pytest.mark.parametrize("method", METHODS)
def test_one_line_is_the_lines_own_winch(method, friction):
    """Where iterations end."""
    found = [own_or_shared(is_shared, friction, fixed(0.005, method)) for is_shared in (False, True)]
    assert np.ptp(found[0][:, 0]) > 0.3
    assert found[0] == pytest.approx(found[1], abs=1e-6)


# --- orders


def swung(solver):
    """Payouts, speeds and positions after 0.5 s of two drums without friction on two lines, and their tensions."""
    points = [Point("pod", (0.0, 0.0, 0.0)), Point("kite", (0.0, 0.0, 19.0), mass=30.0), Point("far", (-8.0, 0.0, 22.0))]
    of_rope = {"segments": 5, "drag_coefficient": 0.5, **LIGHT, "axial_damping": 1e3}
    lines = [Line("a", "pod", "kite", rope(18.9, **of_rope)), Line("b", "pod", "far", rope(23.3, **of_rope))]
    winches = [
        SharedWinch("steering", {"a": 1.0, "b": -1.0}, "force", winch_mass=15.0, winch_damping=50.0),
        SharedWinch("power", {"a": 1.0, "b": 0.5}, "force", winch_mass=20.0, winch_damping=50.0),
    ]
    system = TetherSystem(points, lines, solver=solver, winches=winches)
    system.initialize(**scenes.told(0))
    for k in range(25):
        outputs = system.step(0.02, **scenes.told(k))
    return (
        np.concatenate([np.ravel(list(outputs.winches.values())), outputs.points["kite"].position]),
        np.array([outputs.lines[name].ground_tension for name in "ab"]),
    )


@pytest.mark.parametrize(("method", "order"), [("second_order", 2.0), ("backward_euler", 1.0)])
def test_orders(method, order):
    """Slopes over 2.5, 1.25 and 0.625 ms of tensions, and that motion is at least as good."""
    exact, steps = swung(Solver(relative_tolerance=1e-9)), np.array((0.0025, 0.00125, 0.000625))
    flown = [swung(fixed(h, method)) for h in steps]
    motion, tensions = ([np.abs(each[k] - exact[k]).max() for each in flown] for k in range(2))
    assert np.polyfit(np.log(steps), np.log(tensions), 1)[0] == pytest.approx(order, abs=0.05)
    assert np.polyfit(np.log(steps), np.log(motion), 1)[0] > order - 0.07
    assert motion[0] < (1e-5 if order == 2.0 else 0.04)


# --- beside sheaves


def falls(solver):
    """A block on a rope from a drum over a sheave on it, and on a line from a drum of its own: payouts after 0.5 s."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("block", (0.5, 0.0, -10.0), mass=50.0), Point("end", (1.0, 0.0, 0.0))]
    points.append(Point("side", (8.0, 0.0, -4.0)))
    of_rope = {"drag_coefficient": 0.3, **LIGHT, "segments": 4}
    drum = Winch(winch_control="force", winch_mass=10.0)
    fall = {"through": ["block"], "sheave_mass": 1.0}
    lines = [Line("falls", "top", "end", rope(20.1, **of_rope), winch=drum, **fall)]
    lines.append(Line("guy", "side", "block", rope(9.7, **of_rope), winch=drum))
    system = TetherSystem(points, lines, solver=solver)
    system.initialize(winch_forces={"falls": 180.0, "guy": 150.0})
    for _ in range(25):
        outputs = system.step(0.02, winch_forces={"falls": 230.0, "guy": 80.0})
    return np.array([*(outputs.lines[name].tether_length for name in ("falls", "guy")), *outputs.points["block"].position])


@pytest.mark.parametrize(("method", "within"), [("second_order", 2e-4), ("backward_euler", 4e-3)])
def test_beside_sheaves_they_agree_with_adaptive_steps(method, within):
    """At 10 ms, and at 0.625 ms much better; the jump of force at the start leaves less than order 2 with a light sheave."""
    exact = falls(Solver(relative_tolerance=1e-9))
    coarse, fine = (np.abs(falls(fixed(h, method)) - exact).max() for h in (0.01, 0.000625))
    assert coarse < within
    assert fine < (0.02 if method == "second_order" else 0.7) * coarse


# --- random systems


@pytest.mark.parametrize("method", METHODS)
def test_random_drums_are_bounded(method):
    """All that starts goes on, all numbers are finite, the work is bounded."""
    flights = 0
    for seed in range(40):
        rng = np.random.default_rng((5, seed))
        network, h = random_winches(rng), float(rng.choice((0.002, 0.01, 0.05)))
        try:
            system = started(network, fixed(h, method))
        except StepRefused:  # no lengths of the portions are found
            continue
        flights += 1
        bounded_flight(system, h, lambda time, network=network: told(network, time))
    assert flights > 30


# --- steps that are given up


def test_a_step_that_is_given_up_is_done_with_fixed_steps():
    """8 s in one step, of stiff ropes without damping between masses that almost balance."""
    places = {"a": (20.0, -10.0), "b": (20.1, -10.0)}
    points = [Point("top", (0.0, 0.0, 0.0))]
    points += [Point(name, (0.0, 0.0, z), mass=mass) for name, (mass, z) in places.items()]
    light = {"diameter": 0.002, "mass_per_length": 1e-3, "axial_stiffness": 1e5, "axial_damping": 0.0}
    lines = [Line(f"to_{name}", "top", name, rope(10.99, 20, **light)) for name in "ab"]
    drum = SharedWinch("drum", {"to_a": 1.0, "to_b": -1.0}, "force", winch_mass=0.01)
    system = TetherSystem(points, lines, winches=[drum])
    system.initialize()
    outputs = system.step(8.0)
    assert any("it was done with fixed steps" in each for each in system.implausible)
    payout = outputs.winches["drum"].payout
    assert abs(payout) > 0.1
    assert [outputs.lines[f"to_{name}"].tether_length for name in "ab"] == pytest.approx([10.99 + payout, 10.99 - payout])
