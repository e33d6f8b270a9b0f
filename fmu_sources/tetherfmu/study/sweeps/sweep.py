"""The sweep of a scene or of a system: all flights on any executor, kept as they finish, in one table."""

import math
import sys
from concurrent.futures import as_completed
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import pandas as pd

from tetherfmu.console.ending import WorkersLost
from tetherfmu.files.scene_files import Scene, SceneError, load, read
from tetherfmu.files.settings import check_settings, with_settings
from tetherfmu.files.toml_files import WrongUse, check_once, tables_of
from tetherfmu.runtime.naming import check_names, prefixed
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, Tether
from tetherfmu.runtime.variants import BY_NAME, VARIANTS
from tetherfmu.study.measuring import system_flights
from tetherfmu.study.measuring.executors import executor_of, progress_bar
from tetherfmu.study.measuring.runs import Config, least_cost
from tetherfmu.study.measuring.store import Store, key

from . import system_sweeps
from .statistics import USUAL, Statistics, Task, fly_all
from .varied import all_varied, points, unit_of

FLIGHTS = "flights.jsonl"  # file of finished flights
STEP = 0.02  # default communication step [s]
TASK, MOST_PER_TASK = 0.5, 200  # work of a task, about [s]; flights in it
FEWEST_TASKS = 32


def config_of(scene, tether, segments, step):
    """`Config` of all flights of a sweep; ValueError for a tether that cannot fly the scene."""
    check_names("sweep", [tether], VARIANTS, "tether")
    if scene.kite_is_free and tether != "dynamic":
        raise ValueError(f"tether is {tether}; the free end of {scene.name} is moved by the dynamic tether only")
    variant, step = BY_NAME[tether], step or scene.wanted.communication_step or STEP
    return Config(tether, segments if variant.has_nodes else 0, DEFAULT_TOLERANCE if variant.has_waves else 0.0, step)


class Subject(NamedTuple):
    """What a sweep flies: a scene or a system."""

    base: Any  # `Scene` or `SystemFlight`, with the settings of all flights
    path: Path
    table: dict  # of the file, with these settings
    config: Any
    unit_in: Any  # as for `all_varied`, as the next one
    check: Any


def subject_of(scene, settings, tether, segments, step, quiet=False):
    """`Subject` of a file or a name; ValueError for a wrong one. Doubts on it are printed, unless it is to be quiet."""
    path, is_system = system_flights.file_of(scene)
    if is_system:
        with prefixed(f"{path}: ", SceneError):
            table = system_flights.with_values(tables_of(path), settings)
            base = system_flights.read(table, path.parent, path.stem)
        if tether != "dynamic":
            raise ValueError(f"tether is {tether}; the lines of a system are dynamic")
        if segments is not None:
            raise ValueError("segments are those of each line of a system, lines.NAME.segments")
        config = system_sweeps.SystemConfig(step or base.wanted.communication_step)
        return Subject(base, path, table, config, system_sweeps.unit_in(base), check_once)
    base = load(path, settings, quiet=quiet)
    table = with_settings(tables_of(path), settings)
    config = config_of(base, tether, Tether.segments if segments is None else segments, step)
    return Subject(base, path, table, config, partial(unit_of, flight=table["flight"]["kind"]), check_settings)


def statistics_for(subject, names, outputs, percentiles, cycles_of, start):
    """`Statistics` of a `Subject`; None for the usual ones. names : of what is varied. ValueError for wrong ones."""
    rest = tuple(map(float, percentiles))
    if isinstance(subject.base, Scene):
        given = Statistics(tuple(outputs or USUAL.outputs), rest, cycles_of or USUAL.cycles_of, float(start))
        return given.checked()
    flight = subject.base
    listed = system_sweeps.outputs_of(flight, outputs, names)
    counted = cycles_of or f"{flight.found.lines[0].name}.{system_sweeps.USUAL[0]}"
    return Statistics(listed, rest, counted, float(start)).checked(system_sweeps.known_outputs(flight))


def tasks_of(task, scene, missing):
    """Tasks of the missing flights, so large that the overhead is small: a list of `Task`.

    task : `Task` without flights.  scene : or a `SystemFlight`.  missing : pairs (key, values).
    """
    is_system = isinstance(task.config, system_sweeps.SystemConfig)
    cost = system_sweeps.cost_of(scene, task.config) if is_system else least_cost(scene, task.config) * scene.duration
    cost = max(1e-4, cost)
    size = max(1, min(math.ceil(TASK / cost), MOST_PER_TASK, math.ceil(len(missing) / FEWEST_TASKS)))
    return [task._replace(flights=tuple(missing[k : k + size])) for k in range(0, len(missing), size)]


def collect(tasks, executor, store, name):
    """Run tasks on an executor (None: here), and keep their results in a `Store` (modified), with a progress bar."""
    if executor is None:
        done = map(fly_all, tasks)
    else:
        futures = [executor.submit(fly_all, task) for task in tasks]
        done = (future.result() for future in as_completed(futures))
    with progress_bar(None, sum(len(task.flights) for task in tasks), name) as bar:
        for found in done:
            store.add_all(found)
            bar.update(len(found))


def fly_missing(task, scene, flights, store, executor, processes, dask):
    """Run all flights (dict key -> values) that a `Store` (modified) lacks.

    If a process of this machine is killed, others continue its work; `WorkersLost` if they are also killed
    before they finish anything.
    """
    while missing := [(name, values) for name, values in flights.items() if name not in store.points]:
        tasks, before = tasks_of(task, scene, missing), len(store.points)
        if executor is not None or processes == 1:
            collect(tasks, executor, store, scene.name)
            continue
        try:
            with executor_of(dask, processes) as own:
                collect(tasks, own, store, scene.name)
        except WorkersLost:
            if dask is not None or len(store.points) == before:
                raise


def doubts_of_extremes(task, quantities, values):
    """Sentences on implausible flights with the least and the largest value of each quantity, without duplicates.

    task : `Task`.  quantities, values : of all flights, as in `varied.points`.
    """
    found = {}
    for k in (k for k, each in enumerate(quantities) if each.unit is not None):
        for extreme in (least(values, key=lambda flight, k=k: flight[k][1]) for least in (min, max)):
            with suppress(ValueError):  # reported in the row of that flight
                found |= dict.fromkeys(read(with_settings(task.table, extreme), task.folder, task.name).doubts())
    return list(found)


def sweep(
    scene,
    vary,
    *,
    samples=100,
    method="latin_hypercube",
    seed=1,
    settings=(),
    outputs=None,
    percentiles=USUAL.percentiles,
    cycles_of=None,
    start=0.0,
    tether="dynamic",
    segments=None,
    step=None,
    out=None,
    executor=None,
    processes=None,
    dask=None,
):
    """Fly a scene or a system with many values; a DataFrame with a row for each flight.

    Columns: the varied values (SI units) by name; of each output its largest and least value, mean, root mean square and
    percentiles, as ``kite_tension_max``, ``_min``, ``_mean``, ``_rms``, ``_p5``; of the power also its means while the winch
    reels out and in, ``power_mean_out`` and ``power_mean_in``; ``peak_tension`` [N], the largest of all internal steps;
    ``cycles`` and ``largest_cycle`` by rainflow counting; ``time_slack`` [s], with a slack segment; ``broken``, 1 of a
    tether that broke, and ``break_time`` [s], NaN of others; ``refused``, why a flight could not be flown, whose statistics
    are NaN, or "".
    ``attrs["bins"]`` has the cycles of each flight by range, see `flights.counted`.

    The numbers do not depend on who does the work.  ValueError says in one line what is not possible, WorkersLost that
    nobody is left to do the work.

    Parameters
    ----------
    scene : str or Path
        File of a scene or of a system, or a name of `tetherfmu fly --list`.
    vary : sequence of str, or dict
        Texts as of ``--vary``, such as ``"tether.diameter=3 mm..6 mm:4"``; or by name a sequence of values or a distribution
        of scipy.stats. All points of the grid are flown with all samples of the distributions.
    samples : int
        Number of samples, if anything has a distribution.
    method : "latin_hypercube" or "sobol"
        How they are drawn; the points of Sobol are balanced if their number is a power of 2.
    seed : int
        Of the samples; with the same one they are the same.
    settings : sequence of (str, value)
        Values in the place of those of the file, in all flights.
    outputs : sequence of str or None
        Scalar outputs, ``kite_force`` and ``ground_force``, of which the magnitude is taken, ``power`` [W], the tension at
        the winch times its speed, or ``payout`` [m] since the start.  Of a system: one (``hoist.tension_from``), or those of
        all lines (``tension_from``).  None: tensions at both ends, power and payout.
    percentiles : sequence of float
        From 0 to 100.
    cycles_of : str or None
        Output whose cycles are counted; None: the tension at the ground, or at the start of the first line of a system.
    start : float
        Time that the statistics leave out before [s].
    tether : str
        "dynamic", "quasi_steady", "catenary" or "straight".
    segments : int or None
        None: 20.  The lines of a system have those of their file.
    step : float or None
        Communication step [s]; None: that of the scene, or 20 ms.
    out : str or Path or None
        Folder in which finished flights are kept; with the same one, a stopped sweep continues.
    executor : None, executor of concurrent.futures or Dask client
        Who does the work; None: processes of this machine.
    processes : int or None
        How many, if there is no executor; None: one per core; 1: this process.
    dask : str or None
        Address of a Dask scheduler that does the work.

    Examples
    --------
    >>> from tetherfmu.study import sweep
    >>> table = sweep("circle", ["wind.speed=6,9"], settings=[("duration", 2.0)], processes=1)
    >>> bool(table.kite_tension_max[1] > table.kite_tension_max[0])
    True
    """
    subject = subject_of(scene, settings, tether, segments, step)
    base, path, table, config, unit_in, check = subject
    quantities = all_varied(vary, unit_in, path.parent, settings, check)
    statistics = statistics_for(subject, [each.name for each in quantities], outputs, percentiles, cycles_of, start)
    if not 0.0 <= start < base.duration:
        raise WrongUse(f"start is {start:g} s; it must be at least 0 s and less than the duration, {base.duration:g} s")
    if isinstance(samples, bool) or int(samples) != samples or samples < 1:
        raise WrongUse(f"samples is {samples!r}; it must be a whole number of at least 1")
    if round(start / config.step) >= round(base.duration / config.step):
        raise WrongUse(
            f"step is {config.step:g} s; at least one whole step must lie between start, {start:g} s, and the duration, "
            f"{base.duration:g} s"
        )
    task = Task(table, path.parent, base.name, config, statistics, ())
    values = points(quantities, int(samples), method, seed)
    for doubt in doubts_of_extremes(task, quantities, values) if isinstance(base, Scene) else ():
        if doubt not in base.doubts():  # printed by `load`
            print(f"{path}: {doubt}", file=sys.stderr)
    keys = [key(base.digest, *config, *statistics, *statistics.columns(), each) for each in values]
    in_memory = SimpleNamespace(points=(found := {}), add_all=found.update)
    store = Store(Path(out) / FLIGHTS) if out is not None else in_memory
    if hasattr(executor, "get_executor"):  # a Dask client
        executor = executor.get_executor(pure=False)
    fly_missing(task, base, dict(zip(keys, values, strict=True)), store, executor, processes, dask)
    return frame_of(quantities, values, statistics, [store.points[each] for each in keys])


def frame_of(quantities, values, statistics, found):
    """The table of a sweep, see `sweep`; found : results of `flights.fly` for each flight."""
    table = pd.DataFrame([dict(each) for each in values], columns=[each.name for each in quantities])
    numbers = pd.DataFrame(found).reindex(columns=[*statistics.columns(), "refused"])
    numbers["refused"] = [each.get("refused", "") for each in found]
    table = pd.concat([table, numbers], axis=1).rename_axis("flight")
    table.attrs = {"bins": [each.get("bins", {}) for each in found]}
    table.attrs["units"] = {each.name: each.unit for each in quantities} | statistics.columns()
    table.attrs["varied"] = [each.name for each in quantities]
    return table
