"""Four drones with one load: tensions of its ropes against statics, and where these end."""

import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn

sys.path.append(str(EXAMPLES))

from systems import four_drones
from tetherfmu import TetherSystem
from tetherfmu.runtime.layout import SLACK_SEGMENTS


def test_ropes_pull_as_statics_say_until_they_go_slack(tmp_path, capsys):
    four_drones.main(["--out", str(tmp_path)])
    assert "a rope goes slack at 3.71 m/s2" in capsys.readouterr().out
    assert_is_drawn(tmp_path / "four_drones_7s.png")
    time, flown = four_drones.fly(14.0)
    flies = time < 14.0
    acceleration = four_drones.motion(time, 14.0)[2]
    more = [
        (four_drones.tension(flown, ropes) - four_drones.tension_by_statics(acceleration, side))[flies]
        for ropes, side in ((four_drones.AHEAD, 1), (four_drones.BEHIND, -1))
    ]
    # the ropes weigh something; the air holds them and they bounce, which adds to those ahead what it takes from the others
    assert np.mean(more) == pytest.approx(weight_in_rope(), rel=0.02)
    assert np.std(more) < 1.0
    assert not any(flown.outputs[name][:, SLACK_SEGMENTS].any() for name in four_drones.AHEAD + four_drones.BEHIND)
    _, fast = four_drones.fly(7.0)
    assert any(fast.outputs[name][:, SLACK_SEGMENTS].any() for name in four_drones.BEHIND)


def weight_in_rope():
    """What its own weight w adds to the tension of the first segment of four [N].

    The chord leans by an angle from the vertical, and the lower end leans more than it by w sin/(2 T), so T there is
    (m g/4 + w sin^2/2)/cos; all the weight but that of half a segment comes on top of it.
    """
    weight = TetherSystem.from_file(four_drones.FILE).lines[0].tether.mass_per_length * four_drones.ROPE * 9.81
    cos = four_drones.BELOW / four_drones.ROPE
    return weight * (0.5 * (1.0 - cos**2) / cos + (1.0 - 1.0 / 8.0) * cos)
