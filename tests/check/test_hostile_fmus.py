"""FMUs that end, hold, or deceive the process that runs them: a line for each, and nothing runs on."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from check.test_check import changed
from tetherfmu.check import __main__, apart

LOOP = "while True: pass"
HOSTILE = {
    "ends with status 0": ("import os; os._exit(0)", "wrote no result: the FMU ended the process that ran it"),
    "ends with status 3": ("import os; os._exit(3)", "the run of the evidence set failed: exit code 3"),
    "kills itself": ("import os; os.kill(os.getpid(), 9)", "the process that ran the FMU died (exit code -9)"),
    "holds": (LOOP, "the run of the evidence set did not end within 1 s"),
    "fails": ("raise ValueError('of its own')", "the run of the evidence set failed: "),
    "says much": ("import sys, os; sys.stderr.write('a' * 10**8); os._exit(1)", "the run of the evidence set failed: "),
    "leaves a result": (
        "import sys, os; open(sys.argv[3], 'w').write('{}'); os._exit(0)",
        "the result of the evidence run cannot be read",
    ),
}


def with_slave(fmu_folder, target, line):
    """TetherStraight.fmu whose slave begins with a line of Python."""

    def change(name, content):
        is_launcher = name.startswith("resources/tether_straight_") and name.count("/") == 1
        return f"{line}\n".encode() + content if is_launcher else content

    return changed(fmu_folder / "TetherStraight.fmu", target, change)


def with_a_second(task, path, what):
    """`apart.apart` with one second for the FMU; FMPy's validation takes longer."""
    with pytest.MonkeyPatch.context() as limited:
        limited.setattr(apart, "LONGEST", 1 if task is apart.flown else apart.LONGEST)
        return apart.apart(task, path, what)


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_line_for_each_fmu_whatever_it_does(kind, fmu_folder, tmp_path, monkeypatch, capsys):
    line, words = HOSTILE[kind]
    hostile = with_slave(fmu_folder, tmp_path / "hostile.fmu", line)
    if line is LOOP:
        monkeypatch.setattr(__main__, "apart", with_a_second)
    (tmp_path / "next.fmu").write_text("no archive")
    assert __main__.main([str(hostile), str(tmp_path / "next.fmu")]) == 1
    said = capsys.readouterr()
    assert (said.out.count("PROBLEM"), said.out.count(words)) == (2, 1), said.out
    assert "not a readable zip archive" in said.out
    assert "Traceback" not in said.out + said.err
    assert said.out.endswith("2 problems found\n")
    assert len(said.out) < 10_000 + apart.LAST_CHARACTERS


@pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")
def test_nothing_runs_on_when_the_check_is_killed(fmu_folder, tmp_path):
    sign = tmp_path / "process"
    line = (
        f"import os, pathlib; pathlib.Path({str(sign)!r}).write_text(str(os.getpid())); {LOOP.removesuffix(': pass')}: pass"
    )
    hostile = with_slave(fmu_folder, tmp_path / "hostile.fmu", line.replace("; while", "\nwhile"))
    checking = subprocess.Popen([sys.executable, "-m", "tetherfmu.check", str(hostile)], stdout=subprocess.DEVNULL)
    while not (sign.exists() and sign.read_text()):
        assert checking.poll() is None
        time.sleep(0.05)
    checking.send_signal(signal.SIGKILL)
    checking.wait()
    status = Path(f"/proc/{sign.read_text()}/stat")
    for _ in range(200):
        if not status.exists() or ") Z " in status.read_text():
            return
        time.sleep(0.05)
    os.kill(int(sign.read_text()), signal.SIGKILL)
    pytest.fail("the process that ran the FMU runs on")
