"""A sweep gives the same table whoever does its work, keeps what is finished, and a flight that is refused is a row."""

import os
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from manual import codes, page
from tetherfmu.__main__ import main
from tetherfmu.console.ending import WorkersLost
from tetherfmu.files.scene_files import load
from tetherfmu.study import sweep
from tetherfmu.study.measuring import executors
from tetherfmu.study.measuring.executors import executor_of
from tetherfmu.study.measuring.runs import Config, run
from tetherfmu.study.sweeps import sweep as module
from tetherfmu.study.sweeps.statistics import Statistics, Task, fly_all, statistics_of
from tetherfmu.study.sweeps.sweep import MOST_PER_TASK, tasks_of

SHORT = {"settings": [("duration", 0.6)], "segments": 4}
ONE_PROCESS = {"processes": 1, **SHORT}
WIND = ["wind.speed=2..7"]


@pytest.fixture(scope="module")
def table():
    """Six flights, in this process."""
    return sweep("circle", WIND, **ONE_PROCESS)


def test_statistics_are_those_of_the_flight(table):
    """The scene of the file with another wind, flown by the function of the advisor, a row in each communication step."""
    scene = load("circle", [("duration", 0.6), ("wind.velocity", [5.0, 0.0, 0.0])])
    flown = run(replace(scene, every=0.02), Config("dynamic", 4, 1e-4, 0.02)).flown
    (row,) = table[table["wind.speed"] == 5].to_dict("records")
    assert row["kite_tension_max"] == flown.of("kite_tension").max()
    assert row["ground_tension_p50"] == np.median(flown.of("ground_tension"))
    assert row["peak_tension"] == flown.of("peak_tension").max()


def test_statistics_of_a_sine():
    """Amplitude a about a mean m, whole periods: rms^2 = m^2 + a^2/2, half of the time above m, cycles of 2 a."""
    time, mean, amplitude, periods = np.arange(1000) / 1000.0, 300.0, 110.0, 5
    force = mean + amplitude * np.sin(2.0 * np.pi * periods * time)
    signals = {"kite_tension": force, "ground_tension": force, "peak_tension": 2.0 * force, "slack_segments": time >= 0.75}
    signals["broken"] = np.zeros(1000)
    found = statistics_of(signals, Statistics(("kite_tension",), (50.0, 100.0)), 0.001)
    assert found["kite_tension_mean"] == pytest.approx(mean)
    assert found["kite_tension_rms"] == pytest.approx(np.sqrt(mean**2 + 0.5 * amplitude**2))
    assert found["kite_tension_p50"] == pytest.approx(mean)
    assert found["kite_tension_p100"] == found["kite_tension_max"] == pytest.approx(mean + amplitude)
    assert found["peak_tension"] == 2.0 * found["kite_tension_max"]
    assert found["time_slack"] == pytest.approx(0.25)
    assert found["largest_cycle"] == pytest.approx(2.0 * amplitude)
    # from the first peak to the last trough 4.5 cycles of 2 a; before and behind half cycles of a
    assert found["cycles"] == pytest.approx(5.5)
    assert found["bins"] == {"40": 1.0, "46": 4.5}  # from 100 to 112 N, from 200 to 224 N


@pytest.mark.parametrize("executor", ["all cores", "threads"])
def test_who_does_the_work_does_not_count(table, executor):
    if executor == "threads":
        with ThreadPoolExecutor(2) as threads:
            found = sweep("circle", WIND, executor=threads, **SHORT)
    else:
        found = sweep("circle", WIND, **SHORT)
    assert found.equals(table)
    assert found.attrs == table.attrs


def test_a_refused_flight_is_a_row():
    found = sweep("circle", ["tether.initial_length=525,1e9,0.03"], **ONE_PROCESS)
    assert found.refused[0] == ""
    assert "tether.initial_length is 1000000000.0; it must be" in found.refused[1]
    assert "segments" in found.refused[2]  # of 4, none shorter than 1 cm
    assert found.kite_tension_max.notna().tolist() == [True, False, False]


def test_a_stopped_sweep_continues(table, tmp_path, monkeypatch):
    """Of six flights four are there, the last one half written."""
    flown = []
    monkeypatch.setattr(module, "fly_all", lambda task: flown.extend(task.flights) or fly_all(task))
    sweep("circle", ["wind.speed=2..5"], out=tmp_path, **ONE_PROCESS)
    file = tmp_path / "flights.jsonl"
    file.write_bytes(file.read_bytes()[:-20])
    assert sweep("circle", WIND, out=tmp_path, **ONE_PROCESS).equals(table)
    assert [dict(values)["wind.speed"] for _, values in flown] == [2, 3, 4, 5, 5, 6, 7]


def kill(task):
    """Kill the process that does a task, once, if the file of `KILLED` is not there."""
    once = Path(os.environ["KILLED"])
    if dict(task.flights[0][1])["wind.speed"] == 5 and not once.exists():
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return fly_all(task)


def kill_always(task):
    """Kill the process that does a task."""
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals of this kind")
def test_a_killed_process_costs_nothing(table, tmp_path, monkeypatch):
    monkeypatch.setenv("KILLED", str(tmp_path / "killed"))
    monkeypatch.setattr(executors, "sleep", lambda _: None)
    monkeypatch.setattr(module, "fly_all", kill)
    assert sweep("circle", WIND, processes=2, **SHORT).equals(table)
    assert (tmp_path / "killed").exists()
    monkeypatch.setattr(module, "fly_all", kill_always)
    with pytest.raises(WorkersLost, match="a process that did the work has ended"):
        sweep("circle", WIND, processes=2, **SHORT)


def interrupted():
    """Ctrl-C while a task runs that does not end; only its worker is told."""
    with executor_of(processes=1) as executor:
        worker = executor.submit(os.getpid).result()
        task = executor.submit(time.sleep, 3600.0)
        os.kill(worker, signal.SIGINT)
        task.result()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals of this kind")
def test_a_worker_that_ends_first(monkeypatch):
    """Ctrl-C goes to all processes of a terminal: this one is told while it waits because a worker has ended."""
    monkeypatch.setattr(executors, "sleep", lambda _: os.kill(os.getpid(), signal.SIGINT))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # also where the tests run in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            interrupted()
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(("count", "duration"), [(1, 1.0), (500, 0.5), (100_000, 60.0), (100, 80_000.0)])
def test_flights_go_in_tasks(count, duration):
    """Large enough that what is around them does not count, small enough that all processes have work to the end."""
    scene = replace(load("circle"), duration=duration)
    task = Task({}, Path(), "circle", Config("dynamic", 20, 1e-4, 0.02), Statistics(), ())
    flights = [(str(k), ()) for k in range(count)]
    tasks = tasks_of(task, scene, flights)
    assert [each for task in tasks for each in task.flights] == flights
    assert len(tasks) >= min(count, 25)
    assert max(len(each.flights) for each in tasks) <= (MOST_PER_TASK if duration < 1000.0 else 1)
    if count == 100_000:
        assert len(tasks) <= count / 10  # a flight of 60 s takes some 20 ms


def test_the_command_writes_tables_figures_and_a_page(tmp_path, capsys):
    asked = ["--outputs", "sag", "--percentiles", "90", "--set", "duration=0.6", "--segments", "4", "--processes", "1"]
    values = ["--vary", "tether.diameter=3 mm,4 mm,-1"]
    assert main(["sweep", "circle", *values, *asked, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert said.startswith("3 flights of 0.6 s, 1 of them refused\nlargest tension: ")
    written = pd.read_csv(tmp_path / "flights.csv")
    statistics = [*(f"sag_{each}" for each in ("max", "min", "mean", "rms", "p90")), "peak_tension", "cycles"]
    statistics += ["largest_cycle", "time_slack", "broken", "break_time"]
    assert list(written) == ["flight", "tether.diameter", *statistics, "refused"]
    figures = sorted(path.name for path in (tmp_path / "figures").iterdir())
    assert figures == ["response.png"]  # one value is varied: no surface
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "tether.diameter is -1" in report
    assert "figures/response.png" in report
    assert "tetherfmu fly circle --tether dynamic --step 0.02 --set segments=4 --set duration=0.6" in report
    cycles = pd.read_csv(tmp_path / "cycles.csv")
    assert cycles.groupby("flight").cycles.sum().to_dict() == pytest.approx({0: written.cycles[0], 1: written.cycles[1]})
    pytest.importorskip("pyarrow")
    stored = pd.read_parquet(tmp_path / "flights.parquet")
    assert stored.sag_max.tolist()[:2] == written.sag_max.tolist()[:2]


def test_the_example_of_the_manual_runs(capsys):
    exec(*codes(page("use/sweeps"), "python"), found := {})
    assert len(found["table"]) == 16
    assert "peak_tension" in capsys.readouterr().out


def test_what_is_hardly_meant_is_said_of_the_extremes(capsys, tmp_path):
    """Millimetres taken for metres; and a duration that is varied is not given as that of all flights."""
    options = ["--vary", "tether.diameter=0.004,4", "--vary", "duration=0.6,0.8", "--segments", "2", "--processes", "1"]
    assert main(["sweep", "circle", *options, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    assert said.err.count("tether.diameter is 4 m, more than 0.2 m; diameters are in m: 4 mm are 0.004") == 1
    assert said.out.startswith("4 flights, 0 of them refused\n")


def test_flights_that_break_their_tether_are_counted(tmp_path, capsys):
    """The circle pulls with some 50 N: 20 N break it, 200 N do not."""
    values = ["--vary", "tether.breaking_force=200,20", "--set", "duration=0.6", "--segments", "4", "--processes", "1"]
    assert main(["sweep", "circle", *values, "--out", str(tmp_path)]) == 0
    assert "2 flights of 0.6 s, 0 of them refused, 1 broke, as in flight 1\n" in capsys.readouterr().out
    held, broke = pd.read_csv(tmp_path / "flights.csv").break_time
    assert np.isnan(held)
    assert 0.0 <= broke <= 0.6


def test_a_doubt_is_said_once(tmp_path, capsys):
    values = ["--vary", "wind.speed=2,3", "--set", "tether.initial_length=250", "--set", "duration=0.6", "--processes", "1"]
    assert main(["sweep", "circle", *values, "--segments", "4", "--out", str(tmp_path)]) == 0
    (said,) = capsys.readouterr().err.splitlines()
    assert "the tether is 250 m long: stretched by 100 %, where any rope is broken; check tether.initial_length" in said
