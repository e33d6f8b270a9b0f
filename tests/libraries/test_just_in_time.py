"""Kernels compiled ahead of time give the bits of those that numba compiles just in time for this very processor.

Neither is allowed to reorder or to fuse operations.
"""

import numpy as np
import pytest

from scenes import CIRCLE_TETHER, REVOLUTION, circle
from tetherfmu import models
from tetherfmu.libraries import just_in_time
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.variants import VARIANTS, WITHOUT_NODES, class_name

STEP = 0.02


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_revolution_bit_for_bit(variant):
    """Outputs, node positions, states and energies of a whole circle with reel-out in gusts."""
    inputs = np.zeros((round(REVOLUTION / STEP), at.INPUTS))
    for k, row in enumerate(inputs):
        row[at.KITE_POSITION : at.GROUND_POSITION] = np.concatenate(circle(k * STEP))
        row[at.REEL_OUT_SPEED : at.WIND_VELOCITY + 2] = 0.1 * np.sin(0.1 * k), 8.0 + np.sin(0.3 * k), 1.0
    models_of_both = [
        getattr(models, class_name(variant))(CIRCLE_TETHER, kernels=kernels)
        for kernels in (None, just_in_time.kernels(variant))
    ]
    flights = []
    for model in models_of_both:
        model.initialize(*circle(0.0), wind_velocity=(8.0, 1.0, 0.0))
        flights.append(model.fly(inputs, STEP, every=10))
    ahead, just = flights
    assert len(ahead.outputs) == len(inputs) // 10
    assert ahead.outputs.tobytes() == just.outputs.tobytes()
    assert ahead.positions.tobytes() == just.positions.tobytes()
    states = [model.get_state() for model in models_of_both]
    assert states[0].tobytes() == states[1].tobytes()
    if variant not in WITHOUT_NODES:
        assert models_of_both[0].energy() == models_of_both[1].energy()
