"""Ctrl-C ends a command with one line and status 130, and all that the command has started with it."""

import gzip
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import pytest

from running import TIMEOUT, environment, points_in, wait_for
from study.scenes_of_tests import written
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import CODE
from tetherfmu.runtime.kernel_library import file_name, this_platform

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
# whole groups get the signal from a terminal; a tool such as an editor sends it to one process, which may have children
EACH_WAY = pytest.mark.parametrize("send", [os.kill, getattr(os, "killpg", None)], ids=["process", "group"])
LISTENING = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # also in the background
COMMAND = f"{LISTENING}import sys; from tetherfmu.__main__ import main; sys.exit(main(sys.argv[1:]))"
EXAMPLE = f"{LISTENING}import runpy; runpy.run_module({{!r}}, run_name='__main__')"
KEEPING = "import tempfile; tempfile.tempdir = {!r}\n"  # where FMUs are extracted
STABILITY = COMMAND.replace("tetherfmu.__main__", "make_stability")
COLD_BUILD = f"""{LISTENING}
import sys
from pathlib import Path
from tetherfmu.libraries import ready
import build_fmus
ready.cache_folder = lambda: Path(sys.argv[1])
sys.exit(build_fmus.main(["TetherStraight", "--out", sys.argv[2]]))
"""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="it reads which processes a Linux system has")


def stopped(send, code, *arguments, begun, wait=0.0, cwd):
    """What Python code said on stderr until Ctrl-C, sent when `begun()` is true; its status is 130, its group is gone."""
    process = subprocess.Popen(
        [sys.executable, "-c", code, *map(str, arguments)],
        env=environment(),
        start_new_session=True,
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        cwd=cwd,
    )
    try:
        wait_for(lambda: begun(process.pid), process)
        time.sleep(wait)
        send(process.pid, signal.SIGINT)
        said = process.communicate(timeout=TIMEOUT)[1]
        assert process.returncode == 130, said
        deadline = time.monotonic() + TIMEOUT
        while sessions(process.pid):  # a slow machine needs a moment until the last one is gone
            assert time.monotonic() < deadline, "a process of the command is left"
            time.sleep(0.01)
        return said.splitlines()
    finally:
        for number in sessions(process.pid):
            os.kill(number, signal.SIGKILL)


def sessions(leader):
    """Numbers of the processes in the session of a process, and the names of their commands."""
    found = {}
    for number in filter(str.isdecimal, os.listdir("/proc")):
        folder = Path("/proc", number)
        try:
            if os.getsid(int(number)) == leader and "\nState:\tZ" not in (folder / "status").read_text():
                found[int(number)] = (folder / "cmdline").read_text().replace("\0", " ")
        except (FileNotFoundError, ProcessLookupError):
            pass  # it has ended since
    return found


def runs(words):
    """Function of a process: whether one of its session has these words in its command."""
    return lambda leader: any(words in command for command in sessions(leader).values())


@EACH_WAY
@pytest.mark.parametrize("words", ["tetherfmu.libraries.ahead_of_time", "multiprocessing.spawn"])
def test_while_kernels_compile(tmp_path, send, words):
    """At its begin, and when what numba has written (before, which is quicker) is optimized in processes of their own."""
    cache = tmp_path / "cache"
    if words == "multiprocessing.spawn":
        written = ready.folders(["straight"], [this_platform()])["straight"] / CODE
        ready.place(cache, "straight").mkdir(parents=True)
        shutil.copy(written, ready.place(cache, "straight"))
    head, last = stopped(send, COLD_BUILD, cache, tmp_path / "dist", begun=runs(words), cwd=tmp_path)
    assert head.startswith("compiling kernels for ")
    assert last == "stopped"
    # what is finished and lets the next build go on may stay, and is whole
    left = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert all(path.name.endswith(".ll.gz") for path in left)
    assert all(gzip.decompress(path.read_bytes()) for path in left)


def test_while_an_fmu_flies(tmp_path, fmu_folder):
    """Again and again: the signal comes anywhere in a step, most of which is inside the FMU."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    code = KEEPING.format(str(temporary)) + COMMAND
    flight = ("fly", "--fmu", fmu_folder / "TetherDynamic.fmu", "--duration", 10_000)
    extracted = lambda _: any(temporary.rglob("*.so"))  # noqa: E731
    for delay in (0.1, 0.31, 0.32):
        assert stopped(os.kill, code, *flight, begun=extracted, wait=delay, cwd=tmp_path) == ["stopped"]
        assert not list(temporary.iterdir())


def test_while_an_example_runs(dist):
    loaded = lambda leader: "TetherDynamic" in Path(f"/proc/{leader}/maps").read_text()  # noqa: E731
    code = EXAMPLE.format("at_rest.forces_over_wind_and_slack")
    assert stopped(os.kill, code, begun=loaded, cwd=dist.parent) == ["stopped"]


def test_while_a_system_of_fmus_flies(tmp_path, dist):
    """Four FMUs in one process; their folders are gone afterwards."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    code = KEEPING.format(str(temporary)) + EXAMPLE.format("power_system.pumping_cycle")
    loaded = lambda _: len(list(temporary.rglob("*.so"))) > 4  # noqa: E731 (the tether has its kernels, too)
    assert stopped(os.kill, code, "--cycles", 1000, begun=loaded, wait=0.5, cwd=dist.parent) == ["stopped"]
    assert not list(temporary.iterdir())


def test_while_lessons_run(tmp_path):
    begun = lambda _: (tmp_path / "tether_01.png").exists()  # noqa: E731
    assert stopped(os.kill, COMMAND, "tutorial", "all", "--out", tmp_path, begun=begun, cwd=tmp_path) == ["stopped"]


@EACH_WAY
def test_while_an_evidence_set_runs(tmp_path, fmu_folder, send):
    begun = runs("tetherfmu.check.apart flown")
    assert stopped(send, COMMAND, "check", fmu_folder / "TetherDynamic.fmu", begun=begun, cwd=tmp_path) == ["stopped"]


@pytest.mark.parametrize("command", ["stability map", "trade-off"])
def test_finished_points_are_kept(tmp_path, command):
    points = tmp_path / "points.jsonl"
    stability = (STABILITY, "--quick", "--results", points, "--processes", 2)
    call = stability if command == "stability map" else (COMMAND, "tradeoff", written(tmp_path))
    begun = lambda _: points_in(points) > 1  # noqa: E731
    said = stopped(os.killpg, *call, "--out", tmp_path, begun=begun, cwd=tmp_path)
    assert said == ["stopped; the finished points are kept, and the same command continues from them"]


def test_while_the_advisor_flies(tmp_path):
    """A flight of 1000 s, from the moment when the advisor has loaded a tether."""
    scene = tmp_path / "circle.toml"
    text = (EXAMPLES / "scenes" / "circle.toml").read_text(encoding="utf-8")
    scene.write_text(text.replace('duration = "20 s"', 'duration = "1000 s"'), encoding="utf-8")
    loaded = lambda leader: f"/{file_name('dynamic', this_platform())}" in Path(f"/proc/{leader}/maps").read_text()  # noqa: E731
    assert stopped(os.killpg, COMMAND, "advise", scene, begun=loaded, cwd=tmp_path) == ["stopped"]


def test_a_lock_that_is_interrupted_is_no_failure(capsys):
    """Python then says that a lock is released that nobody holds; with points that are kept, too."""
    from tetherfmu.console.ending import command
    from tetherfmu.study.measuring.store import KEPT, keeping

    def interrupted(kept):
        with keeping() if kept else nullcontext():
            try:
                raise KeyboardInterrupt
            finally:
                raise RuntimeError("release unlocked lock")

    assert [command(interrupted)(kept) for kept in (False, True)] == [130, 130]
    assert capsys.readouterr().err.splitlines() == ["stopped", f"stopped; {KEPT}"]
