"""Wall times of several jobs, interleaved: all see the same load of the machine."""

from statistics import median
from time import perf_counter


def interleaved(jobs, repeats, statistic=median, clock=perf_counter):
    """Median (or another statistic of the) time [s] of each job; each runs once before, untimed.

    jobs : dict of functions without arguments.  clock : function that gives the time [s].
    Returns dict of times and dict of what the untimed calls returned.
    """
    results = {name: job() for name, job in jobs.items()}
    times = {name: [] for name in jobs}
    for _ in range(repeats):
        for name, job in jobs.items():
            started = clock()
            job()
            times[name].append(clock() - started)
    return {name: statistic(each) for name, each in times.items()}, results
