"""A log with any of its optional columns is flown, or refused in one line that names what is missing."""

from itertools import chain, combinations

import pandas as pd
import pytest

from study.replay.known_flight import enu, written
from tetherfmu import TetherDynamic, TetherQuasiSteady, TetherStraight
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.study.replay import replay as command

OPTIONAL = {
    "kite_velocity": ["vx", "vy", "vz"],
    "wind_velocity": ["wind_x", "wind_y", "wind_z"],
    "airspeed": ["airspeed"],
    "tether_length": ["tether_length"],
    "reel_out_speed": ["reel_out_speed"],
    "ground_tension": ["ground_tension"],
}
LED = ("tether_length", "reel_out_speed", "ground_tension")  # what a winch can follow
LEADS = {"length": "tether_length", "speed": "reel_out_speed", "tension": "ground_tension"}


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Kernels that are compiled first say so on stderr, where nothing but one refusal is expected."""
    for tether in (TetherDynamic, TetherQuasiSteady, TetherStraight):
        tether().initialize()


def subsets(names):
    """All of them, a list of tuples."""
    return list(chain.from_iterable(combinations(names, count) for count in range(len(names) + 1)))


def replayed(tmp_path, there, capsys, *options):
    """Status of a replay of a log with these optional columns, what it printed, and what it said on stderr."""
    left_out = [column for name, columns in OPTIONAL.items() if name not in there for column in columns]
    log = written(tmp_path, enu(duration=32.0).drop(columns=left_out))
    status = tetherfmu(["replay", str(log), "--as", "enu", "--tether", "straight", "--out", str(tmp_path / "out"), *options])
    said = capsys.readouterr()
    assert said.err.count("\n") == (status != 0), said.err
    return status, said.out, said.err


@pytest.mark.parametrize("there", subsets(OPTIONAL), ids=lambda there: "+".join(there) or "none")
def test_whatever_columns_a_log_has(there, tmp_path, capsys, monkeypatch):
    """Figures and page are written of all logs that go without one column, and of the full one."""
    written_to = len(there) >= len(OPTIONAL) - 1
    if not written_to:
        monkeypatch.setattr(command, "write", lambda *_: [])
    status, out, err = replayed(tmp_path, there, capsys)
    if not set(LED).intersection(there):
        assert status == 2
        assert err.endswith(
            "flight.csv: has none of ground_tension, tether_length, reel_out_speed: nothing can drive the winch\n"
        )
        return
    assert status == 0
    assert ("length offset m" in out) == ({"tether_length", "ground_tension"} <= set(there))
    assert ("length at 0 s of the log m" in out) == (set(LED).intersection(there) == {"reel_out_speed", "ground_tension"})
    if written_to:
        errors = pd.read_csv(tmp_path / "out" / "errors.csv")
        assert ("length: mean [m]" in errors) == ("ground_tension" in there and len(set(LED).intersection(there)) > 1)


@pytest.mark.parametrize("fit", ["offset", "nothing"])
@pytest.mark.parametrize("lead", LEADS)
@pytest.mark.parametrize("there", subsets(LED), ids=lambda there: "+".join(there) or "none")
def test_whatever_leads_and_is_fitted(there, lead, fit, tmp_path, capsys, monkeypatch):
    """What leads must be there; a fit needs the tension, and a length or its rate, which then becomes a length."""
    monkeypatch.setattr(command, "write", lambda *_: [])
    status, _, err = replayed(tmp_path, there, capsys, "--lead", lead, "--fit", fit)
    is_fitted = "ground_tension" in there and len(there) > 1
    becomes_length = lead == "length" and "reel_out_speed" in there and fit == "offset" and is_fitted
    if fit == "offset" and not is_fitted:
        assert status == 2
        needed = (LEADS[lead], "ground_tension", "neither tether_length nor reel_out_speed")
        assert any(f"has no {each}" in err or f"has {each}" in err for each in needed), err
    elif LEADS[lead] in there or becomes_length:
        assert status == 0
    else:
        assert status == 2
        assert f"flight.csv: has no {LEADS[lead]}: the winch cannot follow the {lead}" in err
        assert all(each in err.partition("the log has ")[2] for each in there)


def test_a_fit_without_a_length_needs_the_length_at_the_start(tmp_path, capsys):
    status, _, err = replayed(tmp_path, ("reel_out_speed", "ground_tension"), capsys, "--fit", "delay")
    assert status == 2
    assert "has no tether_length: delay can be fitted only with offset" in err
