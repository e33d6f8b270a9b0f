"""A slack chain whose fold presses a segment has a shape, the right one; where the wind lets it never rest, it is refused.

Each start must be in balance by `balance.py`, from its node positions alone, and stable: no eigenvalue of dF/dx, the
derivative of the forces by the positions, has a positive real part.

gravity    Upright in hardly any, a rounding error of a position pulls at a segment with more than its load. So the shape is
           judged without its stretch: with tensions T_s along its segments e_s every inner node must hold its weight W, and
           any motion that leaves all lengths as they are must be driven back,

               T_i e_i - T_(i-1) e_(i-1) + W = 0,   y . (dF/dx) y < 0 with F' = sum of T/l (1 - e e) (dx_q - dx_p)
wind       faint and from the side, on a tether almost straight above or below its station: hardly anything keeps its fold
           from turning about its chord
together   both ends almost in one place, in a wind, level or not
strut      a straight chain whose matrix of stiffness across it has a negative eigenvalue: segment s is a spring
           t_s = T_s/l_s there, so it is tridiagonal, t_s + t_(s+1) and -t_s
"""

from itertools import product

import numpy as np
import pytest

from balance import growth, residual, rounding, segments, slope_of_segments
from kernels.packed import packed
from tetherfmu import Environment, StepRefused, Tether, TetherQuasiSteady
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.kernels.rest import compressed_chain, newton

STARTS, AIR = 40, Environment()


def unbalanced(model, wind, tether):
    """Largest missing force of a node over what rounding explains."""
    missing, tensions = residual(model.positions, np.zeros(3), wind, tether, AIR)
    return np.abs(missing).max() / rounding(model.positions, tensions, tether)


# --- hardly any gravity


def upright(count, seed):
    """Start of a slack, stiff tether of so many segments almost straight above or below its station."""
    random = np.random.default_rng([count, seed])
    length, direction = 10.0 ** random.uniform(1.0, 3.0), random.normal(size=3) * (1e-3, 1e-3, 1.0)
    stiffness, slack = 10.0 ** random.uniform(5.0, 8.0), random.uniform(0.01, 1.0)
    tether = Tether(segments=count, initial_length=length, axial_stiffness=stiffness)
    model = TetherQuasiSteady(tether, Environment(gravity=1e-6))
    model.initialize(length / (1.0 + slack) * direction / np.linalg.norm(direction))
    return model, tether


@pytest.mark.parametrize("count", [5, 10, 20, 40])
def test_upright_in_hardly_any_gravity(count):
    """Of these starts 3, 14, 10 and 10 were refused by steps 1 to 6."""
    for seed in range(STARTS):
        upright(count, seed)


# all of them were refused by steps 1 to 6; at the equilibrium of (10, 13) that is nearest to the first guess a motion grows
@pytest.mark.parametrize(("count", "seed"), [(5, 5), (5, 14), (5, 33), (10, 0), (10, 13), (20, 0), (20, 8), (40, 2)])
def test_balance_and_stability_of_an_inextensible_chain(count, seed):
    model, tether = upright(count, seed)
    assert model.counters["iterations"] < 15000
    _, length, e = segments(model.positions, tether)
    rest = tether.initial_length / count
    # the strain of the weight of the whole tether is below 1e-9
    np.testing.assert_allclose(length, rest, rtol=1e-8)
    pulls = np.zeros((count, count + 1, 3))
    pulls[np.arange(count), np.arange(count)] = e
    pulls[np.arange(count), np.arange(1, count + 1)] = -e
    pulls = pulls[:, 1:-1].reshape(count, -1)
    weight = np.tile([0.0, 0.0, -1.0], count - 1)  # in units of that of a node
    tension = np.linalg.lstsq(pulls.T, -weight)[0]
    # the search ends where the rounding of its springs, up to the weight of a node, hides what is left; how far the
    # directions are then depends on the last bit of the kite, which numpy's norm leaves to the processor: 1e-13 to 2e-6
    np.testing.assert_allclose(pulls.T @ tension, -weight, atol=1e-5)
    inextensible = np.linalg.svd(pulls)[2][count:].T
    across = np.eye(3) - e[:, :, None] * e[:, None, :]
    slope = slope_of_segments((tension / length)[:, None, None] * across)[3:-3, 3:-3]
    assert np.linalg.eigvalsh(inextensible.T @ slope @ inextensible).max() < -1e-5 / rest


# --- faint wind


def in_faint_wind(n, slack, up, wind, aside):
    """Start of a tether in a wind [m/s] along y, its kite 500 m up or down and a little aside [m] along x."""
    tether = Tether(segments=n, initial_length=500.0 / (1.0 - slack))
    model = TetherQuasiSteady(tether)
    model.initialize((aside, 0.0, up * 500.0), wind_velocity=(0.0, wind, 0.0))
    return model, tether


# by steps 1 to 6 all of them are refused
@pytest.mark.parametrize(
    ("n", "slack", "up", "wind", "aside"),
    [
        (2, 0.8, 1, 1.0, 1e-6),
        (5, 0.9, -1, 1.0, 1e-6),
        (10, 0.02, 1, 0.1, 0.1),
        (10, 0.9, 1, 0.2, 1e-3),
        (15, 0.3, 1, 0.1, 1.0),
        (30, 0.1, -1, 0.1, 1.0),
        (50, 0.7, 1, 0.2, 0.1),
    ],
)
def test_faint_wind_in_balance_and_stable(n, slack, up, wind, aside):
    model, tether = in_faint_wind(n, slack, up, wind, aside)
    assert unbalanced(model, (0.0, wind, 0.0), tether) < 1.0
    # the softest of the others has some 1e-2 N/m
    assert growth(model.positions, (0.0, wind, 0.0), tether, AIR) < -1e-6


def test_none_is_refused_in_faint_wind():
    """Every fifth of 2160. Step 7 of docs/models/numerics.md, "Initial shape"; steps 1 to 6 refuse 314 of all."""
    cases = (10, 15, 20, 30, 50), (0.02, 0.1, 0.3, 0.5, 0.7, 0.9), (1, -1)
    cases += (0.1, 0.2, 0.5, 1.0, 2.0, 4.0), (1e-6, 1e-3, 0.1, 1.0, 5.0, 20.0)
    for case in list(product(*cases))[::5]:
        in_faint_wind(*case)


# --- ends together


@pytest.mark.parametrize("count", [5, 10, 20, 40])
def test_ends_together_in_a_level_wind(count):
    """By steps 1 to 6 one in ten of those with 40 segments is refused."""
    random = np.random.default_rng(1)
    for _ in range(STARTS):
        length, direction = 10.0 ** random.uniform(1.0, 3.0), random.normal(size=3)
        angle = random.uniform(0.0, 2.0 * np.pi)
        tether, wind = Tether(segments=count, initial_length=length), 8.0 * np.array([np.cos(angle), np.sin(angle), 0.0])
        model = TetherQuasiSteady(tether)
        model.initialize(1e-3 * length * direction / np.linalg.norm(direction), wind_velocity=wind)
        assert unbalanced(model, wind, tether) < 1.0


def together(count, seed):
    """A tether with both ends almost together in 8 m/s of wind from any direction, started, and the wind."""
    random = np.random.default_rng([count, seed, 0])
    length, direction = 10.0 ** random.uniform(1.0, 3.0), random.normal(size=3)
    wind = random.normal(size=3)
    tether, wind = Tether(segments=count, initial_length=length), 8.0 * wind / np.linalg.norm(wind)
    model = TetherQuasiSteady(tether)
    model.initialize(1e-3 * length * direction / np.linalg.norm(direction), wind_velocity=wind)
    return model, tether, wind


# all of them were refused by steps 1 to 6: in a wind that comes down and in one that rises
@pytest.mark.parametrize(("count", "seed"), [(5, 28), (5, 110), (5, 112), (20, 124), (40, 72), (40, 93), (40, 153)])
def test_ends_together_in_any_wind(count, seed):
    model, tether, wind = together(count, seed)
    assert unbalanced(model, wind, tether) < 1.0
    # rounding in the eigenvalues: 1e-16 of the stiffness over the weight per length, up to 1e-4
    assert growth(model.positions, wind, tether, AIR) < -1e-3 * tether.mass_per_length * AIR.gravity


@pytest.mark.parametrize("seed", [19, 22, 47, 94, 108])
def test_a_tether_that_the_wind_never_lets_rest_is_refused(seed):
    """The wind rises by 43 to 49 degrees and carries the tether. All equilibria that were found are unstable.

    An overdamped chain, dx/dt = F, from six different shapes ends in the same flutter.
    """
    with pytest.raises(StepRefused, match="no equilibrium was found between the given ends"):
        together(10, seed)


@pytest.mark.parametrize(("tension", "lowest"), [(1.0, -0.2), (-1.0, -5.0), (0.0, 0.0)])
def test_tensions_change_their_sign_at_a_part_of_their_size(tension, lowest):
    assert newton.lowest_tension.py_func(newton.EITHER_SIGN, tension) == lowest


# --- struts

TETHER = Tether(segments=6, initial_length=60.0)


@pytest.fixture(scope="module")
def chain():
    return chain_at(6, packed(TETHER), 60.0, 0.0, (0.0, 0.0, 0.0))


def straight_chain(seed, pressed):
    """Random nodes on a line, with `pressed` segments shorter than unstretched; lowest eigenvalue over the largest |t|."""
    random = np.random.default_rng(seed)
    stretch = 10.0 ** random.uniform(-6.0, -2.0, 6)
    stretch[random.permutation(6)[:pressed]] *= -(10.0 ** random.uniform(0.0, 2.0))
    way = random.choice([-1.0, 1.0], 6)  # interleaved as it likes
    direction = random.normal(size=3)
    direction /= np.linalg.norm(direction)
    positions = np.concatenate(([0.0], np.cumsum(way * 10.0 * (1.0 + stretch))))[:, None] * direction + random.normal(size=3)
    stiffness = TETHER.axial_stiffness * np.where(stretch > 0.0, 1.0, TETHER.slack_stiffness_ratio)
    across = stiffness * stretch / (10.0 * (1.0 + stretch))
    matrix = np.diag(across[:-1] + across[1:]) - np.diag(across[1:-1], 1) - np.diag(across[1:-1], -1)
    return positions, np.linalg.eigvalsh(matrix)[0] / np.abs(across).max()


@pytest.mark.parametrize("pressed", [0, 1, 2, 6])
def test_unstable_is_what_has_a_negative_eigenvalue(chain, pressed):
    verdicts = []
    for seed in range(200):
        positions, lowest = straight_chain(seed, pressed)
        if abs(lowest) > 1e-5:  # neither neutral nor rounding
            verdicts.append(lowest < 0.0)
            assert compressed_chain.is_unstable(chain, positions.ravel(), 1e-6) == verdicts[-1]
    assert len(verdicts) > 100
    assert pressed != 1 or 10 < sum(verdicts) < len(verdicts) - 10  # both kinds


def test_bent_chain_is_none(chain):
    positions, _ = straight_chain(1, 6)
    positions[3] += (0.1, 0.2, 0.3)
    assert not compressed_chain.is_unstable(chain, positions.ravel(), compressed_chain.PARALLEL)


@pytest.mark.parametrize(
    "direction", [(0.0, 0.0, 1.0), (0.0, 0.0, -3.0), (0.0, 2.0, 0.0), (5.0, 0.0, 0.0), (1.0, 1.0, -1.0)]
)
def test_sideways_is_across(direction):
    side = np.array(compressed_chain.sideways(direction))
    assert np.linalg.norm(side) == pytest.approx(1.0, rel=1e-15)
    assert side @ direction == pytest.approx(0.0, abs=1e-15)
    assert side[1 if direction[0] == 5.0 else 0] > 0.5
