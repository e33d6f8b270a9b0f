"""Ctrl-C: processes that end with the one that started them, and code that it must not break into."""

import os
import signal
import subprocess
import threading
from contextlib import contextmanager, suppress

GRACE = 3.0  # seconds that they get to tidy up


@contextmanager
def ctrl_c_waits():
    """Within the block, only the function that it receives raises Ctrl-C.

    For code that must not be interrupted anywhere, such as an FMU in this process: its library would treat the exception as
    one of its own, report it, and refuse the step.
    If Ctrl-C raises nothing, or outside the main thread, nothing changes.
    """
    pressed = []

    def stop_if_pressed():
        if pressed:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler or threading.current_thread() is not threading.main_thread():
        yield stop_if_pressed
        return
    signal.signal(signal.SIGINT, lambda *_: pressed.append(True))
    try:
        yield stop_if_pressed
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def child(command, **options):
    """`subprocess.Popen` of a command; if an exception leaves the block, it ends with all its children.

    It has no input unless the options specify one.
    Ctrl-C is such an exception. The child has a separate group, so it receives Ctrl-C only through this process.
    """
    group = {} if os.name == "nt" else {"process_group": 0}
    with ctrl_c_waits() as stop_if_pressed:
        given = {"stdin": subprocess.DEVNULL, "text": True, "errors": "replace"} | group | options
        process = subprocess.Popen(command, **given)
    with process:
        try:
            stop_if_pressed()
            yield process
        except BaseException:
            _end(process)
            raise


def _end(process):
    """Interrupt a process and its children, then kill the survivors."""
    if os.name == "nt":  # Ctrl-C has reached all
        process.kill()
        return
    for number in (signal.SIGINT, signal.SIGKILL):
        with suppress(OSError, subprocess.TimeoutExpired):
            os.killpg(process.pid, number)
            process.wait(GRACE)
