"""A free kite or load that starts in equilibrium: `kite_start`.

By `balance.py` the forces of all nodes add up to 0, at the free end with load and weight.
"""

import numpy as np
import pytest

from balance import residual
from mechanics import drags, line_density
from tetherfmu import (
    Environment,
    Line,
    PlausibilityWarning,
    Point,
    Solver,
    StepRefused,
    Tether,
    TetherDynamicFree,
    TetherSystem,
    tether_of,
)

G, TIP = 9.81, np.array((3.0, -2.0, 60.0))
WIRE = tether_of("steel", 0.012, initial_length=40.0, segments=6)
SHEARED = Environment(wind_profile="power_law", wind_exponent=0.2, wind_reference_height=10.0)
LENGTH, MU = WIRE.initial_length / WIRE.segments, line_density(WIRE)


def started(mass, wind=(0.0, 0.0, 0.0), load=(0.0, 0.0, 0.0), tether=WIRE, begin=(0.0, 0.0, 20.0), **options):
    """A kite of this mass [kg] that has started in equilibrium, and its first outputs."""
    kite = TetherDynamicFree(tether, kite_mass=mass, kite_start="equilibrium", **options)
    given = {"ground_position": TIP, "wind_velocity": wind, "kite_load": load}
    return kite, kite.initialize(begin, (1.0, 2.0, 3.0), **given)


SCENES = {
    "load in wind": (500.0, (15.0, 3.0, 0.0), (0.0, 0.0, 0.0), (3.0, -2.0, 21.0)),
    "light load in a storm": (2.0, (30.0, -10.0, 2.0), (0.0, 0.0, 0.0), (3.0, -2.0, 21.0)),
    "balloon": (5.0, (6.0, 2.0, 0.0), (20.0, 0.0, 600.0), (3.0, -2.0, 99.0)),
    "from the wrong side": (500.0, (15.0, 3.0, 0.0), (0.0, 0.0, 0.0), (3.0, -2.0, 99.0)),
    "no wind": (50.0, (0.0, 0.0, 0.0), (300.0, -100.0, 2000.0), (3.0, -2.0, 20.0)),
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_forces_are_in_balance(scene):
    """Of all nodes, from their positions alone, and of the outputs; there is one equilibrium under tension."""
    mass, wind, load, begin = scene
    kite, outputs = started(mass, wind, load, begin=begin, environment=SHEARED)
    assert not outputs.kite_velocity.any()
    x = kite.positions
    missing, tensions = residual(x, np.zeros(3), wind, WIRE, SHEARED)
    assert np.abs(missing).max() < 1e-9 * tensions.max()
    drag, half_weight = drags(x, np.zeros_like(x), wind, WIRE, SHEARED), np.array((0.0, 0.0, -0.5 * MU * LENGTH * G))
    pull = -tensions[-1] * (x[-1] - x[-2]) / np.linalg.norm(x[-1] - x[-2])
    size = 1e-9 * max(tensions.max(), mass * G)
    np.testing.assert_allclose(outputs.kite_force, pull + 0.5 * drag[-1] + half_weight, rtol=0.0, atol=size)
    np.testing.assert_allclose(outputs.kite_force, np.subtract((0.0, 0.0, mass * G), load), rtol=0.0, atol=size)
    whole = drag.sum(axis=0) + 12.0 * half_weight - outputs.kite_force
    np.testing.assert_allclose(outputs.ground_force, whole, rtol=0.0, atol=10.0 * size)


def test_a_winch_that_pays_out_does_not_move_the_place():
    """The damper force of a tether that reels is none of an equilibrium."""
    kite = TetherDynamicFree(WIRE, kite_mass=500.0, kite_start="equilibrium")
    given = {"ground_position": TIP, "kite_position": (3.0, -2.0, 20.0)}
    expected = kite.initialize(**given).kite_position
    reeling = kite.initialize(**given, reel_out_speed=0.5)
    np.testing.assert_array_equal(reeling.kite_position, expected)
    assert reeling.winch_speed == 0.5


def test_it_is_a_system_of_one_line():
    wind, load = (12.0, 4.0, 0.0), (100.0, 0.0, 50.0)
    kite, outputs = started(80.0, wind, load)
    system = TetherSystem([Point("tip", TIP), Point("load", mass=80.0)], [Line("wire", "tip", "load", WIRE)])
    expected = system.initialize(wind, loads={"load": load})
    np.testing.assert_allclose(outputs.kite_position, expected.points["load"].position, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(kite.positions, system.positions["wire"], rtol=0.0, atol=1e-9)


def test_wind_at_points_deflects_it():
    wind = (15.0, 3.0, 0.0)
    _, expected = started(500.0, wind)
    kite = TetherDynamicFree(WIRE, kite_mass=500.0, kite_start="equilibrium", wind_points=3)
    outputs = kite.initialize((3.0, -2.0, 21.0), ground_position=TIP, wind_at=[wind] * 3)
    np.testing.assert_allclose(outputs.kite_position, expected.kite_position, rtol=0.0, atol=1e-9)
    for _ in range(50):  # it stays there
        outputs = kite.step(0.02)
    np.testing.assert_allclose(outputs.kite_position, expected.kite_position, rtol=0.0, atol=1e-9)
    assert kite.counters["rejections"] == 0


@pytest.mark.parametrize("height", [19.0, 30.0], ids=["hangs above", "lies"])
def test_on_the_ground(height):
    """A load that lies is carried in proportion to its depth, where it was put: friction holds it."""
    place = np.array((TIP[0] + 5.0, TIP[1], height))
    _, outputs = started(100.0, begin=place, ground_contact="flat", ground_height=height, ground_sink=0.002)
    if height == 19.0:
        assert outputs.kite_force[2] == pytest.approx(100.0 * G, rel=1e-9)
        return
    carried = 100.0 * G - outputs.kite_force[2]
    depth = height - outputs.kite_position[2]
    assert carried == pytest.approx((100.0 + 0.5 * WIRE.mass_per_length * LENGTH) * G * depth / 0.002, rel=1e-9)
    np.testing.assert_allclose(outputs.kite_position[:2], place[:2], rtol=0.0, atol=1e-3)


@pytest.mark.filterwarnings("ignore:a segment is stretched")
def test_without_an_equilibrium_it_is_refused_and_nothing_is_changed():
    soft = Tether(segments=4, initial_length=30.0, axial_stiffness=1.0)  # its drag grows as its length
    kite = TetherDynamicFree(soft, kite_mass=1.0, kite_start="equilibrium")
    kite.initialize((0.0, 0.0, -30.0))
    before = kite.get_state()
    with pytest.raises(StepRefused, match="no equilibrium was found in which the free kite is at rest; check kite_load"):
        kite.initialize((0.0, 0.0, -30.0), wind_velocity=(100.0, 0.0, 0.0))
    np.testing.assert_array_equal(kite.get_state(), before)
    with pytest.raises(ValueError, match=r"kite_start is 3; it must be one of 1 \(given\), 2 \(equilibrium\)"):
        TetherDynamicFree(kite_start=3)


def test_nodes_that_are_given_are_not_sought():
    kite, _ = started(500.0)
    nodes = np.add(kite.positions, (0.0, 1.0, 0.0))
    assert kite.initialize(positions=nodes).kite_position == pytest.approx(nodes[-1], abs=1e-12)


def test_warnings_of_the_start_are_those_of_any_other_start():
    """`plausibility.note_damping_of_steps`: 0.02 s x EA is more than a tenth of the axial damping."""
    solver = Solver(fixed_step=0.02, fixed_step_method="backward_euler")
    with pytest.warns(PlausibilityWarning, match="backward Euler with this fixed_step damps"):
        started(5.0, solver=solver)
