"""Ropes over sheaves: Atwood's machine against its formula, hook blocks on two and four falls, a pulley at rest."""

import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn

sys.path.append(str(EXAMPLES))

from systems import sheaves

pytestmark = pytest.mark.filterwarnings("error")


def test_atwood_runs_as_the_formula_says():
    """The rope stretches by 0.03 %."""
    time, payout, tensions = sheaves.fly_atwood()
    np.testing.assert_allclose(payout, sheaves.payout_of_atwood(time), rtol=0, atol=2e-3)
    assert np.all(tensions[-1] < 9.81 * (sheaves.HEAVY + 2.0 * sheaves.SIDE))


@pytest.mark.parametrize("falls", [2, 4])
def test_a_block_rises_by_its_part_of_the_rope(falls):
    """Within 1 %: the falls stretch by 0.1 % of 20 m, and the block swings on them. Each sheave loses 2 %."""
    _, rise, hauled, tensions = sheaves.fly_hoist(falls)
    assert rise[-1] == pytest.approx(hauled[-1] / falls, rel=0.01)
    mean = tensions[-100:].mean(axis=0)
    assert mean.sum() == pytest.approx(2000.0 * 9.81, rel=0.01)
    np.testing.assert_allclose(mean[1] / mean[0], 0.98, rtol=1e-3)


def test_the_clothes_line_is_in_balance():
    place, pulls = sheaves.hang()
    assert pulls[0] == pytest.approx(pulls[1], rel=1e-9)
    assert 0.0 < place[0] < 6.0  # nearer to the lower end


def test_it_prints_and_draws(tmp_path, capsys):
    sheaves.main(["--out", str(tmp_path)])
    assert_is_drawn(tmp_path / "sheaves.png")
    assert "by the formula 2.852 m" in capsys.readouterr().out
