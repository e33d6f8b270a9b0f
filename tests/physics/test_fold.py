"""The table docs/data/folds.csv on slack tethers straight above their station: errors of their fold, and its push."""

import numpy as np
import pytest

from manual import table
from tetherfmu.python.models import TetherQuasiSteady
from tetherfmu.runtime.parameters import Tether

FOLDS = table("folds")


@pytest.mark.parametrize("row", FOLDS)
def test_fold_table(row):
    """Largest error of the ground force and largest push, both over the weight of a segment, of 25 slack tethers."""
    ratio, error, push = row
    errors, pushes = [], [0.0]
    for n in (5, 10, 20, 50, 100):
        for slack in (0.05, 0.1, 0.3, 0.5, 0.9):
            tether = Tether(segments=n, initial_length=500.0 / (1.0 - slack), slack_stiffness_ratio=ratio)
            model = TetherQuasiSteady(tether)
            force = model.initialize((0.0, 0.0, 500.0)).ground_force
            load = tether.mass_per_length * 9.81
            segment = load * tether.initial_length / n
            hanging = (0.0, 0.0, -0.5 * load * (tether.initial_length - 500.0))
            errors.append(np.linalg.norm(force - hanging) / segment)
            pushes.append(-model.segment_tensions.min() / segment)
    assert max(errors) == pytest.approx(error, abs=0.006)
    assert max(pushes) == pytest.approx(push, abs=0.006)


def test_fold_table_is_there():
    assert len(FOLDS) == 5
