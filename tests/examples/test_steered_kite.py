"""A kite on two tapes that one winch steers: its roll against that of a triangle."""

import sys

import numpy as np

from running import EXAMPLES, assert_is_drawn

sys.path.append(str(EXAMPLES))

from systems import steered_kite


def test_the_wing_rolls_as_a_triangle_does(tmp_path, capsys):
    steered_kite.main(["--out", str(tmp_path)])
    said = capsys.readouterr().out
    assert "after 14 s: roll 9.4" in said
    assert_is_drawn(tmp_path / "steered_kite.png")
    time, roll, paid_out, tensions = steered_kite.fly()
    given = steered_kite.payouts(time)
    # an input is extrapolated over a step, and followed in the next one
    np.testing.assert_allclose(paid_out, given, atol=2e-4)
    # tapes stretch by 0.5 %, which changes the roll by as much; it swings by as little, as the winch is slow
    np.testing.assert_allclose(roll, steered_kite.roll_of(*given), atol=np.radians(0.15))
    still = (time > 37.0) & (time < 41.0)
    # both tapes meet the wing's middle line at angles whose sines are as 1 to 1 over their lengths, see the triangle
    long, short = steered_kite.TAPE - steered_kite.STEERED, steered_kite.TAPE + steered_kite.STEERED
    left, right = tensions[:, still].mean(axis=1)
    assert abs(left / right / (long / short) - 1.0) < 5e-3
