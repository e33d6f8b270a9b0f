"""Winches that hold several lines by force, and start with what they have to pay out until they are in balance.

straight   without gravity a line pulls EA (d/L - 1), so that the payout p solves sum of r T(L + r p) = W
a mass     between two lines of one winch: two equations more, of its balance
together   several winches, sheaves, winches of their own, ground: sum of r T = W at each, and all drums stay
sheaves    a winch over them, and beside them
own        a line with the ratio r at a drum with the mass m is as at a winch of its own with W/r, m/r2, c/r2, F/r
"""

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import over_sheaves
from over_sheaves import LIGHT, G
from shared_winches import rope
from tetherfmu import Environment, Ground, Line, Point, SharedWinch, StepRefused, Tether, TetherDynamic, TetherSystem, Winch

EA = 2e4  # [N]
SOFT = {"segments": 4, "diameter": 0.01, "mass_per_length": 0.3, "axial_stiffness": EA, "axial_damping": 100.0}
CALM = Environment(gravity=0.0)
# what moves drums: the rest of the search, 1e-10 of the largest tension, some 1e-7 N, on 5 kg or on a damper of 1 N s/m
STILL, PULL = 1e-6, 1e-9  # [m/s], of the sum of |r| T [-]


def drum(name, ratios, force, **more):
    """A winch by force that starts in equilibrium."""
    return SharedWinch(name, ratios, "force", winch_force=force, winch_start="equilibrium", **more)


def assert_in_balance(system, seconds=1.0, **inputs):
    """At its start sum of r T is the force of each winch, and the drums stay for some seconds; its first outputs."""
    start = system.initialize(**inputs)
    for winch in system.winches:
        pulls = {name: ratio * start.lines[name].ground_tension for name, ratio in winch.lines.items()}
        for name in pulls.keys() & start.portions.keys():
            pulls[name] = winch.lines[name] * start.portions[name].tension_from[0]
        size = sum(map(abs, pulls.values()))
        assert sum(pulls.values()) == pytest.approx(winch.winch_force, abs=PULL * size)
    for _ in range(round(seconds / 0.02)):
        outputs = system.step(0.02)
        assert all(abs(each.winch_speed) < STILL for each in outputs.winches.values())
        assert all(abs(each.winch_speed) < STILL for each in outputs.lines.values())
    return start


@pytest.mark.parametrize(
    "more", [{"winch_mass": 20.0}, {}, {"winch_mass": 5.0, "winch_friction": 40.0, "winch_damping": 3.0}]
)
@pytest.mark.parametrize(("force", "given"), [(300.0, 10.0), (2000.0, 12.5), (80.0, 9.0)])
def test_straight_lines(force, given, more):
    """Also of a drum without mass, and of one with friction, which is in balance without it."""
    ends, ratios = {"a": (-6.0, 0.0, 9.0), "b": (5.0, 1.0, 9.0)}, {"a": 1.0, "b": 0.5}
    points = [Point("top", (0.0, 0.0, 0.0)), *(Point(f"at_{name}", place) for name, place in ends.items())]
    lines = [Line(name, "top", f"at_{name}", rope(given, **SOFT)) for name in ends]
    system = TetherSystem(points, lines, CALM, winches=[drum("drum", ratios, force, **more)])
    start = assert_in_balance(system)

    def excess(payout):
        spans = {name: np.linalg.norm(place) for name, place in ends.items()}
        tensions = {name: EA * max(0.0, spans[name] / (given + r * payout) - 1.0) for name, r in ratios.items()}
        return sum(r * tensions[name] for name, r in ratios.items()) - force

    assert start.winches["drum"].payout == pytest.approx(brentq(excess, -6.0, 6.0, xtol=1e-13), abs=1e-9)


@pytest.mark.parametrize("side", [0.0, 60.0])
def test_a_mass_between_two_lines(side):
    """It starts in equilibrium, too; the winch pays out one line as it reels in the other."""
    load, force, given = np.array((side, -400.0)), 50.0, np.array((8.5, 8.5))
    anchors = np.array([(-6.0, 0.0), (6.0, 0.0)])
    points = [Point(name, (x, 0.0, z)) for name, (x, z) in zip(("left", "right"), anchors, strict=True)]
    points.append(Point("mass", mass=40.0))
    lines = [Line(name, end, "mass", rope(8.5, **SOFT)) for name, end in (("a", "left"), ("b", "right"))]
    system = TetherSystem(points, lines, CALM, winches=[drum("drum", {"a": 1.0, "b": -1.0}, force, winch_mass=10.0)])
    start = assert_in_balance(system, loads={"mass": (load[0], 0.0, load[1])})

    def balance(unknown):
        x, payout = unknown[:2], unknown[2]
        ways = anchors - x
        spans = np.linalg.norm(ways, axis=1)
        tensions = EA * (spans / (given + payout * np.array((1.0, -1.0))) - 1.0)
        return *(load + (tensions / spans) @ ways), tensions[0] - tensions[1] - force

    x, z, payout = fsolve(balance, (0.0, -6.0, 0.0), xtol=1e-14)
    assert start.winches["drum"].payout == pytest.approx(payout, abs=1e-8)
    assert start.points["mass"].position == pytest.approx((x, 0.0, z), abs=1e-8)


def test_two_winches_a_sheave_the_ground_and_a_winch_of_a_line():
    """All start together, one line of both winches on the ground, one over a sheave, one with a winch of its own."""
    points = [Point("ship", (0.0, 0.0, 0.0)), Point("anchor", (40.0, 0.0, -20.0)), Point("buoy", (-30.0, 5.0, -4.0))]
    points += [Point("block", (0.0, 3.0, 12.0)), Point("quay", (20.0, 20.0, 2.0)), Point("kite", (10.0, 0.0, 60.0))]
    own = {**SOFT, "axial_stiffness": 1e5}
    lines = [Line("mooring", "ship", "anchor", rope(48.0, **{**own, "mass_per_length": 2.0, "segments": 12}))]
    lines += [
        Line("guy", "ship", "buoy", rope(31.0, **own)),
        Line("fall", "ship", "quay", rope(38.0, **own), through=["block"]),
    ]
    balanced = Winch(winch_control="force", winch_start="equilibrium", winch_mass=10.0)
    lines.append(Line("tether", "ship", "kite", rope(63.0, **own), winch=balanced))
    winches = [
        drum("one", {"mooring": 1.0, "guy": 0.5}, 500.0, winch_mass=20.0),
        drum("two", {"guy": -0.7, "fall": 1.0, "mooring": 0.2}, 700.0, winch_damping=1.0),
    ]
    system = TetherSystem(points, lines, Environment(), ground=Ground("flat", -20.0), winches=winches)
    start = assert_in_balance(system, winch_forces={"tether": 900.0})
    assert start.lines["mooring"].grounded_length > 1.0
    assert start.lines["tether"].ground_tension == pytest.approx(900.0, rel=PULL)
    fall = start.portions["fall"]
    assert fall.tension_to[0] == pytest.approx(fall.tension_from[1], rel=PULL)


@pytest.mark.parametrize("through", [(), ("s",)])
def test_a_mass_on_lines_of_two_winches(through):
    """With gravity, and with a sheave: where rope runs on as well as drums, a mass that hangs, a line with both winches."""
    points = [Point("left", (-20.0, 0.0, 0.0)), Point("s", (-2.0, 8.0, 3.0)), Point("right", (20.0, 0.0, 0.0))]
    points += [Point("far", (0.0, 20.0, 5.0)), Point("mass", mass=80.0)]
    ends = {"a": ("left", through), "b": ("right", ()), "c": ("far", ()), "d": ("s", ())}
    lines = [Line(name, end, "mass", rope(28.0 if own else 24.0, **SOFT), through=own) for name, (end, own) in ends.items()]
    winches = [
        drum("one", {"a": 1.0, "b": -1.0}, 20.0, winch_mass=20.0),
        drum("two", {"a": 0.5, "c": 1.0}, 900.0, winch_mass=20.0),
    ]
    start = assert_in_balance(TetherSystem(points, lines, winches=winches))
    assert start.points["mass"].velocity == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize("given", [11.0, 40.0, 400.0])
def test_wherever_the_search_begins(given):
    """Also with lines that hang far down: the lengths are those with which given lines pull so much."""

    def system(length, **more):
        points = [Point("top", (0.0, 0.0, 0.0)), Point("a", (-6.0, 0.0, 9.0)), Point("b", (5.0, 1.0, -9.0))]
        lines = [Line(f"to_{name}", "top", name, rope(length, **SOFT)) for name in "ab"]
        winch = SharedWinch("drum", {"to_a": 1.0, "to_b": 1.0}, "force", winch_force=300.0, winch_mass=10.0, **more)
        return TetherSystem(points, lines, winches=[winch])

    def excess(length):
        return sum(each.ground_tension for each in system(length).initialize().lines.values()) - 300.0

    start = assert_in_balance(system(given, winch_start="equilibrium"), 0.1)
    assert start.winches["drum"].payout + given == pytest.approx(brentq(excess, 10.4, 11.0, xtol=1e-12), abs=1e-9)


MOVING = {"winch_mass": 12.0, "winch_damping": 40.0, "winch_friction": 30.0}


@pytest.mark.parametrize("start", ["given", "equilibrium"])
@pytest.mark.parametrize("speed", [0.0, 0.6, -0.4])
@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_as_with_a_winch_of_its_own(ratio, speed, start):
    """Bit for bit with the ratio 1; with another one the search is another, and so is rounding."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (30.0, 0.0, 40.0))]
    tether, force = rope(52.0, **{**SOFT, "axial_damping": 1.0}), 400.0
    own = Winch(winch_control="force", winch_start=start, **MOVING)
    alone = TetherSystem(points, [Line("line", "ground", "kite", tether, speed, own)])
    powers = {"winch_mass": 2, "winch_damping": 2, "winch_friction": 1}
    scaled = {name: MOVING[name] * ratio**power for name, power in powers.items()}
    held = SharedWinch("drum", {"line": ratio}, "force", speed / ratio, ratio * force, **scaled, winch_start=start)
    shared = TetherSystem(points, [Line("line", "ground", "kite", tether)], winches=[held])
    found = [alone.initialize(winch_forces={"line": force}), shared.initialize()]
    assert found[1].winches["drum"].winch_speed == pytest.approx(speed / ratio, abs=1e-15)
    within = 0.0 if ratio == 1.0 and start == "equilibrium" else 1e-9
    assert abs(found[0].lines["line"].tether_length - found[1].lines["line"].tether_length) <= within
    for _ in range(25):
        one, other = alone.step(0.02), shared.step(0.02)
        assert other.lines["line"].tether_length == pytest.approx(one.lines["line"].tether_length, abs=2e-6)
    if start == "equilibrium" and speed != 0.0:
        pulled = found[1].lines["line"].ground_tension
        assert pulled == pytest.approx(
            force + 40.0 * speed + 30.0 * np.sign(speed), rel=5e-4
        )  # but for the momentum of the rope


@pytest.mark.parametrize("control", ["length", "force"])
def test_a_start_speed_with_several_lines(control):
    """Each line starts with its ratio times it, the sum of that of both winches."""
    points = [
        Point("pod", (0.0, 0.0, 0.0)),
        Point("left", (-2.0, 0.0, 10.0)),
        Point("right", mass=20.0, position=(2, 0, 10)),
    ]
    lines = [Line(name, "pod", end, rope(10.3, **SOFT)) for name, end in (("a", "left"), ("b", "right"))]
    ratios = {"one": {"a": 1.0, "b": -1.0}, "two": {"a": 1.0, "b": 0.5}}
    more = {"winch_mass": 1e6} if control == "force" else {}
    winches = [SharedWinch(name, held, control, 0.3, **more) for name, held in ratios.items()]
    system = TetherSystem(points, lines, CALM, winches=winches)
    start = system.initialize(reel_out_speeds={"two": 0.2})
    wanted = {"a": 0.3 + 0.2, "b": -0.3 + 0.1}
    for name, speed in wanted.items():
        assert start.lines[name].winch_speed == pytest.approx(speed, abs=1e-14)
    assert [start.winches[name].winch_speed for name in ratios] == pytest.approx([0.3, 0.2], abs=1e-14)
    outputs = system.step(0.02)
    for name, speed in wanted.items():
        assert outputs.lines[name].tether_length - 10.3 == pytest.approx(0.02 * speed, abs=1e-6)
        assert outputs.lines[name].winch_speed == pytest.approx(speed, abs=2e-4)
    again = system.initialize(reel_out_speeds={"one": 0.0, "two": 0.0})
    assert again.lines["a"].winch_speed == 0.0


def test_what_has_no_balance_is_refused_in_words():
    """A force below the weight of the ropes; a load on all lines of a winch, which pull alike at any length."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("a", (-6.0, 0.0, -9.0)), Point("b", (5.0, 1.0, -9.0))]
    lines = [Line(f"to_{name}", "top", name, rope(10.0, **SOFT)) for name in "ab"]
    held = {"to_a": 1.0, "to_b": 0.5}
    least = 1.5 * 0.3 * G * 9.0  # of ropes that hang down from the drum
    said = (
        r"the line to_a: no lengths of the lines that its winch holds .* "
        r"drum\.winch_force, {} N, with drum\.winch_start 2 .*"
    )
    with pytest.raises(StepRefused, match=said.format(0.9 * least)):
        TetherSystem(points, lines, winches=[drum("drum", held, 0.9 * least)]).initialize()
    system = TetherSystem(points, lines, winches=[drum("drum", held, 300.0)])
    with pytest.raises(StepRefused, match=r"the line to_a: the input drum\.winch_force is nan; it must be a finite number"):
        system.initialize(winch_forces={"drum": np.nan})
    hanging = [points[0], Point("top_b", (1.0, 0.0, 0.0)), Point("load", mass=50.0)]
    lines = [Line("to_a", "top", "load", rope(10.0, **SOFT)), Line("to_b", "top_b", "load", rope(10.0, **SOFT))]
    system = TetherSystem(hanging, lines, winches=[drum("drum", {"to_a": 1.0, "to_b": 1.0}, 300.0)])
    with pytest.raises(StepRefused, match=said.format(300.0)):
        system.initialize()
    with pytest.raises(StepRefused, match="initialize"):
        system.step(0.02)
    system = TetherSystem(
        hanging, [*lines[:1], Line("b", "top_b", "load", rope(10.0, **SOFT))], winches=[drum("d", {"to_a": 1.0}, 9.0)]
    )
    said = r"the line to_a: d\.winch_start is 2 .* and a free end starts in equilibrium, too"
    with pytest.raises(StepRefused, match=said):
        system.initialize()


# --- over sheaves, and beside them

BALANCED = Winch(winch_control="force", winch_start="equilibrium", winch_mass=20.0)


@pytest.mark.parametrize("given", [41.0, 52.0, 80.0])
@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_a_winch_over_sheaves_starts_in_balance(gravity, given):
    """The rope pulls with the force, and the drum stays; without gravity it is as long as straight: d/(1 + W/EA)."""
    places = np.array([(-8.0, 0.0, 0.0), (0.0, 0.0, 6.0), (1.0, 0.0, -14.0), (3.0, 0.0, 6.0)])
    points = [Point(name, place) for name, place in zip(("winch", "head", "foot", "anchor"), places, strict=True)]
    tether = over_sheaves.rope(given, 4, diameter=0.01, mass_per_length=0.3, axial_stiffness=2e4)
    line = Line("rope", "winch", "anchor", tether, winch=BALANCED, through=["head", "foot"])
    system = TetherSystem(points, [line], Environment(gravity=gravity))
    start = system.initialize(winch_forces={"rope": 200.0})
    assert start.portions["rope"].tension_from[0] == pytest.approx(200.0, rel=1e-9)
    assert start.portions["rope"].tension_to[:-1] == pytest.approx(start.portions["rope"].tension_from[1:], rel=1e-9)
    if gravity == 0.0:
        spans = np.linalg.norm(np.diff(places, axis=0), axis=1)
        assert start.portions["rope"].length == pytest.approx(spans / (1.0 + 200.0 / 2e4), rel=1e-8)
    for _ in range(10):
        outputs = system.step(0.02)
    assert abs(outputs.lines["rope"].winch_speed) < 1e-6
    assert outputs.lines["rope"].tether_length == pytest.approx(start.lines["rope"].tether_length, abs=1e-7)


@pytest.mark.parametrize("beside", ["line", "sheave", "shared winch"])
def test_a_line_beside_others_starts_as_alone(beside):
    """Also beside a sheave, and beside a winch that holds a line by force."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (300.0, 0.0, 400.0)), Point("end", (5.0, 100.0, 0.0))]
    points += [Point("s", (0.0, 50.0, 9.0))] if beside == "sheave" else []
    tether, through = Tether(initial_length=600.0), ["s"] if beside == "sheave" else []
    lines = [Line("main", "ground", "kite", tether, winch=BALANCED)]
    lines.append(Line("guy", "ground", "end", over_sheaves.rope(111.0, 4, **LIGHT), through=through))
    winches = [SharedWinch("drum", {"guy": 1.0}, "force")] if beside == "shared winch" else []
    system = TetherSystem(points, lines, winches=winches)
    start = system.initialize(winch_forces={"main": 3000.0})
    alone = TetherDynamic(tether, winch=BALANCED).initialize(winch_force=3000.0)
    assert start.lines["main"].tether_length == alone.tether_length
    assert abs(system.step(0.02, winch_forces={"main": 3000.0}).lines["main"].winch_speed) < 1e-3


def test_a_rope_and_a_point_at_it_cannot_both_be_sought():
    """Nor is there a length with which the rope pulls with less than its weight."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("block", mass=200.0), Point("anchor", (1.0, 0.0, 30.0))]
    line = Line("hoist", "winch", "anchor", over_sheaves.rope(40.0, 4, **LIGHT), winch=BALANCED, through=["block"])
    with pytest.raises(StepRefused, match="the line hoist: winch_start is 2"):
        TetherSystem(points, [line]).initialize(winch_forces={"hoist": 1000.0})
    points[1] = Point("block", (0.5, 0.0, 10.0), mass=200.0)
    system = TetherSystem(points, [line])
    with pytest.raises(StepRefused, match=r"no lengths of the portions were found .* pulls with winch_force"):
        system.initialize(winch_forces={"hoist": 10.0})
    weight = 200.0 * 9.81
    start = system.initialize(winch_forces={"hoist": 0.5 * weight + 40.0})
    assert start.portions["hoist"].tension_to[0] == pytest.approx(0.5 * weight, rel=2e-3)
