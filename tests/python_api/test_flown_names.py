"""A flight in compiled code gives each scalar output by its name, equal to the outputs of a loop of steps."""

import numpy as np
import pytest

from tetherfmu import TetherDynamic, inputs_along
from tetherfmu.python.results import SCALARS

STEP, COUNT = 0.02, 20


def test_columns_are_the_outputs_of_the_steps():
    """Bit for bit, since `fly` equals a loop of `step`; the speeds give each output another value."""
    flying, stepping = (TetherDynamic(segments=5) for _ in range(2))
    flying.initialize()
    stepping.initialize()
    flown = flying.fly(inputs_along(COUNT, STEP, reel_out_speed=0.5, wind_velocity=(8.0, 1.0, 0.0)), STEP)
    rows = [stepping.step(STEP, reel_out_speed=0.5, wind_velocity=(8.0, 1.0, 0.0)) for _ in range(COUNT)]
    for name in SCALARS:
        np.testing.assert_array_equal(flown.of(name), [getattr(row, name) for row in rows])


def test_scalars_are_all_outputs_but_vectors():
    assert set(SCALARS) == {
        "ground_tension", "kite_tension", "max_tension", "tether_length", "ground_elevation", "ground_azimuth",
        "slack_segments", "kite_end_mass", "kite_stiffness", "kite_damping", "wave_time", "sag", "winch_speed",
        "solver_steps", "solver_rejections", "solver_iterations", "grounded_length",
        "solver_iteration_limit", "fallback_steps", "peak_tension", "broken", "break_time",
    }  # fmt: skip


def test_another_name_is_refused_with_those_that_exist():
    tether = TetherDynamic(segments=5)
    tether.initialize()
    flown = tether.fly(inputs_along(1, STEP), STEP)
    with pytest.raises(
        ValueError, match=r"^there is no scalar output 'tension'; did you mean ground_tension, kite_tension, max_tens"
    ):
        flown.of("tension")
    with pytest.raises(ValueError, match=r"^there is no scalar output 'lift'; there are ground_tension, kite_tension, "):
        flown.of("lift")


def test_it_is_printed_in_one_line():
    tether = TetherDynamic(segments=5)
    tether.initialize()
    assert repr(tether.fly(inputs_along(4, STEP), STEP)) == "<Flown: 4 rows, 6 nodes, all outputs>"
    assert repr(tether.fly(inputs_along(4, STEP), STEP, outputs=False)) == "<Flown: 4 rows, 6 nodes, node positions only>"
