"""Work in parallel, through any executor of concurrent.futures: processes of this machine, or a Dask cluster."""

import multiprocessing
import os
import signal
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from time import sleep

from pebble import ProcessPool
from tqdm import tqdm

from tetherfmu.console.ending import WorkersLost

OF_THREAD = threading.local()  # `alone` of a worker of a cluster: its pool of one process


def progress_bar(iterable, total, text):
    """The iterable, of this length, with a bar that shows how far it is; silent where nobody sees it."""
    return tqdm(iterable, total=total, desc=text, disable=None, leave=False)


@contextmanager
def executor_of(dask=None, processes=None, **more):
    """An executor: that of the Dask scheduler at an address, or processes of this machine (None: one per core).

    Tasks that are not begun when it is left are cancelled. `WorkersLost` if what does the work is gone.

    more : options of `ProcessPoolExecutor`.
    """
    if dask is not None:
        from .cluster import cluster  # distributed belongs to another extra

        with cluster(dask) as executor:
            yield executor
        return
    silently = signal.SIGINT, signal.SIG_DFL  # Ctrl-C ends a process without a traceback
    executor = ProcessPoolExecutor(processes, initializer=signal.signal, initargs=silently, **more)
    try:
        yield executor
    except BrokenProcessPool:
        sleep(1.0)  # after Ctrl-C the processes may end before this one hears of it
        raise WorkersLost("a process that did the work has ended, perhaps for lack of memory") from None
    finally:
        executor.shutdown(cancel_futures=True)


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
