"""Ctrl-C goes to all processes of a terminal: it counts as Ctrl-C also where a worker is the first to end."""

import os
import signal
import sys
import time

import pytest

from tetherfmu.study.measuring import executors
from tetherfmu.study.measuring.executors import executor_of


def interrupted():
    """Ctrl-C while a task runs that does not end; only its worker is told."""
    with executor_of(processes=1) as executor:
        worker = executor.submit(os.getpid).result()
        task = executor.submit(time.sleep, 3600.0)
        os.kill(worker, signal.SIGINT)
        task.result()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals of this kind")
def test_a_worker_that_ends_first(monkeypatch):
    """This process is told while it waits because a worker has ended."""
    monkeypatch.setattr(executors, "sleep", lambda _: os.kill(os.getpid(), signal.SIGINT))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # also where the tests run in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            interrupted()
    finally:
        signal.signal(signal.SIGINT, before)
