"""The catenary on a flat ground: another code, its equations by quadrature, limits in closed form, and what must not change.

A part that hangs begins at an end with the force P of the tether on it as tension: with the load q per unstretched length

    t(s) = P - s q,   dx/ds = t/T (1 + T/EA),   T = |t|

until t is horizontal, at s = P_z/q_z; there it must touch the ground. On the ground the tether is straight, in the direction
of the tension H there. Its tension falls by friction from H to max(0, H - mu n l), with n the load that presses it down.
"""

import warnings

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from mechanics import drags, line_density
from scenes import read
from tetherfmu import PlausibilityWarning
from tetherfmu.models import TetherCatenary, TetherStraight
from tetherfmu.runtime.parameters import Environment, Tether

pytestmark = [
    pytest.mark.filterwarnings("ignore:a segment is stretched"),  # soft ropes, so that the stretch counts
    pytest.mark.filterwarnings("ignore:a driven end"),  # of paths that lead one under the ground
]

GRAVITY = 9.81
ROPE = Tether(initial_length=100.0, axial_stiffness=1e5)
WEIGHT = line_density(ROPE) * GRAVITY  # per unstretched length [N/m]
CASES = read("moorpy_touchdown.csv")
POINTS, WEIGHTS = leggauss(20)
POINTS, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS  # on 0 .. 1


def held(tether, ground, kite, friction=0.0, wind=(0.0, 0.0, 0.0), height=0.0, points=0, model=TetherCatenary):
    """Outputs of a tether that lies on a ground at a height [m] between two ends [m]."""
    place = {"ground_contact": "flat", "ground_friction": friction, "ground_height": height}
    started = model(tether, **place, shape_points=points)
    return started.initialize(ground_position=ground, kite_position=kite, wind_velocity=wind)


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


def random_scene(random):
    """Tether, ends [m], friction, wind [m/s] and height of the ground [m] of a tether that is likely to touch it."""
    length = 10.0 ** random.uniform(1.0, 3.0)
    tether = Tether(initial_length=length, axial_stiffness=10.0 ** random.uniform(3.0, 7.0))
    heights = length * np.array([random.choice([0.0, random.uniform(0.0, 0.3)]), random.uniform(0.0, 0.8)])
    random.shuffle(heights)
    out, azimuth = length * random.uniform(0.0, 1.0), random.uniform(-np.pi, np.pi)
    height = random.uniform(-50.0, 50.0)
    ground = np.array([*random.uniform(-50.0, 50.0, 2), height + heights[0]])
    kite = np.array([ground[0] + out * np.cos(azimuth), ground[1] + out * np.sin(azimuth), height + heights[1]])
    wind = random.choice([0.0, 2.0, 8.0]) * random.normal(size=3) * (1.0, 1.0, 0.3)
    return tether, ground, kite, random.choice([0.0, random.uniform(0.0, 1.5)]), wind, height


def load_of(tether, ground, kite, wind):
    """Weight and mean drag on the chord, both per length [N/m]."""
    chord = np.linalg.norm(kite - ground)
    drag = drags(np.array([ground, kite]), np.zeros((2, 3)), wind, tether, Environment())[0] / chord
    return drag - (0.0, 0.0, line_density(tether) * GRAVITY)


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
    for _ in range(1500):
        scene = random_scene(random)
        outputs = held(*scene, points=41)
        assert outputs.shape[:, 2].min() >= scene[5] - 1e-12 * scene[0].initial_length
        assert np.allclose(outputs.shape[[0, -1]], scene[1:3], rtol=0.0, atol=1e-9 * scene[0].initial_length)
        if outputs.grounded_length > 0.0:
            high, low = is_in_equilibrium(scene, outputs)
            least = 1e-6 * outputs.max_tension
            between = min(scene[1][2], scene[2][2]) > scene[5]
            kinds += [high < least, low < least < high, low > least, between]
    assert (kinds > 50).all(), kinds  # slack, held by friction, taut up to the low end, both ends above the ground


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


def test_what_is_missing_from_the_weight_lies_on_the_ground():
    """The ends carry the weight of the parts that hang; friction takes up to mu w l of their horizontal forces."""
    random, count = np.random.default_rng(8), 0
    for _ in range(500):
        tether, ground, kite, friction, _, height = random_scene(random)
        outputs = held(tether, ground, kite, friction, height=height)
        total, weight = outputs.ground_force + outputs.kite_force, line_density(tether) * GRAVITY
        lying = outputs.grounded_length
        largest = max(outputs.max_tension, weight * tether.initial_length)
        assert total[2] == pytest.approx(-weight * (tether.initial_length - lying), abs=1e-12 * largest)
        assert np.linalg.norm(total[:2]) <= friction * weight * lying + 1e-12 * largest
        count += lying > 0.0
    assert count > 250


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
    assert outputs.sag == pytest.approx(
        out * 50.0 / np.hypot(out, 50.0), rel=1e-9
    )  # from the chord to where it touches down
    # the slack tension of `wave_time` is 1e-9 EA
    assert outputs.wave_time > 50.0 * np.sqrt(line_density(ROPE) / (1e-9 * ROPE.axial_stiffness)) * 0.99


def test_slack_between_two_ends_above_the_ground():
    outputs = held(ROPE, (0.0, 0.0, 4.0), (30.0, 0.0, 20.0), 0.3)
    assert np.allclose(outputs.ground_force, (0.0, 0.0, -4.0 * WEIGHT), rtol=1e-3, atol=0.0)  # stretched by their weight
    assert np.allclose(outputs.kite_force, (0.0, 0.0, -20.0 * WEIGHT), rtol=1e-3, atol=0.0)


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


def jumps(values):
    """Largest change between neighbours over the largest value."""
    values = np.array(values)
    return np.abs(np.diff(values, axis=0)).max() / np.abs(values).max()


def forces(outputs):
    return [*outputs.ground_force, *outputs.kite_force, outputs.sag, outputs.grounded_length]


@pytest.mark.parametrize("friction", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("station", [0.0, 5.0])
@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (4.0, 3.0, 0.0)])
def test_numbers_are_continuous_where_it_touches_the_ground(station, friction, wind):
    """Where the free tether just touches, its forces are those of one that lies; the length on the ground begins at 0.

    Near there it grows with the root of how much longer the tether is: 1e-7 m more lie as up to 1e-2 m.
    """
    ends = (0.0, 0.0, station), (60.0, 10.0, 30.0)

    def outputs_with(length):
        return held(Tether(initial_length=length), *ends, friction, wind)

    lengths = np.linspace(60.0, 90.0, 601)
    lies = [outputs_with(length).grounded_length > 0.0 for length in lengths]
    first = int(np.argmax(lies))
    assert first > 0
    assert all(lies[first:])
    low, high = lengths[first - 1 : first + 1]
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if outputs_with(middle).grounded_length > 0.0 else (middle, high)
    below, above = forces(outputs_with(low)), forces(outputs_with(high))
    assert np.allclose(below[:7], above[:7], rtol=0.0, atol=1e-3 * max(np.abs(below[:6])))
    assert 0.0 < above[7] < 2e-2
    closer = forces(outputs_with(low + 0.01 * (high - low)))
    assert np.abs(np.subtract(closer, below))[:6].max() <= np.abs(np.subtract(above, below))[:6].max()


@pytest.mark.parametrize("friction", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (4.0, 3.0, 0.0)])
@pytest.mark.parametrize(
    "path",
    [
        lambda t: ((0.0, 0.0, 5.0 * t), (50.0, 0.0, 40.0)),  # the station rises from the ground
        lambda t: ((0.0, 0.0, 0.0), (50.0, 0.0, 40.0 * t)),  # the kite rises from the ground
        lambda t: ((0.0, 0.0, 5.0), (50.0, 0.0, 40.0 * t)),  # and past the height of the station
        lambda t: ((0.0, 0.0, 2.0 - 4.0 * t), (50.0, 0.0, 40.0)),  # the station sinks into the ground
        lambda t: ((0.0, 0.0, 0.0), (20.0, 0.0, 40.0 - 80.0 * t)),  # the kite sinks into the ground
        lambda t: ((0.0, 0.0, 0.0), (100.0 * t, 0.0, 40.0)),  # from slack to taut
        lambda t: ((0.0, 0.0, 0.0), (60.0 - 120.0 * t, 1.0, 40.0)),  # the kite crosses the station
    ],
)
def test_numbers_are_continuous_along_a_path(path, wind, friction):
    """Four times as many steps along it make the largest jump smaller, by a factor above that of a root where it begins."""
    rope = Tether(initial_length=95.0)
    found = [forces(held(rope, *path(t), friction, wind)) for t in np.linspace(0.0, 1.0, 1601)]
    assert jumps(found) < 0.75 * jumps(found[::4])


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


# --- what must not change


SCENES = [
    {"initial_length": 100.0, "kite_position": (60.0, 20.0, 70.0), "wind_velocity": (3.0, 1.0, 0.0)},  # is above the ground
    {"initial_length": 100.0, "kite_position": (0.0, 90.0, 45.0)},
    {"initial_length": 100.0, "kite_position": (10.0, 0.0, -99.0)},
]


def every_number(tether, scene, reel_out_speed=0.1):
    scene = {name: value for name, value in scene.items() if name != "initial_length"}
    tether.initialize(**scene)
    return [tether.step(0.05, **scene, reel_out_speed=reel_out_speed) for _ in range(3)]


@pytest.mark.parametrize("scene", SCENES)
def test_without_contact_not_a_bit_changes(scene):
    ground_height = min(0.0, scene["kite_position"][2]) - 0.5
    options = {"initial_length": scene["initial_length"], "shape_points": 9}
    free = every_number(TetherCatenary(**options), scene)
    over = every_number(TetherCatenary(**options, ground_contact="flat", ground_height=ground_height), scene)
    for one, other in zip(free, over, strict=True):
        assert other.grounded_length == 0.0
        for name in vars(one) if hasattr(one, "__dict__") else one._fields:
            assert np.array_equal(getattr(one, name), getattr(other, name)), name


def test_the_straight_tether_ignores_the_ground():
    outputs = held(ROPE, (0.0, 0.0, 0.0), (60.0, 0.0, 10.0), 0.5, height=5.0, model=TetherStraight)
    free = TetherStraight(ROPE).initialize(kite_position=(60.0, 0.0, 10.0))
    assert outputs.grounded_length == 0.0
    assert np.array_equal(outputs.kite_force, free.kite_force)


def warned(**options):
    """Sentences about the ground of a tether that hangs 10 m below z = 0."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        tether = TetherCatenary(initial_length=100.0, **options)
        tether.initialize(kite_position=(60.0, 0.0, 50.0))
        tether.step(0.1, kite_position=(60.0, 0.0, 50.0))
    return [str(each.message) for each in caught if issubclass(each.category, PlausibilityWarning)]


def test_a_ground_that_is_ignored_is_noted_once():
    (sentence,) = warned()
    assert "ground_contact" in sentence
    assert warned(ground_contact="flat") == []
    assert warned(ground_height=-10.0) == []  # 0.3 m below: less than 1 % of the length
    assert warned(ground_height=1.0) == []  # the station is below the ground itself


# --- winches


@pytest.mark.filterwarnings("ignore:the winch pulls with 3 N at a slack tether")
@pytest.mark.parametrize("mass", [0.0, 20.0])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_winch_that_is_told_a_force_finds_its_length_on_the_ground(mass, friction):
    """At rest the tension at the ground is the force of the winch, whatever lies on the ground."""
    kite, force = (85.0, 0.0, 5.0), 3.0
    options = {"initial_length": 100.0, "ground_contact": "flat", "ground_friction": friction}
    tether = TetherCatenary(**options, winch_control="force", winch_mass=mass, winch_damping=20.0 if mass else 0.0)
    outputs = tether.initialize(kite_position=kite, winch_force=force)
    assert outputs.grounded_length > 80.0
    for _ in range(1500 if mass else 2):
        outputs = tether.step(0.1, kite_position=kite, winch_force=force)
    assert outputs.ground_tension == pytest.approx(force, rel=1e-6)
    assert 1.0 < outputs.grounded_length < 80.0


@pytest.mark.filterwarnings("ignore:the length that the winch follows")
def test_a_winch_that_is_told_a_length_reels_the_tether_over_the_ground():
    kite = (60.0, 0.0, 30.0)
    tether = TetherCatenary(initial_length=95.0, ground_contact="flat", winch_control="length")
    tether.initialize(kite_position=kite, winch_length=95.0)
    for k in range(60):
        length = 95.0 - 0.5 * k
        outputs = tether.step(0.1, kite_position=kite, winch_length=length)
        expected = held(Tether(initial_length=outputs.tether_length), (0.0, 0.0, 0.0), kite, 0.5)
        assert np.allclose(forces(outputs), forces(expected), rtol=1e-9, atol=1e-9)


def test_every_tether_that_hangs_below_the_ground_is_laid_on_it():
    """In calm air and in storms whose drag is hundreds of times the weight, with a bounded number of iterations."""
    random, count, iterations = np.random.default_rng(10), 0, []
    for _ in range(1500):
        tether, ground, kite, friction, wind, height = random_scene(random)
        wind = wind * random.choice([1.0, 10.0])
        free = TetherCatenary(tether, shape_points=201)
        free.initialize(ground_position=ground, kite_position=kite, wind_velocity=wind)
        shape = free.step(0.1, ground_position=ground, kite_position=kite, wind_velocity=wind).shape
        outputs = held(tether, ground, kite, friction, wind, height, points=41)
        if shape[:, 2].min() < height - 1e-6 * tether.initial_length:
            count += 1
            assert outputs.grounded_length > 0.0
        elif shape[:, 2].min() > height + 1e-2 * tether.initial_length:  # between two points it may hang a little lower
            assert outputs.grounded_length == 0.0
        assert outputs.shape[:, 2].min() >= height - 1e-12 * tether.initial_length
        iterations.append(outputs.solver_iterations)
    assert count > 500
    assert max(iterations) < 40  # twice what the most difficult one takes here


def test_sag_is_the_largest_distance_from_the_chord():
    """Of 2001 points of the shape; it may lie between two of them, which are 5e-4 L apart but for the stretch."""
    random, count = np.random.default_rng(11), 0
    for _ in range(100):
        tether, ground, kite, *_ = scene = random_scene(random)
        outputs = held(*scene, points=2001)
        chord = kite - ground
        places = np.clip((outputs.shape - ground) @ chord / (chord @ chord), 0.0, 1.0)
        distances = np.linalg.norm(outputs.shape - ground - np.outer(places, chord), axis=1)
        assert -1e-9 < (outputs.sag - distances.max()) / tether.initial_length < 5e-4
        count += outputs.grounded_length > 0.0
    assert count > 50


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
