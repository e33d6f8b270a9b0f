"""A Dask cluster gives the same verdicts; a study that loses it, or is stopped, says so in one line and keeps its points."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest
from pebble import ProcessExpired

import make_stability
from running import TIMEOUT, environment, points_in, wait_for
from stability.flight import judge_all
from stability.isolated import isolated
from stability.points import point
from study.scenes_of_tests import written
from tetherfmu.__main__ import main
from tetherfmu.console.ending import WorkersLost
from tetherfmu.files.scene_files import load
from tetherfmu.study import sweep
from tetherfmu.study.advice.configurations import study
from tetherfmu.study.measuring import cluster as connection
from tetherfmu.study.measuring.executors import executor_of
from tetherfmu.study.measuring.runs import Config
from tetherfmu.study.measuring.store import Store
from tetherfmu.study.sweeps import sweep as sweeps
from tetherfmu.study.sweeps.statistics import fly_all

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals of this kind")
FEW = [Config("straight", 0, 0.0, 0.02), Config("quasi_steady", 4, 0.0, 0.02), Config("dynamic", 8, 1e-3, 0.02)]
KEPT = "the finished points are kept, and the same command continues from them"
PATIENCE = 2.0  # seconds, of a command whose worker is killed; a worker that is slow to start must not cost it
RUN = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # also in the background
from tetherfmu.__main__ import main
sys.exit(main(sys.argv[1:]))
"""


@contextmanager
def started(folder, *options):
    """Address of a scheduler, its process and that of its only worker."""
    file = folder / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment(), "cwd": folder}
    run = [sys.executable, "-m"]
    where = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)]
    scheduler = subprocess.Popen([*run, "distributed.cli.dask_scheduler", *where], **quiet)
    wait_for(file.exists, scheduler)
    wait_for(lambda: file.read_text(encoding="utf-8").endswith("}"), scheduler)
    address = json.loads(file.read_text(encoding="utf-8"))["address"]
    how = ["--nworkers", "1", "--nthreads", "1", "--no-dashboard", *options]
    worker = subprocess.Popen([*run, "distributed.cli.dask_worker", address, *how], **quiet)
    try:
        with distributed.Client(address, timeout=TIMEOUT, set_as_default=False) as client:
            client.wait_for_workers(1, TIMEOUT)
        yield address, scheduler, worker
    finally:
        for process in (worker, scheduler):
            process.terminate()
            process.wait(TIMEOUT)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Address of a cluster that nothing befalls; its worker has a nanny, as `dask worker` starts it."""
    with started(tmp_path_factory.mktemp("cluster")) as (address, *_):
        yield address


def has_points(folder):
    """Whether three points are finished there."""
    return points_in(folder / "points.jsonl") >= 3


def test_one_line_says_that_it_is_stopped_and_that_points_are_kept(tmp_path, cluster):
    call = [sys.executable, "-c", RUN, "tradeoff", str(written(tmp_path)), "--out", str(tmp_path), "--dask", cluster]
    process = subprocess.Popen(call, env=environment(), stderr=subprocess.PIPE, text=True, start_new_session=True)
    wait_for(lambda: has_points(tmp_path), process)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=TIMEOUT)[1]
    assert (process.returncode, said) == (130, f"stopped; {KEPT}\n")


@pytest.mark.parametrize(
    ("lost", "words", "command"),
    [
        ("scheduler", "the Dask scheduler at {} is lost", "tradeoff"),
        ("worker", "the Dask scheduler at {} has had no worker for 2 s", "stability map"),
    ],
)
def test_one_line_says_what_is_lost_and_that_points_are_kept(tmp_path, monkeypatch, capsys, lost, words, command):
    monkeypatch.setattr(connection, "PATIENCE", PATIENCE if lost == "worker" else TIMEOUT)
    stability = (make_stability.main, "--points", "1000", "--results", str(tmp_path / "points.jsonl"))
    run, *given = (main, "tradeoff", str(written(tmp_path))) if command == "tradeoff" else stability
    with started(tmp_path, "--no-nanny") as (address, scheduler, worker), ThreadPoolExecutor(1) as beside:
        killed = beside.submit(kill_after_points, tmp_path, {"scheduler": scheduler, "worker": worker}[lost])
        assert run([*given, "--out", str(tmp_path), "--dask", address]) == 1
        killed.result(TIMEOUT)
    assert capsys.readouterr().err == f"{words.format(address)}; {KEPT}\n"


def kill_after_points(folder, process):
    wait_for(lambda: has_points(folder), process)
    process.kill()


def end(status):
    os._exit(status)


def test_a_crash_and_a_hang_on_a_worker_cost_one_point(cluster):
    """Also on a worker with a nanny, which may have no children otherwise."""
    with isolated(cluster) as begun:
        calls = [(abs, -1, 60.0), (end, 3, 60.0), (time.sleep, 3600.0, 1.0), (abs, -2, 60.0)]
        futures = [begun(*call) for call in calls]
        found = [future.exception(TIMEOUT) for future in futures]
        assert [type(each) for each in found] == [type(None), ProcessExpired, TimeoutError, type(None)]
        assert (futures[0].result(), futures[3].result()) == (1, 2)


def test_a_cluster_gives_the_same_map(tmp_path, cluster):
    points = [point(1, number) for number in range(12)]
    here = judge_all(points, tmp_path / "here.jsonl", 1)
    there = judge_all(points, tmp_path / "there.jsonl", dask=cluster)
    assert here.drop(columns="longest").equals(there.drop(columns="longest"))


def killing(task):
    """Kill the worker that does a task, once, if the file of the task is not there."""
    once = task.folder / "killed"
    if not once.exists():
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return fly_all(task)


def test_a_cluster_gives_the_same_sweep_when_its_worker_is_killed(tmp_path, cluster, monkeypatch):
    given = {"vary": ["wind.speed=5..7"], "segments": 4}
    here = sweep(written(tmp_path), **given, processes=1)
    monkeypatch.setattr(sweeps, "fly_all", killing)
    with distributed.Client(cluster, timeout=TIMEOUT, set_as_default=False) as client:
        there = sweep(written(tmp_path), **given, executor=client)
    assert (tmp_path / "killed").exists()
    assert there.equals(here)
    assert there.attrs == here.attrs


def test_a_cluster_gives_the_same_trade_off(tmp_path, cluster):
    scene, found = load(written(tmp_path)), []
    for address in (None, cluster):
        with executor_of(address, processes=1) as executor:
            _, points = study(scene, Store(tmp_path / f"{address is None}.jsonl"), executor, FEW, 1)
        found.append(points.errors.tolist())
    assert found[0] == found[1]


def test_no_scheduler_is_said_in_words(monkeypatch):
    monkeypatch.setattr(connection, "PATIENCE", 0.5)
    with (
        pytest.raises(WorkersLost, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:1 "),
        executor_of("tcp://127.0.0.1:1"),
    ):
        pass
