"""A free kite end: the released end of tutorial scene 08, and a mass on a vertical tether, which is a spring.

Scene 08: 70 m and 10 segments between (0, 0, 0) and (-40, 0, -47) m, at rest in a wind of 2 m/s; then the lower end is free
and the tether reels out at 0.3 m/s. It uses the stretch-rate damper and a slack stiffness of 0.01/1.01 of the taut one.
"""

import numpy as np
import pytest

from scenes import SCENE_08_ERRORS, nodes, read
from tetherfmu import TetherDynamic, TetherDynamicFree


@pytest.mark.parametrize(("tolerance", "allowed"), SCENE_08_ERRORS)
def test_released_end(tolerance, allowed):
    """All nodes and the outputs kite_position and kite_velocity; the start is found, not given."""
    columns = read("tether_08.csv")
    expected = nodes(columns, 10)
    velocity = np.stack([columns[f"v_last_{axis}"] for axis in "xyz"], axis=-1)
    scene = {"segments": 10, "initial_length": 70.0, "damping_law": 2, "slack_stiffness_ratio": 0.01 / 1.01}
    tether = TetherDynamicFree(**scene, kite_mass=0.0, relative_tolerance=tolerance)
    outputs = [tether.initialize(expected[0, -1], wind_velocity=(2.0, 0.0, 0.0))]
    positions = [tether.positions]
    for _ in expected[1:]:
        outputs.append(tether.step(0.02, reel_out_speed=0.3))
        positions.append(tether.positions)
    np.testing.assert_allclose(positions, expected, rtol=0.0, atol=allowed)
    np.testing.assert_array_equal([each.kite_position for each in outputs], np.array(positions)[:, -1])
    # the chain whips at rates up to some 10 1/s: observed up to 16 1/s times the error of the positions
    moving = np.array([each.kite_velocity for each in outputs])[1:]
    np.testing.assert_allclose(moving, velocity[1:], rtol=0.0, atol=30.0 * allowed)


LENGTH, STIFFNESS, GRAVITY, LINE = 100.0, 50_000.0, 9.81, 0.02  # m, N, m/s2, kg/m
HANGING = {
    "initial_length": LENGTH,
    "segments": 1,
    "axial_stiffness": STIFFNESS,
    "axial_damping": 0.0,
    "density": LINE / (np.pi * 0.002**2),
    "relative_tolerance": 1e-8,
}


@pytest.mark.parametrize("mass", [0.0, 10.0, 100.0])
@pytest.mark.parametrize("load", [0.0, 50.0])
def test_a_mass_hangs_and_swings_as_on_a_spring(mass, load):
    """z = -L - s + a cos(w t),  s = (M g - F)/k,  w^2 = k/M,  M = m + mu L/2,  k = EA/L; the load F points upwards.

    Linear from first to last, so the error is that of the solver: 1e-8 of 100 m in each of some hundred steps at most.
    """
    load = 0.01 * load if mass == 0.0 else load
    inertia, stiffness = mass + 0.5 * LINE * LENGTH, STIFFNESS / LENGTH
    stretch, rate = (inertia * GRAVITY - load) / stiffness, np.sqrt(stiffness / inertia)
    amplitude, step = 0.5 * stretch, 0.01 / rate
    tether = TetherDynamicFree(**HANGING, kite_mass=mass)
    tether.initialize((0.0, 0.0, -LENGTH - stretch + amplitude))
    for k in range(1, 2001):  # some three periods
        outputs = tether.step(step, kite_load=(0.0, 0.0, load))
        phase = rate * k * step
        assert outputs.kite_position[2] == pytest.approx(-LENGTH - stretch + amplitude * np.cos(phase), abs=1e-7 * stretch)
        assert outputs.kite_velocity[2] == pytest.approx(-amplitude * rate * np.sin(phase), abs=1e-7 * stretch * rate)


def flown(step, input_continuation):
    """Position [m] after 4 s of a kite of 10 kg with a lift along the tether and a drag c |w| w of w, air minus kite."""
    tether = TetherDynamicFree(initial_length=500.0, input_continuation=input_continuation, relative_tolerance=1e-7)
    outputs = tether.initialize((300.0, 0.0, 400.0), wind_velocity=(8.0, 0.0, 0.0))
    for _ in range(round(4.0 / step)):
        wind = np.array([8.0, 0.0, 0.0]) - outputs.kite_velocity
        lift = (180.0, 40.0 + 5.0 * outputs.kite_velocity[0], 350.0)
        outputs = tether.step(step, kite_load=lift + 2.0 * np.linalg.norm(wind) * wind)
    return outputs.kite_position


@pytest.mark.parametrize(("input_continuation", "order"), [("linear", 2), ("held", 1)])
def test_order_of_a_load_that_depends_on_the_motion(input_continuation, order):
    """Steps of 40, 20, 10 ms, far longer than a kite moved by kite_force allows (1.5 ms): differences fall as 2^order."""
    positions = [flown(step, input_continuation) for step in (0.04, 0.02, 0.01)]
    coarse, fine = (np.linalg.norm(positions[k] - positions[k + 1]) for k in (0, 1))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.2)


@pytest.mark.filterwarnings("ignore:a segment is stretched")  # of the softest
@pytest.mark.parametrize(("mass", "stiffness", "wind"), [(1e5, 614_600.0, 8.0), (1e9, 614_600.0, 8.0), (10.0, 0.001, 0.0)])
def test_the_shape_at_the_start_does_not_depend_on_the_mass(mass, stiffness, wind):
    """The kite end is held there, so its mass pulls at nothing: the shape is that between driven ends.

    Taut and slack, kite above and below the station. Positions of the springs' ends are rounded to 100 m * 2e-16, which is
    EA/l0 * 2e-14 m = 3e-9 N in a force, and a node of the slackest chain moves by 1 m per 0.01 N: below 1e-6 m. The search
    takes nearly the same way, so a heavy kite costs no iterations.
    """
    properties = {"initial_length": 100.0, "axial_stiffness": stiffness}
    driven, free = TetherDynamic(**properties), TetherDynamicFree(**properties, kite_mass=mass)
    for distance in (30.0, 95.0, 100.1):
        for direction in ((0.6, 0.0, 0.8), (0.8, 0.6, 0.0), (0.0, 0.6, -0.8)):
            kite = distance * np.array(direction)
            expected = driven.initialize(kite, wind_velocity=(wind, 0.0, 0.0))
            outputs = free.initialize(kite, wind_velocity=(wind, 0.0, 0.0))
            size = max(1.0, expected.sag / 100.0)
            np.testing.assert_allclose(free.positions, driven.positions, rtol=0.0, atol=1e-6 * size)
            assert outputs.solver_iterations <= expected.solver_iterations + 3
