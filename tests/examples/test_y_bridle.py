"""A kite on a Y-bridle: its roll and the tensions of the bridle against statics."""

import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn

sys.path.append(str(EXAMPLES))

from systems import y_bridle


def test_the_kite_rolls_as_statics_say(tmp_path, capsys):
    y_bridle.main(["--out", str(tmp_path)])
    assert "(at rest 4.92 deg)" in capsys.readouterr().out
    assert_is_drawn(tmp_path / "y_bridle.png")
    time, flown = y_bridle.fly()
    roll, at_rest = y_bridle.roll_of(flown, time), y_bridle.roll_at_rest(time)
    # the tips weigh 2 % of the lift, and the roll swings with some 1.5 Hz: the frequency of the steering over that, squared,
    # is 1 %; at first it also swings because the steering begins abruptly, with 5 % and for some seconds
    error = np.abs(roll - at_rest) / np.abs(at_rest).max()
    assert error.max() < 0.06
    assert error[time > 10.0].max() < 0.025
    tension = {name: flown.outputs[name][:, y_bridle.GROUND_TENSION] for name in y_bridle.COLOURS}
    # moments about the other tip: what the right line carries over what the left one does, at the largest shift
    row = np.argmax(y_bridle.shift(time))
    more, less = 1.0 + y_bridle.SHIFT, 1.0 - y_bridle.SHIFT
    sides = tension["bridle_right"][row] / tension["bridle_left"][row]
    assert sides == pytest.approx(bridle_ratio(more, less, at_rest[row]), rel=0.02)


def bridle_ratio(more, less, roll):
    """Tension of the right line over that of the left one, from the forces across the wing on tips that roll [rad]."""
    height = np.sqrt(y_bridle.BRIDLE**2 - 0.25 * y_bridle.WIDTH**2)
    lean = np.arctan2(0.5 * y_bridle.WIDTH, height)  # of a line against the normal of the wing
    half, spread = 0.5 * y_bridle.LIFT, y_bridle.SPREAD
    right, left = (part * half * np.cos(roll) - side * spread * np.sin(roll) for part, side in ((more, 1.0), (less, -1.0)))
    return (right / np.cos(lean)) / (left / np.cos(lean))
