"""The kernels in a WebAssembly engine give the numbers of the native library, to the last bit.

The engine calls the functions of mathematics of the same C library; all else is arithmetic in the same order.
"""

import os

import numpy as np
import pytest

from in_webassembly import Engine
from libraries.test_same_bits import circle_inputs
from scenes import CIRCLE_TETHER, circle
from tetherfmu.libraries.webassembly import IMPORTS, browser_file
from tetherfmu.python import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.variants import VARIANTS, class_name

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the engine is given the functions of mathematics of a POSIX system")
STEP, STEPS = 0.02, 60
SIZE = 400_000  # bytes


@pytest.fixture(scope="module")
def engine():
    return Engine(browser_file())


def test_size_and_names(engine):
    """Small, and nothing is asked for but a memory and mathematics."""
    assert browser_file().stat().st_size < SIZE
    assert set(engine.imported) <= {"memory", *IMPORTS}
    assert {f"{variant}_{verb}" for variant in VARIANTS for verb in ("pack", "advance", "outputs")} <= engine.exported


def reeling():
    """A circle with reel-out in gusts."""
    return circle_inputs(STEP)[:STEPS], {}


def approaching():
    """As `reeling`, but the tether is taut at first, and the kite comes closer until it is slack."""
    inputs, _ = reeling()
    speed = 20.0
    fallen = speed * STEP * np.arange(STEPS)[:, np.newaxis]
    radial = inputs[:, at.KITE_POSITION : at.KITE_POSITION + 3].copy()
    radial /= np.linalg.norm(radial, axis=1)[:, np.newaxis]
    inputs[:, at.KITE_POSITION : at.KITE_POSITION + 3] -= fallen * radial
    inputs[:, at.KITE_VELOCITY : at.KITE_VELOCITY + 3] -= speed * radial
    return inputs, {"initial_length": 495.0, "initial_shape": "static_equilibrium"}


def lying():
    """A long tether, a part of which lies on the ground."""
    inputs, _ = reeling()
    return inputs, {"initial_length": 620.0, "ground_contact": "flat", "ground_height": -1.0}


def pulling():
    """A drum under force control."""
    inputs, _ = reeling()
    inputs[:, at.REEL_OUT_SPEED], inputs[:, at.WINCH_FORCE] = 0.0, 5000.0
    return inputs, {"initial_length": 495.0, "winch_control": "force", "winch_mass": 500.0, "winch_damping": 20.0}


def flown(model, inputs):
    """Outputs of each step, array (steps, numbers), and a dict of those at the end."""
    columns, found = by_name(inputs), []
    for k in range(len(inputs)):
        told = {name: np.squeeze(column[k])[()] for name, column in columns.items() if np.any(column[k])}
        outputs = model.step(STEP, **told)._asdict()
        found.append(np.concatenate([np.ravel(each) for each in outputs.values()]))
    return np.array(found), outputs


@pytest.mark.parametrize("scene", [reeling, approaching, lying, pulling])
@pytest.mark.parametrize("variant", VARIANTS)
def test_same_bits(engine, variant, scene):
    """Outputs of all steps, and the state at the end."""
    inputs, quantities = scene()
    quantities = {"initial_length": CIRCLE_TETHER.initial_length, **quantities}
    flights, states = [], []
    for kernels in (None, engine.kernels(variant)):
        model = getattr(models, class_name(variant))(kernels=kernels, **quantities)
        model.initialize(*circle(0.0), wind_velocity=(8.0, 1.0, 0.0))
        flights.append(flown(model, inputs))
        states.append(model.get_state())
    (native, last), (other, _) = flights
    assert len(native) == STEPS
    if scene is approaching and variant != "quasi_steady":  # which hangs, taut
        assert last["slack_segments"] > 0
    assert (last["grounded_length"] > 0.0) == (scene is lying and variant != "straight")
    assert native.tobytes() == other.tobytes()
    assert states[0].tobytes() == states[1].tobytes()
