"""With `end_velocities = derived` velocity and acceleration of an end come from its last three positions.

    u = (p - p_last)/h_last,   a = (u - u_last)/((h_last + h_before)/2),   v = u + a h_last/2

exact for constant acceleration, with any steps. In the first step the ends rest; the second does not know whether a
difference is a velocity or a jump, the third knows no acceleration, the fourth not whether the motion is smooth.
"""

from itertools import pairwise

import numpy as np
import pytest

from solvers import every_model
from tetherfmu import MovingEnd, Tether, TetherDynamic, inputs_along

every_end = pytest.mark.parametrize("end", ["kite", "ground"])
STARTS = {"kite": np.array([30.0, 0.0, 40.0]), "ground": np.array([-30.0, 0.0, -40.0])}
LIES = np.array([7.0, -80.0, 3.0])  # velocities that nobody reads [m/s]
EVEN = 0.02 * np.arange(11)
UNEVEN = np.cumsum([0.0, 0.02, 0.05, 0.03, 0.02, 0.04, 0.01, 0.02, 0.05, 0.02, 0.03])


def derived(model, end, path, times):
    """Fly one end along path(time), the other one stays at the origin; end position and velocity after each step."""
    other = {"ground": "kite", "kite": "ground"}[end]
    tether = model(Tether(segments=4, initial_length=60.0), end_velocities="derived")
    tether.initialize(**{f"{end}_position": path(times[0]), f"{other}_position": np.zeros(3)})
    node, rows = {"kite": -1, "ground": 0}[end], []
    for now, then in pairwise(times):
        tether.step(then - now, **{f"{end}_position": path(now)})
        rows.append((tether.positions[node], tether.velocities[node]))
    return np.array(rows)


@every_model
@every_end
@pytest.mark.parametrize(
    ("times", "acceleration", "exact"),
    [(EVEN, 0.0, 2), (UNEVEN, 0.0, 4), (EVEN, 1.0, 3), (UNEVEN, 1.0, 5)],
    ids=["even", "uneven", "even, accelerated", "uneven, accelerated"],
)
def test_exact_once_two_rates_or_three_are_known(model, end, times, acceleration, exact):
    """At constant velocity two, at constant acceleration three; each belongs to at least three quarters of its time.

    In the first step the end rests; a single difference may be a jump, so the second step only comes to its position.
    Steps of 20, 50, 30 and 20 ms: the fourth still corrects over 30 ms what the third could not know, and the curve of the
    end of a dynamic tether still corrects the jolt of the start until a step is no shorter than the last.
    """
    speed, gain = np.array([[3.0, -1.0, 2.0], [-4.0, 5.0, 1.0]]) * [[1.0], [acceleration]]
    rows = derived(model, end, lambda time: STARTS[end] + speed * time + 0.5 * gain * time**2, times)
    then = times[1:, None]
    positions, velocities = STARTS[end] + speed * then + 0.5 * gain * then**2, speed + gain * then
    np.testing.assert_array_equal(rows[0], [STARTS[end], np.zeros(3)])
    np.testing.assert_allclose(rows[1, 0], positions[0], rtol=0, atol=1e-12)
    exact += 2 * (times is UNEVEN and model is TetherDynamic and acceleration > 0.0)
    # rounding of positions, 1e-14 m, over two steps of at least 10 ms, and over their square
    within = (1e-11, 1e-9) if acceleration else (1e-12, 1e-11)
    np.testing.assert_allclose(rows[exact:, 0], positions[exact:], rtol=0, atol=within[0])
    np.testing.assert_allclose(rows[exact:, 1], velocities[exact:], rtol=0, atol=within[1])


@every_model
def test_velocity_inputs_are_not_read(model):
    """Rows of a flight that have them warn of it once and change nothing; given by name they are refused."""
    flights = []
    for velocity in (np.zeros(3), LIES):
        tether = model(initial_length=505.0, end_velocities="derived")
        tether.initialize()
        kite = MovingEnd(lambda time: (300.0, 5.0 * time, 400.0), lambda time, velocity=velocity: velocity)
        flights.append(tether.fly(inputs_along(5, 0.02, kite), 0.02))
        told = [each for each in tether.implausible if "the velocity of an end" in each]
        assert len(told) == np.any(velocity)
    assert all(map(np.array_equal, flights[0].outputs, flights[1].outputs))
    with pytest.raises(ValueError, match=r"kite_velocity is .* and has no effect: end_velocities is 2 \(derived\)"):
        tether.step(0.02, kite_velocity=LIES)
    with pytest.raises(ValueError, match=r"ground_velocity is .* and has no effect"):
        tether.initialize(ground_velocity=LIES)
