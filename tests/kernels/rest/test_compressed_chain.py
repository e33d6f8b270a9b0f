"""Which straight chains are struts: those whose matrix of stiffness across the chain has a negative eigenvalue.

Across, segment s is a spring T/l: with t_s = T_s/l_s the matrix of the free nodes is tridiagonal, t_s + t_(s+1) and -t_s.
"""

import numpy as np
import pytest

from kernels.packed import packed
from tetherfmu import Tether
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.kernels.rest import compressed_chain

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
