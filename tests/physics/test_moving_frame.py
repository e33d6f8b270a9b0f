"""A tether seen by an observer who moves uniformly: its start and first steps are the same, without air."""

import numpy as np
import pytest

from tetherfmu import Environment, Solver, Tether, TetherDynamic, TetherQuasiSteady

RATE, STEP = 0.5, 0.02  # of the kite on its circle [rad/s], [s]


@pytest.mark.parametrize("model", [TetherDynamic, TetherQuasiSteady])
@pytest.mark.parametrize("fixed", [0.0, 0.005])
@pytest.mark.parametrize("slack", [0.998, 1.02])
def test_first_steps_in_a_moving_frame(model, fixed, slack):
    forces = []
    for frame in ((0.0, 0.0, 0.0), (20.0, -7.0, 3.0)):
        frame = np.array(frame)
        tether = model(
            Tether(segments=10, initial_length=100.0 * slack, diameter=0.004),
            environment=Environment(air_density=0.0),
            solver=Solver(fixed_step=fixed) if model is TetherDynamic else Solver(),
        )

        def inputs(time, frame=frame):
            c, s = np.cos(RATE * time), np.sin(RATE * time)
            kite, velocity = np.array((60.0 * c, 60.0 * s, 80.0)), 60.0 * RATE * np.array((-s, c, 0.0))
            ends = {"kite_position": kite + frame * time, "kite_velocity": velocity + frame}
            return ends | {"ground_position": frame * time, "ground_velocity": frame}

        tether.initialize(**inputs(0.0))
        forces.append([tether.step(STEP, **inputs(k * STEP)).kite_force for k in range(5)])
    still, moving = np.array(forces)
    np.testing.assert_allclose(moving, still, rtol=0, atol=1e-7 * np.abs(still).max())
