"""Starts without a false first peak: shapes that move with their ends, winches in balance, and what is said of the others.

Oracles: a tether whose ends move alike in steady wind hangs as one at rest in the wind relative to them (Galileo); a winch
in balance pulls with its force and does not turn; ends at rest have one equilibrium, whatever it is called.
"""

import numpy as np
import pytest

from solvers import MODELS
from tetherfmu import (
    Ground,
    Line,
    PlausibilityWarning,
    Point,
    Solver,
    StepRefused,
    Tether,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
    TetherSystem,
    Winch,
)

STEP = 0.02
NO_WIND = np.zeros(3)


def moving(shape, kite, speed, wind, seconds, **tether):
    """Largest tension [N] at the start and after each step, of a tether whose ends move with one velocity [m/s]."""
    model = TetherDynamic(Tether(**tether), solver=Solver(initial_shape=shape))
    motion = {"kite_velocity": speed, "ground_velocity": speed, "wind_velocity": wind}
    found = [model.initialize(kite_position=kite, **motion).max_tension]
    for k in range(round(seconds / STEP)):
        way = k * STEP * np.asarray(speed)
        found.append(model.step(STEP, kite_position=kite + way, ground_position=way, **motion).max_tension)
    return np.array(found)


@pytest.mark.parametrize(("kite", "speed", "wind", "diameter"), [
    ((30.0, 0.0, 40.0), (5.0, 0.0, 0.0), (8.0, 2.0, 0.0), 0.005),  # on a ship
    ((30.0, 0.0, 39.9), (15.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.004),  # truck and drone
])  # fmt: skip
def test_ends_that_move_alike(kite, speed, wind, diameter):
    kite, tether = np.array(kite), {"segments": 20, "initial_length": 50.0, "diameter": diameter}
    relative = TetherDynamic(Tether(**tether))
    oracle = relative.initialize(kite_position=kite, wind_velocity=np.subtract(wind, speed)).max_tension
    found = moving("quasi_steady", kite, speed, wind, 1.0, **tether)
    np.testing.assert_allclose(found, oracle, rtol=1e-4)  # the solver's tolerance; 2e-7 observed
    assert moving("static_equilibrium", kite, speed, wind, 0.1, **tether).max() > 1.5 * oracle  # the false peak
    assert Solver().initial_shape == 2


def test_reeling_out():
    """A kite that flies away at the reel-out speed: its tether pulls less, the longer it is, from the start on."""
    away, speed = np.array([0.6, 0.0, 0.8]), 4.0
    model = TetherDynamic(Tether(initial_length=100.0))
    motion = {"kite_velocity": speed * away, "reel_out_speed": speed, "wind_velocity": (8.0, 0.0, 0.0)}
    steady = TetherQuasiSteady(Tether(initial_length=100.0))
    pulls = [[each.initialize(kite_position=100.05 * away, **motion).max_tension] for each in (model, steady)]
    for k in range(50):
        kite = (100.05 + speed * k * STEP) * away
        for each, found in zip((model, steady), pulls, strict=True):
            found.append(each.step(STEP, kite_position=kite, **motion).max_tension)
    np.testing.assert_allclose(*pulls, rtol=0.02)  # waves of a tether that gets longer; 0.6 % observed


def test_one_shape_at_rest():
    """With ends at rest quasi-steady and static are one shape: 1000 scenes, slack and taut, in wind and on the ground."""
    random = np.random.default_rng(5)
    for scene in range(1000):
        ground = Ground(ground_contact="flat") if scene % 5 == 0 else Ground()
        kite = random.uniform((20.0, -60.0, 1.0), (90.0, 60.0, 90.0))
        length = np.linalg.norm(kite) * random.uniform(0.99, 1.2)
        wind = random.uniform(-15.0, 15.0, 3) * (1.0, 1.0, 0.0)
        started = []
        for shape in ("static_equilibrium", "quasi_steady"):
            model = TetherDynamic(
                Tether(segments=8, initial_length=length), solver=Solver(initial_shape=shape), ground=ground
            )
            out = model.initialize(kite_position=kite, ground_position=(0.0, 0.0, 0.5), wind_velocity=wind)
            started.append((*out.kite_force, *out.ground_force, *model.positions.ravel()))
        assert started[0] == started[1]


def test_at_rest_where_no_moving_shape_is_found():
    tether = Tether(segments=17, initial_length=77.8, axial_stiffness=78.6)  # waves along it are slower than the kite
    model = TetherDynamic(tether)
    fast = {"kite_position": (-33.7, 35.2, 32.2), "kite_velocity": (256.0, -240.0, -326.0)}
    fast |= {"ground_velocity": (5.4, -35.2, -21.5)}
    with pytest.raises(StepRefused, match="no equilibrium"):
        TetherQuasiSteady(tether).initialize(**fast)
    with pytest.warns(
        PlausibilityWarning, match="no shape was found that moves with its ends, so the tether starts at rest"
    ):
        out = model.initialize(**fast)
    other = TetherDynamic(tether, solver=Solver(initial_shape="static_equilibrium")).initialize(**fast)
    assert out.kite_force.tolist() == other.kite_force.tolist()


# --- winches


@pytest.mark.parametrize("variant", MODELS)
@pytest.mark.parametrize("given", [600.0, 480.0])
@pytest.mark.parametrize(
    "drum", [{}, {"winch_mass": 20.0, "winch_damping": 50.0, "winch_friction": 30.0}], ids=["light", "drum"]
)
def test_winch_starts_in_balance(variant, given, drum):
    model = variant(winch_control="force", winch_start="equilibrium", initial_length=given, **drum)
    inputs = {"winch_force": 3000.0, "wind_velocity": (8.0, 0.0, 0.0)}
    out = model.initialize(**inputs)
    length = out.tether_length
    # half the drag and the weight of the first segment are no part of its spring, which is what a chain's winch feels
    assert out.ground_tension == pytest.approx(3000.0, rel=1e-9)
    for _ in range(100):
        out = model.step(STEP, **inputs)
    assert out.tether_length == pytest.approx(length, rel=1e-9)
    assert not model.implausible


def test_balance_with_a_drum_that_turns():
    """At the reel-out speed u of the start: T = W + c u + F."""
    drum = {"winch_damping": 50.0, "winch_friction": 30.0}
    model = TetherDynamic(winch_control="force", winch_start="equilibrium", **drum)
    out = model.initialize(winch_force=1000.0, reel_out_speed=2.0, kite_velocity=(1.2, 0.0, 1.6))
    tension = out.ground_tension - 473.0 / out.tether_length * (2.0 / 500.0 * 500.0 - 2.0)  # its damper: the strain stays
    assert tension == pytest.approx(1000.0 + 50.0 * 2.0 + 30.0, rel=1e-4)


def test_a_stop_holds_the_winch():
    model = TetherDynamic(winch_control="force", winch_start="equilibrium", longest_length=499.0)
    assert model.initialize(winch_force=100.0).tether_length == pytest.approx(499.0, rel=1e-12)


@pytest.mark.parametrize("variant", MODELS[:-1])
def test_no_balance(variant):
    model = variant(winch_control="force", winch_start="equilibrium")
    with pytest.raises(StepRefused, match=r"no unstretched length was found .* 500 m apart, pulls with winch_force, 1\.0 N"):
        model.initialize(winch_force=1.0)


def test_kite_and_winch_cannot_both_be_sought():
    model = TetherDynamicFree(winch_control="force", winch_start="equilibrium", kite_start="equilibrium")
    with pytest.raises(StepRefused, match=r"winch_start is 2 .* and a free end starts in equilibrium, too"):
        model.initialize(winch_force=100.0)
    points = [Point("hook", (0.0, 0.0, 50.0)), Point("load", mass=100.0)]
    winch = Winch(winch_control="force", winch_start="equilibrium")
    line = Line("rope", "hook", "load", Tether(initial_length=20.0), winch=winch)
    with pytest.raises(StepRefused, match="the line rope: winch_start is 2"):
        TetherSystem(points, [line]).initialize(winch_forces={"rope": 100.0})


@pytest.mark.parametrize("variant", MODELS)
def test_winch_out_of_balance_is_told(variant):
    model = variant(winch_control="force", initial_length=498.0)
    start = model.initialize()
    model.step(STEP, winch_force=1.19 * start.ground_tension)
    assert not any("off from winch_force" in each for each in model.implausible)
    model.initialize()
    with pytest.warns(PlausibilityWarning, match="N at the start, more than 20 % off from winch_force"):
        model.step(STEP, winch_force=1.3 * start.ground_tension)
    heavy = variant(winch_control="force", initial_length=498.0, winch_mass=20.0)
    heavy.initialize()
    heavy.step(STEP, winch_force=1.3 * start.ground_tension)
    assert not heavy.implausible


# --- where the first step begins


@pytest.mark.parametrize("variant", MODELS)
def test_first_step_from_elsewhere_is_told(variant):
    model = variant()
    model.initialize()
    with pytest.warns(
        PlausibilityWarning, match="the first step begins 10 m from where the initialization put the kite end"
    ):
        model.step(STEP, kite_position=(310.0, 0.0, 400.0))
    model.initialize()
    with pytest.warns(
        PlausibilityWarning, match="the first step begins 2 m from where the initialization put the ground end"
    ):
        model.step(STEP, ground_position=(2.0, 0.0, 0.0))
    model.initialize(kite_velocity=(20.0, 0.0, 0.0))
    model.step(STEP, kite_position=(300.4, 0.0, 400.0))  # a step further along its motion: late, but no jump
    assert not any("first step" in each for each in model.implausible)


def test_first_length_from_elsewhere_is_told():
    model = TetherQuasiSteady(winch_control="length")
    model.initialize()
    with pytest.warns(PlausibilityWarning, match="a winch_length that is 5 m from the length of the start"):
        model.step(STEP, winch_length=500.0)


def test_free_end_under_the_ground_is_refused():
    model = TetherDynamicFree(ground_contact="flat", ground_height=5.0)
    with pytest.raises(StepRefused, match=r"kite_position\[3\] at the start is -5.0 m, more than 0.1 m below ground_height"):
        model.initialize(kite_position=(300.0, 0.0, -5.0))


@pytest.mark.parametrize("length", [15.0, 20.0, 25.0])  # of the shorter ones, no shape is found between the ends
def test_free_point_under_the_ground_is_refused(length):
    points = [Point("hook", (0.0, 0.0, 10.0)), Point("load", (0.0, 0.0, -10.0), mass=10.0)]
    rope = Line("rope", "hook", "load", Tether(initial_length=length, segments=4))
    system = TetherSystem(points, [rope], ground=Ground("flat"))
    with pytest.raises(StepRefused, match=r"the line rope: load.position\[3\] is -10.0 m"):
        system.initialize()


def test_a_point_that_is_sought_may_be_sought_from_anywhere():
    """The ground is at 5 m; the search for the load, whose position nobody gives, begins below it."""
    points = [Point("hook", (0.0, 0.0, 30.0)), Point("load", mass=10.0)]
    rope = Line("rope", "hook", "load", Tether(initial_length=10.0))
    out = TetherSystem(points, [rope], ground=Ground("flat", 5.0)).initialize()
    assert out.points["load"].position[2] == pytest.approx(20.0, abs=0.01)
