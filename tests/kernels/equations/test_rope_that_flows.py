"""Rope that flows past the nodes has the forces of Lagrange's equations (docs/models/theory.md, "Rope that flows").

Written here are the energies, and nothing else; their derivatives are differences:

    K = sum over half segments of 1/2 (mu l0/2) |v_i + w_i u r/l0|^2,  w_i = 1 - i/n,  q = (x, L),  q' = (v, u)
    d/dt dK/dv_i - dK/dx_i - (mu u v_0 at node 0) = m_i a_i - f_i
    d/dt dK/du - dK/dL + d/dL (springs, weight) + dampers = mu u^2/2 - mu |v_0|^2/2 - R
"""

import numpy as np
import pytest

from tetherfmu.kernels.equations import flow, segment
from tetherfmu.kernels.equations import rope_at_drum as rope
from tetherfmu.kernels.equations.properties import chain_in_motion
from tetherfmu.runtime import layout as at

N, DENSITY, STIFFNESS, DAMPING, G = 4, 0.7, 2e3, 60.0, 9.81
LENGTH, SPEED, ACCELERATION = 38.0, 1.5, 0.7
STEP = 1e-5
WIND = (0.0, 0.0, 0.0)


def parameters():
    """Of a chain of N equal segments."""
    array = np.zeros(at.parameters_size(N))
    array[at.DAMPING_LAW], array[at.GRAVITY], array[at.SLACK_STIFFNESS_RATIO] = at.STRAIN_RATE, G, 1.0
    array[at.SLACK_DAMPING_RATIO] = 1.0
    places = {at.SHARE: 1.0 / N, at.LINE_DENSITY: DENSITY, at.STIFFNESS: STIFFNESS, at.DAMPING: DAMPING}
    for which, value in places.items():
        array[at.PARAMETER_SCALARS + which * N : at.PARAMETER_SCALARS + (which + 1) * N] = value
    return array


def motion(seed):
    """Positions, velocities and accelerations of the nodes, random about a line."""
    random = np.random.default_rng(seed)
    x = np.linspace((0.0, 0.0, 1.0), (22.0, 3.0, 33.0), N + 1) + random.normal(size=(N + 1, 3))
    return x, 3.0 * random.normal(size=(N + 1, 3)), random.normal(size=(N + 1, 3))


def split(q):
    return q[:-1].reshape(-1, 3), q[-1]


def energy(q, rate):
    """K [J]."""
    (x, length), (v, speed) = split(q), split(rate)
    r, rest, total = np.diff(x, axis=0), length / N, 0.0
    for j in range(2):
        part = (1.0 - np.arange(j, N + j) / N)[:, None]
        total += 0.25 * DENSITY * rest * ((v[j : N + j] + part * speed * r / rest) ** 2).sum()
    return total


def potential(q):
    """Energy [J] of springs and weight, with rope on the drum at the height of the first node."""
    x, length = split(q)
    rest, stretched = length / N, np.linalg.norm(np.diff(x, axis=0), axis=1)
    heights = 0.5 * (x[1:, 2] + x[:-1, 2]) - x[0, 2]
    return 0.5 * STIFFNESS / rest * ((stretched - rest) ** 2).sum() + DENSITY * G * rest * heights.sum()


def gradient(function, point):
    shifts = STEP * np.eye(len(point))
    return np.array([(function(point + each) - function(point - each)) / (2.0 * STEP) for each in shifts])


def left_sides(seed):
    """d/dt dK/dq' - dK/dq."""
    x, v, a = motion(seed)
    q, rate = np.append(x, LENGTH), np.append(v, SPEED)
    second = np.append(a, ACCELERATION)
    h = 1e-4

    def momentum(time):
        moved = q + time * rate + 0.5 * time**2 * second
        return gradient(lambda speeds: energy(moved, speeds), rate + time * second)

    return (momentum(h) - momentum(-h)) / (2.0 * h) - gradient(lambda place: energy(place, rate), q)


def along_chain(seed, function):
    """Calls function(s, part, chain, x, v) for all segments."""
    x, v, _ = motion(seed)
    chain, part = chain_in_motion(N, parameters(), LENGTH, SPEED, ACCELERATION, WIND), 1.0
    for s in range(N):
        function(s, part, chain, x, v)
        part -= 1.0 / N


@pytest.mark.parametrize("seed", range(3))
def test_forces_on_nodes(seed):
    """Differences are right to 1e-6 of the largest term, mu l0 a: 10 N."""
    _, v, a = motion(seed)
    found = np.zeros((N + 1, 3))

    def add(s, part, chain, x, v):
        of_p, of_q = flow.forces(chain, s, part, *map(tuple, (x[s], x[s + 1], v[s], v[s + 1])))
        found[s] += of_p
        found[s + 1] += of_q

    along_chain(seed, add)
    mass = np.full(N + 1, DENSITY * LENGTH / N)
    mass[[0, -1]] *= 0.5
    expected, _ = split(left_sides(seed))
    expected[0] -= DENSITY * SPEED * v[0]
    assert np.abs(found).max() > 1.0
    np.testing.assert_allclose(mass[:, None] * a - found, expected, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_force_on_the_drum(seed):
    x, v, a = motion(seed)
    found = [rope.of_speed(chain_in_motion(N, parameters(), LENGTH, SPEED, ACCELERATION, WIND))]

    def add(s, part, chain, x, v):
        r, u, height = x[s + 1] - x[s], v[s + 1] - v[s], 0.5 * (x[s, 2] + x[s + 1, 2]) - x[0, 2]
        column_p, column_q = rope.columns(chain, s, part, tuple(r))
        found.append(rope.pull(chain, s, part, segment.TAUT, tuple(r), tuple(u), height))
        found.append(np.dot(column_p, a[s]) + np.dot(column_q, a[s + 1]))
        found.append(-ACCELERATION * rope.inertia(chain, s, part, tuple(r)))

    along_chain(seed, add)
    r, u, rest = np.diff(x, axis=0), np.diff(v, axis=0), LENGTH / N
    stretched = np.linalg.norm(r, axis=1)
    damper = DAMPING / rest * ((r * u).sum(axis=1) / stretched - stretched * SPEED / LENGTH)
    expected = 0.5 * DENSITY * (SPEED**2 - v[0] @ v[0]) - left_sides(seed)[-1]
    expected += (damper * stretched / rest).sum() / N - gradient(potential, np.append(x, LENGTH))[-1]
    assert sum(found) == pytest.approx(expected, abs=1e-4)
