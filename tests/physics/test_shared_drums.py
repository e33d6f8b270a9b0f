"""Winches that hold several lines by force, and force control beside sheaves, against formulas.

atwood     loads m_i on heavy rope straight down from a drum with ratios r_i: (m + sum r_i^2 (m_i + mu l_i)) u' =
           sum r_i (m_i + mu l_i) g - W with l_i = L + r_i p, as rope is as fast as the drum where it leaves it; on each line
           T_i = (m_i + mu l_i)(g - r_i u')
two falls  a block M on a rope from a drum over a sheave on the block to a fixed point: by the balance of energy
           (m + mu l/2 + M/4) u' = M g/2 + mu g l/2 + mu u^2/4 - W with l = L + p
one line   a winch that holds one line with ratio 1 is the line's own winch
held       a drum that friction holds is a winch at rest, bit for bit, and slips when the pull exceeds it
stops      a drum reels in no further than segments may get shorter, and pays out no further than longest_length
frame      an observer who moves uniformly sees the same tensions
energy     what the powers do not explain falls with the square of the communication step, of the lines and of each drum
orders     slopes of fixed steps to the adaptive solver at 1e-9: 2 and 1; with stiff damping less, as of the drum of one line
random     random systems in fixed steps are bounded
"""

import numpy as np
import pytest

from of_systems import assert_continues, unexplained
from over_sheaves import LIGHT, G
from random_sheaves import random_winches
from shared_winches import ONE, SERIES, between, block_on_falls, moved, own_or_shared, rope, steered, told
from solvers import ADAPTIVE, METHODS, bounded_flight, fixed, with_each_solver
from tetherfmu import Line, Point, SharedWinch, Solver, StepRefused, TetherSystem, Winch

TIGHT = Solver(relative_tolerance=1e-6)
# where it jumps
LOOSE = pytest.mark.filterwarnings("ignore:.*stretched by", "ignore:.*slack", "ignore:.*at a sheave")
STRAINED = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # at the extremes


# --- formulas


ATWOODS = [((1.0, -1.0), 20.0, 0.0), ((0.5, 1.5), 20.0, 300.0), ((-1.0, 0.5), 0.0, -30.0), ((-2.0, 1.0), 5.0, 0.0)]
SOLVERS = [(TIGHT, 1e-4, 0.02), (fixed(0.005, "second_order"), 3e-4, 0.05)]


@pytest.mark.parametrize(("solver", "within", "of_tension"), SOLVERS)
@pytest.mark.parametrize(("ratios", "mass", "force"), ATWOODS)
def test_atwood(ratios, mass, force, solver, within, of_tension):
    """Payout [m] in 1.2 s, tensions [N]: what is left are waves along the rope, which is not rigid."""
    loads, length, r = np.array([20.0, 30.0]), 10.0, np.array(ratios)
    ends = [
        Point(name, (0.0, 0.0, -length * (1.0 + (m + 5.0) * G / 1e7)), mass=m) for name, m in zip("ab", loads, strict=True)
    ]
    lines = [Line(f"to_{name}", "top", name, rope(length)) for name in "ab"]
    drum = SharedWinch("drum", dict(zip(("to_a", "to_b"), ratios, strict=True)), "force", winch_force=force, winch_mass=mass)
    system = TetherSystem([Point("top", (0.0, 0.0, 0.0)), *ends], lines, solver=solver, winches=[drum])
    system.initialize()
    payout, speed = 0.0, 0.0

    def rate(p, _):
        hanging = loads + length + r * p
        return (r @ hanging * G - force) / (mass + r**2 @ hanging)

    for _ in range(60):
        found = system.step(0.02)
        payout, speed = moved(rate, payout, speed, 0.02)
        assert abs(found.winches["drum"].payout - payout) < within
    assert abs(found.winches["drum"].winch_speed - speed) < 2.0 * within
    tensions, gained = [found.lines[f"to_{name}"].ground_tension for name in "ab"], rate(payout, speed)
    assert tensions == pytest.approx((loads + length + r * payout) * (G - r * gained), abs=of_tension)
    assert r @ tensions == pytest.approx(force + mass * gained, abs=of_tension)
    assert abs(payout) > 0.4


@pytest.mark.parametrize("is_shared", [False, True])
def test_two_falls(is_shared):
    """Length within 5e-4 m in 1.2 s, as above; the block moves with half of the speed of the drum."""
    mass, block, length, force = 10.0, 50.0, 20.0, 200.0
    points = [
        Point("top", (0.0, 0.0, 0.0)),
        Point("block", (0.0, 0.0, -0.5 * length), mass=block),
        Point("end", (0.0, 0.0, 0.0)),
    ]
    own, drum = {"winch_mass": mass}, "drum" if is_shared else "falls"
    winch = Winch() if is_shared else Winch(winch_control="force", **own)
    line = Line("falls", "top", "end", rope(length, 5), winch=winch, through=["block"], initial_portions=[10.0, 10.0])
    winches = [SharedWinch("drum", {"falls": 1.0}, "force", **own)] if is_shared else []
    system = TetherSystem(points, [line], solver=TIGHT, winches=winches)
    system.initialize(winch_forces={drum: force})
    payout, speed = 0.0, 0.0

    def rate(p, u):
        whole = length + p
        return (0.5 * (block + whole) * G + 0.25 * u * u - force) / (mass + 0.5 * whole + 0.25 * block)

    for _ in range(60):
        found = system.step(0.02)
        payout, speed = moved(rate, payout, speed, 0.02)
        assert found.lines["falls"].tether_length - length == pytest.approx(payout, abs=5e-4)
    assert found.lines["falls"].winch_speed == pytest.approx(speed, abs=2e-4)
    assert found.points["block"].velocity[2] == pytest.approx(-0.5 * speed, abs=2e-4)
    assert found.portions["falls"].payout[0] == pytest.approx(0.5 * payout, abs=5e-4)
    assert found.lines["falls"].ground_tension == pytest.approx(force + mass * rate(payout, speed), abs=0.02)


OWN = [  # friction, start, solver, what both may differ by, tethers
    *((0.0, start, TIGHT, 1e-6, ONE) for start in ("top", "body")),  # the tolerance
    *((50.0, start, TIGHT, 1e-9, ONE) for start in ("top", "body")),  # where both take the same steps
    *(
        (friction, "top", fixed(0.005, method), 1e-6, ONE) for friction in (0.0, 50.0) for method in METHODS
    ),  # iterations end
    (0.0, "top", TIGHT, 1e-8, SERIES),
]


@pytest.mark.filterwarnings("ignore:.*backward Euler")
@pytest.mark.parametrize(("friction", "start", "solver", "within", "tethers"), OWN)
def test_one_line_is_the_lines_own_winch(friction, start, solver, within, tethers):
    """To the tolerance, or nearly to rounding."""
    found = [own_or_shared(is_shared, friction, solver, start, tethers) for is_shared in (False, True)]
    assert np.ptp(found[0][:, 0]) > 0.3
    assert found[0] == pytest.approx(found[1], abs=within)


@LOOSE
def test_a_drum_beside_a_sheave_starts_with_its_speed():
    """In balance with half of the weight of the block it keeps it, but for the rope that comes."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("block", (0.0, 0.0, -10.0), mass=50.0), Point("end", (0.0, 0.0, 0.0))]
    winch = Winch(winch_control="force", winch_mass=100.0)
    line = Line("falls", "top", "end", rope(20.0, 5, **LIGHT), through=["block"], reel_out_speed=0.5, winch=winch)
    system = TetherSystem(points, [line])
    system.initialize(winch_forces={"falls": 0.5 * 50.0 * G})
    assert system.step(1e-3).lines["falls"].winch_speed == pytest.approx(0.5, abs=0.01)
    for _ in range(25):
        outputs = system.step(0.02)
    assert outputs.lines["falls"].winch_speed == pytest.approx(0.5, abs=0.1)


# --- friction and stops


@with_each_solver()
def test_a_held_drum_is_a_winch_at_rest(solver):
    """Bit for bit."""
    held = between([SharedWinch("drum", {"from_a": 1.0, "from_b": -1.0}, "force", winch_friction=1e3)], solver)
    still = between(solver=solver)
    for k in range(40):
        load = {"loads": {"mass": (30.0 * np.sin(0.2 * k), 10.0, 0.0)}}
        one, other = (system.step(0.02, **load) for system in (held, still))
        assert all(np.array_equal(held.positions[name], still.positions[name]) for name in still.positions)
        assert np.array_equal(one.points["a"].force, other.points["a"].force)
        assert one.winches["drum"] == (0.0, 0.0)


@with_each_solver()
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_onset(way, solver):
    """The drum begins to turn in the communication step in which its lines pull more than its friction, and that way."""
    drum = SharedWinch("drum", {"from_a": 1.0, "from_b": -1.0}, "force", winch_mass=2.0, winch_friction=100.0)
    system, pulls = between([drum], solver), [0.0, 0.0]
    for k in range(400):
        outputs = system.step(0.02, loads={"mass": (way * 0.5 * k, 0.0, 0.0)})
        if outputs.winches["drum"].payout != 0.0:
            break
        pulls.append(way * (outputs.lines["from_a"].ground_tension - outputs.lines["from_b"].ground_tension))
    assert pulls[-1] < 100.0 < pulls[-1] + 2.0 * (pulls[-1] - pulls[-2])
    assert way * outputs.winches["drum"].winch_speed > 0.0


def test_it_comes_to_rest():
    """Friction brings it to rest, and holds it while the pull is within."""
    system = between([SharedWinch("drum", {"from_a": 1.0, "from_b": -1.0}, "force", winch_mass=20.0, winch_friction=60.0)])
    found = [system.step(0.02, loads={"mass": (250.0 if k < 20 else 0.0, 0.0, 0.0)}).winches["drum"] for k in range(200)]
    payouts = np.array([each.payout for each in found if each.winch_speed == 0.0 and each.payout != 0.0])
    assert len(payouts) > 20
    assert np.sum(np.diff(payouts) == 0.0) > 20


@LOOSE
@with_each_solver(0.005)
def test_it_stops_where_segments_get_too_short(solver):
    """At 4 segments of 1 cm; reeled in by 1.3 times the weight."""
    within = 1e-8 if solver is ADAPTIVE else 1e-6
    points = [Point("top", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -1.0), mass=30.0)]
    lines = [Line(name, "top", "load", rope(1.0, 4, **LIGHT)) for name in "ab"]
    drum = SharedWinch("drum", {"a": 1.0, "b": 1.0}, "force", winch_mass=5.0, winch_damping=200.0)
    system = TetherSystem(points, lines, solver=solver, winches=[drum])
    system.initialize()
    for _ in range(200):
        outputs = system.step(0.02, winch_forces={"drum": 1.3 * 30.0 * G})
        assert outputs.lines["a"].tether_length >= 0.04 * (1.0 - within)
    assert outputs.lines["a"].tether_length == pytest.approx(0.04, rel=within)
    assert outputs.winches["drum"].winch_speed == 0.0
    outputs = system.step(0.02, winch_forces={"drum": 0.5 * 30.0 * G})  # it pays out again
    for _ in range(20):
        outputs = system.step(0.02)
    assert outputs.winches["drum"].payout > -0.95


@LOOSE
def test_longest_length_beside_a_sheave():
    """The drum of a line that runs over none stops there, while another line runs over a sheave."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -10.0), mass=40.0)]
    points += [Point("s", (3.0, 0.0, 0.0)), Point("other", (3.0, 0.0, -5.0), mass=10.0)]
    winch = Winch(winch_control="force", winch_mass=10.0, winch_damping=100.0, longest_length=10.3)
    lines = [Line("line", "top", "load", rope(10.0, **LIGHT), winch=winch)]
    lines += [Line("over", "load", "other", rope(15.4, **LIGHT), through=["s"], initial_portions=[10.4, 5.0])]
    system = TetherSystem(points, lines)
    system.initialize(winch_forces={"line": 100.0})
    for _ in range(200):
        outputs = system.step(0.02)
        assert outputs.lines["line"].tether_length <= 10.3 * (1.0 + 1e-8)
    assert outputs.lines["line"].tether_length == pytest.approx(10.3, rel=1e-8)
    assert outputs.lines["line"].winch_speed == 0.0


# --- two drums on the same lines


def test_moving_frame():
    """Rounding over 2 s."""
    found = []
    for velocity in (np.zeros(3), np.array([7.0, -3.0, 1.0])):
        system, rows = steered(velocity, solver=TIGHT), []
        system.initialize(np.array([6.0, 0.0, 0.0]) + velocity, **told(0))
        for k in range(100):
            places = {"pod": 0.02 * k * velocity, "far": np.array([-8.0, 0.0, 22.0]) + 0.02 * k * velocity}
            outputs = system.step(0.02, positions=places, velocities=dict.fromkeys(places, velocity), **told(k))
            rows.append([*(outputs.lines[name].ground_tension for name in "ab"), *np.ravel(list(outputs.winches.values()))])
        found.append(np.array(rows))
    assert np.abs(found[0][:, 2:]).max() > 0.5
    assert found[0] == pytest.approx(found[1], abs=1e-7)


@pytest.mark.parametrize("pod", [None, 40.0])
def test_energy(pod):
    """A quarter of the step leaves less than a tenth of the residual, of the system and of the drum `power`."""
    residuals, start = [], {"loads": {"kite": (0.0, 0.0, 600.0)}, "winch_forces": {"steering": 60.0, "power": 300.0}}

    def account(energy):
        drum = energy.winches["power"]
        return (energy.total, drum.kinetic), (energy.power, drum.power)

    for step in (0.02, 0.005):
        system = steered(pod=pod, solver=Solver(relative_tolerance=1e-7))
        system.initialize((6.0, 0.0, 0.0), **start)
        residuals.append(np.abs(unexplained(system, step, round(1.0 / step), account=account)[0]))
    assert np.all(residuals[0] / residuals[1] > 10.0)
    assert np.all(residuals[1] < 0.1)


@with_each_solver()
def test_a_state_is_restored(solver):
    """With drums that turn and one that friction holds at times."""
    system = steered(solver=TIGHT if solver is ADAPTIVE else solver)
    system.initialize(**told(0))
    assert_continues(system, told, 20, 20)


@with_each_solver()
def test_without_mass_the_lines_pull_with_the_force(solver):
    """At every instant the sum of tensions times ratios; the force is continued linearly within a step."""
    system = between([SharedWinch("drum", {"from_a": 1.0, "from_b": 0.5}, "force", winch_force=500.0)], solver)
    for k in range(1, 40):
        outputs = system.step(0.02, winch_forces={"drum": 500.0 - 2.0 * k})
        pull = outputs.lines["from_a"].ground_tension + 0.5 * outputs.lines["from_b"].ground_tension
        assert pull == pytest.approx(500.0 - 2.0 * k - (2.0 if k > 1 else 0.0), abs=1e-6)


# --- all together


def test_drums_beside_sheaves_at_one_free_point():
    """The residual of the energy falls as above."""
    residuals, forces = [], {"winch_forces": {"falls": 230.0, "guy": 80.0}}
    for step in (0.02, 0.005):
        system = block_on_falls(Solver(relative_tolerance=1e-7), 8.0, 0.05)
        residuals.append(abs(unexplained(system, step, round(0.6 / step), lambda _: forces)[0]))
    assert min(abs(each.winch_speed) for each in system.outputs().lines.values()) > 0.1
    assert residuals[0] / residuals[1] > 8.0
    assert residuals[1] < 0.2


# --- fixed steps


def swung(solver):
    """Payouts, speeds and positions after 0.5 s of two drums without friction on two lines, and their tensions."""
    drums = {name: {"winch_mass": mass, "winch_damping": 50.0} for name, mass in (("steering", 15.0), ("power", 20.0))}
    system = steered(solver=solver, axial_damping=1e3, **drums)
    system.initialize(**told(0))
    for k in range(25):
        outputs = system.step(0.02, **told(k))
    return (
        np.concatenate([np.ravel(list(outputs.winches.values())), outputs.points["kite"].position]),
        np.array([outputs.lines[name].ground_tension for name in "ab"]),
    )


@STRAINED
@pytest.mark.parametrize(("method", "order"), [("second_order", 2.0), ("backward_euler", 1.0)])
def test_orders(method, order):
    """Slopes over 2.5, 1.25 and 0.625 ms of tensions, and that motion is at least as good."""
    exact, steps = swung(Solver(relative_tolerance=1e-9)), np.array((0.0025, 0.00125, 0.000625))
    flown = [swung(fixed(h, method)) for h in steps]
    motion, tensions = ([np.abs(each[k] - exact[k]).max() for each in flown] for k in range(2))
    assert np.polyfit(np.log(steps), np.log(tensions), 1)[0] == pytest.approx(order, abs=0.05)
    assert np.polyfit(np.log(steps), np.log(motion), 1)[0] > order - 0.07
    assert motion[0] < (1e-5 if order == 2.0 else 0.04)


def lifted(solver):
    """Lengths and the place of `block_on_falls` after 0.5 s [m]."""
    system = block_on_falls(solver)
    for _ in range(25):
        outputs = system.step(0.02, winch_forces={"falls": 230.0, "guy": 80.0})
    return np.array([*(outputs.lines[name].tether_length for name in ("falls", "guy")), *outputs.points["block"].position])


@STRAINED
@pytest.mark.parametrize(("method", "within"), [("second_order", 2e-4), ("backward_euler", 4e-3)])
def test_beside_sheaves_they_agree_with_adaptive_steps(method, within):
    """At 10 ms, and at 0.625 ms much better; the jump of force at the start leaves less than order 2 with a light sheave."""
    exact = lifted(Solver(relative_tolerance=1e-9))
    coarse, fine = (np.abs(lifted(fixed(h, method)) - exact).max() for h in (0.01, 0.000625))
    assert coarse < within
    assert fine < (0.02 if method == "second_order" else 0.7) * coarse


@STRAINED
@pytest.mark.parametrize("method", METHODS)
def test_random_drums_are_bounded(method):
    """All that starts goes on, all numbers are finite, the work is bounded."""
    flights = 0
    for seed in range(40):
        rng = np.random.default_rng((5, seed))
        scene, h = random_winches(rng), float(rng.choice((0.002, 0.01, 0.05)))
        try:
            system = scene.started(fixed(h, method))
        except StepRefused:  # no lengths of the portions are found
            continue
        flights += 1
        bounded_flight(system, h, scene.told)
    assert flights > 30


@STRAINED
def test_a_step_that_is_given_up_is_done_with_fixed_steps():
    """8 s in one step, of stiff ropes without damping between masses that almost balance."""
    points = [Point("top", (0.0, 0.0, 0.0))]
    points += [Point(name, (0.0, 0.0, -10.0), mass=mass) for name, mass in (("a", 20.0), ("b", 20.1))]
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
