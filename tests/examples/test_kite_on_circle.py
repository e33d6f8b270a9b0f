"""The environment for Gymnasium keeps its rules, flies the tether of the Python API, and does little work."""

import sys
import warnings

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from learning import kite_on_circle as example
from learning import steered_circle
from manual import page
from running import assert_is_drawn, run_without
from tetherfmu import TetherDynamicFree
from tetherfmu.runtime import layout as at

STEPS = 200
MOST_SOLVER_STEPS, MOST_CALLS = 1.1, 80  # of a step; measured: 1.05 over a minute, and 61


@pytest.fixture(scope="module")
def flown():
    """A minute by the policy by hand."""
    return steered_circle.fly()


def test_gymnasium_finds_nothing():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(infinity|different)")  # bounds of tension and wind, and render modes
        check_env(example.KiteOnCircle(), skip_render_check=True)


def test_the_policy_flies_the_circle(flown):
    """All of a minute, within 1.1 deg of 20 after the start, three times around."""
    positions, observations, rewards = flown
    off, place = observations[500:, 0], np.unwrap(np.arctan2(observations[:, 3], observations[:, 2]))
    assert len(positions) == steered_circle.MINUTE + 1
    assert np.rad2deg(np.abs(off).max()) < 1.1
    assert rewards == pytest.approx(np.sum(1.0 - np.abs(observations[1:, 0]) / example.RADIUS), rel=1e-5)  # 32 bits
    assert 2.5 < (place[-1] - place[0]) / (2.0 * np.pi) < 3.5  # to the right


def test_it_is_the_tether_of_the_python_api():
    """To the bit, with the same loads."""
    kite = example.KiteOnCircle()
    tether = TetherDynamicFree(initial_length=example.LENGTH, segments=example.SEGMENTS, kite_mass=example.MASS)
    tether.initialize(kite.position, np.multiply(example.SPEED, example.UP), wind_velocity=example.WIND)
    observation, _ = kite.reset(seed=1)
    for _ in range(STEPS):
        observation, *_ = kite.step(example.steer(observation))
        outputs = tether.step(example.STEP, kite.tether.values[at.KITE_LOAD : at.KITE_LOAD + 3])
    assert list(kite.position) == outputs.kite_position.tolist()
    assert observation[5] == np.float32(1e-3 * outputs.kite_tension)


def episode(kite, seed):
    observations = [kite.reset(seed=seed)[0]]
    for _ in range(STEPS):
        observations.append(kite.step(example.steer(observations[-1]))[0])
    return np.array(observations)


def test_a_reset_equals_a_fresh_environment():
    """To the bit; another seed has another heading."""
    kite = example.KiteOnCircle()
    first, again, other = episode(kite, 1), episode(kite, 1), episode(kite, 2)
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first, episode(example.KiteOnCircle(), 1))
    assert not np.array_equal(first, other)


def calls(function, *arguments):
    """Number of calls of functions, in Python and in C, that a call makes."""
    count = 0

    def counted(frame, event, argument):
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(counted)
    try:
        function(*arguments)
    finally:
        sys.setprofile(None)
    return count


def test_a_step_and_a_reset_are_little_work():
    """A reset from the saved state starts no solver, and makes fewer calls than a step."""
    kite = example.KiteOnCircle()
    observation, _ = kite.reset(seed=0)
    started = kite.tether.state[at.STEPS]
    for _ in range(steered_circle.MINUTE):
        observation, *_ = kite.step(example.steer(observation))
    assert kite.tether.state[at.STEPS] - started <= MOST_SOLVER_STEPS * steered_circle.MINUTE
    of_step = calls(kite.step, example.steer(observation))
    assert calls(kite.reset) < of_step <= MOST_CALLS
    assert kite.tether.state[at.STEPS] == started


@pytest.mark.parametrize(("steering", "is_off"), [(0.0, True), (1.0, False)])
def test_an_episode_ends_off_the_circle_or_near_the_ground(steering, is_off):
    """Without steering the kite flies over the circle, with all of it in ever lower loops."""
    kite = example.KiteOnCircle()
    kite.reset(seed=0)
    for _ in range(steered_circle.MINUTE):
        _, reward, ends, _, information = kite.step(np.array((steering,), np.float32))
        if ends:
            break
    assert ends
    assert not information
    assert (reward < 0.0, kite.position[2] < example.LOWEST) == (is_off, not is_off)


def test_a_refused_step_ends_the_episode_and_says_why():
    kite = example.KiteOnCircle()
    kite.reset(seed=0)
    _, _, ends, _, information = kite.step(np.array((np.nan,), np.float32))
    assert ends
    assert "the input kite_load[1] is nan" in information["refused"]
    np.testing.assert_array_equal(episode(kite, 1), episode(example.KiteOnCircle(), 1))


def test_prints_what_the_page_shows(flown, tmp_path, monkeypatch, capsys):
    """All but the times, which are those of a machine."""
    monkeypatch.setattr(steered_circle, "speed", lambda: (20000.0, 1.0))
    monkeypatch.setattr(steered_circle, "fly", lambda: flown)
    assert steered_circle.main(["--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert "\n".join(printed[:2]) in page("use/coupling")
    assert printed[2] == "20000 steps a second with the policy; a reset takes the time of 1.0 steps"
    assert_is_drawn(tmp_path / "kite_on_circle.png")


def test_without_gymnasium_it_is_named_in_one_line():
    """The extra that brings it is in the message where this version is installed."""
    done = run_without("gymnasium", "learning.steered_circle")
    assert done.returncode == 2
    assert done.stderr.startswith("gymnasium is not installed: pip install ")
    assert len(done.stderr.splitlines()) == 1
