"""The trade-off study: finished points survive a kill, and the report has its parts."""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys

import pytest

from running import environment, points_in, status_of, wait_for
from study.scenes_of_tests import written
from tetherfmu.__main__ import main
from tetherfmu.files.scene_files import load
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.study.advice.configurations import cheapest, front, ladder, study
from tetherfmu.study.measuring import store
from tetherfmu.study.measuring.executors import executor_of
from tetherfmu.study.measuring.runs import Config
from tetherfmu.study.measuring.store import Store, key

FEW = [Config("straight", 0, 0.0, 0.02), Config("quasi_steady", 4, 0.0, 0.02), Config("dynamic", 8, 1e-3, 0.02)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Results of the whole ladder in a short scene, of a run that was killed and one that went on."""
    folder = tmp_path_factory.mktemp("tradeoff")
    scene = written(folder)
    command = [sys.executable, "-m", "tetherfmu", "tradeoff", str(scene), "--out", str(folder / "out")]
    points = folder / "out" / "points.jsonl"
    process = subprocess.Popen([*command, "--processes", "1"], env=environment(), start_new_session=True)
    wait_for(lambda: points_in(points) >= 3, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    (folder / "killed.jsonl").write_bytes(points.read_bytes())
    with open(points, "ab") as file:
        file.write(b'{"key": "half a li')  # what a kill in the middle of a line leaves
    assert main(command[3:]) == 0
    return folder


def test_finished_points_survive_a_kill(folder):
    killed = (folder / "killed.jsonl").read_text(encoding="utf-8").split("\n")[:-1]
    lines = (folder / "out" / "points.jsonl").read_text(encoding="utf-8").splitlines()
    scene = load(folder / "short.toml")
    assert 3 <= len(killed) < len(ladder(scene))
    assert lines[: len(killed)] == killed
    keys = [json.loads(line)["key"] for line in lines if "half a li" not in line]
    assert len(keys) == len(set(keys)) == len(ladder(scene))


def test_report_has_its_parts(folder):
    out = folder / "out"
    assert "# Scene short" in (out / "report.md").read_text(encoding="utf-8")
    assert "<table>" in (out / "report.html").read_text(encoding="utf-8")
    assert (out / "pareto.png").stat().st_size > 6000
    with open(out / "points.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 1 + len(ladder(load(folder / "short.toml")))


def test_finer_is_closer_to_the_reference(folder):
    """The chain converges with the square of the number of segments: 4 times finer is 16 times closer, 8 asked."""
    with open(folder / "out" / "points.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["variant"] == "dynamic" and row["tolerance"] == "0.001"]
    error = {int(row["segments"]): float(row["kite_force"]) for row in rows}
    assert error[16] < error[4] / 8.0


def test_a_changed_default_anywhere_in_the_package_makes_another_key(tmp_path, monkeypatch):
    """The key of a finished point covers every source and table: here the default drag of a tether, and a unit cost."""
    scene = load(written(tmp_path))
    copy = shutil.copytree(PACKAGE, tmp_path / "package", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(store, "PACKAGE", copy)
    monkeypatch.setattr(store, "digest", store.digest.__wrapped__)
    keys = [key(scene.digest, *FEW[0])]
    for name, old, new in (("runtime/parameters.py", "0.958", "0.959"), ("study/measuring/costs.csv", "host,1", "host,2")):
        text = (copy / name).read_text(encoding="utf-8")
        assert old in text
        (copy / name).write_text(text.replace(old, new, 1), encoding="utf-8")
        keys.append(key(scene.digest, *FEW[0]))
    assert len(set(keys)) == 3


@pytest.mark.parametrize("wrong", [["--processes", "0"], ["--procesess", "2"], ["--out", "short.toml/out"]])
def test_a_wrong_option_is_told_in_one_line(tmp_path, monkeypatch, capsys, wrong):
    monkeypatch.chdir(tmp_path)
    assert status_of("tradeoff", str(written(tmp_path)), *wrong) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.fixture(scope="module")
def points(folder):
    with executor_of(processes=1) as executor:
        return study(load(folder / "short.toml"), Store(folder / "few.jsonl"), executor, FEW, 1)[1]


def test_cheapest_and_front(points):
    exact = points.loc[points.kite_force.idxmin()]
    assert cheapest(points, exact.kite_force).config == exact.config
    assert cheapest(points, 1e-12) is None
    best = front(points)
    assert best.variant.iloc[0] == "straight"
    assert best.config.iloc[-1] == exact.config
    assert best.cost.is_monotonic_increasing
    assert best.kite_force.is_monotonic_decreasing
