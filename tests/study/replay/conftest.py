"""The known flight and a measured cycle, unbroken."""

import pandas as pd
import pytest

from study.replay.breaking import CYCLE, KEPT
from study.replay.known_flight import FULL, flown, full, map_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("logs")


@pytest.fixture(scope="module")
def own(folder):
    return map_of(FULL, folder)


@pytest.fixture(scope="module")
def unbroken(folder, own):
    return flown(folder, full(), own)


@pytest.fixture(scope="module")
def cycle():
    """The cycle from its first second on, without velocities."""
    table = pd.read_csv(CYCLE)[[*KEPT, "ground_wind_velocity", "ground_upwind_direction"]]
    return table.assign(time=(table.time - table.time[0]).round(1))


@pytest.fixture(scope="module")
def unbroken_cycle(folder, cycle):
    return flown(folder, cycle, "kitepower_2019")
