"""A copied or unpickled system goes on as the original does, and leaves it alone; states of systems with wind points."""

import pickle
from copy import copy, deepcopy

import numpy as np
import pytest

from tetherfmu import Line, Point, Tether, TetherSystem

WIND = np.array([[4.0, 1.0, 0.0], [9.0, -2.0, 0.5], [12.0, 1.5, 0.0]])
POINTS = [Point("left", (0.0, 0.0, 30.0)), Point("right", (8.0, 0.0, 30.0)), Point("load", (4.0, 0.0, 10.2), mass=20.0)]
ROPE = Tether(segments=4, initial_length=20.4)


def started(wind_points):
    lines = [Line("a", "left", "load", ROPE), Line("b", "right", "load", ROPE)]
    system = TetherSystem(POINTS, lines, wind_points=wind_points)
    system.initialize(**winds(wind_points, 0))
    return system


def winds(wind_points, k):
    scale = 1.0 + 0.1 * k
    return {"wind_at": dict.fromkeys("ab", scale * WIND)} if wind_points else {"wind_velocity": scale * WIND[1]}


def flown(system, wind_points, steps=range(5, 10)):
    return [system.step(0.02, **winds(wind_points, k)).points["load"].position.tolist() for k in steps]


@pytest.mark.parametrize("wind_points", [0, 3])
@pytest.mark.parametrize("copied", [copy, deepcopy, lambda each: pickle.loads(pickle.dumps(each))])
def test_a_copy_goes_on(copied, wind_points):
    system = started(wind_points)
    flown(system, wind_points, range(5))
    other = copied(system)
    assert other.counters == system.counters
    assert flown(other, wind_points) == flown(system, wind_points)


@pytest.mark.parametrize("wind_points", [0, 3])
def test_back_to_a_state_with_other_winds(wind_points):
    system = started(wind_points)
    flown(system, wind_points, range(5))
    state = system.get_state()
    expected = flown(system, wind_points)
    system.set_state(state)
    assert flown(system, wind_points) == expected
    other = started(wind_points)
    other.set_state(state)
    assert flown(other, wind_points) == expected


def test_a_system_that_was_not_started_is_copied():
    system = TetherSystem(POINTS, [Line("a", "left", "load", ROPE), Line("b", "right", "load", ROPE)])
    assert "not initialized" in repr(deepcopy(system))
