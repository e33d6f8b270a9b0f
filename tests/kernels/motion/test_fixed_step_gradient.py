"""The iteration of the fixed step descends along the gradient of its own potential, also while the tether reels."""

import numpy as np
import pytest

from kernels.differences import differences
from kernels.packed import packed
from tetherfmu import Environment, Solver, Tether
from tetherfmu.kernels.arrays import shared_size
from tetherfmu.kernels.equations.boundary import chain_during, conditions_of_chain, inputs_of_step
from tetherfmu.kernels.line import backward_euler, incremental_potential
from tetherfmu.runtime import layout as at

N, LENGTH, STEP = 4, 20.0, 0.05
KITE, KITE_VELOCITY = np.array((9.0, 2.0, 14.0)), np.array((3.0, -1.0, 2.0))


def attempt_of(reel_out_speed, law, slack, is_stage=False):
    """A step from a crooked chain that moves, with drag and a free kite end; its scratch arrays, and positions to try."""
    random = np.random.default_rng(3)
    tether = Tether(segments=N, initial_length=LENGTH, axial_stiffness=5e4, damping_law=law)
    solver = Solver(fixed_step=STEP)
    parameters = packed(tether, Environment(), solver, (False, True))
    state, work = np.zeros(at.state_size(N)), np.zeros(shared_size(N) + backward_euler.workspace_size(N))
    inputs = np.zeros(at.INPUTS)
    inputs[at.KITE_POSITION : at.KITE_POSITION + 6] = *KITE, *KITE_VELOCITY
    inputs[at.REEL_OUT_SPEED], inputs[at.WIND_VELOCITY] = reel_out_speed, 8.0
    state[at.LENGTH], state[at.LAST_REEL_OUT_SPEED], state[at.LAST_STEP] = LENGTH, reel_out_speed, STEP
    state[at.LAST_KITE_VELOCITY : at.LAST_KITE_VELOCITY + 3] = KITE_VELOCITY
    nodes = np.linspace(np.zeros(3), KITE, N + 1) * (0.9 if slack else 1.3) + random.normal(0.0, 0.3, (N + 1, 3))
    nodes[0] = 0.0
    x, v = nodes.ravel(), random.normal(0.0, 2.0, 3 * (N + 1))
    v[:3] = 0.0
    state[at.STATE_HEADER : at.STATE_HEADER + 3 * (N + 1)] = x
    given = inputs_of_step(N, parameters, inputs, STEP, state)
    conditions = conditions_of_chain(N, parameters, parameters[at.INITIAL_SHAPE], given, state, x, v)
    w = backward_euler.workspace(N, work, work[shared_size(N) :])
    attempt = incremental_potential.Attempt(conditions, chain_during(conditions, STEP), STEP, v, is_stage)
    backward_euler.start(attempt, chain_during(conditions, 0.0), 0.0, backward_euler.STAGE if is_stage else 0, x, w)
    backward_euler.add_drag(attempt, x, w)
    # where the step may end, with segments turned by some degrees
    there = x + STEP * v + random.normal(0.0, 0.1, len(x))
    there[:3] = w.free[:3]
    return attempt, w, there


@pytest.mark.parametrize("slack", [False, True])
@pytest.mark.parametrize("law", ["strain_rate", "stretch_rate"])
@pytest.mark.parametrize("reel_out_speed", [0.0, 20.0, -20.0])
@pytest.mark.parametrize("is_stage", [False, True])
def test_is_the_gradient_of_the_potential(is_stage, reel_out_speed, law, slack):
    attempt, w, x = attempt_of(reel_out_speed, law, slack, is_stage)
    incremental_potential.linearize(attempt, x, False, w)
    gradient = -w.move.copy()
    # central differences: error delta^2 x''' / 6 of springs of 1e4 N/m over metres, and rounding of 1e4 J over delta
    delta = 1e-5
    found = differences(lambda x: np.array(incremental_potential.potential(attempt, x, w)[:1]), x, delta)[0]
    np.testing.assert_allclose(gradient[3:], found[3:], rtol=0, atol=1e-8 * np.abs(gradient).max())


@pytest.mark.parametrize("reel_out_speed", [20.0, -20.0])
@pytest.mark.parametrize("is_stage", [False, True])
def test_the_damper_pulls_with_its_tension(is_stage, reel_out_speed):
    """c (e . v - (l/l0) dl0/dt) along e, as in `segment.tension`: in a stage, and in a whole step where no segment turns."""
    attempt, w, there = attempt_of(reel_out_speed, "strain_rate", False, is_stage)
    x = there if is_stage else w.old * 1.1  # all vectors keep their directions
    incremental_potential.linearize(attempt, x, False, w)
    with_damper = w.move.copy()
    attempt.chain.parameters[at.PARAMETER_SCALARS + at.DAMPING * N : at.PARAMETER_SCALARS + (at.DAMPING + 1) * N] = 0.0
    incremental_potential.linearize(attempt, x, False, w)
    damper = (with_damper - w.move).reshape(-1, 3)
    r, moved = (np.diff(each.reshape(-1, 3), axis=0) for each in (x, x - w.old))
    length, rest = np.linalg.norm(r, axis=1), attempt.chain.length / N
    rate = np.sum(r * moved, axis=1) / length / STEP
    tension = Tether().axial_damping / rest * (rate - length / rest * reel_out_speed / N)
    pulls = tension[:, None] * r / length[:, None]
    expected = np.vstack((pulls, np.zeros(3))) - np.vstack((np.zeros(3), pulls))
    np.testing.assert_allclose(damper, expected, rtol=0, atol=1e-9 * np.abs(pulls).max())
