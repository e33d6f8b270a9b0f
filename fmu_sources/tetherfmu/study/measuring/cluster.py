"""A Dask cluster as an executor of concurrent.futures, which says in one line that it is lost."""

import asyncio
import logging
import threading
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager, suppress
from functools import partial

from distributed import Client, KilledWorker
from distributed.comm import CommClosedError

from tetherfmu.console.ending import WorkersLost

PATIENCE = 30.0  # without any worker, and for a scheduler that does not answer [s]
LOOKED_AFTER = 1.0  # how often the workers are counted [s]
LOST = (CancelledError, asyncio.CancelledError, CommClosedError)  # what versions of distributed raise without a scheduler


class Cluster(Executor):
    """Gives the tasks to a client of distributed. Its futures fail with `WorkersLost` when nobody is left to do them."""

    def __init__(self, client, address):
        self._client, self._address = client, address
        self._tasks, self._closed = {}, threading.Event()  # future of the client by the one that was given away
        threading.Thread(target=self._look_after, daemon=True).start()

    def submit(self, function, /, *arguments, **named):
        """A future of concurrent.futures."""
        promised = Future()
        self._tasks[promised] = task = self._client.submit(function, *arguments, **named, pure=False)
        task.add_done_callback(partial(self._done, promised))
        return promised

    def shutdown(self, wait=True, *, cancel_futures=False):
        """Look after the workers no more; the client cancels what is not done when it closes."""
        self._closed.set()

    def _done(self, promised, task):
        """Pass on what came of a task; runs in a thread of distributed."""
        if self._closed.is_set():
            return
        try:
            result = task.result()
        except LOST:
            self._fail(promised, WorkersLost(f"the Dask scheduler at {self._address} is lost"))
        except KilledWorker:
            self._fail(promised, WorkersLost("the Dask cluster has lost one worker after another at the same task"))
        except BaseException as error:
            self._fail(promised, error)
        else:
            self._tasks.pop(promised, None)
            promised.set_result(result)

    def _fail(self, promised, error):
        if self._tasks.pop(promised, None) is not None:
            promised.set_exception(error)

    def _look_after(self):
        """Fail all tasks when the cluster has been without workers for too long: the scheduler would wait for ever."""
        without = 0.0
        while not self._closed.wait(LOOKED_AFTER):
            count = 1
            with suppress(Exception):  # the scheduler may be lost, which its tasks notice
                count = len(self._client.nthreads())
            without = without + LOOKED_AFTER if self._tasks and not count else 0.0
            if without >= PATIENCE:
                words = f"the Dask scheduler at {self._address} has had no worker for {PATIENCE:g} s"
                for promised in list(self._tasks):
                    self._fail(promised, WorkersLost(words))


@contextmanager
def cluster(address):
    """`Cluster` of the Dask scheduler at an address; while it is in use, nothing is logged: what counts is raised."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        try:
            client = Client(address, timeout=PATIENCE, set_as_default=False)
        except OSError:
            raise WorkersLost(f"no Dask scheduler answers at {address} (`dask scheduler` starts one)") from None
        executor = Cluster(client, address)
        try:
            yield executor
        finally:
            executor.shutdown()
            with suppress(TimeoutError):  # of many tasks without a scheduler
                client.close(timeout=LOOKED_AFTER)
    finally:
        logging.disable(before)
