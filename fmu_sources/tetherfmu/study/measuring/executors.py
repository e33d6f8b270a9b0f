"""Work in parallel, through any executor of concurrent.futures: processes of this machine, or a Dask cluster."""

import signal
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from time import sleep

from tqdm import tqdm


def progress_bar(iterable, total, text):
    """The iterable, of this length, with a bar that shows how far it is; silent where nobody sees it."""
    return tqdm(iterable, total=total, desc=text, disable=None, leave=False)


def finished(executor, tasks, text):
    """Results of tasks (function, arguments...), as they finish; those not begun are cancelled if the loop is left."""
    futures = [executor.submit(*task) for task in tasks]
    try:
        yield from (future.result() for future in progress_bar(as_completed(futures), len(futures), text))
    finally:
        for future in futures:
            future.cancel()


@contextmanager
def executor_of(dask=None, processes=None, **more):
    """An executor: that of the Dask scheduler at an address, or processes of this machine (None: one per core).

    more : options of `ProcessPoolExecutor`.
    """
    if dask is None:
        silently = signal.SIGINT, signal.SIG_DFL  # Ctrl-C ends a process without a traceback
        executor = ProcessPoolExecutor(processes, initializer=signal.signal, initargs=silently, **more)
        try:
            yield executor
        except BrokenProcessPool:
            sleep(1.0)  # after Ctrl-C the processes may end before this one hears of it
            raise
        finally:
            executor.shutdown(cancel_futures=True)
        return
    from distributed import Client

    with Client(dask) as client, client.get_executor() as executor:
        yield executor
