"""Judge many points in parallel, keep each verdict in a file at once, and survive what a point may do to its process.

The file (`store.Lines`) holds the point and its verdict by the key of the point. The key is made of the point, of the
sources of the kernels and of the map, so a verdict is used again only for what it was found with.
"""

import faulthandler
import hashlib
import json
import multiprocessing
import os
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from time import perf_counter

from tetherfmu.study.measuring.store import Lines, package_digest

from .points import Point
from .verdict import Verdict, judge

BATCH = 4  # points that a process gets at a time
MOST_SECONDS = 120.0  # for one point with its refinement: 90 calls; beyond it the process is ended


def key(point):
    """Name of a point and of the sources that judge it: 16 hexadecimal digits."""
    text = json.dumps([package_digest(), *point])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def read(path):
    """Verdicts in a file: dict of (Point, Verdict) by key; nothing where there is no file."""
    return _verdicts_in(Lines(path))


def _verdicts_in(lines):
    found = {}
    for name, row in lines.points.items():
        try:
            found[name] = Point(**row["point"]), Verdict(**row["verdict"])
        except (KeyError, TypeError):
            continue  # of another version
    return found


def _judge_all(judgement, points, most_seconds):
    """Verdicts of some points; the process ends if one takes longer."""
    verdicts = []
    for point in points:
        faulthandler.dump_traceback_later(most_seconds, exit=True)
        verdicts.append(judgement(point))
        faulthandler.cancel_dump_traceback_later()
    return verdicts


def _executor(processes):
    return ProcessPoolExecutor(processes, mp_context=multiprocessing.get_context("spawn"))


def _judge_alone(judgement, point, most_seconds=MOST_SECONDS):
    """Verdict of a point in a process of its own, which may die or take too long [s]."""
    started = perf_counter()
    with _executor(1) as executor:
        try:
            return executor.submit(_judge_all, judgement, [point], most_seconds).result()[0]
        except BrokenProcessPool:
            return Verdict("hanging" if perf_counter() - started > most_seconds else "crashed")


def _verdicts(judgement, points, processes):
    """Pairs (point, verdict) as they come."""
    waiting = [points[i : i + BATCH] for i in range(0, len(points), BATCH)][::-1]
    while waiting:
        running, suspects = {}, []
        with _executor(processes) as executor:
            while (waiting or running) and not suspects:
                while waiting and len(running) < 2 * processes:
                    batch = waiting.pop()
                    running[executor.submit(_judge_all, judgement, batch, MOST_SECONDS)] = batch
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    batch = running.pop(future)
                    if isinstance(future.exception(), BrokenProcessPool):
                        suspects += batch
                    else:
                        yield from zip(batch, future.result(), strict=True)
            suspects += [point for batch in running.values() for point in batch]
        for point in suspects:
            yield point, _judge_alone(judgement, point)


def judge_all(points, path, processes=None, judgement=judge, progress=iter):
    """Judge the points that the file at `path` does not have yet, and append them; returns all (Point, Verdict), in order.

    processes : how many work at a time; None: one per core.  judgement : function of a point.  progress : wraps the iterator
    of verdicts, as tqdm does.
    """
    lines = Lines(path)
    found = _verdicts_in(lines)
    missing = [point for point in points if key(point) not in found]
    for point, verdict in progress(_verdicts(judgement, missing, processes or os.cpu_count())):
        lines.add(key(point), {"point": point._asdict(), "verdict": verdict._asdict()})
        found[key(point)] = point, verdict
    return [found[key(point)] for point in points]
