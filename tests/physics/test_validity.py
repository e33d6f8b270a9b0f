"""The table docs/data/validity.csv: what tethers without waves get wrong as the kite flies its circle faster."""

import numpy as np
import pytest

from manual import table
from scenes import fly_circle
from tetherfmu.python.models import TetherCatenary, TetherDynamic, TetherQuasiSteady
from tetherfmu.runtime.parameters import Solver, Tether

VALIDITY = table("validity")


@pytest.mark.parametrize("row", VALIDITY)
def test_validity_table(row):
    """Root mean square difference of kite_force from the dynamic tether; solver tolerance 1e-4 moves the last digit."""
    length, rate, wave_time, product, quasi_steady, catenary = row
    force = {}
    for model in (TetherDynamic, TetherQuasiSteady, TetherCatenary):
        tether = model(Tether(initial_length=length), solver=Solver(initial_shape=2))
        _, outputs = fly_circle(tether, 0.02, 12.0, rate=rate)
        force[model] = np.array([each.kite_force for each in outputs])
        if model is TetherQuasiSteady:
            crossing = np.mean([each.wave_time for each in outputs])
    assert crossing == pytest.approx(wave_time, abs=0.06)
    assert rate * crossing == pytest.approx(product, abs=0.006)
    size = np.sqrt(np.mean(force[TetherDynamic] ** 2))
    for model, percent in ((TetherQuasiSteady, quasi_steady), (TetherCatenary, catenary)):
        difference = 100.0 * np.sqrt(np.mean((force[model] - force[TetherDynamic]) ** 2)) / size
        assert difference == pytest.approx(percent, abs=0.2)


def test_validity_table_is_there():
    assert len(VALIDITY) == 6
