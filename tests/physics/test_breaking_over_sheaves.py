"""Ropes over sheaves that break, let go, and run off: against solvers of their own, with adaptive and fixed steps.

The rope of the solvers is inextensible; a broken one ends in half of the broken segment, as a lump. T is the tension beside
the sheave, l1 and l2 the lengths on its sides.

two masses   (m1 + mu (l1 + l2) + J/r2) a = (mu (l2 - l1) - m1) g, after m2 was lost: the payout is a hyperbolic cosine
running      before and after the break, whose time is the time at which the tension reaches the breaking force
run off      what falls then, falls with g; rope is neither lost nor made; of a rope over no sheave beyond, T = mu l (g - a)
held         a rope that friction holds at its sheave is two lines, of which the second one lets go, bit for bit
one line     on a drum that holds no other is the line with its own winch

Energy: `test_sheaves.py`.
"""

import re
import warnings

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from of_systems import assert_continues, unexplained
from over_sheaves import DENSITY, LIGHT, Atwood, G, driven, rope
from shared_winches import own_or_shared
from solvers import ADAPTIVE, METHODS, fixed, with_each_solver
from tetherfmu import Line, Point, SharedWinch, Solver, StepRefused, Tether, TetherSystem, Winch

SECOND, EULER = (fixed(0.002, method) for method in METHODS)


ignored = ("backward Euler", "the tension at a sheave", "broke", "presses its ends apart", "the tether hangs")
pytestmark = pytest.mark.filterwarnings(*(f"ignore:.*{each}" for each in ignored))


def snapped(solver=ADAPTIVE, sheave_mass=0.0):
    """Two masses on a rope that breaks at the start in the segment beside the sheave, on the side of the heavier one.

    A part keeps a segment, so the second segment breaks: 1.5 of 10 segments are left on this side.
    """
    scene = Atwood(sheave_mass)
    system = scene.system(solver, breaking_force=(scene.m2 + DENSITY * 9.5) * G - 1.0)
    scene.right, scene.tail = 0.0, 1.5
    return scene, system


@pytest.mark.parametrize(("solver", "within"), [(ADAPTIVE, 4e-4), (SECOND, 4e-4), (EULER, 5e-3)])
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
def test_a_rope_of_two_masses_breaks(sheave_mass, solver, within):
    """The stretch by the lost mass, 0.2 mm, stays; backward Euler has its order."""
    scene, system = snapped(solver, sheave_mass)
    low = system.outputs().points["b"].position[2]
    for k in range(35):
        outputs, time = system.step(0.01), 0.01 * (k + 1)
        assert outputs.portions["rope"].payout[0] == pytest.approx(scene.payout(time), abs=within)
    assert outputs.lines["rope"].broken
    assert outputs.lines["rope"].break_time == 0.0
    assert outputs.portions["rope"].speed[0] == pytest.approx(scene.speed(time), abs=2.0 * within)
    assert outputs.portions["rope"].tension_to[0] == pytest.approx(scene.tensions(time)[0], abs=100.0 * within)
    assert outputs.points["b"].position[2] - low == pytest.approx(-0.5 * G * time**2, abs=within)
    assert outputs.portions["rope"].length.sum() == pytest.approx(20.0, abs=1e-12)


# --- a rope that runs when it breaks

SLOPE, STEP = 400.0, 0.01  # of the load [N/s], communication step [s]


def load_at(time):
    """Load on the heavier mass [N]: a ramp, of which the first step knows nothing."""
    return SLOPE * time if time >= STEP else 0.0


def running(breaking_force, duration):
    """Time of the break [s], then payout [m] and its rate [m/s] at the end."""
    m1, m2, length, segment = 20.0, 30.0, 10.0, 0.1  # of an `Atwood`
    whole = m1 + m2 + 2.0 * length * DENSITY

    def rates(time, state):
        return state[1], ((m2 - m1 + 2.0 * DENSITY * state[0]) * G + load_at(time)) / whole

    def lacking(time, state):
        hanging = m2 + DENSITY * (length + state[0]) * (1.0 - 0.5 * segment)  # at the middle of the first segment
        return breaking_force - hanging * (G - rates(time, state)[1]) - load_at(time)

    lacking.terminal = True
    options = {"rtol": 1e-10, "atol": 1e-12, "max_step": STEP}
    before = solve_ivp(rates, (0.0, duration), (0.0, 0.0), events=lacking, **options)
    payout, tail = before.y[0, -1], 1.5 * segment * (length + before.y[0, -1])

    def rates_after(time, state):
        left, right = m1 + DENSITY * (length - state[0]), DENSITY * (tail + state[0] - payout)
        return state[1], (right - left) * G / (left + right)

    after = solve_ivp(rates_after, (before.t[-1], duration), before.y[:, -1], **options)
    return before.t[-1], after.y[:, -1]


@pytest.mark.parametrize("solver", [ADAPTIVE, Solver(fixed_step=0.0002)])  # it breaks at the end of a fixed step
def test_a_running_rope_breaks(solver):
    force, duration = 450.0, 1.2
    time, (payout, speed) = running(force, duration)
    assert 0.3 < time < 1.0
    system = Atwood().system(solver, breaking_force=force)
    for k in range(round(duration / STEP)):
        outputs = system.step(STEP, loads={"b": (0.0, 0.0, -load_at(STEP * k))})
    found = outputs.portions["rope"]
    assert outputs.lines["rope"].break_time == pytest.approx(time, abs=0.002)
    assert found.payout[0] == pytest.approx(payout, abs=0.002)
    assert found.speed[0] == pytest.approx(speed, abs=0.02)


# --- rope that runs off


@with_each_solver(0.002)
def test_what_runs_off_falls(solver):
    """The mass that is left falls with g then, and the rope with it; the other side keeps nothing that moves it."""
    (scene, system), before = snapped(solver), None
    for k in range(90):
        outputs = system.step(0.01)
        if outputs.portions["rope"].speed[0] == 0.0 and before is None:
            before = k, outputs.points["a"].velocity[2]
            assert abs(outputs.portions["rope"].payout[0]) > 0.5 * scene.tail
    at, speed = before
    assert outputs.points["a"].velocity[2] == pytest.approx(speed - (89 - at) * 0.01 * G, abs=0.05)
    assert outputs.points["b"].velocity[2] == pytest.approx(-0.9 * G, abs=0.02)
    found = outputs.portions["rope"]
    assert found.length.sum() == pytest.approx(20.0, abs=1e-9)
    assert found.length[0] == pytest.approx(10.0 + scene.tail, abs=1e-9)
    assert found.tension_from == pytest.approx([0.0, 0.0], abs=1e-3)
    assert np.isfinite(system.positions["rope"]).all()
    assert np.linalg.norm(outputs.points["s"].force) < 1.0


@with_each_solver(0.002)
def test_a_released_rope_runs_off_its_sheave(solver):
    """It does not stop there, as a knot would: both ends fall."""
    points = [Point("a", (0.0, 0.0, -4.0), mass=20.0), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, -1.0))]
    line = Line("rope", "a", "b", rope(5.0, 5, **LIGHT), through=["s"], initial_portions=[4.0, 1.0])
    system, speeds = TetherSystem(points, [line], solver=solver), []
    system.initialize()
    for _ in range(75):
        outputs = system.step(0.02, releases={"rope": True})
        speeds.append(outputs.points["a"].velocity[2])
        assert outputs.lines["rope"].peak_tension < 400.0
    assert np.diff(speeds[40:]) == pytest.approx(np.full(34, -0.02 * G), abs=2e-3)
    assert outputs.portions["rope"].length[0] == pytest.approx(5.0, abs=0.011)


def hoist_of_four_falls(breaking_force, solver, control="speed", is_shared=False):
    """Started system of a block of 2 t on a rope with this breaking force [N], and its winch."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("crown", (0.5, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0))]
    points.append(Point("block", mass=2000.0))
    of_rope = {"diameter": 0.012, "mass_per_length": 0.57, "axial_stiffness": 5e6, "axial_damping": 2e4}
    own = Tether(segments=6, initial_length=80.0, breaking_force=breaking_force, slack_stiffness_ratio=0.0, **of_rope)
    drum = {"winch_mass": 200.0, "winch_damping": 50.0} if control == "force" else {}
    winches = [SharedWinch("drum", {"hoist": 1.0}, control, **drum)] if is_shared else []
    winch = {} if is_shared else {"winch": Winch(winch_control=control, **drum)}
    line = Line("hoist", "winch", "anchor", own, through=["block", "crown", "block"], sheave_efficiency=0.98, **winch)
    system = TetherSystem(points, [line], winches=winches, solver=solver)
    name = "drum" if is_shared else "hoist"
    given = {"force": {"winch_forces": {name: 5100.0}}, "length": {"winch_lengths": {name: 80.0 * (not is_shared)}}}
    system.initialize(**given.get(control, {}))
    return system


@with_each_solver(0.002)
def test_a_rope_breaks_once(solver):
    """While the winch pays out; braking it then pulls at the first portion with more than the breaking force."""
    system = hoist_of_four_falls(5400.0, solver)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for k in range(70):
            outputs = system.step(0.02, reel_out_speeds={"hoist": min(0.04 * k, 2.0)})
    sentence = r"the line (\S+): .*, broke .* under ([\d.]+) N"
    ((portion, force),) = re.findall(sentence, "\n".join(str(each.message) for each in told))
    assert portion == "hoist[4]"
    assert 5399.99 < float(force) < (5400.01 if solver is ADAPTIVE else 5420.0)
    assert outputs.lines["hoist"].break_time == pytest.approx(1.1, abs=0.02)  # backward Euler damps its swing


# --- winches, refusals


def broken_while(control, is_shared, solver):
    """A hoist whose winch moves until its rope breaks: outputs, energy from nowhere [J]."""
    name = "drum" if is_shared else "hoist"
    system = hoist_of_four_falls(5300.0 if control == "force" else 5550.0, solver, control, is_shared)

    def inputs(time):
        return {
            "speed": {"reel_out_speeds": {name: 1.5 * np.sin(4.0 * time)}},
            "force": {"winch_forces": {name: 5100.0 + 3000.0 * time}},
            "length": {"winch_lengths": {name: 80.0 * (not is_shared) + 0.8 * np.sin(3.0 * time)}},
        }[control]

    residual, _ = unexplained(
        system, 0.01, 200, inputs, lambda energy: (energy.total + energy.lines["hoist"].broken, energy.power)
    )
    return system.outputs(), residual


@pytest.mark.parametrize("is_shared", [False, True])
@pytest.mark.parametrize("control", ["speed", "force", "length"])
def test_any_winch_is_braked(control, is_shared):
    """In adaptive as in fixed steps; energy but for its sampling, of 200 kJ."""
    depths = []
    for solver in (ADAPTIVE, SECOND):
        outputs, residual = broken_while(control, is_shared, solver)
        assert outputs.lines["hoist"].broken
        assert outputs.lines["hoist"].winch_speed == 0.0
        assert outputs.portions["hoist"].length.sum() == pytest.approx(outputs.lines["hoist"].tether_length, abs=1e-9)
        assert abs(residual) < 200.0
        depths.append(outputs.points["block"].position[2])
    assert depths[0] < 0.0
    assert depths[1] == pytest.approx(depths[0], abs=0.1)


def test_a_step_in_which_the_end_passes_its_sheave_is_refused():
    """It breaks and runs off within one long step; shorter steps go on."""
    _, system = snapped()
    with pytest.raises(StepRefused, match="the end of the rope reached a sheave in a step of 2"):
        system.step(2.0)
    system.step(0.01)


# --- a rope that lets go at its last end

DRUM = Winch(winch_control="force", winch_mass=10.0, winch_damping=20.0)


@pytest.mark.parametrize(("solver", "within"), [(ADAPTIVE, 1e-4), (SECOND, 1e-4), (EULER, 1e-2)])
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
def test_a_rope_runs_off(sheave_mass, solver, within):
    """Payout in m; what is left is the stretch by the lost mass, 0.2 mm at the end of the rope, and of Euler its order."""
    scene = Atwood(sheave_mass, 20.0, 20.0)
    system = scene.system(solver)
    scene.right = 0.0
    low = system.outputs().points["b"].position[2]
    for k in range(50):
        outputs, time = system.step(0.02, releases={"rope": True}), 0.02 * (k + 1)
        assert outputs.portions["rope"].payout[0] == pytest.approx(scene.payout(time), abs=within)
    found, lost = outputs.portions["rope"], outputs.points["b"]
    assert abs(found.payout[0]) > 2.0
    behind, ahead, _ = scene.tensions(1.0)
    if solver is not EULER:
        assert (found.tension_to[0], found.tension_from[1]) == pytest.approx((behind, ahead), abs=0.02)
        assert lost.position[2] == pytest.approx(low - 0.5 * G, abs=1e-6)
    assert lost.velocity[2] == pytest.approx(-G, abs=1e-6)
    assert found.tension_to[1] == outputs.lines["rope"].kite_tension == 0.0
    assert outputs.lines["rope"].broken
    assert outputs.lines["rope"].break_time == 0.0


def hung(through, solver):
    """Nodes and forces of a rope from a winch over a sheave to an end below, which it lets go at 0.2 s; on one line or two.

    The tail carries more than the tension at its end, so that it stays taut.
    """
    points = [Point("a", (-7.0, 0.0, 0.0)), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, -10.0012))]
    of_rope = {**LIGHT, "axial_damping": 300.0, "drag": 1.0}
    if through:
        sheave = {"through": ["s"], "initial_portions": [7.0, 10.0], "sheave_friction": 5.0}
        lines = [Line("one", "a", "b", rope(17.0, **of_rope), **sheave)]
    else:
        lines = [Line("one", "a", "s", rope(7.0, **of_rope)), Line("two", "s", "b", rope(10.0, **of_rope))]
    system = TetherSystem(points, lines, solver=solver)
    system.initialize()
    found = []
    for k in range(50):
        moved = {"positions": {"b": (0.002 * k, 0.0, -10.0012)}, "velocities": {"b": (0.1, 0.0, 0.0)}}
        given = {"reel_out_speeds": {"one": 0.1 * np.sin(0.05 * k)}, "releases": {lines[-1].name: k >= 10}}
        outputs = system.step(0.02, **moved, **given)
        nodes = list(system.positions.values())
        nodes = nodes[0] if through else np.vstack([nodes[0], nodes[1][1:]])
        found.append(np.concatenate([nodes.ravel(), *(outputs.points[name].force for name in "asb")]))
    assert outputs.lines[lines[-1].name].broken
    return np.array(found)


@with_each_solver(0.002)
def test_a_rope_that_is_held_is_two_lines(solver):
    one, two = hung(True, solver), hung(False, solver)
    assert np.array_equal(one, two)
    assert np.all(one[12:, -3:] == 0.0)  # nothing pulls at the last point


@pytest.mark.parametrize(("solver", "within"), [(Solver(relative_tolerance=1e-6), 1e-8), (SECOND, 1e-4), (EULER, 1e-8)])
def test_a_line_of_a_drum_by_force(solver, within):
    """The drum reels in what is left; as the line with a winch of its own but for steps that backward Euler takes over."""
    found = [own_or_shared(is_shared, 20.0, solver, lets_go=True) for is_shared in (False, True)]
    assert found[0][20, 0] - found[0][-1, 0] > 1.5
    assert found[0] == pytest.approx(found[1], abs=within)


def test_releases_that_are_no_numbers():
    """They are refused as such, also where nothing could be let go of."""
    points = [Point("a", (0.0, 0.0, 0.0)), Point("s", (1.0, 0.0, 0.0)), Point("b", (3.0, 0.0, -4.0), mass=0.0)]
    system = TetherSystem(points, [Line("rope", "a", "b", rope(5.05, 4), through=["s"], initial_portions=[1.0, 4.05])])
    system.initialize()
    for value, said in (
        (np.nan, "rope.release is nan"),
        (np.inf, "rope.release is inf"),
        (True, "released end has no mass"),
    ):
        before = system.get_state()
        with pytest.raises(StepRefused, match=said):
            system.step(0.02, releases={"rope": value})
        assert np.array_equal(system.get_state(), before)


@with_each_solver(0.002)
def test_states_and_flights_over_the_event(solver):
    outputs = assert_continues(driven(2.0, solver, DRUM), lambda k: {"releases": {"rope": k >= 8}}, 5, 20)
    assert not outputs[7].lines["rope"].broken
    assert outputs[-1].lines["rope"].broken
