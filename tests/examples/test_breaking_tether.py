"""A tether that breaks in a loop: its recoil against the formula, and that it falls to the ground."""

import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn

sys.path.append(str(EXAMPLES))

from ground import breaking_tether


@pytest.mark.filterwarnings("ignore:segment 50, counted from the winch, broke")
@pytest.mark.filterwarnings("ignore:a slack segment presses its ends apart")
def test_it_recoils_and_falls(tmp_path, capsys, monkeypatch):
    flown = at_break, segment, speeds, shapes = breaking_tether.fly()
    assert 0.0 < at_break < breaking_tether.LONGEST
    assert segment == breaking_tether.SEGMENTS  # weight and drag add to the pull of the ground
    early = speeds[(speeds[:, 0] > 0.005) & (speeds[:, 0] < 0.02), 1]
    # the tension was 2 % less below, and the end is pulled by the weight of 10 m of rope and its drag
    np.testing.assert_allclose(early, breaking_tether.recoil(), rtol=0.04)
    assert np.all(shapes[-1][1][:, 2] > -0.1)
    assert shapes[-1][1][:, 2].max() < 2.0 < shapes[0][1][:, 2].max()
    monkeypatch.setattr(breaking_tether, "fly", lambda: flown)
    breaking_tether.main(["--out", str(tmp_path)])
    assert "segment 50 of 50 breaks after 1.1" in capsys.readouterr().out
    assert_is_drawn(tmp_path / "breaking_tether.png")
