"""A Dask cluster as an executor of concurrent.futures, with a one-line error if it is lost."""

import asyncio
import logging
import threading
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress

from distributed import Client, KilledWorker
from distributed.comm import CommClosedError

from tetherfmu.console.ending import WorkersLost

PATIENCE = 30.0  # without any worker, and for a scheduler that does not answer [s]
LOOKED_AFTER = 1.0  # how often the workers are counted [s]
LOST = (CancelledError, asyncio.CancelledError, CommClosedError)  # raised by versions of distributed without a scheduler


def look_after(client, executor, closed):
    """Cancel all tasks when the cluster has been without workers for too long: the scheduler would wait forever."""
    without = 0.0
    while not closed.wait(LOOKED_AFTER):
        count = 1
        with suppress(Exception):  # the scheduler may be lost, which its tasks notice
            count = len(client.nthreads())
        without = without + LOOKED_AFTER if client.futures and not count else 0.0
        if without >= PATIENCE:
            executor.without_workers = True
            executor.shutdown(wait=False)
            return


@contextmanager
def cluster(address):
    """The executor of the Dask scheduler at an address; `WorkersLost` when no worker is left.

    It suppresses logging: relevant errors are raised.
    """
    before, closed = logging.root.manager.disable, threading.Event()
    logging.disable(logging.CRITICAL)
    try:
        try:
            client = Client(address, timeout=PATIENCE, set_as_default=False)
        except OSError:
            raise WorkersLost(f"no Dask scheduler answers at {address} (`dask scheduler` starts one)") from None
        executor = client.get_executor(pure=False)
        executor.without_workers = False
        threading.Thread(target=look_after, args=(client, executor, closed), daemon=True).start()
        try:
            yield executor
        except KilledWorker:
            raise WorkersLost("the Dask cluster has lost one worker after another at the same task") from None
        except LOST:
            words = f"has had no worker for {PATIENCE:g} s" if executor.without_workers else "is lost"
            raise WorkersLost(f"the Dask scheduler at {address} {words}") from None
        finally:
            closed.set()
            with suppress(TimeoutError):  # of many tasks without a scheduler
                client.close(timeout=LOOKED_AFTER)
    finally:
        logging.disable(before)
