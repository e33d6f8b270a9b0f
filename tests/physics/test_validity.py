"""Tables of the manual: what tethers without waves get wrong as the kite flies its circle faster, and slack folds.

In wind, nodes of the quasi-steady tether turn rigidly with the kite, those of the dynamic one also move against that while
drag and weight change their directions along the turn: a difference of first and second order in the rate.
"""

from pathlib import Path

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, circle, fly_circle
from tetherfmu import Solver, Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady
from tetherfmu.runtime import layout as at

DATA = Path(__file__).parents[2] / "docs" / "data"


def table(name):
    """Rows of numbers of a CSV file of the manual, (rows, columns)."""
    return np.loadtxt(DATA / f"{name}.csv", delimiter=",", skiprows=1)


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


STEP = 0.02
RATES = (0.05, 0.025, 0.0125)  # [rad/s]
TABLE = (1.41, 0.46, 0.11)  # [%], in docs/models/theory.md, "Validity"


@pytest.fixture(scope="module")
def forces():
    """Force on the kite [N] along the second turn by rate, of both tethers: arrays (2, steps)."""
    found = {}
    for rate in RATES:
        steps = round(2.0 * np.pi / rate / STEP)
        inputs = np.zeros((2 * steps, at.INPUTS))
        for k, row in enumerate(inputs):
            row[at.KITE_POSITION : at.GROUND_POSITION] = np.concatenate(circle(k * STEP, rate))
        inputs[:, at.WIND_VELOCITY] = 8.0
        flown = []
        for kind in (TetherDynamic, TetherQuasiSteady):
            tether = kind(CIRCLE_TETHER, initial_shape="quasi_steady")
            tether.initialize(*circle(0.0, rate), wind_velocity=(8.0, 0.0, 0.0))
            flown.append(np.linalg.norm(tether.fly(inputs, STEP).kite_force[steps:], axis=1))
        found[rate] = np.array(flown)
    return found


def missing(found, part):
    """How much the mean force of the quasi-steady tether is below that of the dynamic one in a part of the turn [%]."""
    dynamic, quasi_steady = found[:, part].mean(axis=1)
    return 100.0 * (1.0 - quasi_steady / dynamic)


def test_the_difference_in_the_second_half_falls_faster_than_the_rate(forces):
    half = [missing(found, slice(found.shape[1] // 2, None)) for found in forces.values()]
    assert half == pytest.approx(TABLE, abs=0.01)


def test_over_a_whole_turn_little_is_left(forces):
    """The halves are wrong to either side."""
    for found in forces.values():
        assert abs(missing(found, slice(None))) < 0.2


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
