"""The law of the ground: derivatives against central differences, and what it promises of rebounds and steps."""

import numpy as np
import pytest

from kernels.differences import assert_close, differences
from tetherfmu.kernels.equations import ground as earth

GROUND = earth.Ground(-1.0, 9.81 / 0.002, 2.0 / np.sqrt(9.81 * 0.002), 0.5)
STEP = 1e-7
under_ground = pytest.mark.parametrize("depth", [1e-4, 0.002, 0.05])
sliding = pytest.mark.parametrize("speed", [0.0, 1e-4, 0.3])


@under_ground
@sliding
def test_derivatives_of_contact(depth, speed):
    x, v = (3.0, -2.0, GROUND.height - depth), (0.8 * speed, -0.6 * speed, 0.02)
    by_z, by_velocity = earth.derivatives(GROUND, x, v)
    by_position = differences(lambda x: earth.acceleration(GROUND, tuple(x), v), x, STEP)
    assert_close(by_z, by_position[:, 2])
    assert np.abs(by_position[:, :2]).max() == 0.0
    # the friction turns over within v_r, 0.2 mm/s
    assert_close(np.reshape(by_velocity, (3, 3)), differences(lambda v: earth.acceleration(GROUND, x, tuple(v)), v, 1e-9))


@under_ground
@sliding
def test_derivatives_of_support(depth, speed):
    """Of a chain in equilibrium, whose velocities follow its positions: v = v_0 + S x."""
    x = np.array((3.0, -2.0, GROUND.height - depth))
    motion = np.random.default_rng(2).normal(size=(3, 3))
    v = np.array((0.8, -0.6, 0.1)) * speed
    found = earth.support_slope(GROUND, tuple(x), tuple(v), tuple(motion.ravel()))
    expected = differences(lambda y: earth.support(GROUND, tuple(y), tuple(v + motion @ (y - x))), x, STEP)
    assert_close(np.reshape(found, (3, 3)), expected)


@pytest.mark.parametrize("before", [-0.02, 0.0, 0.001, 0.05])
@pytest.mark.parametrize("after", [-0.01, 0.0004, 0.03, 0.2])
@pytest.mark.parametrize("slide", [(0.0, 0.0, 0.0), (0.02, 0.05, 0.0)])
def test_step_of_backward_euler(before, after, slide):
    """The force is minus the gradient of a potential that is convex: its iteration has somewhere to go down to."""
    h, old = 0.004, (0.0, 0.0, GROUND.height - before)
    new = np.array((1e-4, -3e-4, GROUND.height - after))
    force, slope = earth.force_of_step(GROUND, old, tuple(new), h, 4.0, slide)

    gradient = -differences(lambda x: earth.potential_of_step(GROUND, old, tuple(x), h, 4.0, slide), new, STEP)
    np.testing.assert_allclose(force, gradient, rtol=0, atol=1e-5 * np.abs(force).max() + 1e-7)
    slope = np.reshape(slope, (3, 3))
    expected = differences(lambda x: earth.force_of_step(GROUND, old, tuple(x), h, 4.0, slide)[0], new, STEP)
    np.testing.assert_allclose(slope, expected, rtol=0, atol=1e-6 * np.abs(slope).max() + 1e-6)

    np.testing.assert_array_equal(slope, slope.T)
    assert np.linalg.eigvalsh(slope).max() <= 0.0


def test_step_of_backward_euler_presses_with_the_velocity_at_its_end():
    h, before, after = 0.004, 0.01, 0.012
    force, _ = earth.force_of_step(GROUND, (0.0, 0.0, -1.0 - before), (0.0, 0.0, -1.0 - after), h, 0.0, (0.0, 0.0, 0.0))
    assert force[2] == pytest.approx(earth.pressure(GROUND, (0.0, 0.0, -1.0 - after), (0.0, 0.0, (before - after) / h)))


@pytest.mark.parametrize("speed", [0.1, 3.0, 100.0])
def test_a_node_leaves_the_ground_slower_than_one_over_a(speed):
    """v dv/dd = - w2 d (1 + a v), without weight, v downwards: integrated over an impact. Height g sink/8 at most."""
    depth, velocity, dt = 0.0, speed, 1e-5  # s: steps of 1e-7 s give the same to seven digits
    while velocity > 0.0 or depth > 0.0:
        pressed = earth.pressure(GROUND, (0.0, 0.0, GROUND.height - depth), (0.0, 0.0, -velocity))
        velocity -= pressed * dt
        depth += velocity * dt
    assert -velocity < 1.0 / GROUND.damping
    assert velocity**2 / (2.0 * 9.81) < 0.002 / 8.0


def test_pressure_is_continuous_and_never_pulls():
    v = (0.0, 0.0, -5.0)
    assert earth.pressure(GROUND, (0.0, 0.0, GROUND.height), v) == 0.0
    assert earth.touches(GROUND, (0.0, 0.0, GROUND.height - 1e-9), v)
    assert not earth.touches(GROUND, (0.0, 0.0, GROUND.height + 1e-9), v)
    leaving = (0.0, 0.0, 1.01 / GROUND.damping)  # faster than the ground can follow
    assert not earth.touches(GROUND, (0.0, 0.0, GROUND.height - 0.01), leaving)


@pytest.mark.parametrize(
    ("p", "q", "part"),
    [(1.0, 2.0, 0.0), (-1.0, -2.0, 1.0), (-1.0, 3.0, 0.25), (3.0, -1.0, 0.25), (0.0, 0.0, 0.0), (0.0, -1.0, 1.0)],
)
def test_part_of_a_segment_under_the_ground(p, q, part):
    points = ((0.0, 0.0, GROUND.height + p), (5.0, 0.0, GROUND.height + q))
    assert earth.part_under(GROUND, *points) == part
