"""Systems of tethers against MoorDyn: a bridle whose kites move, four drones that carry a load; without drag.

Scenes and settings: benchmarks/moordyn_systems.py, which wrote the files. The equations are the same, so that steps are all
that differs. The ropes of the drones are slack and snap; there MoorDyn with steps twice as long differs from itself, too.

And against an explicit method with steps of 40 microseconds, with drag (benchmarks/explicit_systems.py).
"""

import numpy as np
import pytest

from benchmarks import explicit_systems as explicit
from benchmarks.moordyn_systems import columns, differences, ours
from scenes import read


def theirs(name):
    """Rows of MoorDyn."""
    found = read(f"moordyn_{name}.csv")
    return np.column_stack([found[each] for each in columns(name)])


def test_a_bridle():
    """With steps of 20 ms and the default tolerance; its main line pulls with 1 to 8 kN."""
    right = theirs("y")
    assert np.ptp(right[:, 4:]) > 5000.0
    _, place, _, force = differences(ours("y")[0], right)
    assert place < 0.02  # [mm], of 5 m; 0.007, of which the digits of the file are 0.005
    assert force < 0.1  # [N]; 0.034


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")  # they snap, as those of MoorDyn do
def test_four_drones_with_a_load():
    """With steps of 5 ms: how fast a slack rope becomes taut is in the accelerations of the drones, which steps must see."""
    right = theirs("drones")
    assert right[:, 4:].min() == 0.0
    _, place, force, _ = differences(ours("drones", step=0.005)[0], right)
    assert place < 0.1  # [mm], of 10 m; 0.039
    assert force < 0.3  # [N] rms, of 340 N; 0.11, MoorDyn with steps twice as long 0.14


def right(name):
    """Rows of the explicit method."""
    return np.column_stack([*read(f"explicit_{name}.csv").values()])


@pytest.mark.filterwarnings("ignore:.*presses its ends apart")  # as the explicit system does
def test_a_y_that_is_slack_in_part():
    place, _, force, _, largest = explicit.errors(
        explicit.ours(explicit.network("slack_y"), explicit.DURATION["slack_y"]), right("slack_y")
    )
    assert place < 1e-3
    assert force < 1.0
    assert largest > 100.0


def test_a_bridle_of_short_lines():
    """Coupled from single tethers it needs communication steps of 4 to 6 ms."""
    _, _, force, _, largest = explicit.errors(
        explicit.ours(explicit.network("bridle"), explicit.DURATION["bridle"]), right("bridle")
    )
    assert force < 0.002 * largest
