"""Run FMPy and an FMU in a separate process, which may exit, crash or hang: `python -m tetherfmu.check.apart`.

The process ends with its parent, and after `LONGEST` seconds; its result is a file of JSON, or nothing.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from pathlib import Path

from tetherfmu.libraries.children import child

from . import inspection
from .evidence_runs import evidence_of, replay
from .soundness import PROBLEM, Finding

LONGEST = 300  # seconds, of the clock and of the processor; a tether takes one or two
LARGEST_FILE = 1_000_000_000  # bytes of a file that it writes
LAST_CHARACTERS, LAST_LINES = 10_000, 5  # of the output of a failed process
NOT_LOADED = "Failed to load shared library"  # FMPy's message
TRAPS = "see `Traps for hosts` in docs/reference/fmi.md of TetherFMU"


def flown(path):
    """Results of the evidence sets of an FMU by kind, and the units of its variables by name."""
    return {kind: replay(path, each) for kind, each in evidence_of(path).items()}, inspection.units(path)


TASKS = {each.__name__: each for each in (inspection.description, flown)}


def apart(task, path, what):
    """The value of a task for an FMU in a separate process: (value, None), or (None, Finding) if there is none.

    task : of `TASKS`.  what : its description in a sentence.
    """
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile("w+", errors="replace") as said:
        result = Path(folder) / "result.json"
        command = [sys.executable, "-m", __name__, task.__name__, str(path), str(result)]
        try:
            with child(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said) as process:
                process.wait(LONGEST)
        except subprocess.TimeoutExpired:
            return None, Finding(PROBLEM, f"{what} did not end within {LONGEST} s", TRAPS)
        finally:
            _end_group(process)
        text = last_lines(said)
        with suppress(OSError, ValueError):
            if process.returncode == 0:
                return json.loads(result.read_text(encoding="utf-8")), None
    return None, failure(what, process.returncode, text)


def failure(what, status, said):
    """`Finding` on a process without a result; status : its exit code.  said : its last lines."""
    if status == 0:
        return Finding(PROBLEM, f"{what} wrote no result: the FMU ended the process that ran it", TRAPS)
    if status < 0 or status > 255:
        text = f"the process that ran the FMU died (exit code {status}); its last output: {said or 'nothing'}"
        return Finding(PROBLEM, text, TRAPS)
    remedy = "use an FMU for this processor and system" if NOT_LOADED in said else ""
    return Finding(PROBLEM, f"{what} failed: {said or f'exit code {status}'}", remedy)


def last_lines(file):
    """The last lines of a text file as one line; of a traceback the error alone."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(0, size - LAST_CHARACTERS))
    lines = file.read().strip().splitlines()
    traced = [k for k, line in enumerate(lines) if line.startswith("Traceback (most recent call last)")]
    if traced:
        after = [line for line in lines[traced[-1] + 1 :] if not line.startswith(" ")]
        lines = lines[: traced[0]] + after[:1]
    return " | ".join(lines[-LAST_LINES:])


def _end_group(process):
    """End the remaining children of a finished process."""
    if os.name != "nt":
        with suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)


def _end_with_parent():
    """End this process as soon as its input is closed, which happens when the process that has started it ends."""
    sys.stdin.read()
    os._exit(1)


def _limit():
    """Limit the time on the processor and the files of this process, where the system can."""
    with suppress(ImportError):
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 1))
        resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))


if __name__ == "__main__":
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _limit()
    task, fmu, target = sys.argv[1:]
    Path(target).write_text(json.dumps(TASKS[task](fmu)), encoding="utf-8")
