"""Systems of tethers, steps of 20 ms and the default tolerance, against an explicit method with steps of 40 microseconds.

Scenes, equations and settings: benchmarks/explicit_systems.py, which wrote the files.
"""

import numpy as np
import pytest

from benchmarks.explicit_systems import DURATION, errors, network, ours
from scenes import read


def right(name):
    """Rows of the explicit method."""
    return np.column_stack([*read(f"explicit_{name}.csv").values()])


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")  # as the explicit system does
def test_a_y_that_is_slack_in_part():
    place, _, force, _, largest = errors(ours(network("slack_y"), DURATION["slack_y"]), right("slack_y"))
    assert place < 1e-3
    assert force < 1.0
    assert largest > 100.0


def test_a_bridle_of_short_lines():
    """Coupled from single tethers it needs communication steps of 4 to 6 ms."""
    _, _, force, _, largest = errors(ours(network("bridle"), DURATION["bridle"]), right("bridle"))
    assert force < 0.002 * largest
