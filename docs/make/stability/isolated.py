"""Work in parallel that may crash or hang: each call in a process that may be ended, here or on a worker of a cluster."""

import multiprocessing
import os
import threading
from contextlib import contextmanager

from pebble import ProcessPool

from tetherfmu.study.measuring.executors import executor_of

OF_THREAD = threading.local()  # `alone` of a worker of a cluster: its pool of one process


@contextmanager
def isolated(dask=None, processes=None):
    """Function of (function, argument, seconds) that gives a future: each call may crash or hang, the others go on.

    The future has what the function of the argument returns, or TimeoutError after so many seconds, or
    `pebble.ProcessExpired`.
    Calls that are at work when the block is left are ended, on a cluster by their time.

    dask, processes : see `executor_of`.
    """
    if dask is not None:
        with executor_of(dask) as executor:
            yield lambda *call: executor.submit(alone, *call)
        return
    pool = _pool(processes or os.cpu_count())
    try:
        yield lambda function, argument, seconds: pool.schedule(function, (argument,), timeout=seconds)
    finally:
        pool.stop()
        pool.join()


def alone(function, argument, seconds):
    """What a function of an argument returns, called in a process that may crash or hang in the place of this one."""
    if not hasattr(OF_THREAD, "pool"):
        multiprocessing.current_process().daemon = False  # the worker of a nanny is one, and may then start no process
        OF_THREAD.pool = _pool(1)
    return OF_THREAD.pool.schedule(function, (argument,), timeout=seconds).result()


def _pool(processes):
    return ProcessPool(processes, context=multiprocessing.get_context("spawn"))
