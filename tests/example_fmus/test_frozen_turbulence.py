"""Frozen turbulence against formulas: exact on the grid and for linear fields, periodic, carried downwind, with signs."""

from functools import partial

import numpy as np
import pytest

from tetherfmu.wind import frozen_turbulence as frozen
from tetherfmu.wind import wind_boxes as boxes

SPACING, POINTS = (4.0, 8.0, 2.0), (16, 5, 7)  # powers of 2: places of points are exact
STILL = frozen.MeanWind(0.0)


def box_of(velocity, spacing=SPACING, **more):
    """`Box` of an array (along, across, up, 3), in the order of space."""
    strides = [each // velocity.itemsize for each in velocity.strides]
    numbers = velocity.ravel()
    components = [numbers[component:] for component in range(3)]
    return boxes.of_space("box", components, strides[:3], velocity.shape[:3], spacing)._replace(**more)


def random_velocity(seed=5):
    return np.random.default_rng(seed).normal(size=(*POINTS, 3))


def places_of(box):
    """Places of the points of a box at the start, (points, 3), in the order of its array."""
    axes = [first + step * np.arange(count) for first, step, count in zip(box.first, box.spacing, box.points, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize("periodic", [True, False])
def test_the_points_of_the_grid_have_their_numbers(periodic):
    velocity = random_velocity()
    box = box_of(velocity)
    wind = frozen.FrozenTurbulence(STILL, box, periodic=periodic).at(0.0, places_of(box))
    assert np.array_equal(wind, velocity.reshape(-1, 3))


def test_the_numbers_of_turbsim_within_its_heights():
    """It contains its mean wind: nothing is added, whatever the profile; a plane passes x = 0 at the time of its number."""
    velocity = random_velocity()
    box = box_of(velocity, mean=(8.0, 4.0), first=(0.0, -16.0, 1.0), spacing=(-4.0, 8.0, 2.0))
    wind = frozen.FrozenTurbulence(STILL._replace(exponent=0.3), box)
    plane = np.array([(0.0, y, z) for y in -16.0 + 8.0 * np.arange(5) for z in 1.0 + 2.0 * np.arange(7)])
    for k in range(POINTS[0]):
        assert np.array_equal(wind.at(0.5 * k, plane), velocity[k].reshape(-1, 3))


def test_a_linear_field_is_exact():
    matrix, constant = np.random.default_rng(6).normal(size=(3, 3)), np.array([1.0, 2.0, 3.0])
    box = box_of(np.zeros((*POINTS, 3)))
    box = box_of((places_of(box) @ matrix.T + constant).reshape(*POINTS, 3))
    low, high = places_of(box)[0], places_of(box)[-1]
    points = np.random.default_rng(7).uniform(low, high, (200, 3))
    wind = frozen.FrozenTurbulence(STILL, box).at(0.0, points)
    np.testing.assert_allclose(wind, points @ matrix.T + constant, rtol=0.0, atol=1e-12)  # rounding of 100 m/s


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_it_is_periodic(axis):
    """n points on n spacings: 1e-12 is the rounding of places of 1e3 m, over a spacing, times differences of some m/s."""
    wind = frozen.FrozenTurbulence(STILL, box_of(random_velocity()))
    points = np.random.default_rng(8).uniform(-50.0, 50.0, (100, 3))
    period = np.zeros(3)
    period[axis] = 3 * POINTS[axis] * SPACING[axis]
    np.testing.assert_allclose(wind.at(0.0, points + period), wind.at(0.0, points), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("mean", [None, (8.0, 4.0)])
def test_it_is_continuous(mean):
    """Along lines through faces of cells, of the box, and the ground: 1e-6 m change it by 1e-6 m times slopes."""
    box = box_of(random_velocity(), mean=mean)
    wind = frozen.FrozenTurbulence(frozen.MeanWind(8.0, 0.4, 4.0, 0.5), box)
    for k in range(3):
        crossing = np.arange(-40.0, 80.0, SPACING[k])[:, None, None] * np.eye(3)[k] + [0.3, 0.7, 0.9 * (k != 2)]
        sides = crossing + np.array([-5e-7, 5e-7])[:, None] * np.eye(3)[k]
        below, above = wind.at(0.0, sides.reshape(-1, 3)).reshape(-1, 2, 3).swapaxes(0, 1)
        # slopes: 8 m/s over 2 m; the profile at the ground goes as the root of z/h: 8 sqrt(5e-7/4) m/s
        assert np.abs(above - below).max() < (3e-3 if k == 2 else 1e-5)


@pytest.mark.parametrize("in_order_of_arrival", [False, True])
def test_a_gust_is_felt_downwind_later(in_order_of_arrival):
    """By d/U; at the origin first what is at the front, the last plane of a Mann box, the first one of TurbSim's."""
    velocity = np.zeros((*POINTS, 3))
    velocity[6, :, :, 0] = 1.0
    box = box_of(velocity)
    arrives = (15 - 6) * 4.0
    if in_order_of_arrival:
        box = box._replace(first=(0.0, *box.first[1:]), spacing=(-4.0, 8.0, 2.0), mean=(8.0, 1.0))
        arrives = 6 * 4.0
    wind = frozen.FrozenTurbulence(frozen.MeanWind(8.0), box)
    extra = 0.0 if in_order_of_arrival else 8.0
    for distance in (0.0, 12.0, -16.0):
        felt = [wind.at(time, np.array([[distance, 0.0, 2.0]]))[0, 0] - extra for time in np.arange(0.0, 8.0, 0.25)]
        assert np.argmax(felt) * 0.25 == (arrives + distance) / 8.0
        assert max(felt) == 1.0


def test_the_box_turns_with_the_wind():
    """Its axes, and the velocities along them: in a wind along y, left of it is -x."""
    velocity = random_velocity()
    box = box_of(velocity)
    ahead = frozen.FrozenTurbulence(frozen.MeanWind(8.0), box)
    turned = frozen.FrozenTurbulence(frozen.MeanWind(8.0, 0.5 * np.pi), box)
    points = np.random.default_rng(9).uniform(-30.0, 30.0, (50, 3))
    x, y, z = points.T
    u, v, w = ahead.at(1.5, points).T
    np.testing.assert_allclose(turned.at(1.5, np.stack((-y, x, z), 1)), np.stack((-v, u, w), 1), rtol=0.0, atol=1e-12)


def test_the_origin_moves_the_box():
    origin, box = np.array([16.0, -8.0, 6.0]), box_of(random_velocity())
    points = np.random.default_rng(10).uniform(-30.0, 30.0, (50, 3))
    moved = frozen.FrozenTurbulence(STILL, box, origin).at(0.0, points + origin)
    np.testing.assert_allclose(moved, frozen.FrozenTurbulence(STILL, box).at(0.0, points), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("box", [None, box_of(np.zeros((*POINTS, 3)))])
@pytest.mark.parametrize("exponent", [0.0, 0.2])
def test_the_mean_wind_has_its_profile(box, exponent):
    wind = frozen.FrozenTurbulence(frozen.MeanWind(8.0, 0.3, 6.0, exponent), box)
    heights = np.array([-3.0, 0.0, 1.0, 6.0, 250.0])
    speed = 8.0 * np.array([0.0, 0.0, 1.0 / 6.0, 1.0, 250.0 / 6.0]) ** exponent  # 0^0 is 1: uniform
    expected = np.stack((speed * np.cos(0.3), speed * np.sin(0.3), np.zeros(5)), axis=1)
    points = np.stack((np.linspace(0.0, 9.0, 5), np.zeros(5), heights), axis=1)
    np.testing.assert_allclose(wind.at(2.0, points), expected, rtol=1e-14, atol=1e-15)


def test_beyond_the_heights_of_turbsim_the_profile_goes_on():
    """A box of nothing but its mean wind is that mean wind everywhere; between its rows it is interpolated."""
    heights = 10.0 + 2.0 * np.arange(7)
    velocity = np.zeros((*POINTS, 3))
    velocity[..., 0] = 8.0 * (heights / 16.0) ** 0.2
    box = box_of(velocity, mean=(8.0, 16.0), first=(-60.0, -16.0, 10.0))
    wind = frozen.FrozenTurbulence(frozen.MeanWind(1.0, 0.0, 3.0, 0.2), box)
    points = np.array([(3.0, 1.0, z) for z in (1.0, 5.0, 9.0, *heights, 24.0, 25.0, 40.0, 300.0)])
    expected = 8.0 * (points[:, 2] / 16.0) ** 0.2
    np.testing.assert_allclose(wind.at(3.0, points)[:, 0], expected, rtol=0.0, atol=0.01)  # curvature between rows
    np.testing.assert_allclose(wind.at(3.0, points)[3:10, 0], expected[3:10], rtol=1e-14)


REFUSED = partial(frozen.FrozenTurbulence, periodic=False)


@pytest.mark.parametrize(
    ("point", "time", "words"),
    [
        ((0.5, 0.0, 2.0), 0.0, "at 0 s: along the wind it is at 0.5 m; the box is from -60 to 0 m"),
        ((0.0, 0.0, 2.0), 6.5, "(-10, 0, 2) m at 6.5 s: along the wind it is at -10 m; the box is from -8 to 52 m"),
        ((-1.0, 16.5, 2.0), 0.0, "across the wind it is at 16.5 m; the box is from -16 to 16 m"),
        ((-1.0, 0.0, 12.5), 0.0, "the point (-1, 0, 12.5) m at 0 s: upwards it is at 12.5 m; the box is from 0 to 12 m"),
        ((-1.0, 0.0, -0.5), 0.0, "upwards it is at -0.5 m"),
    ],
)
def test_outside_can_be_refused(point, time, words):
    wind = REFUSED(frozen.MeanWind(8.0), box_of(random_velocity()))
    with pytest.raises(boxes.WrongBox) as refusal:
        wind.at(time, np.array([(-10.0, 0.0, 2.0), point]))
    assert words in str(refusal.value)


def test_at_its_faces_nothing_is_outside():
    """A rounding error beyond a face is on it."""
    velocity = random_velocity()
    wind = REFUSED(STILL, box_of(velocity))
    corners = np.array([(-60.0, -16.0, 0.0), (0.0, 16.0, 12.0)])
    assert np.array_equal(wind.at(0.0, corners + np.array([[-1e-12], [1e-12]])), velocity[[0, -1], [0, -1], [0, -1]])
