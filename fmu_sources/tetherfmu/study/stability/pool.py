"""Judge many points in parallel, keep each verdict in a file at once, and survive what a point may do to its process."""

import multiprocessing
import os
from concurrent.futures import as_completed

import pandas as pd
from pebble import ProcessExpired, ProcessPool

from tetherfmu.study.measuring.executors import progress_bar
from tetherfmu.study.measuring.store import Store, key

from .flight import Verdict, judge
from .points import MapPoint

COLUMNS = MapPoint._fields + Verdict._fields
ENDED = {TimeoutError: "hanging", ProcessExpired: "crashed"}  # the verdict on a point that ended its process so
MOST_SECONDS = 120.0  # for one point with its refinement: 90 calls; beyond it the process is ended


def table(lines):
    """Lines of a file as a DataFrame: a row for each point, columns of `MapPoint` and `Verdict`."""
    return pd.DataFrame(list(lines), columns=COLUMNS).astype({"error": float})


def read(path):
    """Table of the results in a file; empty where there is no file, without lines of another form."""
    return table(line for line in Store(path).points.values() if line.keys() == set(COLUMNS))


def judge_all(points, path, processes=None, judgement=judge, most_seconds=MOST_SECONDS, progress=progress_bar):
    """Judge the points that the file at `path` does not have yet, and append them; returns the table of all, in order.

    processes : how many work at a time; None: one per core.  judgement : function of a point, which gets `most_seconds` [s].
    progress : as `progress_bar`.
    """
    store, names = Store(path), [key(*point) for point in points]
    missing = {name: point for name, point in zip(names, points, strict=True) if name not in store.points}
    pool = ProcessPool(processes or os.cpu_count(), context=multiprocessing.get_context("spawn"))
    try:
        futures = {pool.schedule(judgement, (point,), timeout=most_seconds): name for name, point in missing.items()}
        for future in progress(as_completed(futures), len(futures), "points"):
            name, ended = futures[future], ENDED.get(type(future.exception()))
            verdict = Verdict(ended) if ended else future.result()
            store.add(name, {**missing[name]._asdict(), **verdict._asdict()})
    finally:
        pool.stop()  # also those that are still at work, if something stops this loop
        pool.join()
    return table(store.points[name] for name in names)
