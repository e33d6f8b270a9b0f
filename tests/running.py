"""Run commands in this process, examples and the code of pages in processes of their own, and look at what they draw."""

import atexit
import json
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from coarse_figures import PART
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.libraries.examples import EXAMPLES

TIMEOUT = 900.0  # seconds, for what hangs


def status_of(*arguments, main=tetherfmu):
    """Exit status of `tetherfmu`, or of another command, with these arguments, also where its parser ends the program."""
    try:
        return main([*arguments])
    except SystemExit as end:
        return end.code


def environment():
    """That of Python with the rooms of the examples, which opens no window."""
    places = dict.fromkeys([str(EXAMPLES), *sys.path])
    return {**os.environ, "PYTHONPATH": os.pathsep.join(places), "MPLBACKEND": "Agg"}


def wait_for(condition, process):
    """Wait until it is so, as long as a process runs."""
    deadline = time.monotonic() + TIMEOUT
    while not condition():
        assert time.monotonic() < deadline
        assert process.poll() is None, process.stderr and process.stderr.read()
        time.sleep(0.01)


def points_in(file):
    """Number of points that a study has finished."""
    return file.read_bytes().count(b"\n") if file.exists() else 0


def new_python(*arguments, cwd=None):
    """Start Python with the rooms of the examples, in a folder; the finished process."""
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
        timeout=TIMEOUT,
        cwd=cwd,
    )


def run_python(*arguments, cwd=None):
    """As `new_python` with a script, or with `-m` and a module; forked where the system can do so, see `run_code`."""
    if not hasattr(os, "fork"):
        return new_python(*arguments, cwd=cwd)
    first, *given = map(str, arguments)
    if first == "-m":
        module, *given = given
        return run_code(f"import runpy; runpy.run_module({module!r}, run_name='__main__', alter_sys=True)", *given, cwd=cwd)
    place = f"sys.argv[0], sys.path[0] = {first!r}, {str(Path(first).parent)!r}"
    return run_code(f"import runpy, sys; {place}; runpy.run_path({first!r}, run_name='__main__')", *given, cwd=cwd)


def run_code(code, *arguments, cwd=None):
    """As `new_python` with `-c`; where the system can fork, the process is forked from one that has imported packages."""
    if not hasattr(os, "fork"):
        return new_python("-c", code, *arguments, cwd=cwd)
    with tempfile.TemporaryDirectory() as folder:
        printed, errors = Path(folder, "printed"), Path(folder, "errors")
        request = {
            "code": code,
            "arguments": [*map(str, arguments)],
            "folder": str(cwd or Path.cwd()),
            "printed": str(printed),
            "errors": str(errors),
        }
        status = answer(json.dumps(request))
        said = (path.read_text(encoding="utf-8") for path in (printed, errors))
        return subprocess.CompletedProcess(["-c", *request["arguments"]], status, *said)


def run_without(package, module, *arguments, cwd=None):
    """The finished process of `main` of a module with these arguments, where a package is not installed."""
    parts = f"[each for each in sys.modules if each.startswith('{package}.')]"  # what is imported already
    hidden = f"import sys; sys.modules.update(dict.fromkeys([{package!r}, *{parts}]))"
    return run_code(f"{hidden}; import {module}; sys.exit({module}.main(sys.argv[1:]))", *arguments, cwd=cwd)


def answer(request):
    """Exit status of the process that is forked for a request, see `forking`."""
    server = forking()
    server.stdin.write(f"{request}\n")
    server.stdin.flush()
    if not select.select([server.stdout], [], [], TIMEOUT)[0]:
        os.killpg(server.pid, signal.SIGKILL)
        forking.cache_clear()
        raise subprocess.TimeoutExpired(request, TIMEOUT)
    return int(server.stdout.readline())


@cache
def forking():
    """The process of `forking`, which lives until the tests end."""
    server = subprocess.Popen(
        [sys.executable, Path(__file__).with_name("forking.py")],
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    atexit.register(server.communicate)  # it ends when nothing more can be asked
    return server


def run(fmu_folder, code):
    """What Python code prints that finds the FMUs of this test run; it must end cleanly."""
    find = f"fmu_tools.find_fmu = lambda name: {str(fmu_folder)!r} + f'/{{name}}.fmu'"
    done = run_code(f"from shared import fmu_tools\n{find}\nfrom first_flight import circular_flight\n{code}")
    assert done.returncode == 0, done.stderr
    return done.stdout


def assert_is_drawn(file):
    colors = plt.imread(file)[:, :, :3]
    assert np.count_nonzero(np.ptp(colors, axis=-1) > 0.2) > 1000 * PART**2  # coloured pixels; empty axes have none
