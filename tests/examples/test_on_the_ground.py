"""A kite that lands and is dragged away, and a tether that breaks: against weights, friction times weights, its recoil."""

import re

import numpy as np
import pytest

from ground import breaking_tether, landing
from manual import page
from running import EXAMPLES, assert_is_drawn, run_python

HALF = 0.5 / landing.SEGMENTS  # of the tether: what the mass of a driven end is


@pytest.fixture(scope="module")
def landed():
    return landing.land()


def test_the_ground_carries_what_the_ends_do_not(landed):
    """The bow that the wind has laid still creeps: what sinks by less than its depth of 2 mm over 2 m tilts by 1e-3."""
    tether, flown = landed
    assert flown.of("grounded_length")[-1] == pytest.approx(landing.LENGTH, rel=1e-9)
    pull = np.linalg.norm(flown.kite_force[-1])
    assert landing.carried(flown) == pytest.approx(landing.WEIGHT * (1.0 - 2.0 * HALF), abs=1e-3 * pull + 1e-4)
    assert np.abs(tether.positions[1:-1, 2] + landing.GROUND.ground_sink).max() < 1e-5


def test_nothing_is_dragged_until_the_slack_is_out(landed):
    tether, _ = landed
    walked = landing.drag(tether)
    way = np.linalg.norm(tether.positions[-1] - tether.positions[0])
    slack = landing.LENGTH - way
    moved = np.linalg.norm(walked.positions[:, 0] - tether.positions[0], axis=1)
    gone = walked.positions[:, -1, 0] - landing.AT_LANDING[0]
    assert moved[gone < 0.9 * slack].max() < 0.1  # m
    along = walked.positions[-1, 0, 0] - tether.positions[0, 0]  # aside it comes by the bow
    assert along == pytest.approx(gone[-1] - slack, abs=0.05 * slack)  # a bow of some centimetres is left


def test_walking_away_takes_friction_times_weight(landed):
    """The bow straightens slowly: its ends still pull aside, by 1 % of the force after 20 s."""
    walked = landing.drag(landed[0])
    assert np.linalg.norm(walked.kite_force[-1]) == pytest.approx(landing.expected_of_walk(), rel=0.01)


def test_reeling_in_takes_friction_times_both_weights():
    """Steady from 40 s on; 1 % for the bow, and for the sliding of what is reeled in."""
    time, height, tension, length = landing.land_freely()
    np.testing.assert_allclose(tension[time > 40.0], landing.expected_of_reeling(length[time > 40.0]), rtol=0.01)
    np.testing.assert_allclose(height[time > 40.0], -landing.GROUND.ground_sink, atol=1e-4)
    assert height.min() > -0.05  # 1.6 m/s: sqrt(v s sqrt(s/g)) = 7 mm, and what the tether falls with


def test_prints_and_draws(tmp_path):
    done = run_python(EXAMPLES / "ground" / "landing.py", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert not done.stderr  # no warning: the rope does not push
    rows = re.findall(r"(?:carries|takes) ([\d.]+ N)(?: of [\d.]+ N)?, by the formula ([\d.]+ N)", done.stdout)
    assert len(rows) == 3
    for flown, formula in rows:
        assert f"| {flown} | {formula} |" in page("use/ground")
    assert_is_drawn(tmp_path / "landing.png")


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
