"""A free kite or load that starts in equilibrium: `kite_start`.

chain of n segments between node 0 (given) and node n (free), all at rest, L/n = l0:
    T_s = EA (|r_s|/l0 - 1),   D_s = 1/2 rho c_d d |r_s| |w_p| w_p,   w_p = the wind across r_s at the height of its middle
    inner node:  T_(s+1) e_(s+1) - T_s e_s + (D_s + D_(s+1))/2 - mu l0 g e_z = 0
    free end:    load - T_n e_n + D_n/2 - (M + mu l0/2) g e_z = 0
Without wind the tensions follow from the end: T_s e_s = load - (M + (n - s + 1/2) mu l0) g e_z.
"""

import numpy as np
import pytest
from scipy.optimize import fsolve

from tetherfmu import (
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
SHEARED = {"wind_profile": "power_law", "wind_exponent": 0.2, "wind_reference_height": 10.0}
LENGTH = WIRE.initial_length / WIRE.segments


def started(mass, wind=(0.0, 0.0, 0.0), load=(0.0, 0.0, 0.0), tether=WIRE, begin=(0.0, 0.0, 20.0), **options):
    """A kite of this mass [kg] that has started in equilibrium, and its first outputs."""
    kite = TetherDynamicFree(tether, kite_mass=mass, kite_start="equilibrium", **options)
    given = {"ground_position": TIP, "wind_velocity": wind, "kite_load": load}
    return kite, kite.initialize(begin, (1.0, 2.0, 3.0), **given)


def chain_of(tensions, tether):
    """Vectors of the segments [m] and nodes [m] of a chain with these tension vectors [N], (n, 3)."""
    rest, size = tether.initial_length / tether.segments, np.linalg.norm(tensions, axis=1)[:, None]
    r = rest * (1.0 / size + 1.0 / tether.axial_stiffness) * tensions
    return r, TIP + np.vstack([np.zeros(3), np.cumsum(r, axis=0)])


def forces_of_nodes(tensions, tether, mass, wind, load):
    """Forces [N] on the nodes 1 .. n of a chain with these tension vectors [N], by the formulas above; flat arrays.

    The wind grows with the power law.
    """
    pull = tensions.reshape(-1, 3)
    r, nodes = chain_of(pull, tether)
    length, rest = np.linalg.norm(r, axis=1)[:, None], tether.initial_length / tether.segments
    e, height = r / length, 0.5 * (nodes[1:] + nodes[:-1])[:, 2:]
    w = np.asarray(wind) * (height / 10.0) ** 0.2
    across = w - np.sum(w * e, axis=1)[:, None] * e
    width = tether.drag_coefficient * tether.diameter
    drag = 0.5 * 1.225 * width * length * np.linalg.norm(across, axis=1)[:, None] * across
    forces = 0.5 * drag - pull
    forces[:-1] += pull[1:] + 0.5 * drag[1:]
    forces[:, 2] -= tether.mass_per_length * rest * G
    forces[-1] += np.add(load, (0.0, 0.0, (0.5 * tether.mass_per_length * rest - mass) * G))
    return forces.ravel()


SCENES = {
    "load in wind": (500.0, (15.0, 3.0, 0.0), (0.0, 0.0, 0.0), (3.0, -2.0, 21.0)),
    "light load in a storm": (2.0, (30.0, -10.0, 2.0), (0.0, 0.0, 0.0), (3.0, -2.0, 21.0)),
    "balloon": (5.0, (6.0, 2.0, 0.0), (20.0, 0.0, 600.0), (3.0, -2.0, 99.0)),
    "from the wrong side": (500.0, (15.0, 3.0, 0.0), (0.0, 0.0, 0.0), (3.0, -2.0, 99.0)),
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_forces_are_in_balance_as_an_independent_solver_finds_it(scene):
    mass, wind, load, begin = scene
    kite, outputs = started(mass, wind, load, begin=begin, **SHEARED)
    total = outputs.kite_force + np.subtract(load, (0.0, 0.0, mass * G))
    assert np.linalg.norm(total) <= 1e-9 * max(np.linalg.norm(outputs.kite_force), mass * G)
    guess = np.tile(np.add(load, (0.0, 0.0, -(mass + 0.5 * WIRE.mass_per_length * 40.0) * G)), (6, 1))
    found, _, done, _ = fsolve(forces_of_nodes, guess, (WIRE, mass, wind, load), full_output=True, xtol=1e-13)
    assert done == 1
    expected = chain_of(found.reshape(-1, 3), WIRE)[1]
    # 1e-9 of the force over m g/L, the stiffness of a pendulum
    np.testing.assert_allclose(kite.positions, expected, rtol=0.0, atol=1e-7)


def test_tensions_without_wind_follow_from_the_load():
    load, mass = (300.0, -100.0, 2000.0), 50.0
    _, outputs = started(mass, load=load)
    position = TIP.copy()
    for s in range(1, 7):
        t = np.subtract(load, (0.0, 0.0, (mass + (6 - s + 0.5) * WIRE.mass_per_length * LENGTH) * G))
        position += LENGTH * (1.0 / np.linalg.norm(t) + 1.0 / WIRE.axial_stiffness) * t
    np.testing.assert_allclose(outputs.kite_position, position, rtol=0.0, atol=1e-9)


def test_it_starts_at_rest_and_stays_there():
    kite, start = started(500.0, (15.0, 3.0, 0.0), initial_shape="straight")
    assert start.kite_velocity.tolist() == [0.0, 0.0, 0.0]
    for _ in range(50):
        outputs = kite.step(0.02)
    np.testing.assert_allclose(outputs.kite_position, start.kite_position, rtol=0.0, atol=1e-9)
    assert kite.counters["rejections"] == 0


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
    assert kite.step(0.02).kite_position == pytest.approx(expected.kite_position, abs=1e-9)


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
