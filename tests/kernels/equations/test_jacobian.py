"""Derivatives of the node forces against central differences, in all regimes of a segment."""

import numpy as np
import pytest

from kernels.chain_problem import ChainProblem
from kernels.differences import assert_close, differences, full
from kernels.interleaved import interleaved, node_forces
from tetherfmu.kernels.equations import assembly, flow, segment
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.kernels.line import rosenbrock
from tetherfmu.runtime import layout as at

STEP = 1e-5


def chain_of_length(problem, length):
    return chain_at(problem.n, problem.parameters, length, problem.conditions.reeling[1], problem.wind)


def forces(problem, x, v, length):
    return node_forces(chain_of_length(problem, length), np.full(problem.n, segment.BY_LENGTH), x, v)


def linearize(chain, x, v, w):
    """Records of the segments into those of `w`; returns the rate of the forces from reeling."""
    rate = np.zeros_like(x)
    assembly.linearize(chain, interleaved(x), interleaved(v), w.modes, w.segments, w.records, rate)
    return rate


def dense(problem, factors, flowing=None):
    """The matrix of `assembly.assemble` as a full one, with the rope that flows in a `Chain`."""
    w = problem.of_rosenbrock
    assembly.assemble(problem.n, *factors, w.mass, w.records, w.matrix)
    if flowing is not None and flow.flows(flowing):
        flow.subtract_slopes(flowing, factors[1], factors[2], w.matrix)
    return full(problem.n, w.matrix)


@pytest.mark.parametrize("damping_law", [1, 2])
@pytest.mark.parametrize("wind_profile", [1, 2, 3, 4, at.AT_NODES])
@pytest.mark.parametrize(("slack", "masses"), [(False, ()), (True, ()), (False, ((2, 0.3),))])
def test_forces_differentiate_to_the_matrices(damping_law, wind_profile, slack, masses):
    problem = ChainProblem(damping_law=damping_law, wind_profile=wind_profile, masses=masses)
    length = 60.0 if slack else problem.length
    w = problem.of_rosenbrock
    chain = chain_of_length(problem, length)
    assembly.node_masses(chain, w.mass)
    force_rate = linearize(chain, problem.x, problem.v, w)
    if flow.flows(chain):
        flow.add_rates(chain, chain.acceleration, 0.0, problem.x, problem.v, force_rate)
    np.testing.assert_array_equal(w.modes, segment.SLACK if slack else segment.TAUT)
    by_position = differences(lambda x: forces(problem, x, problem.v, length), problem.x, STEP)
    by_velocity = differences(lambda v: forces(problem, problem.x, v, length), problem.v, STEP)
    by_length = differences(lambda at_length: forces(problem, problem.x, problem.v, at_length[0]), [length], STEP)[:, 0]
    assert_close(dense(problem, (0.0, 0.0, -1.0), chain), by_position)
    assert_close(dense(problem, (0.0, -1.0, 0.0), chain), by_velocity)
    assert_close(force_rate / problem.conditions.reeling[1], by_length)


def test_motion_of_an_end_and_damping_product_agree_with_the_matrices():
    problem = ChainProblem()
    n, w = problem.n, problem.of_rosenbrock
    assembly.node_masses(problem.chain, w.mass)
    linearize(problem.chain, problem.x, problem.v, w)
    stiffness = dense(problem, (0.0, 0.0, -1.0))
    damping = dense(problem, (0.0, -1.0, 0.0))
    move = np.random.default_rng(5).normal(size=(2, 3))
    for kite_end, columns in ((False, slice(0, 3)), (True, slice(3 * n, 3 * n + 3))):
        change = np.zeros(3 * (n + 1))
        assembly.add_end_motion(n, kite_end, tuple(move[0]), tuple(move[1]), w.records, change)
        expected = stiffness[:, columns] @ move[0] + damping[:, columns] @ move[1]
        np.testing.assert_allclose(change, expected, rtol=1e-12, atol=1e-9)
    u = np.random.default_rng(6).normal(size=3 * (n + 1))
    w.r[:] = interleaved(u)
    w.stage_mass[:] = w.mass
    rosenbrock.right_hand_side(problem.conditions, 0, 1.0, w)  # force, force_rate and inertia_velocity are 0
    np.testing.assert_allclose(w.q, -damping @ u, rtol=1e-12, atol=1e-9)


def test_still_air_has_a_derivative():
    """At rest in still air the drag's derivative is zero, not NaN."""
    problem = ChainProblem()
    w = problem.of_rosenbrock
    still = np.zeros_like(problem.v)
    calm = chain_at(problem.n, problem.parameters, 38.0, 0.0, (0.0, 0.0, 0.0))
    linearize(calm, problem.x, still, w)
    assert np.isfinite(w.records[: segment.RECORD * problem.n]).all()
