"""The work on a log grows with its length only."""

import numpy as np
import pytest

from study.replay.known_flight import enu, written
from tetherfmu.study.replay import checks, log, readings
from tetherfmu.study.replay.flight import prepare

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them


def test_the_work_on_a_long_log_grows_with_its_seconds():
    """20 minutes at 100 Hz are compared over windows of 1 s, and a reading with neighbours of 1.1 s."""
    time = np.arange(0.0, 1200.0, 0.01)
    assert len(checks.edges(time)) == 1200
    assert len(checks.edges(np.append(time, 1e10))) == 1201
    values = np.zeros(len(time))
    values[60_000] = 100.0
    assert readings.spikes_of(values, 5.0, 0.01).sum() == 1


def test_a_long_log_is_read(folder):
    found = log.read(written(folder, enu(every=0.01, duration=600.0)), "enu")
    assert len(found.time) == 60_000
    assert prepare(found, 0.0, 500.0).end == 500.0
