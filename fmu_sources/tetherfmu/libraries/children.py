"""Processes that end with the one that started them."""

import os
import signal
import subprocess
from contextlib import contextmanager, suppress

GRACE = 3.0  # seconds that they get to tidy up


@contextmanager
def child(command, **options):
    """`subprocess.Popen` of a command, without input; if an exception leaves the block, it ends with all that it started.

    Ctrl-C is such an exception. It does not reach the child, which has a group of its own, but by this process.
    """
    group = {} if os.name == "nt" else {"process_group": 0}
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, text=True, errors="replace", **group, **options) as process:
        try:
            yield process
        except BaseException:
            _end(process)
            raise


def _end(process):
    """Interrupt a process and its children; what does not end by that is killed."""
    if os.name == "nt":  # Ctrl-C has reached all
        process.kill()
        return
    for number in (signal.SIGINT, signal.SIGKILL):
        with suppress(ProcessLookupError, subprocess.TimeoutExpired):
            os.killpg(process.pid, number)
            process.wait(GRACE)


def finished(command, timeout=None, **options):
    """A finished child, as `subprocess.run` gives it with its output captured."""
    with child(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options) as process:
        output, errors = process.communicate(timeout=timeout)
    return subprocess.CompletedProcess(command, process.returncode, output, errors)
