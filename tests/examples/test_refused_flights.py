"""A flight that is refused half way: rows until then, the time and the reason, and the exit code of a failure."""

import pandas as pd
import pytest

from scenes import hanging_load
from tetherfmu.__main__ import main as tetherfmu

SCENE = """
duration = 4.0
[flight]
kind = "parked"
sway = 0.0
[tether]
initial_length = 210
[series]
reel_out_speed = [[0, -1.0], [2, -1.0], [2, -15000.0]]
[wanted]
allowed_error = 0.03
"""
LOAD = hanging_load("tip", 50, 200.0, initial_length=20.0, diameter=0.01, density=1000.0, segments=3)
SYSTEM = f"duration = 4.0\n{LOAD}\n[series]\nrope.reel_out_speed = [[0, -1.0], [2, -1.0], [2, -1500.0]]\n"
FAILED, WRONG_USE = 1, 2


def fly(folder, text, *options):
    """Exit status of `fly`, and the table that it writes, if it does."""
    file, table = folder / "flight.toml", folder / "table.csv"
    file.write_text(text, encoding="utf-8")
    status = tetherfmu(["fly", str(file), "--csv", str(table), "--out", str(folder), *options])
    return status, pd.read_csv(table) if table.exists() else None


@pytest.mark.parametrize(
    ("text", "name", "status"), [(SCENE, "tether_length", FAILED), (SYSTEM, "rope.tether_length", WRONG_USE)]
)
def test_rows_until_the_refused_step(tmp_path, capfd, text, name, status):
    """At 1 m/s up to 2 s; the step from there is refused."""
    ended, table = fly(tmp_path, text)
    said = capfd.readouterr()
    assert ended == status
    assert table["time"].iloc[-1] == pytest.approx(2.0)
    assert len(table) == 101
    assert table[name].iloc[0] - table[name].iloc[-1] == pytest.approx(2.0, rel=1e-6)
    assert "would leave segments shorter than 0.01 m" in said.err
    assert said.err.splitlines()[-1].endswith("; the results end at 2 s")
    assert "mean" in said.out
    assert (tmp_path / "forces.png").exists()


def test_all_fmus_until_the_refused_step(tmp_path, capfd):
    ended, table = fly(tmp_path, SCENE, "--tether", "all", "--outputs", "tether_length")
    assert ended == FAILED
    assert "the results end at 2 s" in capfd.readouterr().err
    tethers = ("Dynamic", "QuasiSteady", "Catenary", "Straight")
    assert list(table) == ["time", *(f"Tether{name}.tether_length" for name in tethers)]
    assert table.notna().all(axis=None)


def test_nothing_is_written_of_a_first_step_that_is_refused(tmp_path, capfd):
    text = SCENE.replace("[[0, -1.0], [2, -1.0], [2, -15000.0]]", "-15000.0")
    assert fly(tmp_path, text) == (FAILED, None)
    assert "results end" not in capfd.readouterr().err


def test_rows_of_an_fmu_that_has_ended_are_nan(tmp_path):
    from tetherfmu.study.measuring.flight_table import beside_one_another

    found = beside_one_another({"a": {"time": [0, 1], "x": [3, 4]}, "b": {"time": [0, 1, 2], "x": [5, 6, 7]}})
    assert found["time"] == [0, 1, 2]
    assert found["b.x"].tolist() == [5, 6, 7]
    assert found["a.x"].tolist()[:2] == [3, 4]
    assert pd.isna(found["a.x"][2])
