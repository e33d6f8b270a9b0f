"""Tethers in series over sheaves: a wire rope runs over them, and a sling or chain hangs beyond the last one.

rest       tensions m g + weights below, stretch by them
cosh       (m1 + m2 + mu l + nu c + J/r2) a = (m2 - m1 + nu c + mu (l2 - l1)) g: the payout is a hyperbolic cosine
oracle     a load on a heavy sling on a light wire, with a drum between stops: equations written here, solved by DOP853
held       a line that friction holds is two lines, the second one of tethers in series, bit for bit
joint      it stops at the sheave, where the wire has 1 cm for each of its segments; also after a release
energy     what the powers do not explain falls with the square of the communication step
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from over_sheaves import LIGHT, G, flown_held, rope
from random_sheaves import random_ropes, told
from solvers import ADAPTIVE, METHODS, fixed, with_each_solver
from tetherfmu import Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch

STEP = 0.02
WIRE = {"diameter": 0.01, "mass_per_length": 0.4, "axial_stiffness": 1e7, "axial_damping": 1e5}
CHAIN = {"diameter": 0.02, "mass_per_length": 5.0, "axial_stiffness": 2e7, "axial_damping": 2e5}
pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # loads that stop at once, wild ropes


# --- rest


@pytest.mark.parametrize("is_sought", [False, True])
def test_a_crane_at_rest(is_sought):
    """Its hook is found, or the length at which its winch is in balance: tension and stretch of wire and chain, to 1e-9."""
    load, wire, chain = 500.0, rope(22.0, 4, **WIRE), rope(3.0, 2, **CHAIN)
    hook = Point("load", None if not is_sought else (0.0, 0.0, -17.0186), mass=load)
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), hook]
    winch = Winch(winch_control="force", winch_start="equilibrium") if is_sought else Winch()
    system = TetherSystem(points, [Line("rope", "winch", "load", (wire, chain), winch=winch, through=["head"])])
    force = (load + 15.0 + 14.0 * WIRE["mass_per_length"]) * G
    found = system.initialize(winch_forces={"rope": force} if is_sought else None)
    own, hangs = found.portions["rope"], found.portions["rope"].length[1] - 3.0
    above, below = (load + 15.0 + hangs * WIRE["mass_per_length"]) * G, load * G
    if is_sought:
        assert own.tension_from == pytest.approx([force] * 2, rel=1e-9)
        return
    assert own.length.sum() == pytest.approx(found.lines["rope"].tether_length, rel=1e-15)
    assert own.length.sum() == pytest.approx(25.0, rel=1e-12)
    assert own.tension_from == pytest.approx([above] * 2, rel=1e-9)
    assert own.tension_to == pytest.approx([above, below], rel=1e-7)  # EA times the rounding of positions
    stretch = 0.5 * (above + below + 15.0 * G) / WIRE["axial_stiffness"] * hangs
    stretch += (below + 7.5 * G) / CHAIN["axial_stiffness"] * 3.0
    assert -found.points["load"].position[2] == pytest.approx(3.0 + hangs + stretch, abs=1e-9)


# --- a hyperbolic cosine


class Weights:
    """Two masses [kg] on a heavy wire, 10 m on either side of a sheave, the second one on a chain of 4 m."""

    m1, m2, chain, side = 30.0, 20.0, 4.0, 10.0

    def __init__(self, sheave_mass=0.0, density=CHAIN["mass_per_length"]):
        wire, self.density, self.sheave_mass = WIRE["mass_per_length"], density, sheave_mass
        beyond = density * self.chain
        whole = self.m1 + self.m2 + wire * (2.0 * self.side - self.chain) + beyond + sheave_mass
        self.rate = np.sqrt(2.0 * wire * G / whole)
        self.first = (self.m2 - self.m1 + beyond - wire * self.chain) * G / whole

    def payout(self, time):
        """Rope that has passed [m]."""
        return self.first / self.rate**2 * (np.cosh(self.rate * time) - 1.0)

    def tensions(self, time):
        """Tensions on both sides of the sheave, and of the chain at the second mass [N]."""
        gained, payout, wire = self.first * np.cosh(self.rate * time), self.payout(time), WIRE["mass_per_length"]
        behind = (self.m1 + wire * (self.side - payout)) * (G + gained)
        beyond = self.m2 + self.density * self.chain + wire * (self.side - self.chain + payout)
        return behind, beyond * (G - gained), self.m2 * (G - gained)

    def system(self, solver):
        """The system, stretched by its weights, started."""
        chain = {**WIRE, "mass_per_length": self.density}
        of_wire, above, below = WIRE["mass_per_length"], self.side - self.chain, self.density * self.chain
        stretch = (self.m1 + 0.5 * of_wire * self.side) * self.side
        other = (self.m2 + below + 0.5 * of_wire * above) * above + (self.m2 + 0.5 * below) * self.chain
        low_a, low_b = (-self.side - each * G / WIRE["axial_stiffness"] for each in (stretch, other))
        points = [Point("a", (0.0, 0.0, low_a), mass=self.m1), Point("s", (0.0, 0.0, 0.0))]
        points.append(Point("b", (0.0, 0.0, low_b), mass=self.m2))
        tethers = rope(2.0 * self.side - self.chain, 6, **WIRE), rope(self.chain, 3, **chain)
        sheave = {"through": ["s"], "initial_portions": [self.side] * 2, "sheave_mass": self.sheave_mass}
        system = TetherSystem(points, [Line("rope", "a", "b", tethers, **sheave)], solver=solver)
        system.initialize()
        return system


@pytest.mark.parametrize(
    ("solver", "within"), [(ADAPTIVE, 2e-4), (fixed(0.002, "second_order"), 2e-4), (fixed(0.002, "backward_euler"), 0.02)]
)
@pytest.mark.parametrize("density", [CHAIN["mass_per_length"], WIRE["mass_per_length"]])
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
def test_weights(sheave_mass, density, solver, within):
    """2 s; stretch of some 1e-5 m is left, and of Euler its order. A chain of the wire's density is a longer wire."""
    scene = Weights(sheave_mass, density)
    system = scene.system(solver)
    for k in range(100):
        own = system.step(STEP).portions["rope"]
        assert own.payout[0] == pytest.approx(scene.payout(STEP * (k + 1)), abs=within)
    assert abs(own.payout[0]) > 1.0
    found = own.tension_to[0], own.tension_from[1], own.tension_to[1]
    assert found == pytest.approx(scene.tensions(2.0), abs=0.1 if within < 1e-2 else 3.0)


# --- a solver of its own

EA_WIRE, EA_SLING, DAMPING, SLING, HEAVY, DRUM, SHEAVE, LOAD = 2e4, 1e5, 40.0, 2.0, 3.0, 5.0, 0.5, 20.0
LONGEST = 20.4
NO_MASS = {"diameter": 1e-4, "mass_per_length": 1e-9, "drag_coefficient": 0.0, "slack_stiffness_ratio": 0.0}
KNOT = 0.5 * HEAVY * SLING  # half of the sling [kg]


def with_sling(solver):
    """A load on a sling of 2 m, 3 kg/m, at 12 m of rope beyond a sheave, which is 8 m from the winch."""
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -12.05), mass=LOAD)]
    wire = Tether(segments=1, initial_length=18.0, axial_stiffness=EA_WIRE, axial_damping=DAMPING, **NO_MASS)
    stiff = {"axial_stiffness": EA_SLING, "axial_damping": 0.0, "drag_coefficient": 0.0, "slack_stiffness_ratio": 0.0}
    sling = Tether(segments=1, initial_length=SLING, diameter=0.02, mass_per_length=HEAVY, **stiff)
    winch = Winch(winch_control="force", winch_mass=DRUM, longest_length=LONGEST)
    sheave = {"through": ["head"], "initial_portions": [8.0, 12.0], "sheave_mass": SHEAVE}
    return TetherSystem(points, [Line("rope", "winch", "load", (wire, sling), winch=winch, **sheave)], solver=solver)


def pulls(stretched, length, rate, growth):
    """Tension of a segment of wire, and tension where rope enters it [N]; with their rates [m/s]."""
    damper = DAMPING / length * (rate - stretched / length * growth)
    pull = EA_WIRE * (stretched**2 / length**2 - 1.0) / 2.0 + damper * stretched / length
    return EA_WIRE * (stretched / length - 1.0) + damper, 2.0 * pull / (1.0 + np.sqrt(1.0 + 2.0 * pull / EA_WIRE))


def rates(time, state, is_held, force):
    """Rates of the heights of load and joint, of L and of the rope over the sheave, and of their speeds."""
    load, joint, length, passed, climb, rise, speed, running = state
    _, behind = pulls(8.0, length - passed - 12.0, 0.0, speed - running)
    tension, ahead = pulls(-joint, 10.0 + passed, -rise, running)
    below = max(EA_SLING * ((joint - load) / SLING - 1.0), 0.0)
    heavy = LOAD + KNOT
    turning = (0.0, 0.0) if is_held else (speed, (behind - force) / DRUM)
    gained = below / heavy - G, (tension - below) / KNOT - G, turning[1], (ahead - behind) / SHEAVE
    return climb, rise, turning[0], running, *gained


def alone(force, times, start):
    """Height of the load, L and rope over the sheave at these times [s], and the time of the stop; start : heights [m]."""
    state, options = (
        np.array((*start, 20.0, *5 * [0.0])),
        {"rtol": 1e-11, "atol": 1e-12, "max_step": 1e-3, "dense_output": True},
    )

    def stops(_, state, *__):
        return state[2] - LONGEST

    stops.terminal = True
    first = solve_ivp(rates, (0.0, times[-1]), state, "DOP853", args=(False, force), events=stops, **options)
    end, state = first.t[-1], first.y[:, -1]
    state[6] = 0.0
    then = solve_ivp(rates, (end, times[-1]), state, "DOP853", args=(True, force), **options)
    return np.array([(first if time <= end else then).sol(time)[[0, 2, 3]] for time in times]), end


TIGHT = Solver(relative_tolerance=1e-9)


@pytest.mark.parametrize(("solver", "within"), [(TIGHT, 1e-6), (fixed(5e-4, "second_order"), 2e-3)])
def test_against_a_solver_of_its_own(solver, within):
    """0.9 s: the drum pays out, stops, and the load swings on a rope that pulls more than W; L counts the sling, too."""
    times, system = STEP * np.arange(1, 46), with_sling(solver)
    start = system.initialize(winch_forces={"rope": 20.0})
    heights = start.points["load"].position[2], system.positions["rope"][2][2]
    exact, end = alone(20.0, times, heights)
    assert 0.1 < end < 0.8
    found = []
    for _ in times:
        outputs = system.step(STEP)
        line, own = outputs.lines["rope"], outputs.portions["rope"]
        found.append((outputs.points["load"].position[2], line.tether_length, own.payout[0]))
    assert np.abs(np.array(found) - exact).max() < within


# --- held by friction


@with_each_solver()
def test_a_line_that_is_held_is_two_lines(solver):
    sling = rope(3.0, 3, drag=1.2, **{**LIGHT, "mass_per_length": 2.0, "diameter": 0.02})
    one, two = (flown_held(through, solver, segments=4, others=(sling,)) for through in (True, False))
    assert np.array_equal(one, two)


# --- the joint at the sheave


def drawn_up(solver):
    """A load on a chain that a winch has drawn up to the sheave, and further: outputs of 2 s."""
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), Point("load", mass=50.0)]
    soft = {"diameter": 0.01, "mass_per_length": 0.4, "axial_stiffness": 1e5, "axial_damping": 2e3}
    tethers = rope(9.0, 3, **soft), rope(2.0, 2, **{**soft, "mass_per_length": 3.0})
    line = Line("rope", "winch", "load", tethers, through=["head"])
    system = TetherSystem(points, [line], solver=solver)
    system.initialize()
    return [system.step(STEP, reel_out_speeds={"rope": -0.5 * min(1.0, 0.05 * k)}) for k in range(150)]


@with_each_solver(0.005)
def test_the_joint_stops_at_the_sheave(solver):
    """The rope before it stretches, the load rises no further; the chain keeps its length."""
    found = drawn_up(solver)
    lengths, heights = (
        [each.portions["rope"].length[1] for each in found],
        [each.points["load"].position[2] for each in found],
    )
    assert min(lengths) == pytest.approx(2.03, abs=2.1e-6)
    assert lengths[-1] == pytest.approx(2.03, abs=2.1e-6)
    assert heights[-1] == pytest.approx(-2.03 * (1.0 + 53.0 * G / 1e5), abs=2e-3)
    before = found[-1].portions["rope"]
    assert before.tension_to[0] > 3.0 * before.tension_from[1] > 140.0 * G


@with_each_solver(0.002)
def test_a_released_joint_stops_at_the_sheave(solver):
    """The bare chain runs up, as its equation says, and hangs at the sheave from its joint: it does not run off."""
    scene, released = Weights(), Weights()
    system = scene.system(solver)
    whole = scene.m1 + WIRE["mass_per_length"] * 16.0 + 20.0
    released.rate = np.sqrt(2.0 * WIRE["mass_per_length"] * G / whole)
    released.first = (20.0 - scene.m1 - WIRE["mass_per_length"] * 4.0) * G / whole
    for k in range(180):
        own = system.step(STEP, releases={"rope": True}).portions["rope"]
        if k < 50:
            assert own.payout[0] == pytest.approx(released.payout(STEP * (k + 1)), abs=0.02)
    assert own.length[1] == pytest.approx(4.06, abs=1e-5)
    assert own.speed[0] == 0.0
    assert own.tension_to[0] == pytest.approx((scene.m1 + WIRE["mass_per_length"] * 15.94) * G, rel=0.1)


# --- energy, states, what is refused


def unexplained(step, solver):
    """Energy [J] that no power explains in 1 s of a hoist with a sling, and what was exchanged [J]."""
    points = [Point("a", (-6.0, 0.0, 0.0)), Point("s", (0.0, 0.0, 4.0)), Point("b", (2.0, 0.0, -6.0), mass=10.0)]
    of_rope = {"diameter": 0.01, "mass_per_length": 0.3, "axial_stiffness": 2e4, "axial_damping": 200.0, "drag": 1.0}
    tethers = rope(17.0, 5, **of_rope), rope(3.0, 2, **{**of_rope, "mass_per_length": 1.5})
    sheave = {"initial_portions": [7.5, 12.5], "sheave_mass": 5.0}
    system = TetherSystem(points, [Line("rope", "a", "b", tethers, through=["s"], **sheave)], solver=solver)
    system.initialize()
    before, total = system.energy(), 0.0
    first = before.total
    for k in range(round(1.0 / step)):
        system.step(step, reel_out_speeds={"rope": 0.5 * (1.0 - np.cos(3.0 * k * step))})
        after = system.energy()
        total += 0.5 * step * (before.power + after.power)
        before = after
    return after.total - first - total, abs(after.total - first)


@pytest.mark.parametrize("is_fixed", [False, True])
def test_energy(is_fixed):
    (coarse, size), (fine, _) = (
        unexplained(step, fixed(step, "second_order") if is_fixed else Solver(relative_tolerance=1e-7))
        for step in (0.01, 0.005)
    )
    assert abs(fine) < 2e-3 * size
    assert 3.3 < coarse / fine < 4.3


@with_each_solver()
def test_a_state_is_restored(solver):
    """Bit for bit."""
    system = with_sling(solver)
    system.initialize(winch_forces={"rope": 100.0})
    for _ in range(10):
        system.step(STEP)
    state = system.get_state()
    first = [system.step(STEP).points["load"].position[2] for _ in range(40)]
    system.set_state(state)
    assert [system.step(STEP).points["load"].position[2] for _ in range(40)] == first


WIRE_AND_CHAIN = rope(16.0, 4, **WIRE), rope(4.0, 2, **CHAIN)
STRONG = replace(WIRE_AND_CHAIN[1], breaking_force=1e4)
LAST = "the last one 4 m more for the tethers beyond the first"
WRONG = {
    "breaking": ((WIRE_AND_CHAIN[0], STRONG), {}, "r.breaking_force is 10000.0, and r is of 2 tethers in series"),
    "portions": (WIRE_AND_CHAIN, {"initial_portions": [16.5, 3.5]}, LAST),
    "sum": (WIRE_AND_CHAIN, {"initial_portions": [8.0, 8.0]}, "must be initial_length, 20.0 m"),
}


@pytest.mark.parametrize("case", WRONG)
def test_refused(case):
    tethers, of_line, said = WRONG[case]
    points = [Point("a", (0.0, 0.0, 0.0)), Point("s", (5.0, 0.0, 5.0)), Point("b", (10.0, 0.0, 0.0), mass=5.0)]
    with pytest.raises(ValueError, match=said):
        TetherSystem(points, [Line("r", "a", "b", tethers, through=["s"], **of_line)])


# --- random ropes


@pytest.mark.parametrize("solver", [ADAPTIVE, *(fixed(0.005, method) for method in METHODS)])
@pytest.mark.parametrize("is_wild", [False, True])
def test_random_ropes_with_a_last_section(is_wild, solver):
    """All that starts goes on; rope is neither lost nor made, and beyond the joint it keeps its length."""
    flights = 0
    for seed in range(24):
        points, lines, environment, ground = random_ropes(np.random.default_rng((31, seed)), is_wild=is_wild)
        rng, found = np.random.default_rng((32, seed)), []
        for line in lines:
            if line.through:
                last = rng.uniform(0.5, 1.5)
                heavy = {"density": line.tether.density * rng.uniform(0.3, 3.0), "segments": int(rng.integers(1, 4))}
                wire = replace(line.tether, initial_length=line.tether.initial_length - last)
                line = replace(line, tether=(wire, replace(line.tether, initial_length=last, **heavy)))
            found.append(line)
        system = TetherSystem(points, found, environment, solver, ground)
        lengths = {line.name: line.initial_length for line in found if line.winch.winch_control == 3}
        try:
            system.initialize((6.0, 2.0, 0.0), winch_lengths=lengths or None)
        except StepRefused:
            continue
        flights += 1
        for k in range(20):
            inputs = told((points, lines, environment, ground), 0.01 * k)
            outputs = system.step(0.01, **inputs)
        assert all(np.isfinite(each).all() for each in system.positions.values())
        for line in found:
            if line.through:
                own, wire = outputs.portions[line.name], line.tether[0]
                assert own.length.sum() == pytest.approx(outputs.lines[line.name].tether_length, rel=1e-12)
                assert own.length[-1] > line.tether[1].initial_length + 0.01 * wire.segments * (1.0 - 1e-3)
    assert flights > 18
