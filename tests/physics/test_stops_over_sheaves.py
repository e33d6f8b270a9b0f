"""Drums of ropes over sheaves that stop at the shortest and longest length of the whole rope, with each solver.

oracle     a load on a light rope over a sheave with mass, with a heavy sling, too: equations written here, solved by DOP853.
           The drum stops without a bounce (L' = 0), and is let go when the rope pulls less than W at the longest length, or
           more than W at the shortest
winch      a drum that is pressed against its stop is a winch at rest, to rounding: with losses, on the ground, limp, broken,
           released
start      a balance beyond a stop is a start at this stop
energy     at a stop never exceeds that of the start, of the winch and of the rope that leaves it
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from of_systems import assert_continues
from over_sheaves import LIGHT, G, rope
from random_sheaves import random_winches
from solvers import ADAPTIVE, METHODS, fixed, with_each_solver
from tetherfmu import Environment, Ground, Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # loads that stop at once
STEP = 0.02

# --- a solver of its own

EA, DAMPING, DRUM, SHEAVE, LOAD = 2e4, 40.0, 5.0, 0.5, 20.0  # [N], [N.s], then masses [kg]
EA_SLING, SLING, KNOT = 1e5, 2.0, 3.0  # of the sling: [N], length [m], half of its mass [kg]
NO_MASS = {"diameter": 1e-4, "mass_per_length": 1e-9, "drag_coefficient": 0.0, "slack_stiffness_ratio": 0.0}


def hoist(solver, has_sling, **stops):
    """A load at 12 m of rope, of which the last 2 m may be a sling, beyond a sheave, which is 8 m from the winch."""
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -12.05), mass=LOAD)]
    beyond = SLING if has_sling else 0.0
    tethers = [Tether(segments=1, initial_length=20.0 - beyond, axial_stiffness=EA, axial_damping=DAMPING, **NO_MASS)]
    if has_sling:
        heavy = {**NO_MASS, "diameter": 0.02, "mass_per_length": 2.0 * KNOT / SLING}
        tethers.append(Tether(segments=1, initial_length=SLING, axial_stiffness=EA_SLING, axial_damping=0.0, **heavy))
    winch = Winch(winch_control="force", winch_mass=DRUM, **stops)
    sheave = {"through": ["head"], "initial_portions": [8.0, 12.0], "sheave_mass": SHEAVE}
    return TetherSystem(points, [Line("rope", "winch", "load", tuple(tethers), winch=winch, **sheave)], solver=solver)


def pulls(stretched, length, rate, growth):
    """Tension of a segment, and tension where rope enters it [N]; with their rates [m/s]."""
    if stretched < length:
        return 0.0, 0.0
    damper = DAMPING / length * (rate - stretched / length * growth)
    pull = EA * (stretched**2 / length**2 - 1.0) / 2.0 + damper * stretched / length
    return EA * (stretched / length - 1.0) + damper, 2.0 * pull / (1.0 + np.sqrt(1.0 + 2.0 * pull / EA))


def rates(state, is_held, force, has_sling):
    """Rates of the heights of load and end of the rope, of L and of the rope over the sheave, and of their speeds."""
    load, end, length, passed, climb, rise, speed, running = state
    _, behind = pulls(8.0, length - passed - 12.0, 0.0, speed - running)
    tension, ahead = pulls(-end, 12.0 - has_sling * SLING + passed, -rise, running)
    gained = [tension / LOAD - G] * 2
    if has_sling:
        below = max(EA_SLING * ((end - load) / SLING - 1.0), 0.0)
        gained = [below / (LOAD + KNOT) - G, (tension - below) / KNOT - G]
    turning = (0.0, 0.0) if is_held else (speed, (behind - force) / DRUM)
    return climb, rise, turning[0], running, *gained, turning[1], (ahead - behind) / SHEAVE


def solved(force, times, heights, has_sling, shortest_length=0.0, longest_length=np.inf):
    """Height of the load, L and rope over the sheave at these times [s], and the times of the events.

    force : W [N] over time.  heights : of load and end of the rope at the start [m].
    """
    state, now, side, found, events = np.array((*heights, 20.0, *5 * [0.0])), 0.0, 0, [], []

    def excess(time, state, *_):
        _, tension = pulls(8.0, state[2] - state[3] - 12.0, 0.0, -state[7])
        return tension - force(time)

    def reaching(stop, direction):
        def left(_, state):
            return state[2] - stop

        left.terminal, left.direction = True, direction
        return left

    excess.terminal = True
    stops = [reaching(longest_length, 1.0), reaching(shortest_length, -1.0)]
    while now < times[-1]:
        excess.direction = -side
        piece = solve_ivp(
            lambda time, state, held=side: rates(state, held, force(time), has_sling),
            (now, times[-1]), state, "DOP853", events=[excess] if side else stops,
            rtol=1e-11, atol=1e-12, dense_output=True, max_step=0.001,
        )  # fmt: skip
        found += [piece.sol(time)[[0, 2, 3]] for time in times if now < time <= piece.t[-1]]
        now, state = piece.t[-1], piece.y[:, -1]
        if piece.status == 1:
            events.append(now)
            side = 0 if side else (1 if len(piece.t_events[0]) else -1)
            state[6] = 0.0
            side = side if excess(now, state) * side > 0.0 else 0
    return np.array(found), events


def flown(system, force, times):
    """As `solved`, of a system that steps from each of these times, which are equally apart, to the next."""
    start, found = system.initialize(winch_forces={"rope": force(0.0)}), []
    heights = start.points["load"].position[2], system.positions["rope"][2][2]
    for time in times:
        outputs = system.step(times[0], winch_forces={"rope": force(time - times[0])})
        line, own = outputs.lines["rope"], outputs.portions["rope"]
        found.append((outputs.points["load"].position[2], line.tether_length, own.payout[0]))
    return np.array(found), heights


STOPS = {"shortest_length": 19.0, "longest_length": 20.6}
SCENES = {  # stops, W [N] over time, steps, events; errors: adaptive, in fixed steps of 4 ms
    "constant": (STOPS, lambda _: 120.0, 150, 5, 2e-6, 1e-3),
    "ramp": (STOPS, lambda time: 140.0 + 80.0 * time if time >= STEP else 140.0, 150, 2, 2e-6, 0.01),
    "sling": ({"longest_length": 20.4}, lambda _: 20.0, 45, 1, 1e-6, 5e-3),
}


@pytest.mark.parametrize("name", SCENES)
def test_against_a_solver_of_its_own(name):
    """The drum stops at up to 2.8 m/s, bounces not, and is drawn away; the ramp reels in to the shortest length.

    Error 8e-8 m until the rope goes slack, which makes the sheave swing. L counts the sling, too.
    """
    stops, force, steps, count, within, coarse_within = SCENES[name]
    times = STEP * np.arange(1, steps + 1)
    tight, *in_steps = (Solver(relative_tolerance=1e-9), *(fixed(h, "second_order") for h in (0.004, 0.0005)))
    found, heights = flown(hoist(tight, name == "sling", **stops), force, times)
    exact, events = solved(force, times, heights, name == "sling", **stops)
    assert len(events) == count
    assert np.abs(found - exact).max() < within
    assert found[:, 1].max() <= stops["longest_length"] * (1.0 + 1e-9)
    flights = (flown(hoist(solver, name == "sling", **stops), force, times)[0] for solver in in_steps)
    coarse, fine = (np.abs(each - exact).max() for each in flights)
    assert fine < 0.4 * coarse < coarse_within


def test_backward_euler_against_a_solver_of_its_own():
    """Order 1 with the constant force; the ramp turns the drum round so close to its stop that it needs steps of 0.1 ms."""
    times, force, errors = STEP * np.arange(1, 151), SCENES["constant"][1], []
    for step in (0.002, 5e-4):
        found, heights = flown(hoist(fixed(step, "backward_euler"), False, **STOPS), force, times)
        errors.append(np.abs(found - solved(force, times, heights, False, **STOPS)[0]).max())
    assert errors[1] < 0.3 * errors[0] < 0.01


@with_each_solver()
def test_a_state_of_a_hoist_with_a_sling_is_restored(solver):
    system = hoist(solver, True, longest_length=20.4)
    system.initialize(winch_forces={"rope": 100.0})
    assert_continues(system, lambda _: {}, 10, 40)


# --- a drum at its stop is a winch at rest

LENGTH = 32.5  # of a `reeved` rope [m]
RESTING = {"winch_mass": 3.0, "winch_damping": 20.0}
OF_ROPE = {**LIGHT, "axial_damping": 300.0}
HOISTS = {  # keywords of the line, of the tether, of the system
    "two falls": ({}, {}, {}),
    "capstan": ({"sheave_friction": 0.2, "sheave_mass": 2.0}, {}, {}),
    "efficiency": ({"sheave_efficiency": 0.9, "sheave_mass": 0.5}, {}, {}),
    "ground": ({"sheave_mass": 1.0}, {}, {"ground": Ground(ground_contact="flat", ground_height=-14.2)}),
    "limp": ({}, {"slack_stiffness_ratio": 0.0}, {"environment": Environment(gravity=0.0)}),
    "broken": ({"sheave_mass": 1.0}, {"breaking_force": 400.0}, {}),
}


def reeved(kind, winch, solver):
    """A load on two falls; the rope runs from the winch over a head, too."""
    of_line, of_tether, of_system = HOISTS[kind]
    points = [Point("winch", (-8.0, 0.0, -3.0)), Point("head", (0.0, 0.0, 0.0)), Point("load", (0.7, 0.0, -12.0), mass=60.0)]
    points.append(Point("anchor", (1.5, 0.0, 0.0)))
    tether = rope(LENGTH, 4, **{**OF_ROPE, **of_tether})
    line = Line("rope", "winch", "anchor", tether, winch=winch, through=["head", "load"], **of_line)
    return TetherSystem(points, [line], solver=solver, **of_system)


@with_each_solver(0.005)
@pytest.mark.parametrize("kind", HOISTS)
def test_a_drum_at_its_stop_is_a_winch_at_rest(kind, solver):
    """Pushed, lifted until the rope is slack, and dropped: the drum holds what the rope draws, and reels nothing in."""
    held = reeved(kind, Winch(winch_control="force", longest_length=LENGTH, **RESTING), solver)
    still = reeved(kind, Winch(), solver)
    held.initialize(winch_forces={"rope": -500.0})  # the motor pays out
    still.initialize()
    for k in range(60):
        loads = {"load": (20.0 * np.sin(0.3 * k), 5.0, 900.0 if 20 <= k < 40 else 0.0)}
        release = {"rope": kind == "capstan" and k >= 45}
        one, other = (system.step(STEP, loads=loads, releases=release) for system in (held, still))
        np.testing.assert_allclose(held.positions["rope"], still.positions["rope"], rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(one.portions["rope"].payout, other.portions["rope"].payout, rtol=0.0, atol=1e-12)
        assert one.lines["rope"].winch_speed == 0.0
    assert one.lines["rope"].broken == (kind in ("broken", "capstan"))
    assert np.abs(one.portions["rope"].payout).max() > 1e-3


# --- start, energy


START = {"winch_control": "force", "winch_start": "equilibrium", "winch_mass": 5.0}


@pytest.mark.parametrize(
    ("stops", "length"),
    [({"longest_length": 19.7}, 19.7), ({"shortest_length": 19.9}, 19.9), ({"longest_length": 20.5}, 20.0 / 1.01)],
)
@pytest.mark.parametrize("given", [19.0, 19.8, 21.0])
def test_a_balance_beyond_a_stop_starts_at_the_stop(given, stops, length):
    """Straight without gravity: T = EA (d/L - 1) is the winch force at d/(1 + W/EA); the drum stays where it starts."""
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), Point("anchor", (0.0, 0.0, -12.0))]
    line = Line("rope", "winch", "anchor", rope(given, 3, **LIGHT), winch=Winch(**START, **stops), through=["head"])
    system = TetherSystem(points, [line], Environment(gravity=0.0))
    start = system.initialize(winch_forces={"rope": 1000.0})
    assert start.lines["rope"].tether_length == pytest.approx(length, rel=1e-9)
    tension = LIGHT["axial_stiffness"] * (20.0 / length - 1.0)
    assert start.portions["rope"].tension_to == pytest.approx([tension] * 2, rel=1e-6)
    for _ in range(10):
        outputs = system.step(STEP)
    assert outputs.lines["rope"].tether_length == pytest.approx(length, rel=1e-9)


def test_a_rope_that_runs_out_starts_at_the_longest_length():
    """Heavy rope pulls with more than the winch force at any length, which is refused without a stop."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("block", (0.5, 0.0, 10.0), mass=200.0), Point("end", (1.0, 0.0, 30.0))]
    line = Line("rope", "winch", "end", rope(40.0, 4, **LIGHT), winch=Winch(**START), through=["block"])
    with pytest.raises(StepRefused, match="no lengths of the portions"):
        TetherSystem(points, [line]).initialize(winch_forces={"rope": 10.0})
    system = TetherSystem(points, [replace(line, winch=replace(line.winch, longest_length=45.0))])
    start = system.initialize(winch_forces={"rope": 10.0})
    assert start.lines["rope"].tether_length == pytest.approx(45.0, rel=1e-12)
    assert start.portions["rope"].tension_to[0] == pytest.approx(start.portions["rope"].tension_from[1], rel=1e-9)


def test_what_is_refused():
    """A given length beyond a stop, of all portions together."""
    line = reeved("two falls", Winch(winch_control="force", longest_length=32.0), ADAPTIVE)
    with pytest.raises(StepRefused, match=r"the line rope: the unstretched length is 32\.5 m at the start, beyond a stop"):
        line.initialize()


@with_each_solver(0.005)
def test_a_state_is_restored(solver):
    """At a stop and away from it."""
    system = reeved("capstan", Winch(winch_control="force", shortest_length=32.4, longest_length=32.7, **RESTING), solver)
    system.initialize(winch_forces={"rope": 200.0})
    outputs = assert_continues(system, lambda k: {"winch_forces": {"rope": 300.0 + 350.0 * np.sin(0.1 * k)}}, 25, 75)
    lengths = [each.lines["rope"].tether_length for each in outputs]
    assert (min(lengths), max(lengths)) == pytest.approx((32.4, 32.7), rel=1e-9)


def gained(drum, segments, density, is_outer, solver):
    """Largest energy beyond that at the start and what the winch gave over the work of the winch, in 2 s at a stop."""
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -12.0), mass=20.0)]
    stiff = {"axial_stiffness": 6.9e5, "axial_damping": 473.0, "slack_stiffness_ratio": 0.0, "diameter": 0.004}
    stop = {"longest_length": 22.0} if is_outer else {"shortest_length": 18.0}
    winch = Winch(winch_control="force", winch_mass=drum, **stop)
    tether = rope(20.0, segments, mass_per_length=density, **stiff)
    line = Line("rope", "winch", "load", tether, winch=winch, through=["head"])
    system, force = TetherSystem(points, [line], solver=solver), 20.0 * G * (0.6 if is_outer else 1.4)
    start = system.initialize(winch_forces={"rope": force}) and system.energy().total
    brought, speed, most = 0.0, 0.0, 0.0
    for _ in range(200):
        own = system.step(0.01).lines["rope"]
        brought += 0.01 * 0.25 * density * max(speed**3 + own.winch_speed**3, 0.0)  # by rope that leaves the winch
        speed = own.winch_speed
        energy = system.energy().total + 0.5 * drum * speed**2
        most = max(most, energy - start - brought - force * (20.0 - own.tether_length))
    assert own.tether_length == pytest.approx(22.0 if is_outer else 18.0, rel=0.2)
    return most / (force * 2.0)


@pytest.mark.parametrize("solver", [ADAPTIVE, *(fixed(h, method) for h in (0.002, 0.01) for method in METHODS)])
@pytest.mark.parametrize("is_outer", [True, False])
def test_a_stop_makes_no_energy(is_outer, solver):
    """At most 1e-3 of the work of the winch, with light and heavy drums and ropes, which bounce at their stop."""
    scenes = [(drum, segments, density) for drum, density in ((0.0, 0.1), (10.0, 0.009)) for segments in (1, 4)]
    found = [gained(*scene, is_outer, solver) for scene in scenes]
    assert max(found) < 1e-3


# --- random systems


def random_stops(seed):
    """As `random_winches`, all ropes on drums with stops close to their lengths."""
    scene = random_winches(np.random.default_rng((21, seed)))
    rng, found = np.random.default_rng((22, seed)), []
    for line in scene.lines:
        if line.through:
            length = line.tether.initial_length
            short, long, mass = rng.uniform(0.97, 0.999), rng.uniform(1.001, 1.03), float(rng.choice((0.0, 5.0)))
            stops = {"shortest_length": length * short, "longest_length": length * long}
            line = replace(line, winch=Winch(winch_control="force", winch_mass=mass, winch_damping=30.0, **stops))
        found.append(line)
    scene.lines = found
    return scene


@pytest.mark.parametrize("solver", [ADAPTIVE, *(fixed(0.005, method) for method in METHODS)])
def test_random_ropes_stay_between_their_stops(solver):
    """Beside winches of several lines: no longer and no shorter, at rest at a stop where it is pressed against it."""
    reached = 0
    for seed in range(16):
        scene = random_stops(seed)
        system, ropes = scene.started(solver), [line for line in scene.lines if line.through]

        for k in range(40):
            outputs = system.step(0.01, **scene.told(0.01 * k))
            for line in ropes:
                own, winch = outputs.lines[line.name], line.winch
                assert winch.shortest_length * (1.0 - 1e-6) <= own.tether_length <= winch.longest_length * (1.0 + 1e-6)
                stops = winch.shortest_length, winch.longest_length
                at_stop = own.tether_length in (pytest.approx(each, rel=1e-9) for each in stops)
                reached += at_stop and own.winch_speed == 0.0
    assert reached > 50
