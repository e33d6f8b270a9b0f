"""The catenary on a flat ground: continuous where it touches down and along paths, the free one where it does not.

Forces, sag and the length on the ground jump nowhere; without contact the ground changes no bit; a winch finds its length
whatever lies on the ground, and every tether that would hang below it is laid on it.
"""

import warnings

import numpy as np
import pytest

from tetherfmu import PlausibilityWarning, Tether, TetherCatenary, TetherStraight
from touchdowns import ROPE, between, forces, held, over_ground, random_scene

pytestmark = [
    pytest.mark.filterwarnings("ignore:a segment is stretched"),  # soft ropes, so that the stretch counts
    pytest.mark.filterwarnings("ignore:a driven end"),  # of paths that lead one under the ground
]


def jumps(values):
    """Largest change between neighbours over the largest value."""
    values = np.array(values)
    return np.abs(np.diff(values, axis=0)).max() / np.abs(values).max()


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

    lengths = np.linspace(60.0, 90.0, 151)
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
    rope = over_ground(Tether(initial_length=95.0), friction)
    found = [forces(between(rope, *path(t), wind)) for t in np.linspace(0.0, 1.0, 801)]
    assert jumps(found) < 0.75 * jumps(found[::4])


# --- what must not change


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
def test_a_winch_that_is_told_a_length_reels_over_the_ground():
    kite = (60.0, 0.0, 30.0)
    tether = TetherCatenary(initial_length=95.0, ground_contact="flat", winch_control="length")
    tether.initialize(kite_position=kite, winch_length=95.0)
    for k in range(60):
        outputs = tether.step(0.1, kite_position=kite, winch_length=95.0 - 0.5 * k)
        expected = held(Tether(initial_length=outputs.tether_length), (0.0, 0.0, 0.0), kite, 0.5)
        assert np.allclose(forces(outputs), forces(expected), rtol=1e-9, atol=1e-9)


# --- whatever hangs below


def test_every_tether_that_hangs_below_the_ground_is_laid_on_it():
    """In calm air and in storms whose drag is hundreds of times the weight, with a bounded number of iterations."""
    random, count, iterations = np.random.default_rng(10), 0, []
    for _ in range(1500):
        tether, ground, kite, friction, wind, height = random_scene(random)
        wind = wind * random.choice([1.0, 10.0])
        free = TetherCatenary(tether, shape_points=201)
        hung = between(free, ground, kite, wind)
        shape = free.step(0.1, ground_position=ground, kite_position=kite, wind_velocity=wind).shape
        outputs = held(tether, ground, kite, friction, wind, height, points=41)
        if shape[:, 2].min() < height - 1e-6 * tether.initial_length:
            count += 1
            assert outputs.grounded_length > 0.0
        elif shape[:, 2].min() > height + 1e-2 * tether.initial_length:  # between two points it may hang a little lower
            assert outputs.grounded_length == 0.0
            if shape[:, 2].min() > height + 0.03 * tether.initial_length:  # beyond `touchdown.CLEAR` not a bit changes
                assert forces(outputs) == forces(hung)
        assert outputs.shape[:, 2].min() >= height - 1e-12 * tether.initial_length
        iterations.append(outputs.solver_iterations)
    assert count > 500
    assert max(iterations) < 40  # twice what the most difficult one takes here
