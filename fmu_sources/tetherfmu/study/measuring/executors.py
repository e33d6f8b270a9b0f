"""Work in parallel, through any executor of concurrent.futures: processes of this machine, or a Dask cluster."""

import os
import signal
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import parent_process
from threading import Thread
from time import sleep

from tqdm import tqdm

from tetherfmu.console.ending import WorkersLost


def progress_bar(iterable, total, text):
    """The iterable, of this length, with a bar that shows how far it is; None: a bar to update. Silent if nobody sees it."""
    return tqdm(iterable, total=total, desc=text, disable=None, leave=False)


def begin():
    """Begin a process that does work: it ends silently at Ctrl-C, and when the process that it works for is killed."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=end_with, args=(parent_process(),), daemon=True).start()


def end_with(parent):
    """End this process when another one has ended."""
    parent.join()
    os._exit(1)


@contextmanager
def executor_of(dask=None, processes=None):
    """An executor: of the Dask scheduler at an address, or processes of this machine (None: one per core).

    On exit, pending tasks are cancelled. `WorkersLost` if the workers are gone.
    """
    if dask is not None:
        from .cluster import cluster  # distributed belongs to another extra

        with cluster(dask) as executor:
            yield executor
        return
    executor = ProcessPoolExecutor(processes, initializer=begin)
    try:
        yield executor
    except BrokenProcessPool:
        sleep(1.0)  # after Ctrl-C the processes may end before this one hears of it
        raise WorkersLost("a process that did the work has ended, perhaps for lack of memory") from None
    finally:
        executor.shutdown(cancel_futures=True)
