"""Wall times of several jobs, interleaved: all see the same load of the machine."""

from statistics import median
from time import perf_counter


def interleaved(jobs, repeats):
    """Median time [s] of each job, a dict of functions without arguments; each runs once before, untimed.

    Returns dict of times and dict of what the untimed calls returned.
    """
    results = {name: job() for name, job in jobs.items()}
    times = {name: [] for name in jobs}
    for _ in range(repeats):
        for name, job in jobs.items():
            started = perf_counter()
            job()
            times[name].append(perf_counter() - started)
    return {name: median(each) for name, each in times.items()}, results
