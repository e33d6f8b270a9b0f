"""Friction on rope that passes the nodes on the ground: derivatives against central differences."""

import numpy as np
import pytest

from kernels.chain_problem import ChainProblem
from kernels.differences import assert_close, differences, full
from kernels.interleaved import interleaved
from tetherfmu.kernels.equations import assembly
from tetherfmu.kernels.equations.properties import chain_in_motion, chain_with_flow
from tetherfmu.kernels.line import contact
from tetherfmu.kernels.line.strand_room import Rope
from tetherfmu.runtime import layout as at

STEP = 1e-6
SPEED, GAIN = 1.5, 0.7  # of the reeling [m/s], [m/s2]


def on_ground():
    problem = ChainProblem(reeling=SPEED)
    problem.parameters[at.GROUND_CONTACT], problem.parameters[at.GROUND_FRICTION] = at.FLAT, 0.5
    problem.parameters[at.GROUND_HEIGHT], problem.parameters[at.GROUND_SINK] = 60.0, 5.0
    problem.v[2::3] *= 0.1  # no node leaves the ground
    return problem


def chain_after(problem, time):
    length, speed = problem.length + SPEED * time + 0.5 * GAIN * time * time, SPEED + GAIN * time
    return chain_in_motion(problem.n, problem.parameters, length, speed, GAIN, problem.wind)


def contact_found(problem, chain, x, v):
    w = problem.of_rosenbrock
    assembly.node_masses(chain, w.mass)
    w.stage_mass[:] = w.mass
    for place in (w.start_x, w.stage_x):
        place[:] = interleaved(x)
    for place in (w.start_v, w.stage_v):
        place[:] = interleaved(v)
    contact.find(problem.conditions, chain, x, v, w)
    return w


def forces(problem, chain, x, v):
    w = contact_found(problem, chain, x, v)
    found = np.zeros(3 * (problem.n + 1))
    for i in range(1, problem.n):
        found[3 * i : 3 * i + 3] = contact.force_at(chain, i, w)
    return found


def test_forces_differentiate_to_the_matrix():
    problem = on_ground()
    chain, (x, v) = chain_after(problem, 0.0), (problem.x.copy(), problem.v.copy())
    by_position = differences(lambda x: forces(problem, chain, x, v), x, STEP)
    by_velocity = differences(lambda v: forces(problem, chain, x, v), v, STEP)
    for d in (0.0, 0.3):
        w = contact_found(problem, chain, x, v)
        assert w.touching[1:-1].all()
        for blocks in w.matrix:
            blocks[:] = 0.0
        contact.subtract_slopes(chain, d, x, v, w)
        assert_close(full(problem.n, w.matrix), -(by_velocity + d * by_position))


def test_rate_of_the_forces():
    """While the winch accelerates and both driven ends move."""
    problem = on_ground()
    x, v = problem.x.copy(), problem.v.copy()

    def later(time):
        moved = x.copy()
        for i in (0, problem.n):
            moved[3 * i : 3 * i + 3] += time * v[3 * i : 3 * i + 3]
        return forces(problem, chain_after(problem, time), moved, v)

    chain, found = chain_after(problem, 0.0), np.zeros_like(x)
    w = contact_found(problem, chain, x, v)
    contact.add_rate(chain, GAIN, w, found)
    contact.add_end_motion(problem.conditions, chain, 0.0, w, found)
    assert_close(found, (later(STEP) - later(-STEP)) / (2.0 * STEP))


@pytest.mark.parametrize("end", [0, 1])
def test_pull_of_friction_differentiates_to_row_and_corner(end):
    problem, rng = on_ground(), np.random.default_rng(7)
    n, x, v = problem.n, problem.x.copy(), problem.v.copy()
    first = np.concatenate(([1.0], 1.0 - np.cumsum(np.full(n, 1.0 / n))))
    weights, growth = (first, first - 1.0), np.full(n, 1.0 / n)
    rates = rng.normal(size=2)

    def with_rates(length, rates, x, v):
        motion = length, rates[0] + rates[1], 0.0, (-rates[1], 0.0)
        chain = chain_with_flow(n, problem.parameters, *motion, problem.wind, False)
        return chain, contact_found(problem, chain, x, v)

    def pull(length, rates, x, v):
        chain, w = with_rates(length, rates, x, v)
        return np.array([contact.pull_of_friction(chain, weights[end], w)])

    chain, w = with_rates(problem.length, rates, x, v)
    d, flat = 0.3, 3 * (n + 1)
    own = Rope(*(np.zeros(flat) for _ in range(7)))
    contact.add_to_row(chain, d, weights[end], w, own)
    by_position = differences(lambda x: pull(problem.length, rates, x, v), x, STEP)[0]
    by_velocity = differences(lambda v: pull(problem.length, rates, x, v), v, STEP)[0]
    assert_close(own.by_velocity, by_velocity)
    assert_close(own.row, by_velocity + d * by_position)
    for other in range(2):
        by_length, by_rate = contact.corner(chain, weights[end], weights[other], growth, w)

        def moved_by(q, more=np.eye(2)[other]):  # noqa: B008 (a constant)
            return pull(problem.length + q[0], rates + more * q[1], x, v)

        expected = differences(moved_by, np.zeros(2), STEP)[0]
        assert_close(np.array((by_length, by_rate)), expected)
    contact.add_to_column(chain, d, weights[end], growth, w, own)

    def moved(q):
        chain, w = with_rates(problem.length + q[0], rates + np.eye(2)[end] * q[1], x, v)
        found = np.zeros(flat)
        for i in range(1, n):
            found[3 * i : 3 * i + 3] = contact.force_at(chain, i, w)
        return found

    by_rope = differences(moved, np.zeros(2), STEP)
    assert_close(own.by_rate, by_rope[:, 1])
    assert_close(own.solved, by_rope[:, 1] + d * by_rope[:, 0])
