"""A driven end follows a smooth motion: path of order 3, outputs of order 2 or more in the communication step h.

Inputs are the position and velocity at the start of a step. The end is led to p + v h + a h^2/2 with velocity v + a h,
a = (v - v_last)/h_last (after much shorter steps: test_unequal_steps.py), which is late by half a step: the position errs by
|jerk| h^3 (1/6 + 1/4), the velocity by |jerk| h^2 (1/2 + 1/2). Motion of constant acceleration is reached exactly from the
second step on. In the first step a is 0, so constant velocity is reached exactly; with initial_shape quasi_steady the two
ends turn around each other: on a circle of the radius R, with q = v h/R, the distance errs by R q^4/8 and not by R q^2/2.
"""

from itertools import pairwise

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, circle
from solvers import every_model
from tetherfmu import Solver, Tether, TetherDynamic

RATE = 0.5
SMOOTH = Solver(relative_tolerance=1e-8, initial_shape=2)


@pytest.mark.parametrize("end", ["kite", "ground"])
def test_constant_acceleration_is_reached_exactly(end):
    start, speed, acceleration = np.array([[30.0, 0.0, 40.0], [3.0, -1.0, 2.0], [-4.0, 5.0, 1.0]])
    other = {"ground": "kite", "kite": "ground"}[end]
    model = TetherDynamic(Tether(segments=4, initial_length=60.0))
    model.initialize(**{f"{end}_position": start, f"{end}_velocity": speed, f"{other}_position": np.zeros(3)})
    times = np.cumsum([0.0, 0.02, 0.05, 0.01, 0.02])  # not uniform
    for now, then in pairwise(times):
        velocity = speed + acceleration * now
        position = start + speed * now + 0.5 * acceleration * now**2
        inputs = {f"{end}_position": position, f"{end}_velocity": velocity, f"{other}_position": np.zeros(3)}
        model.step(then - now, **inputs)
        if now > 0.0:
            node = {"kite": -1, "ground": 0}[end]
            expected = start + speed * then + 0.5 * acceleration * then**2
            np.testing.assert_allclose(model.positions[node], expected, rtol=0, atol=1e-13)  # rounding
            # the last two steps are within a curve of 50 ms: the rounding of a position, 7e-15 m, times 6/(50 ms)
            np.testing.assert_allclose(model.velocities[node], speed + acceleration * then, rtol=0, atol=1e-12)


def test_a_jump_of_velocity_after_a_short_step_is_not_blown_up():
    model = TetherDynamic(Tether(segments=4, initial_length=60.0))
    kite = np.array([30.0, 0.0, 40.0])
    model.initialize(kite_position=kite)
    model.step(0.001, kite_position=kite)
    model.step(0.1, kite_position=kite, kite_velocity=(0.0, 1.0, 0.0))
    # v + a h = 1 + 4 m/s and v h + a h^2/2 = 0.1 + 0.2 m with a of the docstring, and not 101 m/s and 5.1 m
    np.testing.assert_allclose(model.velocities[-1], (0.0, 5.0, 0.0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(model.positions[-1] - kite, (0.0, 0.3, 0.0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("shape", "turn"), [(1, 0.1), (2, 0.01), (2, 0.1), (2, 0.5), (3, 0.1)])
def test_the_first_step_of_a_turning_kite(shape, turn):
    step, station = 0.1, np.array([5.0, -3.0, 2.0])
    radius, riding = np.array([30.0, 0.0, 40.0]), np.array([1.0, 2.0, -0.5])  # [m], [m/s] of both ends
    model = TetherDynamic(Tether(segments=4, initial_length=60.0), solver=Solver(initial_shape=shape))
    ground = {"ground_position": station, "ground_velocity": riding}
    across = np.array([0.0, 50.0 * turn / step, 0.0])
    kite = {"kite_position": station + radius, "kite_velocity": riding + across}
    model.initialize(**ground, **kite)
    model.step(step, **ground, **kite)
    distance = np.linalg.norm(model.positions[-1] - model.positions[0])
    inwards = turn**2 / 2.0 if shape == 2 else 0.0
    expected = 50.0 * np.sqrt((1.0 - inwards) ** 2 + turn**2)
    assert distance == pytest.approx(expected, rel=1e-12)


def test_a_kite_that_moves_along_its_tether_is_not_held_back_in_the_first_step():
    model = TetherDynamic(Tether(segments=4, initial_length=60.0), solver=SMOOTH)
    outwards = {"kite_position": (30.0, 0.0, 40.0), "kite_velocity": (3.0, 0.0, 4.0)}
    model.initialize(**outwards)
    model.step(0.1, **outwards)
    np.testing.assert_allclose(model.positions[-1], (30.3, 0.0, 40.4), rtol=0, atol=1e-12)


# --- on the circle, with velocities that are given, and with derived ones (`test_derived_velocities.py`)


def on_circle(model, step, velocities, end):
    """A kite on the circle until a time [s], and its outputs."""
    tether = model(CIRCLE_TETHER, solver=SMOOTH, end_velocities=velocities)
    given = 1 if velocities == "derived" else 2  # position alone, or velocity, too
    tether.initialize(*circle(0.0, RATE)[:given])
    return tether, [tether.step(step, *circle(k * step, RATE)[:given]) for k in range(round(end / step))]


@every_model
@pytest.mark.parametrize(("velocities", "of_position", "of_velocity"), [("given", 5 / 12, 1.0), ("derived", 1.0, 11 / 6)])
@pytest.mark.parametrize("step", [0.02, 0.01])
def test_the_end_on_the_circle(step, velocities, of_position, of_velocity, model):
    """Derived, v errs by j h^2/3 and a by j h: the end by j h^2 (1/3 + 1 + 1/2) and by j h^3 (1/3 + 1/2 + 1/6)."""
    tether, _ = on_circle(model, step, velocities, 2.0)
    position, velocity = circle(2.0, RATE)
    jerk = RATE**3 * 500.0 * np.sin(np.radians(10.0))
    # leading terms of the formula above; the next ones are of relative size RATE * h <= 0.01
    assert np.linalg.norm(tether.positions[-1] - position) == pytest.approx(jerk * step**3 * of_position, rel=0.05)
    assert np.linalg.norm(tether.velocities[-1] - velocity) == pytest.approx(jerk * step**2 * of_velocity, rel=0.05)


def forces(step, velocities, end):
    """Forces on both ends each 80 ms of 4 s up to a time [s]."""
    every = round(0.08 / step)
    rows = on_circle(TetherDynamic, step, velocities, end)[1][every - 1 :: every][-50:]
    return np.array([np.concatenate((out.ground_force, out.kite_force)) for out in rows])


@pytest.mark.parametrize(("velocities", "end", "largest"), [("given", 4.0, 0.1), ("derived", 30.0, 0.2)])
def test_outputs_have_at_least_order_two(velocities, end, largest):
    """With derived velocities when the jolt of the start is forgotten."""
    exact = forces(0.0025, "given", end)
    error = [np.sqrt(np.mean((forces(step, velocities, end) - exact) ** 2)) for step in (0.04, 0.02, 0.01)]
    order = -np.diff(np.log2(error))
    # drag feels the velocity (order 2), the spring of this taut tether the position (order 3): observed 2.7 and 2.8
    assert np.all(order > 1.8)
    assert np.all(order < 3.3)
    assert error[1] < largest  # [N] at 20 ms and 43 m/s; it is 11 N without a
