"""The catenary on a flat ground: another code, its equations by quadrature, and limits in closed form.

A part that hangs begins at an end with the force P of the tether on it as tension: with the load q per unstretched length

    t(s) = P - s q,   dx/ds = t/T (1 + T/EA),   T = |t|

until t is horizontal, at s = P_z/q_z; there it must touch the ground. On the ground the tether is straight, in the direction
of the tension H there. Its tension falls by friction from H to max(0, H - mu n l), with n the load that presses it down.
"""

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from mechanics import drags, line_density
from scenes import read
from tetherfmu import Environment, Tether, TetherCatenary
from touchdowns import GRAVITY, ROPE, WEIGHT, forces, held, random_scene

pytestmark = [
    pytest.mark.filterwarnings("ignore:a segment is stretched"),  # soft ropes, so that the stretch counts
    pytest.mark.filterwarnings("ignore:a driven end"),  # of paths that lead one under the ground
]

CASES = read("moorpy_touchdown.csv")
POINTS, WEIGHTS = leggauss(20)
POINTS, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS  # on 0 .. 1


def of_case(case):
    """Tether of a line of the reference file: a rope of 1000 kg/m3 that has its weight."""
    diameter = np.sqrt(4.0 * case["weight"] / (GRAVITY * np.pi * 1000.0))
    return Tether(initial_length=case["length"], axial_stiffness=case["stiffness"], diameter=diameter, density=1000.0)


@pytest.mark.parametrize("number", range(200))
def test_is_that_of_moorpy(number):
    """Its own numbers differ by 6e-8 of the largest force or of the length if its tolerance is 100 times as large."""
    case = {name: column[number] for name, column in CASES.items()}
    ends = (0.0, 0.0, case["height_a"]), (case["span"], 0.0, case["height_b"])
    outputs = held(of_case(case), *ends, case["friction"])
    found = [*outputs.ground_force[::2], *outputs.kite_force[::2]]
    expected = [case[name] for name in ("horizontal_a", "vertical_a", "horizontal_b", "vertical_b")]
    assert np.allclose(found, expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())
    assert outputs.grounded_length == pytest.approx(case["lying"], rel=1e-6)
    tensions = [np.linalg.norm(force) for force in (outputs.ground_force, outputs.kite_force)]
    assert np.allclose([outputs.ground_tension, outputs.kite_tension], tensions, rtol=1e-14, atol=0.0)
    assert outputs.max_tension == max(outputs.ground_tension, outputs.kite_tension)


# --- any tether, in wind


def load_of(tether, ground, kite, wind):
    """Weight and mean drag, per unstretched length [N/m], on the shape that the tether has without a ground.

    Under its weight and the drag on its chord; the mean of 8 places (Gauss).
    """
    chord, weight = kite - ground, np.array([0.0, 0.0, -line_density(tether) * GRAVITY])
    load = weight + drags(np.array([ground, kite]), np.zeros((2, 3)), wind, tether, Environment())[0] / np.linalg.norm(chord)
    if not np.any(wind):
        return load
    # where that load is a weight: the axes are turned
    up = -load / np.linalg.norm(load)
    east = np.cross((0.0, 1.0, 0.0) if abs(up[1]) < 0.9 else (1.0, 0.0, 0.0), up)
    axes = np.array([east, np.cross(up, east), up]) / np.linalg.norm([east, np.cross(up, east), up], axis=1)[:, None]
    heavy = Environment(gravity=np.linalg.norm(load) / line_density(tether), air_density=0.0)
    start = TetherCatenary(tether, heavy).initialize(kite_position=axes @ chord).ground_force @ axes
    places, weights = leggauss(8)
    tensions = start - (0.5 * (places + 1.0) * tether.initial_length)[:, None] * load
    sizes = np.linalg.norm(tensions, axis=1)
    along = [
        drags(np.array([np.zeros(3), t]), np.zeros((2, 3)), wind, tether, Environment())[0] / s
        for t, s in zip(tensions, sizes, strict=True)
    ]
    return weight + 0.5 * weights @ (np.array(along) * (1.0 + sizes / tether.axial_stiffness)[:, None])


def hang(end, force, load, stiffness):
    """Where the part that hangs from an end touches the ground [m], its length [m] and the tension vector there [N]."""
    length = force[2] / load[2]
    edges = length * (1.0 - np.append(0.5 ** np.arange(40), 0.0))  # finer and finer towards the ground
    arcs = (edges[:-1, None] + np.diff(edges)[:, None] * POINTS).ravel()
    weights = (np.diff(edges)[:, None] * WEIGHTS).ravel()
    tensions = force - arcs[:, None] * load
    sizes = np.linalg.norm(tensions, axis=1)
    sizes[sizes == 0.0] = 1.0
    return end + weights @ (tensions * (1.0 / sizes + 1.0 / stiffness)[:, None]), length, force - length * load


def is_in_equilibrium(scene, outputs):
    """Assert that the outputs fulfil the equations of the docstring; returns H and H_low [N]."""
    tether, ground, kite, friction, wind, height = scene
    length, stiffness = tether.initial_length, tether.axial_stiffness
    load = load_of(tether, ground, kite, wind)
    # the load of the air is a number of the kernel and of numpy, so they differ by rounding, 1e-15, over the strain
    near, far = 1e-8 * length, 1e-8 * max(outputs.max_tension, np.linalg.norm(load) * length)
    points, lengths, tensions = zip(
        hang(ground, outputs.ground_force, load, stiffness), hang(kite, outputs.kite_force, load, stiffness), strict=True
    )
    assert np.abs([points[0][2] - height, points[1][2] - height]).max() < near
    lying = length - sum(lengths)
    assert outputs.grounded_length == pytest.approx(lying, abs=near)
    assert min(lengths) >= 0.0
    way = (points[1] - points[0])[:2]
    span = np.linalg.norm(way)
    low, high = sorted(np.linalg.norm(tension) for tension in tensions)
    for tension, sign in zip(tensions, (1.0, -1.0), strict=True):
        if span > near:
            assert np.linalg.norm(tension[:2] - sign * np.linalg.norm(tension) * way / span) < far
    limit = friction * -load[2] * lying
    assert high - low <= limit + far
    if min(ground[2], kite[2]) == height:
        assert low == pytest.approx(max(0.0, high - limit), abs=far)
    if high < far:
        assert span <= lying + near
    else:
        most, least = lying * (1.0 + high / stiffness), lying * (1.0 + low / stiffness)
        assert least - near <= span <= most + near
        if low > far:
            assert span == pytest.approx(0.5 * (most + least), abs=near)
        elif friction > 0.0 and min(ground[2], kite[2]) == height:
            assert span == pytest.approx(lying + 0.5 * high**2 / (friction * -load[2] * stiffness), abs=near)
    return high, low


def test_equations_hold_for_random_tethers():
    random, kinds = np.random.default_rng(6), np.zeros(4, int)
    for _ in range(700):  # as many as find each kind 30 times
        scene = random_scene(random)
        outputs = held(*scene, points=41)
        assert outputs.shape[:, 2].min() >= scene[5] - 1e-12 * scene[0].initial_length
        assert np.allclose(outputs.shape[[0, -1]], scene[1:3], rtol=0.0, atol=1e-9 * scene[0].initial_length)
        if outputs.grounded_length > 0.0:
            high, low = is_in_equilibrium(scene, outputs)
            least = 1e-6 * outputs.max_tension
            between = min(scene[1][2], scene[2][2]) > scene[5]
            kinds += [high < least, low < least < high, low > least, between]
    assert (kinds > 30).all(), kinds  # slack, held by friction, taut up to the low end, both ends above the ground


def test_shape_is_the_curve_of_the_forces():
    """Points at equal unstretched length, by quadrature from the nearest end; those on the ground lie in a straight line."""
    random, compared = np.random.default_rng(7), 0
    for _ in range(40):
        tether, ground, kite, _, wind, height = scene = random_scene(random)
        outputs = held(*scene, points=21)
        if not 0.0 < outputs.grounded_length < tether.initial_length:
            continue
        compared += 1
        load, length = load_of(tether, ground, kite, wind), tether.initial_length
        arcs = np.linspace(0.0, length, 21)
        hanging = [force[2] / load[2] for force in (outputs.ground_force, outputs.kite_force)]
        for arc, point in zip(arcs, outputs.shape, strict=True):
            end, force, s = (
                (ground, outputs.ground_force, arc) if arc < hanging[0] else (kite, outputs.kite_force, length - arc)
            )
            if s > hanging[0 if arc < hanging[0] else 1]:
                assert point[2] == height
                continue
            if s == 0.0:
                continue
            grid = np.linspace(0.0, s, 20001)
            middle = force - 0.5 * (grid[1:] + grid[:-1])[:, None] * load
            size = np.linalg.norm(middle, axis=1)[:, None]
            curve = end + (middle * (1.0 / size + 1.0 / tether.axial_stiffness)).sum(axis=0) * s / 20000
            assert np.abs(curve - point).max() < 1e-6 * length  # of the midpoint rule near a touchdown without tension
    assert compared > 10  # most of those that are drawn lie in part


def test_ends_can_be_exchanged():
    """The same tether the other way round; with both ends on the ground its friction would act towards the other one."""
    random, lengths = np.random.default_rng(9), []
    for _ in range(500):
        tether, ground, kite, friction, wind, height = random_scene(random)
        one = held(tether, ground, kite, friction, wind, height, points=11)
        other = held(tether, kite, ground, friction, wind, height, points=11)
        far = 1e-9 * max(one.max_tension, WEIGHT * tether.initial_length)  # rounding over the strain
        assert np.allclose(one.ground_force, other.kite_force, rtol=0.0, atol=far)
        assert np.allclose(one.kite_force, other.ground_force, rtol=0.0, atol=far)
        assert np.allclose(one.shape, other.shape[::-1], rtol=0.0, atol=1e-8 * tether.initial_length)
        assert one.sag == pytest.approx(other.sag, abs=1e-8 * tether.initial_length)
        assert one.wave_time == pytest.approx(other.wave_time, rel=1e-3)  # of where the tension is 0 on the ground
        lengths.append(one.grounded_length)
    assert np.count_nonzero(lengths) > 250


# --- limits in closed form


@pytest.mark.parametrize("friction", [0.0, 0.5, 5.0])
@pytest.mark.parametrize("out", [0.0, 10.0, 49.9])
def test_slack(out, friction):
    """The part that hangs straight down from z has h + w h^2/(2 EA) = z; the rest lies without tension."""
    outputs = held(ROPE, (0.0, 0.0, 0.0), (0.0, out, 50.0), friction, points=101)
    stretch = WEIGHT / ROPE.axial_stiffness
    hanging = (np.sqrt(1.0 + 2.0 * stretch * 50.0) - 1.0) / stretch
    assert np.allclose(outputs.kite_force, (0.0, 0.0, -WEIGHT * hanging), rtol=1e-12, atol=0.0)
    assert (outputs.ground_force == 0.0).all()
    assert (outputs.ground_tension, outputs.ground_elevation) == (0.0, 0.0)
    assert outputs.ground_azimuth == (0.5 * np.pi if out else 0.0)
    assert outputs.grounded_length == pytest.approx(100.0 - hanging, rel=1e-12)
    assert np.allclose(outputs.shape[60:, 1], out, rtol=0.0, atol=1e-9)
    assert (outputs.shape[:50, 2] == 0.0).all()
    # from the chord to where it touches down
    assert outputs.sag == pytest.approx(out * 50.0 / np.hypot(out, 50.0), rel=1e-9)
    # the slack tension of `wave_time` is 1e-9 EA
    assert outputs.wave_time > 50.0 * np.sqrt(line_density(ROPE) / (1e-9 * ROPE.axial_stiffness)) * 0.99


@pytest.mark.parametrize("distance", [50.0, 100.0, 100.0 + 1e-6, 100.01, 101.0])
@pytest.mark.parametrize("friction", [0.0, 0.5, 10.0])
def test_whole_tether_on_the_ground(distance, friction):
    """Tension T and T - m L at the ends, m = mu w: EA (c - L) = T L - m L^2/2, or T^2/(2 m) where it ends in between."""
    outputs = held(ROPE, (1.0, 2.0, 3.0), (1.0, 2.0 + distance, 3.0), friction, height=3.0, points=5)
    length, pulls = 100.0, ROPE.axial_stiffness * max(0.0, distance - 100.0)
    m = friction * WEIGHT
    tension = pulls / length + 0.5 * m * length
    if tension < m * length:
        tension = np.sqrt(2.0 * m * pulls)
    assert outputs.kite_tension == pytest.approx(tension, rel=1e-8)  # rounding over the least strain, 1e-8
    assert outputs.ground_tension == pytest.approx(max(0.0, tension - m * length), rel=1e-8, abs=1e-9)
    assert outputs.grounded_length == length
    assert (outputs.ground_elevation, outputs.ground_azimuth) == (0.0, 0.5 * np.pi)
    assert (outputs.shape[:, 2] == 3.0).all()
    assert outputs.sag == 0.0


def test_whole_tether_on_the_ground_and_both_ends_in_one_place():
    outputs = held(ROPE, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, points=3)
    assert (outputs.kite_tension, outputs.grounded_length) == (0.0, 100.0)
    assert (outputs.shape == 0.0).all()


# --- ends under the ground, friction between two ends


def test_an_end_under_the_ground_takes_the_ground_with_it():
    for ends in (((0.0, 0.0, -3.0), (60.0, 0.0, 40.0)), ((60.0, 0.0, 40.0), (0.0, 0.0, -3.0))):
        sunk, lowered = held(ROPE, *ends, 0.4), held(ROPE, *ends, 0.4, height=-3.0)
        assert forces(sunk) == forces(lowered)
        assert sunk.grounded_length > 0.0


def test_friction_between_two_ends_resists_the_higher_one():
    """It is 0 where they are at the same height, and that of a tether from the ground where one of them is there."""
    low, high = (0.0, 0.0, 10.0), (70.0, 0.0, 30.0)
    without, held_back = held(ROPE, low, high, 0.0), held(ROPE, low, high, 0.5)
    assert held_back.ground_force[0] < without.ground_force[0] < -held_back.kite_force[0]
    level = held(ROPE, low, (85.0, 0.0, 10.0), 0.5)
    assert level.ground_force[0] == pytest.approx(-level.kite_force[0], rel=1e-9)
    assert level.grounded_length > 10.0


def test_sag_is_the_largest_distance_from_the_chord():
    """Of 2001 points of the shape; it may lie between two of them, which are 5e-4 L apart but for the stretch.

    On the ground or not; in many of these scenes the tether is farthest from an end of its chord, beyond which it hangs.
    """
    random, lying, beyond = np.random.default_rng(11), 0, 0
    for _ in range(150):
        tether, ground, kite, friction, wind, height = random_scene(random)
        height -= random.choice([0.0, 1e3])
        outputs = held(tether, ground, kite, friction, wind, height, points=2001)
        chord = kite - ground
        places = (outputs.shape - ground) @ chord / (chord @ chord)
        distances = np.linalg.norm(outputs.shape - ground - np.outer(np.clip(places, 0.0, 1.0), chord), axis=1)
        assert -1e-9 < (outputs.sag - distances.max()) / tether.initial_length < 5e-4
        lying += outputs.grounded_length > 0.0
        beyond += not 0.0 < places[distances.argmax()] < 1.0
    assert lying > 50
    assert beyond > 20


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("station", [0.0, 3.0])
def test_wave_time_is_the_integral_over_the_three_parts(friction, station):
    """sqrt(mu (1 + T/EA)/T) over the length; on the ground T falls evenly. 24 pieces of each part make 1e-3 of it."""
    ground, kite, length = (0.0, 0.0, station), (92.0, 0.0, 20.0), 100.0
    outputs = held(ROPE, ground, kite, friction)
    load = np.array([0.0, 0.0, -WEIGHT])
    assert outputs.ground_tension > 0.5
    assert 5.0 < outputs.grounded_length < 0.9 * length
    sizes = []
    for force in (outputs.ground_force, outputs.kite_force):
        arcs = (np.arange(10000) + 0.5) * force[2] / load[2] / 10000
        sizes.append((force[2] / load[2], np.linalg.norm(force - arcs[:, None] * load, axis=1)))
    on_ground = np.linspace(abs(outputs.ground_force[0]), abs(outputs.kite_force[0]), 10000)
    sizes.append((outputs.grounded_length, on_ground))
    slowness = [
        part * np.mean(np.sqrt(line_density(ROPE) * (1.0 + size / ROPE.axial_stiffness) / size))
        for part, size in sizes
        if part > 0.0
    ]
    assert outputs.wave_time == pytest.approx(sum(slowness), rel=1e-3)
