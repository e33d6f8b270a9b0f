"""Rope that flows past the nodes has the forces of Lagrange's equations (docs/models/theory.md, "Rope that flows").

Written here are the energies, and nothing else; their derivatives are differences:

    K = sum over half segments of 1/2 (mu l0/2) |v_i + w_i u r/l0|^2,  w_i = 1 - i/n,  q = (x, L),  q' = (v, u)
    d/dt dK/dv_i - dK/dx_i - (mu u v_0 at node 0) = m_i a_i - f_i
    d/dt dK/du - dK/dL + d/dL (springs, weight) + dampers = mu u^2/2 - mu |v_0|^2/2 - R
"""

import numpy as np
import pytest

from kernels.differences import differences
from tetherfmu.kernels.equations import flow, rope, segment
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


def left_sides(seed):
    """d/dt dK/dq' - dK/dq."""
    x, v, a = motion(seed)
    q, rate = np.append(x, LENGTH), np.append(v, SPEED)
    second = np.append(a, ACCELERATION)
    h = 1e-4

    def momentum(time):
        moved = q + time * rate + 0.5 * time**2 * second
        return differences(lambda speeds: energy(moved, speeds), rate + time * second, STEP)

    return (momentum(h) - momentum(-h)) / (2.0 * h) - differences(lambda place: energy(place, rate), q, STEP)


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


def sides(part):
    """Weights of the rope that comes in at the start and at the end of a plain line, in a segment; part : of its node p."""
    share = 1.0 / N
    return rope.Side(share, part, part - share), rope.Side(share, part - 1.0, part - share - 1.0)


def of_segment(chain, s, part, x, v):
    """`Piece`, `Flow`, both `Side`s, r and r' of a segment, into which rope comes at the start alone."""
    own, other = sides(part)
    flowing = rope.flow_past(own, other, (SPEED, 0.0), (ACCELERATION, 0.0))
    r, u = tuple(x[s + 1] - x[s]), tuple(v[s + 1] - v[s])
    return rope.piece_of(chain, s, segment.TAUT), flowing, own, other, r, u


@pytest.mark.parametrize("seed", range(3))
def test_force_on_the_drum(seed):
    x, v, a = motion(seed)
    found = [0.5 * DENSITY * SPEED**2]

    def add(s, part, chain, x, v):
        height = 0.5 * (x[s, 2] + x[s + 1, 2])
        heights = height - x[0, 2], height - x[N, 2]
        pulled, _ = rope.pulls(*of_segment(chain, s, part, x, v), heights, tuple(a[s]), tuple(a[s + 1]))
        found.append(pulled)

    along_chain(seed, add)
    r, u, rest = np.diff(x, axis=0), np.diff(v, axis=0), LENGTH / N
    stretched = np.linalg.norm(r, axis=1)
    damper = DAMPING / rest * ((r * u).sum(axis=1) / stretched - stretched * SPEED / LENGTH)
    expected = 0.5 * DENSITY * (SPEED**2 - v[0] @ v[0]) - left_sides(seed)[-1]
    expected += (damper * stretched / rest).sum() / N - differences(potential, np.append(x, LENGTH), STEP)[-1]
    assert sum(found) == pytest.approx(expected, abs=1e-4)


def element(rest, rates, gains, r, u, z, sides):
    """R of both ends and f_p, f_q of one taut segment as a function of all that it depends on."""
    own, other = sides
    growth = (own.share * rates[0] + other.share * rates[1]) / rest
    piece = rope.Piece(rest, 1.0 / rest, 0.5 * DENSITY, STIFFNESS / rest, DAMPING / rest, growth, G)
    flowing = rope.flow_past(own, other, tuple(rates), tuple(gains))
    pulled = rope.pulls(piece, flowing, own, other, tuple(r), tuple(u), (0.0, 0.0), tuple(z[0]), tuple(z[1]))
    return np.array(pulled), np.array(rope.forces(piece, flowing, tuple(r), tuple(u))), piece, flowing


ANY_SIDES = rope.Side(0.3, 0.8, 0.5), rope.Side(0.1, -0.1, -0.2)  # weights as of no plain line
REST, RATES, GAINS = 2.0, np.array([1.5, -0.4]), np.array([0.7, 0.9])
R, U, Z = np.array([1.0, -0.7, 2.1]), np.array([0.4, 1.1, -0.8]), np.array([[0.5, -1.0, 2.0], [1.4, 0.3, -0.6]])


def slope(function, point):
    return differences(function, point, 1e-6)


@pytest.mark.parametrize("end", [0, 1])
def test_slopes_of_pulls(end):
    """Differences are right to 1e-9 of numbers up to 1e4."""
    _, _, piece, flowing = element(REST, RATES, GAINS, R, U, Z, ANY_SIDES)
    side = ANY_SIDES[end]
    by_r, by_u, by_rest = rope.row(piece, flowing, side, tuple(R), tuple(U), tuple(Z[0]), tuple(Z[1]))

    def pull(rest=REST, rates=RATES, gains=GAINS, r=R, u=U, z=Z):
        return element(rest, rates, gains, r, u, z, ANY_SIDES)[0][end]

    np.testing.assert_allclose(by_r, slope(lambda r: pull(r=r), R), rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(by_u, slope(lambda u: pull(u=u), U), rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(by_rest, slope(lambda rest: pull(rest=rest[0]), [REST])[0], rtol=1e-6)
    by_rates = [rope.corner(piece, flowing, side, by, tuple(R), tuple(U)) for by in ANY_SIDES]
    np.testing.assert_allclose(by_rates, slope(lambda rates: pull(rates=rates), RATES), rtol=1e-6, atol=1e-4)
    by_gains = [rope.inertia(piece, side, by, R @ R) for by in ANY_SIDES]
    np.testing.assert_allclose(by_gains, slope(lambda gains: pull(gains=gains), GAINS), rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize("end", [0, 1])
def test_slopes_of_forces(end):
    """What a length, a rate and its rate do to both nodes: springs, dampers, flow, and masses that grow."""
    _, _, piece, flowing = element(REST, RATES, GAINS, R, U, Z, ANY_SIDES)
    length, e = np.linalg.norm(R), R / np.linalg.norm(R)

    def tension(rest, rates):
        growth = (ANY_SIDES[0].share * rates[0] + ANY_SIDES[1].share * rates[1]) / rest
        return STIFFNESS / rest * (length - rest) + DAMPING / rest * (e @ U - growth * length)

    def both(rest=REST, rates=RATES, gains=GAINS):
        pull = tension(rest, rates) * e
        inertia = 0.5 * DENSITY * rest * np.add(Z, (0.0, 0.0, G))
        return np.array([pull, -pull]) - inertia + element(rest, rates, gains, R, U, Z, ANY_SIDES)[1]

    by_rest = slope(lambda rest: tension(rest[0], RATES), [REST])[0]
    loads = [tuple(np.add(z, (0.0, 0.0, G))) for z in Z]
    found = rope.column(piece, flowing, by_rest, tuple(e), tuple(R), tuple(U), ANY_SIDES[end], loads)
    share = ANY_SIDES[end].share
    np.testing.assert_allclose(
        found[0], share * slope(lambda rest: both(rest=rest[0]), [REST])[..., 0], rtol=1e-6, atol=1e-4
    )
    np.testing.assert_allclose(found[1], slope(lambda rates: both(rates=rates), RATES)[..., end], rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(found[2], slope(lambda gains: both(gains=gains), GAINS)[..., end], rtol=1e-6, atol=1e-4)


def test_a_line_is_the_same_from_either_end():
    """Reversed, its ends change places, and so do nodes, with r, u turned round: no coordinate has a sign of its own."""
    pulled, forces, _, _ = element(REST, RATES, GAINS, R, U, Z, ANY_SIDES)
    turned = [rope.Side(each.share, -each.at_q, -each.at_p) for each in ANY_SIDES[::-1]]
    again, back, _, _ = element(REST, RATES[::-1], GAINS[::-1], -R, -U, Z[::-1], turned)
    np.testing.assert_allclose(again[::-1], pulled, rtol=1e-14)
    np.testing.assert_allclose(back[::-1], forces, rtol=1e-14)
