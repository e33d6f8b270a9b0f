"""A line that runs over sheaves (docs/models/theory.md, "Sheaves"), against formulas; most with adaptive and fixed steps.

atwood     two masses on a heavy rope: (m1 + m2 + mu L + J/r2) a = (m2 - m1 + mu (L2 - L1)) g, so that the payout grows as a
           hyperbolic cosine; on each side T = (m + mu l)(g -+ a) at the sheave
capstan    the rope is held until the tensions differ by e^(friction wrap), and runs with (T2 - mu u^2) = e^.. (T1 - mu u^2)
held       a line that friction holds is two lines, bit for bit
pulley     hangs where both falls have the same tension and the same angle
falls      a hook on n falls moves with 1/n of the speed of the rope, and each fall carries 1/n of the load
block      a portion stops before its segments get shorter than they may
frame      an observer who moves uniformly sees the same tensions
energy     what the powers do not explain falls with the square of the communication step
"""

import numpy as np
import pytest

from of_systems import assert_continues, unexplained
from over_sheaves import (
    LIGHT,
    SOFT,
    STIFF,
    WIRE,
    Atwood,
    G,
    block_system,
    corner,
    driven,
    flown_held,
    hanging_pulley,
    hoisted,
    moving,
    rope,
    slips_at,
)
from solvers import ADAPTIVE, fixed, with_each_solver
from tetherfmu import Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch

# --- Atwood's machine


@pytest.mark.filterwarnings("error", "ignore:.*backward Euler")
@pytest.mark.parametrize(
    ("solver", "within", "of_tension"),
    [(ADAPTIVE, 2e-4, 0.05), (fixed(0.01, "second_order"), 2e-4, 0.05), (fixed(0.002, "backward_euler"), 0.02, 3.0)],
)
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
@pytest.mark.parametrize("chain", [0.0, WIRE["mass_per_length"], 5.0])
def test_atwood(chain, sheave_mass, solver, within, of_tension):
    """Payout [m] and tensions [N] in 2 s; left are waves along the rope, which is not rigid, and backward Euler's order.

    Rope that runs further in a step than it is stretched is not taken for slack: it is not warned of, and stays straight. A
    chain of the rope's density is a longer rope.
    """
    atwood = Atwood(sheave_mass, 30.0, 20.0, WIRE, chain) if chain else Atwood(sheave_mass)
    system = atwood.system(solver)
    for k in range(100):
        found, time = system.step(0.02).portions["rope"], 0.02 * (k + 1)
        assert found.payout[0] == pytest.approx(atwood.payout(time), abs=within)
        assert found.length == pytest.approx([10.0 - found.payout[0], 10.0 + found.payout[0]], abs=1e-12)
        if time > 0.5:
            pulls = found.tension_to[0], found.tension_from[1], found.tension_to[1]
            assert pulls == pytest.approx(atwood.tensions(time), abs=of_tension)
    assert found.speed[0] == pytest.approx(atwood.speed(time), abs=5.0 * within)
    assert abs(found.payout[0]) > 1.0
    assert not system.positions["rope"][:, :2].any()
    assert system.counters["rejections"] == 0 or solver is ADAPTIVE


# --- friction


@with_each_solver()
@pytest.mark.parametrize("part", [0.99, 1.01])
def test_capstan(part, solver):
    """The ratio to 1e-12, of rounding; below the onset nothing moves."""
    ratio = np.exp(0.3 * np.pi / 2.0)
    system = corner(100.0 * ratio * part, friction=0.3, solver=solver)
    for _ in range(50):
        found = system.step(0.02).portions["rope"]
    if part < 1.0:
        assert found.payout[0] == 0.0
        assert system.counters["rejections"] == 0 or solver is ADAPTIVE
    else:
        moving = 0.2 * found.speed[0] ** 2
        assert found.speed[0] > 0.01
        assert (found.tension_from[1] - moving) / (found.tension_to[0] - moving) == pytest.approx(ratio, rel=1e-12)


@with_each_solver()
def test_the_onset(solver):
    """It slips within the communication step in which the load gets greater than friction holds."""
    assert slips_at(solver) == pytest.approx(100.0 * np.exp(0.3 * np.pi / 2.0), abs=0.4 if solver is ADAPTIVE else 0.15)


@with_each_solver()
@pytest.mark.parametrize("load", [120.0, 80.0])
def test_efficiency(load, solver):
    """The side that the rope runs from has 0.95 of the tension on the other one, but for mu u^2; either way."""
    system = corner(load, efficiency=0.95, solver=solver)
    for _ in range(50):
        found = system.step(0.02).portions["rope"]
    moving = 0.2 * found.speed[0] ** 2
    pulls = found.tension_to[0] - moving, found.tension_from[1] - moving
    assert np.sign(found.speed[0]) == np.sign(load - 100.0)
    assert min(pulls) / max(pulls) == pytest.approx(0.95, rel=1e-12)


@with_each_solver()
def test_a_line_that_is_held_is_two_lines(solver):
    assert np.array_equal(flown_held(True, solver), flown_held(False, solver))


# --- pulleys


@with_each_solver()
def test_a_hanging_pulley(solver):
    """Equal tensions, and equal angles: 2e-6 of the rope's own weight, 1e-5 of the load; fixed steps: rounding times EA."""
    system, start = hanging_pulley(solver)
    place, found = start.points["pulley"].position, start.portions["rope"]
    up = [(end - place) / np.linalg.norm(end - place) for end in np.array([(0.0, 0.0, 0.0), (8.0, 0.0, 1.0)])]
    assert found.tension_to[0] == pytest.approx(found.tension_from[1], rel=1e-9)
    assert up[0][2] == pytest.approx(up[1][2], abs=2e-6)
    assert found.tension_to[0] == pytest.approx(50.0 * G / (up[0][2] + up[1][2]), rel=1e-5)
    for _ in range(20):
        outputs = system.step(0.05)
    assert np.abs(outputs.points["pulley"].position - place).max() < (1e-8 if solver is ADAPTIVE else 1e-6)


@with_each_solver()
@pytest.mark.parametrize("falls", [2, 4])
def test_falls(falls, solver):
    """The block rises by 1/n of the rope, each fall carries 1/n of it: within 0.1 % and the weight of the rope."""
    start, outputs = hoisted(falls, solver)
    weight = STIFF["mass_per_length"] * G * 20.0
    share, own = 2000.0 * G / falls, start.portions["hoist"].tension_to
    assert own == pytest.approx([share] * falls, rel=1e-3, abs=1.1 * weight)
    assert outputs.portions["hoist"].tension_to == pytest.approx([share] * falls, rel=1e-3, abs=1.1 * weight)
    assert outputs.lines["hoist"].winch_speed == pytest.approx(-0.5)
    assert outputs.lines["hoist"].tether_length == pytest.approx(20.0 * falls - 1.255, abs=0.01)
    risen = outputs.points["block"].position[2] - start.points["block"].position[2]
    paid = 20.0 * falls - outputs.lines["hoist"].tether_length
    assert risen == pytest.approx(paid / falls * (1.0 + share / 1e7), rel=1e-3, abs=5e-4)


@pytest.mark.filterwarnings("error")
@with_each_solver()
@pytest.mark.parametrize("control", ["speed", "length"])
def test_a_winch_pays_out_the_whole_line(control, solver):
    """It follows the length of all portions together; speeds that rise evenly add up to it."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0)), Point("block", mass=2000.0)]
    winch, sheave = Winch(winch_control=control), {"through": ["block"], "sheave_friction": 0.02}
    line = Line("hoist", "winch", "anchor", rope(40.0, **STIFF), winch=winch, **sheave)
    system = TetherSystem(points, [line], solver=solver)
    system.initialize(winch_lengths={"hoist": 40.0} if control == "length" else None)
    name = "winch_lengths" if control == "length" else "reel_out_speeds"
    for k in range(100):
        time = 0.02 * k
        value = 40.0 - 0.1 * time**2 if control == "length" else -0.2 * time
        outputs = system.step(0.02, **{name: {"hoist": value}})
    assert outputs.lines["hoist"].tether_length == pytest.approx(40.0 - 0.1 * 2.0**2, abs=1e-3)
    assert outputs.lines["hoist"].winch_speed == pytest.approx(-0.4, abs=5e-3)
    assert outputs.portions["hoist"].length.sum() == pytest.approx(outputs.lines["hoist"].tether_length, abs=1e-12)


# it jumps
@pytest.mark.filterwarnings("ignore:.*presses its ends apart", "ignore:.*the tension at a sheave", "ignore:.*hangs")
@with_each_solver(0.002)
def test_a_portion_stops_before_it_vanishes(solver):
    """Five segments of 1 cm are left, and the sheave is held while the rope draws it on; until then all methods agree."""
    system, adaptive = block_system(solver), block_system()
    found = [system.step(0.02).portions["rope"] for _ in range(60)]
    other = [adaptive.step(0.02).portions["rope"].length[0] for _ in range(30)]
    assert min(each.length[0] for each in found) == pytest.approx(0.05, rel=1e-6)
    assert max(each.speed[0] for each in found) > 2.0
    assert [each.length[0] for each in found[:30]] == pytest.approx(other, abs=0.01)


@with_each_solver()
def test_a_moving_frame(solver):
    """To rounding of the positions times the stiffness, of 300 N; in fixed steps to where iterations end."""
    still, seen = (moving(velocity, solver) for velocity in ((0.0, 0.0, 0.0), (3.0, -2.0, 1.0)))
    assert np.abs(still[:, -1]).max() > 0.1
    assert np.abs(seen - still).max() < (1e-7 if solver is ADAPTIVE else 1e-3)


# --- energy


TIGHT, SECOND = (lambda _: Solver(relative_tolerance=1e-7)), (lambda step: fixed(step, "second_order"))
SLING = (rope(3.0, 2, drag=1.0, **{**SOFT, "mass_per_length": 1.5}),)
DRUM = Winch(winch_control="force", winch_mass=10.0, winch_damping=20.0)
ENERGIES = {  # mass of the sheave, speed of the winch, solver by its step, `driven`; left of what was exchanged, ratios
    "adaptive": (0.0, 0.0, TIGHT, {}, 2e-3, (3.6, 4.4)),
    "reeled": (5.0, 0.5, TIGHT, {}, 2e-3, (3.6, 4.4)),
    "reeled, fixed steps": (5.0, 0.5, SECOND, {}, 1e-4, (3.3, 4.2)),
    "sling": (5.0, 0.5, TIGHT, {"others": SLING}, 2e-3, (3.3, 4.3)),
    "sling, fixed steps": (5.0, 0.5, SECOND, {"others": SLING}, 2e-3, (3.3, 4.3)),
    # a driven end gives its half segment to the rope where it lets go
    "let go": (2.0, None, TIGHT, {"winch": DRUM}, 2e-3, (3.4, 4.6)),
}


@pytest.mark.parametrize("case", ENERGIES)
def test_energy(case):
    """What no power explains falls with the square of the step, also of a damped rope that turns, and over a release."""
    sheave_mass, reel, solver, more, part, (least, most) = ENERGIES[case]

    def inputs(time):
        if reel is None:
            return {"releases": {"rope": time > 0.295}}
        return {"reel_out_speeds": {"rope": reel * (1.0 - np.cos(3.0 * time))}}

    (coarse, _), (fine, size) = (
        unexplained(driven(sheave_mass, solver(step), **more), step, round(1.0 / step), inputs) for step in (0.01, 0.005)
    )
    assert abs(fine) < part * size
    assert least < coarse / fine < most


def test_friction_makes_heat():
    """Without a winch that turns its power is 0, and friction takes u (T2 - T1) from a rope that hardly stretches."""
    system = corner(200.0, friction=0.3)
    for _ in range(20):
        outputs = system.step(0.02)
    found, energy = outputs.portions["rope"], system.energy()
    heat = found.speed[0] * (found.tension_from[1] - found.tension_to[0])
    assert energy.sheaves["rope"].friction_loss[0] == pytest.approx(heat, rel=3e-3)
    assert abs(energy.lines["rope"].winch_power) < 1e-6 * heat


def test_portions_that_are_given_stay():
    """Where those of another rope are sought, too: by the tensions of that one alone."""
    points = [
        Point("a", (0.0, 0.0, -10.0), mass=20.0),
        Point("s", (0.0, 0.0, 0.0)),
        Point("b", (0.0, 0.0, -10.0), mass=30.0),
    ]
    points += [Point("c", (5.0, 0.0, -8.0)), Point("e", (15.0, 0.0, -8.0))]
    lines = [Line("one", "a", "b", rope(20.0, **LIGHT), through=["s"], initial_portions=[9.9, 10.1])]
    lines.append(Line("two", "s", "e", rope(21.0, **LIGHT), through=["c"]))
    found = TetherSystem(points, lines).initialize().portions
    assert found["one"].length == pytest.approx([9.9, 10.1], rel=1e-12)
    assert found["two"].tension_to[0] == pytest.approx(found["two"].tension_from[1], rel=1e-9)


# --- states, what is refused


@with_each_solver(0.005)
def test_a_state_goes_on_bit_for_bit(solver):
    assert_continues(corner(180.0, friction=0.3, solver=solver), lambda _: {}, 10, 5)


def test_a_state_of_a_portion_a_little_below_its_shortest_length():
    """As fixed steps may leave it; one that no step leaves is no state."""
    rope = Line("rope", "a", "b", Tether(segments=1, initial_length=15.0), through=["s"], initial_portions=[7.0, 8.0])
    system = TetherSystem(POINTS, [rope])
    system.initialize()
    state = system.get_state()
    place = np.flatnonzero(state == 7.0)[0]
    state[place] = 0.01 * (1.0 - 2e-9)
    system.set_state(state)
    assert system.outputs().portions["rope"].length[0] == state[place]
    state[place] = 0.004
    with pytest.raises(ValueError, match="impossible numbers"):
        system.set_state(state)


@pytest.mark.parametrize("control", ["speed", "length"])
def test_a_start_that_leaves_no_room_is_refused_as_such(control):
    """A sheave 1 mm from the start of four segments, with either winch; and a rope that is too short for all."""
    points = [Point("a", (0.0, 0.0, 0.0)), Point("s", (0.001, 0.0, 0.0)), Point("b", (10.0, 0.0, 0.0))]
    rope = Line("r", "a", "b", Tether(segments=4, initial_length=10.05), winch=Winch(winch_control=control), through=["s"])
    system = TetherSystem(points, [rope])
    with pytest.raises(StepRefused, match="no lengths of the portions were found"):
        system.initialize()
    if control == "length":
        with pytest.raises(StepRefused, match=r"winch_length 0\.05 m"):
            system.initialize(winch_lengths={"r": 0.05})


POINTS = [Point("a", (0.0, 0.0, 0.0)), Point("s", (5.0, 0.0, 5.0)), Point("b", (10.0, 0.0, 0.0), mass=5.0)]
WIRE_AND_CHAIN = rope(16.0, 4, **WIRE), rope(4.0, 2, **STIFF)
STRONG = (WIRE_AND_CHAIN[0], rope(4.0, 2, **STIFF, breaking_force=1e4))
WRONG = {
    "ends as initial_portions": ({"initial_portions": [5.0, 5.0]}, "add up to 10"),
    "a number of sheaves": ({"sheave_mass": [1.0, 2.0]}, "sheave_mass has 2 numbers"),
    "a range": ({"sheave_efficiency": 1.2}, "sheave_efficiency is 1.2; it must be"),
    "two losses": ({"sheave_efficiency": 0.9, "sheave_friction": 0.1}, "both given"),
    "a law": ({"tether": Tether(initial_length=16.0, damping_law="stretch_rate")}, "damping_law is stretch_rate"),
    "breaking": (
        {"tether": Tether(segments=2, initial_length=16.0, breaking_force=1e4)},
        r"r\.segments is 2; over sheaves a line with breaking_force must have at least 3",
    ),
    "breaking in series": ({"tether": STRONG}, "r.breaking_force is 10000.0, and r is of 2 tethers in series"),
    "portions in series": (
        {"tether": WIRE_AND_CHAIN, "initial_portions": [16.5, 3.5]},
        "the last one 4 m more for the tethers beyond the first",
    ),
    "a sum": ({"tether": WIRE_AND_CHAIN, "initial_portions": [8.0, 8.0]}, "must be initial_length, 20.0 m"),
    "no point": ({"through": ["x"]}, "point x, which does not exist"),
    "itself": ({"through": ["s", "s"]}, "from the point s to itself"),
    "no effect": ({"through": [], "sheave_mass": 1.0}, "has no effect"),
}


@pytest.mark.parametrize("case", WRONG)
def test_refused(case):
    of_line, said = WRONG[case]
    given = {"tether": Tether(initial_length=16.0), "through": ["s"], **of_line}
    with pytest.raises(ValueError, match=said):
        TetherSystem(POINTS, [Line("r", "a", "b", **given)])


def test_a_file(tmp_path):
    file = tmp_path / "hoist.toml"
    file.write_text(
        '[points.winch]\nposition = [0, 0, 30]\n[points.anchor]\nposition = [1, 0, 30]\n[points.block]\nmass = "2000 kg"\n'
        '[lines.hoist]\nfrom = "winch"\nthrough = ["block"]\nto = "anchor"\nmaterial = "steel"\ndiameter = "12 mm"\n'
        'initial_length = "40 m"\nsegments = 4\nsheave_mass = ["2 kg"]\nsheave_efficiency = 0.98\n',
        encoding="utf-8",
    )
    system = TetherSystem.from_file(file)
    assert system.lines[0].sheave_mass == (2.0,)
    assert system.initialize().portions["hoist"].length == pytest.approx([20.0, 20.0])
    file.write_text(file.read_text(encoding="utf-8").replace('["block"]', '"block"'), encoding="utf-8")
    with pytest.raises(ValueError, match=r"hoist\.through is 'block'; it must be a list of names"):
        TetherSystem.from_file(file)
