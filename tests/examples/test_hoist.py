"""A load on two winches: where it hangs against the lowest point of four bars, and that its ropes carry it."""

import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn

sys.path.append(str(EXAMPLES))

from systems import hoist


def test_the_load_tilts_as_four_bars_do(tmp_path, capsys):
    time, ends, tensions = hoist.fly()
    settled = time > hoist.DURATION - hoist.SETTLED
    mean = ends[settled].mean(axis=0)
    bars = hoist.hanging(*hoist.lengths(hoist.DURATION))
    np.testing.assert_allclose(np.linalg.norm(bars[1] - bars[0]), hoist.BEAM, rtol=1e-12)
    assert hoist.tilt_of(mean) == pytest.approx(hoist.tilt_of(bars), abs=np.radians(0.05))
    # the ropes stretch by 2 kN/4 MN of 20 m, 1 cm; they weigh 8 kg each, and pull the ends together by some mm
    np.testing.assert_allclose(mean, bars, rtol=0, atol=0.02)
    weight = 9.81 * (400.0 + 0.399 * sum(hoist.lengths(hoist.DURATION)))  # of the load and the ropes
    bars = np.vstack([hoist.LEFT, mean, hoist.RIGHT])
    lean = [np.diff(bars, axis=0)[k] for k in (0, 2)]
    upwards = sum(
        pull * abs(each[1]) / np.hypot(*each) for pull, each in zip(tensions[settled].mean(axis=0), lean, strict=True)
    )
    assert upwards == pytest.approx(weight, rel=5e-3)
    hoist.draw(time, ends, tensions, tmp_path / "hoist.png")
    assert_is_drawn(tmp_path / "hoist.png")
    hoist.main(["--out", str(tmp_path)])
    assert "four bars: tilt 29.44 deg, middle at x = 0.404 m" in capsys.readouterr().out
