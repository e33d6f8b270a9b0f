"""A flight of a sweep, and its statistics."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import rainflow

from tetherfmu.console.ending import one_line
from tetherfmu.files.scene_files import read
from tetherfmu.files.settings import with_settings
from tetherfmu.python.results import SCALARS
from tetherfmu.runtime.naming import meant_or_all
from tetherfmu.study.measuring import flight_table
from tetherfmu.study.measuring.runs import Config, run
from tetherfmu.wiring.selection import own_name

from . import system_sweeps

FORCES = ("kite_force", "ground_force")  # vectors, reduced to their magnitude
OUTPUTS = (*FORCES, *SCALARS, *flight_table.DERIVED)
BINS_PER_DECADE = 20  # of the ranges of cycles
SMALLEST_RANGE = 1e-3  # of a cycle that is counted [N]


class Statistics(NamedTuple):
    """Requested statistics of each flight."""

    outputs: tuple = ("kite_tension", "ground_tension", "power", "payout")  # of `OUTPUTS`
    percentiles: tuple = (5.0, 50.0, 95.0)
    cycles_of: str = "ground_tension"  # output for cycle counting
    start: float = 0.0  # start of the evaluation [s]

    def checked(self, known=OUTPUTS):
        """The checked statistics; ValueError names a problem. known : names of outputs."""
        for name in (*self.outputs, self.cycles_of):
            if name not in known:
                raise ValueError(f"there is no output {name!r}{meant_or_all(str(name), known)}")
        for each in self.percentiles:
            if not 0.0 <= each <= 100.0:
                raise ValueError(f"a percentile is {each:g}; it must be from 0 to 100")
        return self

    def columns(self):
        """Names of the statistics of a flight, and their units, a dict."""
        found = {}
        for name in self.outputs:
            parts = ("max", "min", "mean", "rms", *(f"p{each:g}" for each in self.percentiles))
            parts += PHASES if own_name(name) == "power" else ()
            found |= {f"{name}_{part}": flight_table.unit_of(own_name(name)) for part in parts}
        unit = flight_table.unit_of(own_name(self.cycles_of))
        found |= {"peak_tension": "N", "cycles": "", "largest_cycle": unit, "time_slack": "s"}
        return found | {"broken": "", "break_time": "s"}


PHASES = ("mean_out", "mean_in")  # statistics of the power alone: means while the winch reels out and in
USUAL = Statistics()


class Task(NamedTuple):
    """Flights that are done at a time, in any process."""

    table: dict  # of the scene file
    folder: Path
    name: str
    config: Config | system_sweeps.SystemConfig
    statistics: Statistics
    flights: tuple  # pairs (key, values): pairs of name and value


def columns_of(flown, length):
    """`OUTPUTS` along a flight, a `Flown`, arrays (rows,) by name; length : of the tether at the start [m]."""
    found = {name: flown.of(name) for name in SCALARS}
    found |= {name: np.linalg.norm(getattr(flown, name), axis=1) for name in FORCES}
    return found | {"power": found["ground_tension"] * found["winch_speed"], "payout": found["tether_length"] - length}


def counted(series):
    """Cycles of a series by rainflow counting (ASTM E1049): how many, the largest range, and how many by bin.

    The bins are a dict of text (for JSON): k has ranges from 10^(k/20) to 10^((k + 1)/20).
    """
    bins, count, largest = {}, 0.0, 0.0
    for size, _, number, _, _ in rainflow.extract_cycles(series):
        if size >= SMALLEST_RANGE:
            place = str(math.floor(BINS_PER_DECADE * math.log10(size)))
            bins[place] = bins.get(place, 0.0) + number
            count, largest = count + number, max(largest, size)
    return count, largest, bins


def statistics_of(columns, wanted, step):
    """Statistics of a flight, a dict of numbers by `Statistics.columns`, and as `bins` the result of `counted`.

    columns : outputs by name, arrays with a row for each communication step [s].  wanted : `Statistics`.
    """
    rows = slice(round(wanted.start / step), None)
    found: dict[str, Any] = {}
    for name in wanted.outputs:
        values = columns[name][rows]
        found |= {f"{name}_max": values.max(), f"{name}_min": values.min()}
        found |= {f"{name}_mean": values.mean(), f"{name}_rms": np.sqrt(np.mean(values**2))}
        if own_name(name) == "power":
            of_phases = flight_table.phases(columns[f"{name.removesuffix('power')}winch_speed"][rows])
            found |= {f"{name}_mean_{phase}": values[mask].mean() for phase, mask in of_phases.items() if mask.any()}
        shares = np.percentile(values, wanted.percentiles) if wanted.percentiles else ()
        found |= {f"{name}_p{each:g}": value for each, value in zip(wanted.percentiles, shares, strict=True)}
    cycles, largest, bins = counted(columns[wanted.cycles_of][rows])
    found |= {"peak_tension": columns["peak_tension"][rows].max(), "cycles": cycles, "largest_cycle": largest}
    found["time_slack"] = step * np.count_nonzero(columns["slack_segments"][rows])
    found["broken"] = columns["broken"][-1]
    if found["broken"]:
        found["break_time"] = columns["break_time"][-1]
    return {name: float(value) for name, value in found.items()} | {"bins": bins}


def fly(task, values):
    """Statistics of one flight of a `Task` with these values, a dict; of one that is refused `refused`, the reason."""
    try:
        if "points" in task.table:
            return statistics_of(system_sweeps.flown(task, values), task.statistics, task.config.step)
        scene = read(with_settings(task.table, values), task.folder, task.name)
        found = run(replace(scene, every=task.config.step), task.config)
    except (ValueError, OSError) as error:  # also StepRefused and WrongUse
        return {"refused": one_line(error)}
    return statistics_of(columns_of(found.flown, found.length), task.statistics, task.config.step)


def fly_all(task):
    """`fly` of all flights of a `Task`, a dict by key."""
    return {key: fly(task, values) for key, values in task.flights}
