"""A line that runs over sheaves (docs/models/theory.md, "Sheaves"), against formulas.

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

from tetherfmu import Environment, Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch

G, DENSITY, DIAMETER = 9.81, 1.0, 0.01  # [m/s2], of the rope [kg/m], [m]
HEAVY = {"diameter": DIAMETER, "mass_per_length": DENSITY, "axial_stiffness": 1e7, "axial_damping": 1e4}
LIGHT = {"diameter": DIAMETER, "mass_per_length": 0.2, "axial_stiffness": 1e5, "axial_damping": 100.0}


def rope(length, segments=6, drag=0.0, **of_rope):
    return Tether(segments=segments, initial_length=length, drag_coefficient=drag, **of_rope)


# --- Atwood's machine


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")  # at the start it is as stretched as at rest
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
def test_atwood(sheave_mass):
    """Payout within 2e-4 m in 2 s, tensions within 0.05 N: what is left are waves along the rope, which is not rigid."""
    m1, m2, length = 20.0, 30.0, 10.0
    low_a, low_b = (-length * (1.0 + (mass + 0.5 * DENSITY * length) * G / 1e7) for mass in (m1, m2))  # stretched
    points = [Point("a", (0.0, 0.0, low_a), mass=m1), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, low_b), mass=m2)]
    line = Line(
        "rope", "a", "b", rope(20.0, 10, **HEAVY), through=["s"], initial_portions=[10.0, 10.0], sheave_mass=sheave_mass
    )
    system = TetherSystem(points, [line])
    system.initialize()
    whole = m1 + m2 + 2.0 * DENSITY * length + sheave_mass
    rate, first = np.sqrt(2.0 * DENSITY * G / whole), (m2 - m1) * G / whole
    for k in range(100):
        found = system.step(0.02).portions["rope"]
        time = 0.02 * (k + 1)
        payout, gained = first / rate**2 * (np.cosh(rate * time) - 1.0), first * np.cosh(rate * time)
        assert found.payout[0] == pytest.approx(payout, abs=2e-4)
        assert found.length == pytest.approx([length - found.payout[0], length + found.payout[0]], abs=1e-12)
        if time > 0.5:
            assert found.tension_to[0] == pytest.approx((m1 + DENSITY * (length - payout)) * (G + gained), abs=0.05)
            assert found.tension_from[1] == pytest.approx((m2 + DENSITY * (length + payout)) * (G - gained), abs=0.05)
    assert found.speed[0] == pytest.approx(first / rate * np.sinh(rate * time), abs=1e-3)
    assert found.payout[0] > 2.5


# --- friction


def corner(load, friction=0.0, efficiency=1.0):
    """A rope around a right angle without gravity, drawn at with 100 N at its start and with a load [N] at its end."""
    points = [
        Point("a", (-5.0 * (1.0 + 100.0 / 1e5), 0.0, 0.0), mass=10.0),
        Point("s", (0.0, 0.0, 0.0)),
        Point("b", (0.0, 0.0, -5.0 * (1.0 + load / 1e5)), mass=10.0),
    ]
    sheave = {"sheave_friction": friction, "sheave_efficiency": efficiency, "initial_portions": [5.0, 5.0]}
    system = TetherSystem(
        points, [Line("rope", "a", "b", rope(10.0, **LIGHT), through=["s"], **sheave)], Environment(gravity=0.0)
    )
    system.initialize(loads={"a": (-100.0, 0.0, 0.0), "b": (0.0, 0.0, -load)})
    return system


@pytest.mark.parametrize("part", [0.99, 1.01])
def test_capstan(part):
    """The ratio to 1e-12, of rounding; below the onset nothing moves."""
    ratio = np.exp(0.3 * np.pi / 2.0)
    system = corner(100.0 * ratio * part, friction=0.3)
    for _ in range(50):
        found = system.step(0.02).portions["rope"]
    if part < 1.0:
        assert found.payout[0] == 0.0
    else:
        moving = 0.2 * found.speed[0] ** 2
        assert found.speed[0] > 0.01
        assert (found.tension_from[1] - moving) / (found.tension_to[0] - moving) == pytest.approx(ratio, rel=1e-12)


def test_the_onset():
    """It slips within the communication step in which the load gets greater than friction holds."""
    ratio = np.exp(0.3 * np.pi / 2.0)
    system, slipped = corner(100.0 * (ratio - 0.02), friction=0.3), None
    for k in range(60):
        load = 100.0 * (ratio - 0.02 + 0.001 * k)
        found = system.step(0.05, loads={"b": (0.0, 0.0, -load)}).portions["rope"]
        if found.payout[0] != 0.0 and slipped is None:
            slipped = load
    assert slipped == pytest.approx(100.0 * ratio, abs=0.4)


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")  # after the start with 100 N in all of it
def test_efficiency():
    """The side that the rope runs from has 0.95 of the tension on the other one, but for mu u^2."""
    system = corner(120.0, efficiency=0.95)
    for _ in range(50):
        found = system.step(0.02).portions["rope"]
    moving = 0.2 * found.speed[0] ** 2
    ratio = (found.tension_to[0] - moving) / (found.tension_from[1] - moving)
    assert ratio == pytest.approx(0.95, rel=1e-12)


def flown_held(through):
    """Nodes and forces of a mass between two points, in wind, with a winch; on one line over a sheave, or on two."""
    points = [Point("a", (-7.0, 0.0, 0.0)), Point("s", mass=40.0), Point("b", (7.0, 0.0, 0.3))]
    of_rope = {**LIGHT, "axial_damping": 300.0, "drag": 1.0}
    if through:
        sheave = {"through": ["s"], "initial_portions": [10.0, 10.0], "sheave_friction": 5.0}
        lines = [Line("one", "a", "b", rope(20.0, **of_rope), **sheave)]
    else:
        lines = [Line("one", "a", "s", rope(10.0, **of_rope)), Line("two", "s", "b", rope(10.0, **of_rope))]
    system = TetherSystem(points, lines)
    system.initialize((8.0, 1.0, 0.0))
    found = []
    for k in range(50):
        load, speed = (10.0 * np.sin(0.1 * k), 5.0, 0.0), 0.3 * np.sin(0.05 * k)
        moved = {"positions": {"b": (7.0 + 0.002 * k, 0.0, 0.3)}, "velocities": {"b": (0.1, 0.0, 0.0)}}
        outputs = system.step(0.02, **moved, loads={"s": load}, reel_out_speeds={"one": speed})
        nodes = list(system.positions.values())
        nodes = nodes[0] if through else np.vstack([nodes[0], nodes[1][1:]])
        found.append(np.concatenate([nodes.ravel(), *(outputs.points[name].force for name in "asb")]))
    return np.array(found)


def test_a_line_that_is_held_is_two_lines():
    assert np.array_equal(flown_held(True), flown_held(False))


# --- pulleys


def test_a_hanging_pulley():
    """Equal tensions, and equal angles: 2e-6 of the rope's own weight, 1e-5 of the load."""
    of_rope = {"diameter": 0.005, "mass_per_length": 1e-4, "axial_stiffness": 1e6, "axial_damping": 1e3}
    points = [Point("a", (0.0, 0.0, 0.0)), Point("pulley", mass=50.0), Point("b", (8.0, 0.0, 1.0))]
    system = TetherSystem(points, [Line("rope", "a", "b", rope(12.0, 4, **of_rope), through=["pulley"])])
    start = system.initialize()
    place, found = start.points["pulley"].position, start.portions["rope"]
    up = [(end - place) / np.linalg.norm(end - place) for end in np.array([(0.0, 0.0, 0.0), (8.0, 0.0, 1.0)])]
    assert found.tension_to[0] == pytest.approx(found.tension_from[1], rel=1e-9)
    assert up[0][2] == pytest.approx(up[1][2], abs=2e-6)
    assert found.tension_to[0] == pytest.approx(50.0 * G / (up[0][2] + up[1][2]), rel=1e-5)
    for _ in range(20):
        outputs = system.step(0.05)
    assert np.abs(outputs.points["pulley"].position - place).max() < 1e-8


@pytest.mark.parametrize("falls", [2, 4])
def test_falls(falls):
    """Within 0.1 % and the weight of the rope."""
    stiff = {"diameter": 0.012, "mass_per_length": 0.57, "axial_stiffness": 1e7, "axial_damping": 1e5}
    tether = rope(20.0 * falls, **stiff)
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0)), Point("block", mass=2000.0)]
    through = ["block"]
    if falls == 4:
        points.append(Point("crown", (0.5, 0.0, 30.0)))
        through = ["block", "crown", "block"]
    system = TetherSystem(points, [Line("hoist", "winch", "anchor", tether, through=through)])
    start = system.initialize()
    weight = tether.mass_per_length * G * 20.0
    for k in range(150):
        outputs = system.step(0.02, reel_out_speeds={"hoist": -0.5 * min(1.0, 0.02 * k)})
    share, own = 2000.0 * G / falls, start.portions["hoist"].tension_to
    assert own == pytest.approx([share] * falls, rel=1e-3, abs=1.1 * weight)
    assert outputs.lines["hoist"].winch_speed == pytest.approx(-0.5)
    assert outputs.lines["hoist"].tether_length == pytest.approx(20.0 * falls - 1.255, abs=0.01)
    risen = outputs.points["block"].position[2] - start.points["block"].position[2]
    paid = 20.0 * falls - outputs.lines["hoist"].tether_length
    assert risen == pytest.approx(paid / falls * (1.0 + share / 1e7), rel=1e-3, abs=5e-4)


@pytest.mark.parametrize("control", ["speed", "length"])
def test_a_winch_pays_out_the_whole_line(control):
    """It follows the length of all portions together; speeds that rise evenly add up to it."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0)), Point("block", mass=2000.0)]
    stiff = {"diameter": 0.012, "mass_per_length": 0.57, "axial_stiffness": 1e7, "axial_damping": 1e5}
    winch, sheave = Winch(winch_control=control), {"through": ["block"], "sheave_friction": 0.02}
    system = TetherSystem(points, [Line("hoist", "winch", "anchor", rope(40.0, **stiff), winch=winch, **sheave)])
    system.initialize(winch_lengths={"hoist": 40.0} if control == "length" else None)
    name = "winch_lengths" if control == "length" else "reel_out_speeds"
    for k in range(100):
        time = 0.02 * k
        value = 40.0 - 0.1 * time**2 if control == "length" else -0.2 * time
        outputs = system.step(0.02, **{name: {"hoist": value}})
    assert outputs.lines["hoist"].tether_length == pytest.approx(40.0 - 0.1 * 2.0**2, abs=1e-3)
    assert outputs.lines["hoist"].winch_speed == pytest.approx(-0.4, abs=5e-3)
    assert outputs.portions["hoist"].length.sum() == pytest.approx(outputs.lines["hoist"].tether_length, abs=1e-12)


@pytest.mark.filterwarnings(
    "ignore:.*presses its ends apart", "ignore:.*the tension at a sheave", "ignore:.*hangs"
)  # it jumps
def test_a_portion_stops_before_it_vanishes():
    """Five segments of 1 cm are left, and the sheave is held while the rope draws it on."""
    points = [Point("a", (0.0, 0.0, -1.0), mass=20.0), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, -4.0), mass=60.0)]
    line = Line("rope", "a", "b", rope(5.0, 5, **LIGHT, slack_damping_ratio=0.1), through=["s"], initial_portions=[1.0, 4.0])
    system = TetherSystem(points, [line])
    system.initialize()
    found = [system.step(0.02).portions["rope"] for _ in range(60)]
    shortest = min(each.length[0] for each in found)
    assert shortest == pytest.approx(0.05, rel=1e-6)
    assert max(each.speed[0] for each in found) > 2.0


def moving(velocity):
    """Tensions and lengths of a rope over a hanging pulley with friction, seen from a frame of this velocity [m/s]."""
    velocity = np.array(velocity)
    ends = {"a": np.array((-6.0, 0.0, 0.0)), "b": np.array((7.0, 0.0, 1.0))}
    points = [Point(name, place, velocity) for name, place in ends.items()]
    points.append(Point("pulley", velocity=velocity, mass=40.0))
    line = Line("rope", "a", "b", rope(20.0, 5, **LIGHT), through=["pulley"], sheave_mass=0.5, sheave_friction=0.01)
    system = TetherSystem(points, [line])
    system.initialize()
    found = []
    for k in range(50):
        places = {name: place + 0.02 * k * velocity for name, place in ends.items()}
        own = system.step(0.02, places, reel_out_speeds={"rope": 0.5 * np.sin(0.1 * k)}).portions["rope"]
        found.append(np.concatenate([own.tension_from, own.tension_to, own.length, own.speed]))
    return np.array(found)


def test_a_moving_frame():
    still, seen = moving((0.0, 0.0, 0.0)), moving((3.0, -2.0, 1.0))
    assert np.abs(still[:, -1]).max() > 0.1
    assert np.abs(seen - still).max() < 1e-7  # of 300 N; rounding of the positions times the stiffness


# --- energy


def residual(step, sheave_mass, reel):
    """Energy from nowhere [J] in 1 s of a rope over a driven sheave, whose one end hangs, and what was exchanged [J]."""
    points = [Point("a", (-6.0, 0.0, 0.0)), Point("s", (0.0, 0.0, 4.0)), Point("b", (2.0, 0.0, -6.0), mass=10.0)]
    of_rope = {"diameter": DIAMETER, "mass_per_length": 0.3, "axial_stiffness": 2e4, "axial_damping": 200.0, "drag": 1.0}
    sheave = {"initial_portions": [7.5, 12.5], "sheave_mass": sheave_mass}
    line = Line("rope", "a", "b", rope(20.0, 5, **of_rope), through=["s"], **sheave)
    system = TetherSystem(points, [line], solver=Solver(relative_tolerance=1e-7))
    system.initialize()
    before, total = system.energy(), 0.0
    first = before.total
    for k in range(round(1.0 / step)):
        system.step(step, reel_out_speeds={"rope": reel * (1.0 - np.cos(3.0 * k * step))})
        after = system.energy()
        total += 0.5 * step * (before.power + after.power)
        before = after
    return after.total - first - total, abs(after.total - first)


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")
@pytest.mark.parametrize(("sheave_mass", "reel"), [(0.0, 0.0), (5.0, 0.5)])
def test_energy(sheave_mass, reel):
    (coarse, size), (fine, _) = residual(0.01, sheave_mass, reel), residual(0.005, sheave_mass, reel)
    assert abs(fine) < 2e-3 * size
    assert coarse / fine == pytest.approx(4.0, rel=0.1)


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")
def test_friction_makes_heat():
    """Without a winch that turns its power is 0, and friction takes u (T2 - T1) from a rope that hardly stretches."""
    system = corner(200.0, friction=0.3)
    for _ in range(20):
        outputs = system.step(0.02)
    found, energy = outputs.portions["rope"], system.energy()
    heat = found.speed[0] * (found.tension_from[1] - found.tension_to[0])
    assert energy.sheaves["rope"].friction_loss[0] == pytest.approx(heat, rel=3e-3)
    assert abs(energy.lines["rope"].winch_power) < 1e-6 * heat


# --- states, what is refused


def test_a_state_goes_on_bit_for_bit():
    system = corner(180.0, friction=0.3)
    for _ in range(10):
        system.step(0.02)
    state = system.get_state()
    first = [system.step(0.02).portions["rope"].tension_to[0] for _ in range(5)]
    system.set_state(state)
    assert [system.step(0.02).portions["rope"].tension_to[0] for _ in range(5)] == first
    before = system.get_state()
    with pytest.raises(StepRefused, match=r"loads|load"):
        system.step(0.02, loads={"b": (np.nan, 0.0, 0.0)})
    assert np.array_equal(system.get_state(), before)


POINTS = [Point("a", (0.0, 0.0, 0.0)), Point("s", (5.0, 0.0, 5.0)), Point("b", (10.0, 0.0, 0.0), mass=5.0)]
WRONG = {
    "ends as initial_portions": ({"initial_portions": [5.0, 5.0]}, {}, "add up to 10"),
    "a number of sheaves": ({"sheave_mass": [1.0, 2.0]}, {}, "sheave_mass has 2 numbers"),
    "a range": ({"sheave_efficiency": 1.2}, {}, "sheave_efficiency is 1.2; it must be"),
    "two losses": ({"sheave_efficiency": 0.9, "sheave_friction": 0.1}, {}, "both given"),
    "a stop": (
        {"winch": Winch(winch_control="force", longest_length=20.0)},
        {},
        "r.longest_length is 20.0, and r runs over",
    ),
    "a start": (
        {"winch": Winch(winch_control="force", winch_start="equilibrium")},
        {},
        "r.winch_start is equilibrium, and r",
    ),
    "fixed steps": ({}, {"solver": Solver(fixed_step=0.01)}, "fixed_step is 0.01 s, and r runs over sheaves"),
    "wind points": ({}, {"wind_points": 5}, "wind_points is 5, and r runs over sheaves"),
    "a law": ({"tether": Tether(initial_length=16.0, damping_law="stretch_rate")}, {}, "damping_law is stretch_rate"),
    "breaking": ({"tether": Tether(initial_length=16.0, breaking_force=1e4)}, {}, "breaking_force is 10000.0, and r runs"),
    "no point": ({"through": ["x"]}, {}, "point x, which does not exist"),
    "itself": ({"through": ["s", "s"]}, {}, "from the point s to itself"),
    "no effect": ({"through": [], "sheave_mass": 1.0}, {}, "has no effect"),
}


def test_it_does_not_let_go():
    system = corner(100.0)
    with pytest.raises(StepRefused, match="rope: release is true for a line over sheaves"):
        system.step(0.02, releases={"rope": True})
    system.step(0.02)


@pytest.mark.parametrize("case", WRONG)
def test_refused(case):
    of_line, others, said = WRONG[case]
    given = {"tether": Tether(initial_length=16.0), "through": ["s"], **of_line}
    with pytest.raises(ValueError, match=said):
        TetherSystem(POINTS, [Line("r", "a", "b", **given)], **others)


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
