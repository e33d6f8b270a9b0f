"""Tethers in series over sheaves: a wire rope runs over them, and a sling or chain hangs beyond the last one.

rest       tensions m g + weights below, stretch by them
held       a line that friction holds is two lines, the second one of tethers in series, bit for bit
joint      it stops at the sheave, where the wire has 1 cm for each of its segments; also after a release

Atwood's machine, energy, what is refused: `test_sheaves.py`.  With an independent solver: `test_stops_over_sheaves.py`.
"""

from dataclasses import replace

import numpy as np
import pytest

from over_sheaves import LIGHT, WIRE, Atwood, G, flown_held, rope
from random_sheaves import random_ropes
from solvers import ADAPTIVE, METHODS, fixed, with_each_solver
from tetherfmu import Line, Point, StepRefused, TetherSystem, Winch

STEP = 0.02
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
    scene = Atwood(0.0, 30.0, 20.0, WIRE, CHAIN["mass_per_length"])
    system = scene.system(solver)
    scene.right -= scene.m2
    for k in range(180):
        own = system.step(STEP, releases={"rope": True}).portions["rope"]
        if k < 50:
            assert own.payout[0] == pytest.approx(scene.payout(STEP * (k + 1)), abs=0.02)
    assert own.length[1] == pytest.approx(4.06, abs=1e-5)
    assert own.speed[0] == 0.0
    assert own.tension_to[0] == pytest.approx((scene.m1 + WIRE["mass_per_length"] * 15.94) * G, rel=0.1)


# --- random ropes


@pytest.mark.parametrize("solver", [ADAPTIVE, *(fixed(0.005, method) for method in METHODS)])
@pytest.mark.parametrize("is_wild", [False, True])
def test_random_ropes_with_a_last_section(is_wild, solver):
    """All that starts goes on; rope is neither lost nor made, and beyond the joint it keeps its length."""
    flights = 0
    for seed in range(24):
        scene = random_ropes(np.random.default_rng((31, seed)), is_wild=is_wild)
        rng, found = np.random.default_rng((32, seed)), []
        for line in scene.lines:
            if line.through:
                last = rng.uniform(0.5, 1.5)
                heavy = {"density": line.tether.density * rng.uniform(0.3, 3.0), "segments": int(rng.integers(1, 4))}
                wire = replace(line.tether, initial_length=line.tether.initial_length - last)
                line = replace(line, tether=(wire, replace(line.tether, initial_length=last, **heavy)))
            found.append(line)
        scene.lines = found
        try:
            system = scene.started(solver)
        except StepRefused:
            continue

        flights += 1
        for k in range(20):
            outputs = system.step(0.01, **scene.told(0.01 * k))
        assert all(np.isfinite(each).all() for each in system.positions.values())
        for line in found:
            if line.through:
                own, wire = outputs.portions[line.name], line.tether[0]
                assert own.length.sum() == pytest.approx(outputs.lines[line.name].tether_length, rel=1e-12)
                assert own.length[-1] > line.tether[1].initial_length + 0.01 * wire.segments * (1.0 - 1e-3)
    assert flights > 18
