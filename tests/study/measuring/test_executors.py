"""Ctrl-C goes to all processes of a terminal: it counts as Ctrl-C also where a worker is the first to end."""

import os
import signal
import sys
import threading
import time

import pytest

from tetherfmu.study.measuring.executors import executor_of


def interrupted():
    """Ctrl-C while a task runs; its worker is told 0.3 s before this process is."""
    with executor_of(processes=1) as executor:
        worker = executor.submit(os.getpid).result()
        task = executor.submit(time.sleep, 60.0)
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        os.kill(worker, signal.SIGINT)
        task.result()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals of this kind")
def test_a_worker_that_ends_first():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # also where the tests run in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            interrupted()
    finally:
        signal.signal(signal.SIGINT, before)
